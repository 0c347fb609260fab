"""Hostile inputs under sanitizers: no trap, a true status, NaN where there is no answer, all written."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import krhpr
from tests.c.conftest import Build
from tests.c.support import COVER, SOURCES, program, run
from tests.support import THOROUGH, large

SANITIZE = ("-fsanitize=address,undefined", "-fsanitize=float-cast-overflow", "-fno-sanitize-recover=all")

MAY_BE_NAN = (
    # modes that do not exist are NaN as long as another one exists
    "inverse_all.theta",
    "subleg_inverse.theta",
    # so are assembly modes of the 3-CPR: up to eight
    "subleg_forward_all.s",
    "subleg_forward_all.volume",
    # det M_i has a pole where the rod and the distal link of a closed loop are aligned
    "singularity.type_1",
)


HOLDING = tuple(robot for robot in COVER if robot != "planar_grasp_prr")
"""The sliders of `planar_grasp_prr` meet in some working modes, where no function works."""


def may_be_nan(robot: str) -> tuple[str, ...]:
    """Results that may be NaN in part with status OK: arrangement (a) has two to six poses of six places."""
    padded = ("p", "Q", "phi", "redundant", "det_J") if robot.endswith("_a") else ()
    if robot in krhpr.generated.GRASPING:
        padded = ("pivot", "angles")  # up to eight assembly modes
    return (*MAY_BE_NAN, *(f"forward_all.{name}" for name in padded))


@pytest.mark.usefixtures("in_turns")
def test_every_function_keeps_its_promises(robot: str, compiler: str, build: Build, full: bool) -> None:
    """Statuses, NaN, canaries and batch twins (tests/c/hostile.c), with both sanitizers."""
    binary = build("hostile.c", robot, compiler, "-O1" if large(robot, full) else "-O0", "-g", *SANITIZE)
    run([binary, "20000" if large(robot, full) else "600", *may_be_nan(robot)])


@pytest.mark.parametrize("robot", ["planar_grasp_rpr"])
def test_a_grasping_robot_keeps_them_too(robot: str, compiler: str, build: Build, full: bool) -> None:
    """Two legs, in arrays that have room for two."""
    binary = build("hostile.c", robot, compiler, "-O0", "-g", *SANITIZE)
    run([binary, "20000" if full else "600", *may_be_nan(robot)])


@pytest.mark.full
@pytest.mark.usefixtures("in_turns")
@pytest.mark.parametrize("robot", tuple(dict.fromkeys((*THOROUGH, *HOLDING))))
def test_without_sanitizers_at_full_speed(robot: str, compiler: str, build: Build) -> None:
    """The same promises hold for the flags that a controller is compiled with."""
    flags = ("-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-DTOLERANCE=1e-9")
    flags += ("-fno-tree-slp-vectorize",)
    known = flags if compiler == "gcc" else flags[:-1]
    run([build("hostile.c", robot, compiler, *known), "100000", *may_be_nan(robot)])


@pytest.mark.usefixtures("in_turns")
@pytest.mark.parametrize("lanes", [1, 4, 8])
def test_any_number_of_lanes(robot: str, compiler: str, lanes: int, build: Build, full: bool) -> None:
    """Legs and poses side by side in as many lanes as one asks for, on any processor: bit by bit the same.

    Two lanes are those of the test above.
    """
    if not large(robot, full):
        pytest.skip("large samples only")
    if lanes == 4 and robot != THOROUGH[0]:
        pytest.skip("between one lane and the widest: the first robot")
    width = f"-DKRHPR_LANES={lanes}" if lanes < 8 else "-DKRHPR_POSES=8"
    run([build("hostile.c", robot, compiler, "-O1", "-Wno-psabi", width), "10000", *may_be_nan(robot)])


BROKEN = {
    "no NaN for an invalid input": ("krhpr.h", "x[k] = (double)NAN;", "(void)x;", "is not NaN"),
    "no check of the inputs": (
        "krhpr_lanes.h",
        "return krhpr_every((krhpr_ints)(taint == krhpr_all(0.0)));",
        "(void)taint;\n    return 1;",
        "for infinite input",
    ),
    "a status that is not one": (
        "krhpr.h",
        "KRHPR_INVALID_INPUT = 11",
        "KRHPR_INVALID_INPUT = -1",
        "none of the enumeration",
    ),
    "an element left unwritten": (
        "krhpr_lanes.h",
        "if (i + lane < 3)",
        "if (i + lane < 2)",
        "is not written whole",
    ),
    "an element too far": ("krhpr_lanes.h", "if (i + lane < 3)", "if (i + lane < 4)", "AddressSanitizer"),
    "a batch that repeats one element": ("batch", "k * in_step[0]", "0 * in_step[0]", "batch: "),
    "lanes that repeat the first": ("krhpr_poses.h", "here - 1) * step", "here - 1) * 0", "batch: "),
    "even and odd poses in each other's places": (
        "krhpr_poses.h",
        "to[0] = KRHPR_SHUFFLE(even, odd, 0, 2)",
        "to[0] = KRHPR_SHUFFLE(even, odd, 2, 0)",
        "batch: ",
    ),
    "a line of the cache that is forgotten": (
        "krhpr_poses.h",
        "stream->kept = filled - whole;",
        "stream->kept = 0;",
        "batch: ",
    ),
    "a line of the cache that is not ours": (
        "krhpr_poses.h",
        "for (int k = foreign; k < KRHPR_LINE; ++k)",
        "for (int k = 0; k < KRHPR_LINE; ++k)",
        "batch: writes before|AddressSanitizer",
    ),
    "a row that is not the next": (
        "krhpr_poses.h",
        "krhpr_load(from + k * row)",
        "krhpr_load(from + k)",
        "soa: ",
    ),
    "a leg's limit that nobody looks at": ("batch", "        fine &= ", "        (void)", "batch: status"),
    "a limit of legs side by side that nobody looks at": (
        "single",
        "        fine &= ",
        "        (void)",
        "not NaN|status",
    ),
    "angles that nobody looks at": (
        "single",
        "!KRHPR_LIKELY(near) && ",
        "0 && ",
        "for infinite input|for NaN",
    ),
    "angles of a batch that nobody looks at": (
        "batch",
        "near && krhpr_every",
        "(near || 1) && krhpr_every",
        "batch: ",
    ),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_promise_is_seen(what: str, build: Build, tmp_path: Path) -> None:
    """The harness fails where the generated code is spoilt in one place."""
    program("gcc")
    robot = "planar_rr_a"
    kind, good, bad, said = BROKEN[what]
    folder = tmp_path / "spoilt"
    shutil.copytree(SOURCES, folder)
    names = {"single": f"krhpr_{robot}.c", "batch": f"krhpr_{robot}_batch.c"}
    spoilt = folder / names.get(kind, kind)
    text = spoilt.read_text()
    assert good in text
    spoilt.write_text(text.replace(good, bad))
    sanitize = ["-fsanitize=address"] if "Sanitizer" in said else []
    binary = build("hostile.c", robot, "gcc", "-O0", *sanitize, folder=folder)
    with pytest.raises(AssertionError, match=said):
        run([binary, "400", *may_be_nan(robot)])
