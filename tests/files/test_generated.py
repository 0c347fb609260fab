"""Code generated for robot files stands alone, under the file's name, and computes what the derivation says.

Sizes are drawn, and differ from leg to leg; arguments are consistent configurations at those sizes.  Truth is
the derivation in 300-bit balls.
"""

from __future__ import annotations

import ctypes
import importlib
import inspect
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.output import MARK, write
from krhpr.codegen.pipeline import Custom, customised, derive, print_all
from krhpr.codegen.standalone import standalone_files
from krhpr.codegen.targets.base import File
from krhpr.derivations.catalogue import catalogue
from krhpr.limits import Cone, Interval, Limits
from krhpr.validation.agreement import true_values
from krhpr.validation.sampling import Batch, draw
from krhpr.validation.scale import relative, worst_of
from tests.c.support import COMPILERS, CONFORMANCE, CPP, CPP_CONFORMANCE
from tests.files.support import EXAMPLE
from tests.support import SOME, THOROUGH, contents, run_python
from tests.validation.support import subject

ROBOTS = krhpr.catalogue()
SAMPLES = 2
TOLERANCE = 1e-10
"""Relative to the scale of an output: doubles against the derivation, in well conditioned configurations."""

LIMITS = Limits(
    actuators={"theta_1": (Interval(-1.0, 1.0), Interval(-1.0, 2.0), Interval(-1.0, 3.0))},
    spherical=(Cone(1.0),) * 3,
    link_radii={"l_1": (0.01, 0.02, 0.03)},
    clearance=0.005,
    axis_distance=0.02,
    elbow=Interval(0.2, 3.0),
)

# -- against the derivation ---------------------------------------------------------------------------------


@cache
def batch_of(identifier: str) -> Batch:
    """Sizes and configurations of a robot."""
    return draw(subject(identifier), 7, SAMPLES)


@cache
def arguments_of(identifier: str, function: str) -> Batch:
    """The same; errors and residuals, which cancel in consistent configurations, beside them."""
    batch = batch_of(identifier)
    beside = {"constraints": "s", "rotation_error": "Q"}.get(function)
    if beside is None:
        return batch
    values = batch.values[beside]
    return batch.changed(**{beside: values + np.random.default_rng(3).uniform(-0.03, 0.03, values.shape)})


@cache
def truth(identifier: str, function: str) -> list[Mapping[str, Any]]:
    """What the derivation says of a function at each configuration."""
    batch = arguments_of(identifier, function)
    found = batch.subject.code.function(function)
    return [true_values(batch, found, index) for index in range(SAMPLES)]


def files_of(
    identifier: str, *, baked: bool, name: str = "my_arm", limits: Limits | None = None
) -> list[File]:
    """What a folder called `gathered` holds for a robot of one's own."""
    entry = next(entry for entry in catalogue() if entry.identifier == identifier)
    sizes = {field: tuple(map(float, values)) for field, values in batch_of(identifier).geometry.items()}
    custom = Custom(name, sizes, limits or Limits(), baked)  # type: ignore[arg-type]
    derived = customised(derive([entry]), [custom])
    return standalone_files(derived, print_all(derived), "gathered")


@dataclass(frozen=True)
class Gathered:
    """A folder with a robot of one's own, and what is imported from it."""

    folder: Path
    identifier: str
    baked: bool
    python: ModuleType
    casadi: ModuleType


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(
            (name, baked),
            id=f"{name}-{'baked' if baked else 'free'}",
            # small samples: baked and free in turns
            marks=() if name in SOME and baked == bool(SOME.index(name) % 2) else pytest.mark.full,
        )
        for name in THOROUGH
        for baked in (True, False)
    ],
)
def gathered(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Gathered]:
    identifier, baked = request.param
    above = tmp_path_factory.mktemp("above")
    write(files_of(identifier, baked=baked), above / "gathered")
    sys.path.insert(0, str(above))
    try:
        python = importlib.import_module("gathered.python.my_arm")
        casadi = importlib.import_module("gathered.casadi.my_arm")
        yield Gathered(above / "gathered", identifier, baked, python, casadi)
    finally:
        sys.path.remove(str(above))
        for name in [name for name in sys.modules if name.partition(".")[0] == "gathered"]:
            del sys.modules[name]


def functions(identifier: str) -> list[RobotFunction]:
    """Functions with a formula for everything that they do."""
    return [f for f in batch_of(identifier).subject.code.functions if not f.procedure]


def hold(identifier: str, function: RobotFunction, results: Mapping[str, Any]) -> None:
    """Results (configurations first) are those of the derivation."""
    for index, expected in enumerate(truth(identifier, function.name)):
        for port in function.outputs:
            got = np.asarray(results[port.name][index], dtype=float).reshape(port.full_shape)
            error, _ = worst_of(relative(port, got[None], expected[port.name][None]))
            assert error < TOLERANCE, (function.name, port.name, error)


def test_the_numpy_module_computes_what_the_derivation_says(gathered: Gathered) -> None:
    for function in functions(gathered.identifier):
        batch = arguments_of(gathered.identifier, function.name)
        answer = getattr(gathered.python, function.name)(*batch.of(function).values())
        answers = answer if len(function.outputs) > 1 else (answer,)
        hold(
            gathered.identifier, function, dict(zip((p.name for p in function.outputs), answers, strict=True))
        )


def test_the_casadi_functions_compute_it(gathered: Gathered) -> None:
    for function in functions(gathered.identifier):
        batch = arguments_of(gathered.identifier, function.name)
        made = gathered.casadi.FUNCTIONS[function.name]
        call = made() if gathered.baked else made(gathered.casadi.DEFAULT_GEOMETRY)
        results: dict[str, list[Any]] = {port.name: [] for port in function.outputs}
        for index in range(SAMPLES):
            given = [_two(batch.argument(port)[index]) for port in function.inputs]
            found = dict(zip(call.name_out(), call.call(given), strict=True))
            for port in function.outputs:
                whole = port.name in found
                numbers = range(1, port.full_shape[0] + 1) if not whole else ()
                parts = [found[port.name]] if whole else [found[f"{port.name}{number}"] for number in numbers]
                results[port.name].append(np.stack([np.asarray(part.full()) for part in parts]))
        hold(gathered.identifier, function, results)


def _two(value: Any) -> Any:
    import casadi as ca

    array = np.asarray(value, dtype=float)
    return ca.DM(array if array.ndim <= 2 else array.reshape(array.shape[0], -1))


@pytest.mark.compiler
def test_the_compiled_c_computes_it(gathered: Gathered) -> None:
    library = _library(gathered)
    pointer = ctypes.POINTER(ctypes.c_double)
    first: list[Any] = []
    if not gathered.baked:
        library.krhpr_my_arm_geometry_size.restype = ctypes.c_size_t
        geometry = ctypes.create_string_buffer(library.krhpr_my_arm_geometry_size())
        assert library.krhpr_my_arm_default_geometry(geometry) == 0
        first = [geometry]
    for function in functions(gathered.identifier):
        batch = arguments_of(gathered.identifier, function.name)
        results: dict[str, list[Any]] = {port.name: [] for port in function.outputs}
        for index in range(SAMPLES):
            arguments: list[Any] = list(first)
            for port in function.inputs:
                value = np.array(batch.argument(port)[index], dtype=float, order="C")
                scalar = not port.full_shape
                arguments.append(ctypes.c_double(value.item()) if scalar else value.ctypes.data_as(pointer))
            outs = [np.full(port.full_size, np.nan) for port in function.outputs]
            arguments += [out.ctypes.data_as(pointer) for out in outs]
            assert getattr(library, f"krhpr_my_arm_{function.name}")(*arguments) == 0, function.name
            for port, out in zip(function.outputs, outs, strict=True):
                results[port.name].append(out)
        hold(gathered.identifier, function, results)


def _library(gathered: Gathered) -> ctypes.CDLL:
    made = gathered.folder.parent / "my_arm.so"
    if not made.exists():
        source = gathered.folder / "c" / "krhpr_my_arm.c"
        _run("cc", "-std=c99", "-O0", "-fPIC", "-shared", source, "-o", made, "-lm")
    return ctypes.CDLL(str(made))


def _run(*command: object) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_baked_functions_take_no_geometry_and_others_do(gathered: Gathered) -> None:
    for function in batch_of(gathered.identifier).subject.code.functions:
        takes = "geometry" in inspect.signature(getattr(gathered.python, function.name)).parameters
        assert takes != gathered.baked
    header = (gathered.folder / "c" / "krhpr_my_arm.h").read_text()
    assert ("krhpr_my_arm_geometry" in header) != gathered.baked
    assert ("DEFAULT_GEOMETRY" in dir(gathered.python)) != gathered.baked
    assert ("GEOMETRY" in dir(gathered.python)) == gathered.baked


def test_the_geometry_is_that_of_the_file(gathered: Gathered) -> None:
    geometry = gathered.python.GEOMETRY if gathered.baked else gathered.python.DEFAULT_GEOMETRY
    for name, values in batch_of(gathered.identifier).geometry.items():
        assert tuple(geometry.fields[name]) == tuple(values)


def test_the_nearest_mode_is_found_there_too(gathered: Gathered) -> None:
    module, batch = gathered.python, batch_of(gathered.identifier)
    if "inverse_near" not in module.SIGNATURES:
        pytest.skip("its sub-legs have no closed form")
    function = batch.subject.code.function("inverse_near")
    values = {**batch.values, "theta_near": batch.values["theta"] + 0.01}
    found = module.inverse_near(*(values[port.name] for port in function.inputs))
    difference = np.angle(np.exp(1j * (found - batch.values["theta"])))
    assert np.abs(difference).max() < 1e-6 or not all(module.ANGULAR)


def test_the_text_is_the_same_on_every_run(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path\nfrom krhpr.cli import main\n"
        "sys.exit(main(['generate', sys.argv[1], '--bake', '--out', sys.argv[2]]))"
    )
    found = []
    for seed in ("0", "1"):
        folder = tmp_path / seed / "arm"
        folder.parent.mkdir()
        run = run_python("-c", code, str(EXAMPLE), str(folder), env={"PYTHONHASHSEED": seed})
        assert run.returncode == 0, run.stderr
        found.append(contents(folder))
    assert found[0] == found[1]
    assert all(MARK.encode() in data[:4096] for data in found[0].values())


# -- limits -------------------------------------------------------------------------------------------------

PROGRAM = """
#include <stdio.h>
#include "krhpr_my_arm.h"

int main(void)
{
    const struct krhpr_my_arm_limits *l = &krhpr_my_arm_limits;
    printf("%.17g %.17g %.17g ", l->actuators.theta_1[2][1], l->link_radii.l_1[1], l->clearance);
    printf("%.17g %.17g %.17g ", l->spherical[0].tilt, l->spherical[1].socket[0], l->spherical[2].stud[2]);
    printf("%.17g %.17g\\n", l->axis_distance, l->elbow[1]);
    return 0;
}
"""


@pytest.fixture(scope="module", params=[True, False], ids=["baked", "free"])
def limited(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for a robot with limits."""
    folder = tmp_path_factory.mktemp("above") / "gathered"
    write(files_of("spatial_rrr_a", baked=request.param, limits=LIMITS), folder)
    return folder


def test_the_module_carries_the_limits(limited: Path) -> None:
    code = (
        "import sys; sys.modules['krhpr'] = None; sys.path.insert(0, sys.argv[1])\n"
        "from gathered import my_arm\n"
        "print(repr(my_arm.LIMITS)); print(my_arm.LIMITS.actuators['theta_1'][2].high)"
    )
    printed = run_python("-c", code, str(limited.parent)).stdout.splitlines()
    assert printed == [repr(LIMITS), "3.0"]


@pytest.mark.parametrize("compiler", COMPILERS)
def test_the_header_declares_the_limits(limited: Path, compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    (tmp_path / "program.c").write_text(PROGRAM)
    place, binary = limited / "c", tmp_path / "program"
    sources = (tmp_path / "program.c", place / "krhpr_my_arm.c")
    _run(compiler, *CONFORMANCE, f"-I{place}", *sources, "-o", binary, "-lm")
    assert _run(binary).split() == ["3", "0.02", "0.0050000000000000001", "1", "1", "1", "0.02", "3"]
    if shutil.which(CPP[compiler]):
        (tmp_path / "program.cpp").write_text(PROGRAM)
        _run(
            CPP[compiler],
            *CPP_CONFORMANCE,
            f"-I{place}",
            "-c",
            tmp_path / "program.cpp",
            "-o",
            tmp_path / "p.o",
        )


@pytest.mark.compiler
@pytest.mark.parametrize("compiler", COMPILERS)
def test_the_casadi_shim_compiles_and_agrees(limited: Path, compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    import casadi as ca

    made = tmp_path / "shim.so"
    source = limited / "c" / "casadi" / "krhpr_my_arm_casadi.c"
    # clang names every kernel that no function of the shim calls
    flags = (*CONFORMANCE, "-Wno-unused-function", "-O0", "-fPIC", "-shared")
    _run(compiler, *flags, source, "-o", made, "-lm")
    batch = batch_of("spatial_rrr_a")
    call = ca.external("krhpr_my_arm_end_points", str(made))
    found = call(batch.values["p"][0], batch.values["Q"][0], batch.values["redundant"][0])
    assert np.allclose(found.full(), batch.values["s"][0], rtol=0, atol=1e-12)


def test_robots_without_limits_carry_none(gathered: Gathered) -> None:
    assert not hasattr(gathered.python, "LIMITS")
    assert not (gathered.folder / "python" / "limits.py").exists()
    assert "limits" not in (gathered.folder / "c" / "krhpr_my_arm.h").read_text()
