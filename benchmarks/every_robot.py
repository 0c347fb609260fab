"""Every robot of the catalogue: nanoseconds per pose of W1 and W2, bytes and seconds of what is compiled.

W1 is `jacobian_blocks` here (J and K from pose, end points and joint angles), W2 is `inverse`.  The geometry
is an argument, as in a controller that is compiled once; batches are arrays of structures.
"""

from __future__ import annotations

import ctypes
import time
from dataclasses import asdict, dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

import krhpr
from benchmarks.build import HARNESS_FLAGS, PLUMBING_FLAGS, SPEED_FLAGS, Tools, run, section_sizes
from benchmarks.harness import CLOCK
from benchmarks.measure import CHUNK_NS, POOL, Series
from krhpr.backend import c_sources
from krhpr.validation.sampling import rotations

FUNCTIONS = {"w1": "jacobian_blocks", "w2": "inverse"}
KINDS = {"single": "", "batch": "_batch"}
NEAR = 0.05
"""How far poses are from home: metres, radians, and relative for slides."""

DRIVER = """#include "krhpr_@NAME@.h"
#include <time.h>
"""
LOOPS = """
double @KEY@_single(long calls, long pool, const void *g, const double *const *in, double *const *out) {
    const double start = now_ns();
    long i = 0;
    for (long call = 0; call < calls; ++call) {
        krhpr_@NAME@_@FUNCTION@(@ONE@);
        i = i + 1 == pool ? 0 : i + 1;
    }
    return (now_ns() - start) / (double)calls;
}

double @KEY@_batch(long calls, long pool, const void *g, const double *const *in, double *const *out) {
    static const ptrdiff_t in_step[] = {@IN_STEP@}, out_step[] = {@OUT_STEP@};
    const double start = now_ns();
    for (long call = 0; call < calls; ++call) {
        krhpr_@NAME@_@FUNCTION@_batch(g, (size_t)pool, in, in_step, out, out_step, NULL, 0);
    }
    return (now_ns() - start) / (double)(calls * pool);
}
"""


@dataclass(frozen=True)
class RobotRow:
    """What was measured of one robot."""

    robot: str
    nanoseconds: dict[str, float]  # "w1 single", ...: medians
    undisturbed: dict[str, float]  # tenth percentiles
    text_bytes: dict[str, int]  # "single", "batch"
    seconds: dict[str, float]  # to compile them

    def as_json(self) -> dict[str, Any]:
        """For results.json."""
        return asdict(self)


def measure(out: Path, tools: Tools, rounds: int) -> list[RobotRow]:
    """All robots, one after the other."""
    out.mkdir(parents=True, exist_ok=True)
    return [_robot(krhpr.load(name), out, tools, rounds) for name in krhpr.catalogue()]


def _robot(robot: krhpr.Robot, out: Path, tools: Tools, rounds: int) -> RobotRow:
    name = robot.identifier
    objects, sizes, seconds = [], {}, {}
    for kind, ending in KINDS.items():
        target = out / f"{name}{ending}.o"
        source = c_sources() / f"krhpr_{name}{ending}.c"
        start = time.perf_counter()
        run([tools.cc, *SPEED_FLAGS, *PLUMBING_FLAGS, "-c", str(source), "-o", str(target)])
        seconds[kind] = time.perf_counter() - start
        sizes[kind] = section_sizes(target)[0]
        objects.append(str(target))
    driver, library = out / f"{name}_driver.c", out / f"{name}.so"
    driver.write_text(_driver(robot))
    flags = [*HARNESS_FLAGS, f"-I{c_sources()}"]
    run([tools.cc, *flags, "-shared", "-o", str(library), str(driver), *objects, "-lm"])
    loops = ctypes.CDLL(str(library))
    geometry = _geometry(robot, loops)
    samples = _inputs(robot)
    jobs: dict[str, tuple[Any, Any, Any]] = {}
    for key, function in FUNCTIONS.items():
        signature = robot.signature(function)
        given = [np.ascontiguousarray(samples[port.name]) for port in signature.inputs]
        found = [np.empty((POOL, *port.shape)) for port in signature.outputs]
        for mode in KINDS:
            loop = getattr(loops, f"{key}_{mode}")
            loop.restype = ctypes.c_double
            jobs[f"{key} {mode}"] = loop, given, found
    series = _series(jobs, geometry, rounds)
    medians = {label: one.median for label, one in series.items()}
    low = {label: one.low for label, one in series.items()}
    return RobotRow(name, medians, low, sizes, seconds)


def _series(jobs: dict[str, tuple[Any, Any, Any]], geometry: Any, rounds: int) -> dict[str, Series]:
    def once(label: str, calls: int) -> float:
        loop, given, found = jobs[label]
        pointers = [(ctypes.c_void_p * len(x))(*(a.ctypes.data for a in x)) for x in (given, found)]
        return float(loop(ctypes.c_long(calls), ctypes.c_long(POOL), geometry, *pointers))

    calls = {}
    for label in jobs:
        each = min(once(label, 10), once(label, 10)) * (POOL if label.endswith("batch") else 1)
        calls[label] = max(1, round(CHUNK_NS / max(each, 1.0)))
    times: dict[str, list[float]] = {label: [] for label in jobs}
    for _ in range(rounds):
        for label in jobs:
            times[label].append(once(label, calls[label]))
    return {label: Series(found) for label, found in times.items()}


def _driver(robot: krhpr.Robot) -> str:
    text = DRIVER + CLOCK
    for key, function in FUNCTIONS.items():
        signature = robot.signature(function)
        inputs = [
            f"in[{k}] + {prod(port.shape)} * i" if port.shape else f"in[{k}][i]"
            for k, port in enumerate(signature.inputs)
        ]
        outputs = [f"out[{k}] + {prod(port.shape)} * i" for k, port in enumerate(signature.outputs)]
        words = {
            "KEY": key,
            "FUNCTION": function,
            "ONE": ", ".join(["g", *inputs, *outputs]),
            "IN_STEP": ", ".join(str(prod(port.shape)) for port in signature.inputs),
            "OUT_STEP": ", ".join(str(prod(port.shape)) for port in signature.outputs),
        }
        made = LOOPS
        for word, value in words.items():
            made = made.replace(f"@{word}@", value)
        text += made
    return text.replace("@NAME@", robot.identifier)


def _geometry(robot: krhpr.Robot, library: ctypes.CDLL) -> ctypes.Array[ctypes.c_char]:
    prefix = f"krhpr_{robot.identifier}"
    size = getattr(library, f"{prefix}_geometry_size")
    size.restype = ctypes.c_size_t
    buffer = ctypes.create_string_buffer(size())
    fields = np.ascontiguousarray(robot.geometry.flat(), dtype=float)
    getattr(library, f"{prefix}_set_geometry")(buffer, fields.ctypes.data_as(ctypes.c_void_p))
    return buffer


def _inputs(robot: krhpr.Robot, seed: int = 1) -> dict[str, Any]:
    """As many poses within reach as the pool holds, with everything that the functions take."""
    home, rng, many = robot.home, np.random.default_rng(seed), 20 * POOL
    p = np.asarray(home.p) + NEAR * rng.uniform(-1, 1, (many, len(home.p)))
    turn = NEAR * rng.uniform(-1, 1, (many, 1 if robot.planar else 3))
    Q = home[1] + turn[:, 0] if robot.planar else np.asarray(home[1]) @ rotations(turn)
    redundant = np.asarray(home.redundant) * rng.uniform(1 - NEAR, 1 + NEAR, (many, 3))
    samples = {"p": p, "phi" if robot.planar else "Q": Q, "redundant": redundant}
    signs = np.asarray(robot.mode_signs(), dtype=float)
    samples["mode"] = np.broadcast_to(signs, (many, *signs.shape))
    samples["swivel"] = NEAR * rng.uniform(-1, 1, (many, 3))
    taken = [samples[port.name] for port in robot.signature("inverse").inputs]
    theta, status = robot.call("inverse", *taken, status=True)
    samples |= {"theta": theta, "s": robot.end_points(p, Q, redundant)}
    good = np.flatnonzero(status == 0)[:POOL]
    if len(good) < POOL:
        raise RuntimeError(
            f"{robot.identifier}: {len(good)} of {many} poses about home are in reach, {POOL} needed"
        )
    return {name: np.array(values[good]) for name, values in samples.items()}
