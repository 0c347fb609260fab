"""The example of a sub-leg of one's own, from its file to compiled code, and its closed form."""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr.cli import main
from krhpr.codegen.evaluate import evaluate_kernel, prepare_geometry
from krhpr.derivations.plugin import Plugin
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.derivations.sublegs.planar_serial import PP
from krhpr.errors import PluginError
from krhpr.plugins import Printed, check, load_plugin, prove
from krhpr.robot import Robot
from krhpr.validation.check import Kind
from krhpr.validation.run import run
from tests.c.support import CONFORMANCE
from tests.c.support import run as execute
from tests.plugins.support import EXAMPLE, closed_form
from tests.support import need

POSE = (np.array([0.01, -0.02, 0.35]), np.eye(3), np.full(3, 1.7))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that `krhpr generate` wrote for one robot with the example's sub-leg."""
    target = tmp_path_factory.mktemp("plugin") / "wrist_arm"
    command = ["generate", "spatial_offset_wrist_a", "--plugin", str(EXAMPLE), "--out", str(target)]
    assert main(command) == 0
    return target


@pytest.fixture(scope="module")
def robot(folder: Path) -> Robot:
    """The robot of that folder, imported as a stranger would."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder.parent))
        module = importlib.import_module("wrist_arm.python.spatial_offset_wrist_a")
    return Robot(module, backend="numpy")


def joints(robot: Robot) -> Any:
    return robot.inverse(*POSE, near=np.tile([0.3, 0.9, -1.2], (3, 1)))


def test_newton_inverse_lands_on_the_end_points(robot: Robot) -> None:
    theta = joints(robot)
    ends = robot.end_points(*POSE)
    np.testing.assert_allclose(robot.subleg_forward(theta), ends, rtol=0, atol=1e-14)
    wrist = robot.link_points(*POSE[:2], ends, theta).points[:, -2]
    np.testing.assert_allclose(np.linalg.norm(ends - wrist, axis=-1), 0.04, rtol=1e-12)


def test_a_pose_out_of_reach_does_not_converge(robot: Robot) -> None:
    far = (POSE[0] + np.array([0.0, 0.0, 3.0]), *POSE[1:])
    with pytest.raises(krhpr.NoConvergence):
        robot.inverse(*far, near=joints(robot), check=True)
    theta, status = robot.inverse(*far, near=joints(robot), status=True)
    assert np.isnan(theta).all() and int(status) != 0


class NewtonPP(PP):
    """Two slides, all at zero where the end point is in the base point, without their closed form."""

    inverse = SubLeg.inverse


def test_joints_of_zero_count_as_found() -> None:
    """The size of the unknowns, to which a step is compared, is nothing there."""
    leg = NewtonPP()
    kernels = {kernel.name: kernel for kernel in leg.kernels()}
    sizes = {"azimuth": 0.3, "R_b": 0.25, "slide_1": 0.0, "slide_2": 1.7}
    g = prepare_geometry(leg.geometry(), sizes)
    s = evaluate_kernel(kernels["forward"], {"theta": [0.0, 0.0]}, g)["s"]
    found = evaluate_kernel(kernels["inverse_step"], {"s": s, "theta": [0.0, 0.0]}, g)
    assert found["theta_next"] == [0.0, 0.0] and found["change"] == [0.0]
    assert evaluate_kernel(kernels["inverse_step"], {"s": s, "theta": [0.1, -0.2]}, g)["change"][0] > 0.5


@pytest.mark.compiler
def test_its_c_is_strict(folder: Path, tmp_path: Path) -> None:
    need("gcc")
    source = folder / "c" / "krhpr_spatial_offset_wrist_a.c"
    execute(["gcc", *CONFORMANCE, "-O2", "-c", source, "-o", tmp_path / "arm.o"])


def test_what_was_generated_says_how_it_inverts(folder: Path) -> None:
    header = (folder / "c" / "krhpr_spatial_offset_wrist_a.h").read_text()
    assert "Newton steps from theta_near" in " ".join(header.split()).replace("* ", "")


@pytest.mark.parametrize("kinds", [(Kind.DIFFERENCES, Kind.AGREEMENT, Kind.INVARIANT)], ids=["numeric"])
def test_the_validation_holds(kinds: tuple[Kind, ...], full: bool) -> None:
    """All kinds of checks in full; those of doubles, which are quick, always."""
    entries = load_plugin(EXAMPLE).entries()[: 3 if full else 1]
    with Printed(entries) as printed:
        report = run(
            None,
            "small",
            kinds=None if full else kinds,
            generated=printed.folder,
            among=entries,
            folder=None,
        )
    assert len(report.results) > 50 and not report.failed, report.failed


def test_the_closed_form_of_the_guide(robot: Robot) -> None:
    """With the `inverse` that the guide adds there are working modes, and Newton steps agree with one."""
    plugin: Plugin = check(closed_form(), "the guide")
    prove(plugin.entries()[:1])
    entries = plugin.entries()[:1]
    with Printed(entries) as printed:
        closed = printed.robot(printed.identifiers[0])
        report = run(
            None,
            "small",
            kinds=(Kind.DIFFERENCES, Kind.INVARIANT),
            generated=printed.folder,
            among=entries,
            folder=None,
        )
    assert report.results and not report.failed, report.failed
    assert list(closed.modes) == ["front/elbow+", "front/elbow-", "back/elbow+", "back/elbow-"]
    every = closed.inverse_all(*POSE)
    gap = np.abs(np.exp(1j * every) - np.exp(1j * joints(robot))[:, None]).max(axis=-1).min(axis=-1)
    assert (gap < 1e-12).all()


def test_a_robot_file_chooses_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "long_arm.yaml"
    file.write_text("space: spatial\nsubleg: offset_wrist\narrangement: c\ngeometry: {h: 0.06, l_2: 0.32}\n")
    out = tmp_path / "long_arm"
    assert main(["generate", str(file), "--plugin", str(EXAMPLE), "--out", str(out)]) == 0
    assert "0.06" in (out / "python" / "long_arm.py").read_text()
    assert "offset_wrist states no `inverse`" in capsys.readouterr().out
    assert main(["generate", str(file), "--out", str(tmp_path / "none")]) == 2  # never by the file alone
    assert "offset_wrist" in capsys.readouterr().err


def test_list_and_info_know_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--plugin", str(EXAMPLE), "--sub-leg", "offset_wrist"]) == 0
    listed = capsys.readouterr().out
    assert all(f"spatial_offset_wrist_{letter}" in listed for letter in "abc")
    assert main(["info", "spatial_offset_wrist_b", "--plugin", str(EXAMPLE)]) == 0
    assert "offset of S_i from W_i along e_2" in capsys.readouterr().out
    picture = tmp_path / "arm.png"
    command = ["info", "spatial_offset_wrist_b", "--plugin", str(EXAMPLE), "--picture", str(picture)]
    assert main(command) == 0 and picture.stat().st_size > 10_000


def test_generated_holds_the_catalogue_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "--plugin", str(EXAMPLE)]) == 2
    assert "add --out DIR" in capsys.readouterr().err


MISTAKES: dict[str, tuple[str, Any, str]] = {
    "a sign in B": (
        "velocity",
        lambda found: type(found)(**{**vars(found), "B": found.B * -1}),
        "`velocity`",
    ),
    "the determinant": (
        "velocity",
        lambda found: type(found)(**{**vars(found), "determinant": -found.determinant}),
        "`determinant`",
    ),
    "posture": ("posture", lambda found: {**found, "v": -found["v"]}, "`velocity` (or `posture`)"),
    "forward": (
        "forward",
        lambda found: type(found)(found.s, {**found.posture, "d": -found.posture["d"]}, found.radicand),
        "postures of `forward` and `posture`",
    ),
    "points": ("points", lambda found: {**found, "E": 2 * found["E"]}, "a link of `links`"),
    "passive": ("passive", lambda found: type(found)(found.angles, 2 * found.link), "no rotation"),
}


@pytest.mark.parametrize("what", MISTAKES)
def test_a_mistake_is_found_before_code_is_made(what: str) -> None:
    method, change, said = MISTAKES[what]
    plugin = load_plugin(EXAMPLE)
    original = getattr(type(plugin.subleg), method)
    wrong = type(
        "Wrong",
        (type(plugin.subleg),),
        {method: lambda self, *arguments: change(original(self, *arguments))},
    )
    spoilt = Plugin(wrong(), plugin.sizes)
    with pytest.raises(PluginError, match="contradict one another") as caught:
        prove(spoilt.entries()[:1])
    assert said in str(caught.value)


def test_half_a_turn_more_is_the_same_posture(robot: Robot) -> None:
    """Newton steps from joints a full turn on stay there."""
    theta = joints(robot)
    again = robot.inverse(*POSE, near=theta + 2 * math.pi)
    np.testing.assert_allclose(again, theta + 2 * math.pi, rtol=0, atol=1e-13)
