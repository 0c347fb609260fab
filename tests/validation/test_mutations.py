"""Would the validation notice?  Mistakes are planted, and a named check must fail for each."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

from krhpr.derivations.catalogue import catalogue
from krhpr.derivations.sublegs import two_link
from krhpr.derivations.sublegs.base import Forward, VelocityEquations
from krhpr.validation.check import Check, Kind, Target
from krhpr.validation.plan import plan
from krhpr.validation.subject import Subject
from tests.support import cover, derived_robots
from tests.validation.mutants import (
    changed,
    changed_at,
    changed_template,
    changed_text,
    failed,
    failing,
    first_failure,
    formula_places,
    mutable_nodes,
    mutated,
    printed,
    sample,
    with_parts,
)
from tests.validation.support import IDENTIFIERS, subject

COVER = cover(IDENTIFIERS)
ENTRIES = {entry.identifier: entry for entry in catalogue()}
PARTS = derived_robots().parts


# -- derivations -----------------------------------------------------------------------------------


def _velocity(row: int, column: int, matrix: str = "B") -> Any:
    """A sign error in one element of A or B."""

    def change(found: VelocityEquations) -> VelocityEquations:
        wrong = sp.Matrix(getattr(found, matrix))
        wrong[row, column] = -wrong[row, column]
        values = {**vars(found), matrix: wrong}
        return VelocityEquations(**values)

    return change


def _determinant(found: VelocityEquations) -> VelocityEquations:
    return VelocityEquations(**{**vars(found), "determinant": -found.determinant})


def _forward(found: Forward) -> Forward:
    return Forward(found.s, {**found.posture, "d": -found.posture["d"]}, found.radicand)


SUBLEGS: dict[str, tuple[str, dict[str, Any], str]] = {
    "(2.15), a sign": ("spatial_rrr_a", {"velocity": _velocity(1, 1)}, "velocity equations"),
    "(1.13), a sign": ("spatial_r_fivebar_a", {"velocity": _velocity(2, 1)}, "thesis matrices"),
    "(1.12), a sign": ("spatial_r_fivebar_a", {"velocity": _velocity(0, 0)}, "velocity equations"),
    "(1.10), a sign": ("spatial_r_fivebar_a", {"velocity": _velocity(2, 0, "A")}, "accelerations"),
    "M of the plane": ("planar_rr_a", {"velocity": _velocity(0, 1)}, "velocity equations"),
    "det M, its sign": ("spatial_r_fivebar_a", {"velocity": _determinant}, "determinant of M"),
    "posture": ("spatial_rrr_a", {"forward": _forward}, "forward closes"),
    "forward": (
        "planar_rr_a",
        {"forward": lambda found: Forward(-found.s, found.posture)},
        "accelerations",
    ),
    "closure, consistently wrong": (
        "spatial_rrr_a",
        {"geometry": None},
        "first principles",
    ),
    "inverse, theta_1": (
        "spatial_rrr_a",
        {"inverse": lambda found: ([-found[0][0], *found[0][1:]], found[1])},
        "inverse closes",
    ),
    "inverse, theta_3": (
        "spatial_r_fivebar_a",
        {"inverse": lambda found: ([*found[0][:2], -found[0][2]], found[1])},
        "inverse closes",
    ),
    "reach": ("planar_rr_a", {"reach": lambda found: -found}, "reach"),
}

PLATFORMS: dict[str, tuple[str, dict[str, Any], str]] = {
    "direction": ("spatial_rrr_a", {"direction": lambda found: -found}, "rows"),
    "anchor": ("spatial_rrr_c", {"anchor": lambda found: -found}, "thesis rows"),
    "residual": ("spatial_rrr_c", {"residual": lambda found: -found}, "rows"),
    "end point": ("planar_rr_a", {"end_point": lambda found: -found}, "closure"),
    "redundant coordinate": ("spatial_rrr_a", {"redundant": lambda found: -found}, "closure"),
    "end velocity": (
        "spatial_rrr_a",
        {"end_velocity": lambda found: -found},
        "end velocity and acceleration",
    ),
    "closed form of det J": (
        "spatial_rrr_c",
        {"closed_form": lambda found: [found[0], -found[1]]},
        "determinant of J",
    ),
    "margins": ("spatial_rrr_a", {"margins": lambda found: [-found[0], found[1]]}, "equilateral"),
    "redundant link": ("planar_rr_a", {"joint": lambda found: -found}, "joint"),
}


@pytest.mark.parametrize("what", SUBLEGS)
def test_a_mistake_in_a_sub_leg_is_found(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    identifier, methods, name = SUBLEGS[what]
    part = ENTRIES[identifier].robot.subleg
    if methods == {"geometry": None}:
        # angles run the other way in closure, forward, inverse and velocities alike
        monkeypatch.setattr(two_link, "in_plane", lambda angle: sp.Matrix([sp.cos(angle), -sp.sin(angle)]))
        wrong = with_parts(ENTRIES[identifier])
    else:
        wrong = with_parts(ENTRIES[identifier], subleg=changed(part, **methods))
    failures = failing(wrong, Kind.PROOF, [name])
    assert [result.check.name for result in failures] == [name]


@pytest.mark.parametrize("what", PLATFORMS)
def test_a_mistake_in_an_arrangement_is_found(what: str) -> None:
    identifier, methods, name = PLATFORMS[what]
    part = ENTRIES[identifier].robot.platform
    wrong = with_parts(ENTRIES[identifier], platform=changed(part, **methods))
    assert [result.check.name for result in failing(wrong, Kind.PROOF, [name])] == [name]


# -- graphs ----------------------------------------------------------------------------------------

# What a guard compares with zero need not be right in size: only where it changes its sign is proven.
GUARDS = {"radicand", "excess", "breadth", "flatness", "sign"}


@pytest.mark.parametrize(
    ("identifier", "count"),
    [
        ("planar_rr_a", 1),
        *(pytest.param(identifier, 2, marks=pytest.mark.full) for identifier in COVER),
    ],
)
def test_an_exchanged_operation_in_a_kernel_is_found(identifier: str, count: int) -> None:
    right, survivors, seen = subject(identifier), [], 0
    for key in parts_of(identifier):
        for kernel in right.code.parts[key].kernels:
            derived = right.derived(key, kernel.name)
            for where in sample(mutable_nodes(derived, GUARDS), count, 7):
                wrong = mutated(derived, where)
                if wrong is None:
                    continue
                mutant = Subject(right.entry, parts=PARTS)
                mutant.derived(key, kernel.name)
                mutant._derived[key][kernel.name] = wrong
                function = f"{key}.{kernel.name}"
                if not _equivalent(mutant, function):
                    seen += 1
                    if not _noticed(mutant, function):
                        survivors.append(f"{function}: node {where}, {derived.graph.nodes[where]}")
    assert not survivors
    assert seen >= 8 * count


def parts_of(identifier: str) -> tuple[str, ...]:
    """The sub-leg, and the arrangement of the first robot that has it: parts are shared."""
    letters = [(robot.split("_")[0], robot[-1]) for robot in COVER]
    first = letters.index((identifier.split("_", maxsplit=1)[0], identifier[-1]))
    return ("subleg", "platform") if COVER[first] == identifier or identifier not in COVER else ("subleg",)


def _equivalent(mutant: Subject, function: str) -> bool:
    """Whether the change does not change the kernel (a sum with what is always zero, say)."""
    checks = [c for c in plan(mutant.code) if c.kind is Kind.PASSES and c.function == function]
    return not any(failed(mutant, check) for check in checks)


def _noticed(mutant: Subject, function: str) -> bool:
    """Whether a proof fails, of those about the kernel first."""

    def about(check: Check) -> bool:
        return function in (check.function, *check.also)

    checks = [c for c in plan(mutant.code) if c.kind is Kind.PROOF and (c.shared or about(c))]
    return any(failed(mutant, check) for check in sorted(checks, key=lambda c: not about(c)))


# -- templates -------------------------------------------------------------------------------------

TEMPLATES = [
    ("c/inverse_near.c.j2", "+ 0.5)", "+ 0.25)", Target.C),
    ("c/inverse_near.c.j2", "distance < nearest", "distance > nearest", Target.C),
    ("python/runtime.py.j2", "np.argmin(", "np.argmax(", Target.NUMPY),
    ("python/runtime.py.j2", "goal - found", "found - goal", Target.NUMPY),
    ("casadi/runtime.py.j2", "parts[size * leg : size * (leg + 1)]", "parts[:size]", Target.CASADI),
    ("casadi/runtime.py.j2", "ca.diagcat(*blocks)", "ca.diagcat(*reversed(blocks))", Target.CASADI),
]


@pytest.mark.parametrize(("name", "old", "new", "target"), TEMPLATES)
def test_a_mistake_in_a_template_is_found(
    name: str, old: str, new: str, target: Target, tmp_path: Path
) -> None:
    entry = ENTRIES["planar_rr_a"]
    with changed_template(name, old, new):
        folder = printed([entry], tmp_path / "generated")
    assert first_failure(Subject(entry, folder, PARTS), Kind.IDENTITY, target) is not None


def test_without_a_mistake_nothing_fails(tmp_path: Path) -> None:
    entry = ENTRIES["planar_rr_a"]
    folder = printed([entry], tmp_path / "generated")
    for target in (Target.C, Target.NUMPY, Target.CASADI):
        assert first_failure(Subject(entry, folder, PARTS), Kind.IDENTITY, target) is None


# -- printed texts ---------------------------------------------------------------------------------

TEXTS = {
    Target.C: (r"    (const double|\*?\w+(\[\d+\])?) .*=|    \*?\w+(\[\d+\])? = ", r"\bint\b|status"),
    Target.NUMPY: (r"    (    )?\w+ = |        -?\(?\w.*,$", r"rt\.|= \w+$"),
    Target.CASADI: (r"    (    )?\w+ = |        -?\(?\w.*,$", r"rt\.|= \w+$"),
}
FOLDERS = {
    Target.C: "c/krhpr_{}.h",
    Target.NUMPY: "python/{}.py",
    Target.CASADI: "casadi/{}.py",
}


NO_MISTAKE = re.compile(r"positive where the legs go round z_1|/ sign\b|= residual_0 / ")
"""Lines whose change is none: of a value only the sign counts, as its remark says; a sign divides as it
multiplies; the 3-CPR's root is on the first cylinder, where that residual is a rounding error.
"""


@pytest.mark.parametrize("target", TEXTS)
@pytest.mark.parametrize(
    ("identifier", "count"),
    [
        ("spatial_rrr_a", 2),
        *(pytest.param(identifier, 4, marks=pytest.mark.full) for identifier in COVER),
    ],
)
def test_a_mistake_in_a_printed_text_is_found(
    identifier: str, count: int, target: Target, tmp_path: Path
) -> None:
    right = subject(identifier)
    survivors = []
    for part in (right.code.parts[key] for key in parts_of(identifier)):
        path = FOLDERS[target].format(part.name)
        text = (right.folder / path).read_text(encoding="utf-8")
        places = formula_places(text, *TEXTS[target])
        assert len(places) >= 20
        for index, place in enumerate(sample(places, count, 5)):
            wrong, line = changed_at(text, place)
            if NO_MISTAKE.search(line):
                continue
            folder = changed_text(tmp_path / f"{part.name}_{index}", path, wrong)
            if first_failure(Subject(right.entry, folder, PARTS), Kind.IDENTITY, target, part.name) is None:
                survivors.append(f"{path}: {line}")
    assert not survivors
