"""Reference numbers: the thesis' printed ones, and configurations computed from the plain geometry.

The values lie beside the tests, in millimetres; the robots are given their default sizes in millimetres,
since formulas are homogeneous in length.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

import krhpr
from krhpr.codegen.kernel import LEGS, Unit
from krhpr.study.trajectory import trajectory
from krhpr.validation.check import Check
from krhpr.validation.differences import arc
from krhpr.validation.numeric import Floats, Geometry, Numeric, target
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.subject import Subject

FOLDER = Path(krhpr.__file__).resolve().parent.parent / "tests" / "reference"
"""Where the values are; an installed package has none, and says so."""


class NoReference(RuntimeError):
    """The reference values are part of the source tree, not of an installation."""


@cache
def load(name: str) -> dict[str, Any]:
    """One file of reference values."""
    path = FOLDER / f"{name}.json"
    if not path.is_file():
        raise NoReference(f"the reference values are with the source tree only ({path.name})")
    values: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return values


def in_millimetres(subject: Subject, **changes: float) -> Geometry:
    """The default sizes in millimetres, some fields changed for all legs."""
    units = {field.name: field.unit for kind in subject.geometry_types.values() for field in kind.fields}
    geometry = {
        name: tuple(x * (1.0 if units[name] is Unit.RADIAN else 1000.0) for x in values)
        for name, values in subject.entry.sizes.items()
    }
    return {**geometry, **{name: (value,) * LEGS for name, value in changes.items()}}


class _Case:
    """A configuration handed to functions, and its results compared."""

    def __init__(self, one: Numeric, geometry: Geometry, found: Measured, label: str, **values: Any) -> None:
        self.one, self.geometry, self.found, self.label = one, geometry, found, label
        self.values = {name: np.array(value, dtype=float)[None] for name, value in values.items()}

    def call(self, name: str) -> dict[str, Floats]:
        """A function's results; a mode that is not given is the default."""
        function = self.one.subject.code.function(name)
        known = {port.name: self.values[port.name] for port in function.inputs if port.name in self.values}
        return {key: value[0] for key, value in self.one.call(name, known, self.geometry).items()}

    def compare(self, got: Any, wanted: Any, what: str, scale: float | None = None) -> None:
        """The error relative to the largest of the values wanted."""
        size = float(np.abs(wanted).max()) if scale is None else scale
        self.found.worse(np.abs(np.asarray(got) - np.asarray(wanted)) / size, f"{self.label}: {what}")

    def pose(self, p: Any, q: Any) -> None:
        """Set the pose."""
        planar = self.one.subject.planar
        self.values |= {
            "p": np.array(p, dtype=float)[None],
            ("phi" if planar else "Q"): np.array(q, dtype=float)[None],
        }


def runner(body: Callable[[Numeric, Measured], int]) -> Runner:
    """A check of one target; the body returns the number of configurations."""

    def run(subject: Subject, check: Check, count: int) -> Measured:
        found = Measured(check)
        found.samples = body(target(subject, check.target), found)
        return found

    return run


def robots(one: Numeric, found: Measured) -> int:
    """Every function at the reference configurations of the robot."""
    subject = one.subject
    entries = [
        e
        for e in load("planar" if subject.planar else "spatial")["robots"]
        if e["robot"] == subject.identifier
    ]
    for index, entry in enumerate(entries):
        changes = {} if subject.planar else {"alpha": radians(entry["alpha_deg"])}
        case = _Case(
            one,
            in_millimetres(subject, **changes),
            found,
            f"case {index}",
            redundant=entry["redundant"],
            s=entry["s"],
        )
        case.pose(entry["p"], entry["phi"] if subject.planar else entry["Q"])
        case.compare(case.call("end_points")["s"], entry["s"], "s")
        case.compare(case.call("redundant_coordinates")["redundant"], entry["redundant"], "redundant")
        case.values["swivel"] = np.zeros((1, LEGS))
        every = case.call("subleg_inverse")["theta"]
        if "assembly" in entry:
            every = _of_assembly(case, every, entry["assembly"], entry["s"])
        _same_solutions(case, every, entry["inverse"])
        case.values["theta"] = np.array(entry["theta"], dtype=float)[None]
        case.compare(case.call("subleg_jacobian")["M"], entry["M"], "M")
        result = case.call("jacobians")
        case.compare(result["J"], entry["J"], "J")
        case.compare(result["K"], entry["K"], "K")
        case.compare(case.call("singularity")["type_2"].prod(), entry["det_J"], "det J")
    return len(entries)


def _of_assembly(case: _Case, every: Floats, assembly: str, s: Any) -> Floats:
    """Inverse solutions whose joints lead to s in one assembly mode; the others as not-a-number."""
    code = case.one.subject.code
    signs = np.array(code.assembly_signs[code.assembly_labels.index(assembly)], dtype=float)
    result = np.full_like(every, np.nan)
    for mode in range(every.shape[1]):
        case.values["theta"] = every[None, :, mode]
        case.values["assembly"] = np.broadcast_to(signs, (1, LEGS, len(signs)))
        apart = np.abs(case.call("subleg_forward")["s"] - np.array(s)).max(axis=-1)
        here = apart < 1e-6 * np.abs(s).max()
        result[here, mode] = every[here, mode]
    return result


def _same_solutions(case: _Case, every: Floats, wanted: list[list[list[float]]]) -> None:
    """The same set of inverse solutions in each leg, whatever their order."""
    angular = case.one.subject.code.angular
    for leg, solutions in enumerate(wanted):
        modes = every[leg][np.isfinite(every[leg]).all(axis=-1)]
        case.found.worse(
            float(len(modes) != len(solutions)), f"{case.label}: number of solutions of leg {leg + 1}"
        )
        gaps = np.abs(arc(modes[:, None], np.array(solutions)[None], angular)).max(axis=-1)
        case.found.worse(gaps.min(axis=0), f"{case.label}: a solution of leg {leg + 1} is missing")
        case.found.worse(
            gaps.min(axis=1), f"{case.label}: a solution of leg {leg + 1} is not in the reference"
        )


def platforms(one: Numeric, found: Measured) -> int:
    """Poses that hold given end points satisfy the constraints and have the redundant coordinates of the
    reference.
    """
    subject = one.subject
    values = load("platforms")
    count = 0
    cases = [
        (f"forward {i}", e, 1.0)
        for i, e in enumerate(values["forward"])
        if e["arrangement"] == subject.platform.arrangement
    ]
    if subject.platform.arrangement == "a":
        cases.append(
            ("Section 3.2.1", values["section_3_2_1"], 1e-4)
        )  # end points are printed with six digits
    for label, entry, weight in cases:
        for solution in entry["solutions"]:
            case = _Case(one, in_millimetres(subject), found, label, s=entry["s"])
            case.pose(solution["p"], solution["Q"])
            redundant = solution.get("redundant", np.radians(solution.get("redundant_deg", 0.0)))
            got = case.call("redundant_coordinates")["redundant"]
            angular = subject.platform.redundant_joint.kind == "revolute"
            size = 1.0 if angular else float(np.abs(redundant).max())
            found.worse(
                weight * np.abs(arc(got, np.array(redundant), (angular,) * LEGS)) / size,
                f"{label}: redundant",
            )
            rows = np.abs(_rows(case)).max(axis=-1)
            found.worse(weight * np.abs(case.call("constraints")["residual"]) / rows, f"{label}: residual")
            count += 1
    return count


def _rows(case: _Case) -> Floats:
    """J, whose rows say what a residual is to be compared with; theta does not matter to it."""
    case.values["theta"] = np.ones((1, LEGS, case.one.subject.subleg.n))
    return case.call("jacobians")["J"]


# -- Section 1.8 -----------------------------------------------------------------------------------


def chapter_1(one: Numeric, found: Measured) -> int:
    """The example trajectory, followed by inverse_near."""
    values = load("chapter1")
    p, Q = trajectory()
    geometry = in_millimetres(one.subject)
    beta = np.full((len(p), LEGS), radians(97.0))
    case = _Case(one, geometry, found, "Section 1.8")
    case.compare(float(len(p)), float(values["poses"]), "number of poses")
    start = np.radians(values["q_start_deg"])
    path = [start]
    for k in range(len(p)):
        arguments = {"p": p[k], "Q": Q[k], "redundant": beta[k], "theta_near": path[-1]}
        path.append(one.call("inverse_near", arguments, geometry)["theta"])
    theta = np.array(path[1:])
    case.compare(np.degrees(theta[0]), values["q_start_deg"], "joints at the start")
    spans = np.degrees(theta.max(axis=0) - theta.min(axis=0))
    case.compare(spans, values["range_deg"], "ranges")
    case.compare(spans.max(), values["largest_range_deg"], "largest range")
    found.worse(float(spans.max() > 60.0), "the largest range exceeds 60 degrees")
    found.worse(float(np.abs(theta).max() < np.pi), "no joint goes beyond +-pi")
    case.compare(theta[-1], theta[0], "the path returns")
    s = one.call("end_points", {"p": p, "Q": Q, "redundant": beta}, geometry)["s"]
    case.compare((s[0] - p[0]) @ Q[0], values["s_local"], "end points in the platform")
    M = one.call("subleg_jacobian", {"s": s, "theta": theta}, geometry)["M"]
    conditions = np.linalg.cond(M)
    case.compare([conditions.min(), conditions.max()], values["cond_M"], "condition of M")
    result = one.call("jacobians", {"p": p, "Q": Q, "s": s, "theta": theta}, geometry)
    upper, lower = _norms(result)
    case.compare(
        [upper.min() / 1000, upper.max() / 1000], values["norm_Up_m"], "norm of the upper half of J^-1 K"
    )
    case.compare([lower.min(), lower.max()], values["norm_Ur"], "norm of the lower half of J^-1 K")
    case.compare(np.linalg.det(result["J"][0]), values["det_J"], "det J")
    return len(p)


def _norms(result: dict[str, Floats]) -> tuple[Floats, Floats]:
    """2-norms of the upper and the lower half of J^-1 K."""
    U = np.linalg.solve(result["J"], result["K"])
    upper, lower = (
        np.linalg.norm(U[..., :3, :], 2, axis=(-2, -1)),
        np.linalg.norm(U[..., 3:, :], 2, axis=(-2, -1)),
    )
    return np.asarray(upper), np.asarray(lower)


def chapter_4(one: Numeric, found: Measured) -> int:
    """The rows of Chapter 4."""
    values = load("chapter4")
    subject = one.subject
    signs = subject.code.mode_signs[subject.code.mode_labels.index(values["mode"])]
    geometry = in_millimetres(subject)
    for index, row in enumerate(values["cases"]):
        beta = np.radians(row["beta_deg"])
        case = _Case(
            one, geometry, found, f"row {index}", redundant=beta, s=row["spheres"], mode=[signs] * LEGS
        )
        case.pose(row["p"], row["Q"])
        case.compare(case.call("end_points")["s"], row["spheres"], "s")
        case.values["theta"] = case.call("inverse")["theta"][None]
        M = case.call("subleg_jacobian")["M"]
        case.compare(M, row["M"], "M")
        result = case.call("jacobians")
        case.compare(result["J"], row["J"], "J")
        case.compare(result["K"], row["K"], "K")
        upper, lower = _norms(result)
        case.compare(upper, row["eta1_mm"], "eta_1")
        case.compare(lower, row["eta2"], "eta_2")
        singular = np.linalg.svd(M, compute_uv=False)
        case.compare(singular.max() / singular.min(), row["eta3"], "eta_3")
        case.compare(case.call("singularity")["margins"][0], row["type2_margin_D"], "D")
    return len(values["cases"])


RUNNERS: dict[str, Runner] = {
    "robots": runner(robots),
    "platforms": runner(platforms),
    "chapter 1": runner(chapter_1),
    "chapter 4": runner(chapter_4),
}
"""The code of each check by its name in the plan."""
