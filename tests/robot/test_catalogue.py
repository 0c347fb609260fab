"""Robots describe themselves; what can be loaded, and what is refused."""

from __future__ import annotations

import os

import pytest

import krhpr
from krhpr import GeneratedMismatch, Robot
from tests.robot.support import load
from tests.support import run_python


def test_robots_describe_themselves(robot: Robot) -> None:
    assert repr(robot) == f"<Robot {robot.identifier} {robot.notation}: {robot.title}>"
    assert robot.planar == robot.identifier.startswith("planar")
    assert robot.default_mode in robot.modes
    assert set(robot.functions) >= {"inverse", "inverse_all", "end_points", "twist", "singularity"}
    assert set(robot.documentation["geometry"]) and [
        name for name, _ in robot.documentation["geometry"]
    ] == list(robot.geometry.order)
    assert {unit for _, unit in robot.documentation["units"]} <= {"m", "rad"}


def test_an_unknown_robot_gives_the_nearest_names() -> None:
    with pytest.raises(
        krhpr.UnknownRobot, match=r"no robot is called 'spatial_rr_a'; did you mean spatial_rrr_a"
    ):
        krhpr.load("spatial_rr_a")
    with pytest.raises(KeyError, match="there are spatial_rrr_a, "):
        krhpr.load("zzz")


def test_robots_written_by_another_version_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    import krhpr.generated

    monkeypatch.setattr(krhpr.generated, "VERSION", "0.0.1")
    with pytest.raises(
        GeneratedMismatch, match=r"written by krhpr 0\.0\.1, this is krhpr .*run `krhpr generate`"
    ):
        krhpr.load("planar_rr_a")
    monkeypatch.delattr(krhpr.generated, "VERSION")
    with pytest.raises(GeneratedMismatch, match="of an unknown version"):
        krhpr.catalogue()


USE = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] not in {"krhpr", "numpy", *sys.stdlib_module_names}:
            raise ImportError(f"{name} is not needed")

sys.meta_path.insert(0, Blocked())
from krhpr.generated import planar_rr_a as robot

theta, status = robot.inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6], status=True)
print(theta.ravel().tolist(), int(status), robot.Status(0).name)
print(sorted(name for name in sys.modules if name.startswith("krhpr")))
"""


def test_a_generated_module_takes_numpy_alone() -> None:
    run = run_python("-c", USE, env={"KRHPR_CC": "none"})
    assert run.returncode == 0, run.stderr
    numbers, modules = run.stdout.splitlines()
    theta = load("planar_rr_a", "numpy").inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6])
    assert numbers == f"{theta.ravel().tolist()} 0 OK"
    assert "krhpr.robot" not in modules and "krhpr.backend" not in modules
    assert os.path.basename(krhpr.generated.__path__[0]) == "generated"
