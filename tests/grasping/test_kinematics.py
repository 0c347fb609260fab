"""Round trips, finite differences, agreement of backends and CasADi, messages."""

from __future__ import annotations

import pickle
import subprocess
from pathlib import Path
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import krhpr
from krhpr import Status
from krhpr.backend import c_sources
from tests.grasping.support import ROBOTS, Array, configurations, cross, different
from tests.support import ROOT, need

number = st.floats(-1.0, 1.0)


@pytest.mark.parametrize("name", ROBOTS)
@settings(max_examples=60, deadline=None)
@given(x=number, y=number, phi=number, beta=number)
def test_forward_undoes_inverse(name: str, x: float, y: float, phi: float, beta: float) -> None:
    """In every working mode, among the eight solutions is the pose, with its labels."""
    robot = different(name)
    pivot = np.array([0.03 * x, 0.09 + 0.02 * y])
    angles = np.array([np.pi / 4 + 0.5 * phi, 3 * np.pi / 4 + 0.5 * beta])
    s = robot.end_points(pivot, angles)
    every = robot.inverse_all(pivot, angles)
    assert np.abs(every - robot.subleg_inverse(s)).max() == 0
    side = np.sign(cross(s[1] - s[0], pivot - s[0]))
    for mode in range(len(robot.modes)):
        for other in range(len(robot.modes)):
            theta = np.stack([every[0, mode], every[1, other]])
            labels = [robot.modes[mode], robot.modes[other]]
            if len(robot.modes) > 1:
                assert np.array_equal(robot.inverse(pivot, angles, mode=labels), theta)
            found = robot.forward_all(theta)
            near = np.abs(found.pivot - pivot).max(axis=-1) + np.abs(found.angles - angles).max(axis=-1)
            assert np.nanmin(near) < 1e-9
            best = int(np.nanargmin(near))
            choice = [robot.assemblies[best // 4], robot.assemblies[best // 2 % 2]]
            alone = robot.forward(theta, choice, side=side)
            assert np.abs(alone.pivot - pivot).max() < 1e-9
            assert np.abs(alone.angles - angles).max() < 1e-9
            assert (best % 2 == 0) == (side > 0)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_every_solution_closes(name: str, backend: str) -> None:
    robot = different(name, backend).with_geometry(l_j=(0.07, 0.08))
    rng = np.random.default_rng(2)
    home = robot.inverse(*robot.home)
    theta = home + rng.uniform(-0.02, 0.02, (200, 2, 2))
    found = robot.forward_all(theta)
    there = np.isfinite(found.pivot).all(axis=-1)
    assert (there == np.isfinite(found.angles).all(axis=-1)).all()
    assert there.sum(axis=1).max() == 8
    s = robot.end_points(found.pivot, found.angles)
    joints = robot.inverse_all(found.pivot, found.angles)
    modes = joints.shape[-2]
    for leg in range(2):
        best = np.min(
            [np.abs(joints[:, :, leg, m] - theta[:, None, leg]).max(axis=-1) for m in range(modes)], axis=0
        )
        assert np.nanmax(np.where(there, best, 0.0)) < 1e-9
    # in the order that is documented
    line = s[:, :, 1] - s[:, :, 0]
    left = cross(line, found.pivot - s[:, :, 0]) > 0
    assert (left == (np.arange(8) % 2 == 0))[there].all()
    for place in range(8):
        choice = [robot.assemblies[place // 4], robot.assemblies[place // 2 % 2]]
        alone, status = robot.forward(theta, choice, side=1 if place % 2 == 0 else -1, status=True)
        assert ((status == Status.OK) == there[:, place]).all()
        assert np.nanmax(np.abs(alone.pivot - found.pivot[:, place]), initial=0.0) < 1e-12


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("backend", ["numpy", "compiled"])
def test_finite_differences(name: str, backend: str) -> None:
    robot = different(name, backend)
    pivot, angles, s, theta = configurations(robot, 50)
    rng = np.random.default_rng(3)
    velocity, rates = rng.uniform(-1, 1, (50, 2)), rng.uniform(-1, 1, (50, 2))
    h = 1e-6
    after = robot.inverse(pivot + h * velocity, angles + h * rates)
    before = robot.inverse(pivot - h * velocity, angles - h * rates)
    found = robot.joint_rates(pivot, s, theta, velocity, rates)
    assert np.abs(found - (after - before) / (2 * h)).max() < 1e-7
    back = robot.twist(pivot, s, theta, found)
    assert np.abs(back.pivot_rate - velocity).max() < 1e-12
    assert np.abs(back.angle_rates - rates).max() < 1e-10
    moved = robot.end_points(pivot + h * velocity, angles + h * rates)[:, 0]
    moved = (moved - robot.end_points(pivot - h * velocity, angles - h * rates)[:, 0]) / (2 * h)
    assert np.abs(back.twist - np.column_stack([moved, rates[:, 0]])).max() < 1e-7
    M = robot.subleg_jacobian(s, theta)
    s_dot = np.einsum("...ij,...j", M, found)
    assert np.abs(s_dot[:, 0] - back.twist[:, :2]).max() < 1e-12


@pytest.mark.parametrize("name", ROBOTS)
def test_backends_and_casadi_agree(name: str) -> None:
    robots = {backend: different(name, backend) for backend in ("numpy", "compiled")}
    pivot, angles, s, theta = configurations(robots["numpy"], 9)
    rng = np.random.default_rng(4)
    for function in robots["numpy"].functions:
        signature = robots["numpy"].signature(function)
        known: dict[str, Array] = {"pivot": pivot, "angles": angles, "s": s, "theta": theta}
        arguments: list[Any] = []
        for port in signature.inputs:
            value = known.get(port.name)
            if port.name == "mode":
                value = robots["numpy"].mode_signs()
            elif port.name == "assembly":
                value = robots["numpy"].assembly_signs()
            elif port.name == "side":
                value = np.ones(9)
            elif port.name == "sensor":
                value = krhpr.grasping.sensor("lo")
            elif port.name == "friction":
                value = np.array(1e3)
            elif port.name == "faces":
                value = np.array([2.4, -2.3]) + rng.uniform(-0.1, 0.1, (9, 2))
            elif value is None:
                value = rng.uniform(0.5, 1.5, (9, *port.shape))
            arguments.append(value)
        answers = {key: robot.call(function, *arguments, status=True) for key, robot in robots.items()}
        plain, compiled = ([*_parts(answer), status] for answer, status in answers.values())
        for a, b in zip(plain, compiled, strict=True):
            assert np.array_equal(np.isnan(a), np.isnan(b))
            assert np.nanmax(np.abs(a - b), initial=0.0) < 1e-11 * max(1.0, np.nanmax(np.abs(a), initial=0.0))
        built = getattr(robots["numpy"].casadi, function)
        one = [np.broadcast_to(a, (9, *p.shape))[0] for a, p in zip(arguments, signature.inputs, strict=True)]
        results = built(*one)
        results = results if isinstance(results, tuple) else (results,)
        if plain[-1][0] == Status.OK and all(len(port.shape) < 3 for port in signature.outputs):
            for a, b in zip(plain, results, strict=False):
                assert np.allclose(a[0].ravel(), np.array(b).ravel(), rtol=1e-10, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("name", ROBOTS)
def test_compiled_functions_in_casadi(name: str, tmp_path: Path) -> None:
    """The C source for `casadi.external`: values and exact Jacobians as of the SX functions."""
    need("gcc")
    library = tmp_path / "external.so"
    folder = c_sources()
    source = folder / "casadi" / f"krhpr_{name}_casadi.c"
    places = [f"-I{folder}", f"-I{folder / 'casadi'}"]
    flags = ["-std=c99", "-O1", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, *places, str(source), "-lm", "-o", str(library)], check=True)
    robot = krhpr.load_grasping(name, backend="numpy")
    pivot, angles = robot.home
    s, theta = robot.end_points(pivot, angles), robot.inverse(pivot, angles)
    arguments = {
        "end_points": (pivot, angles),
        "jacobians_k": (pivot, s, theta),
        "inverse_statics_n": (pivot, s, theta, [1.0, -2.0, 0.1, 0.2]),
        "inverse_statics_r": (s, theta, [1.0, -2.0, 0.1], 3.0),
    }
    for function, given_ in arguments.items():
        compiled = casadi.external(f"krhpr_{name}_{function}", str(library))
        symbolic = getattr(robot.casadi, function)
        for one, other in ((compiled, symbolic), (compiled.jacobian(), symbolic.jacobian())):
            guesses = [np.zeros(one.size_in(i)) for i in range(len(given_), one.n_in())]
            found, wanted = (f.call([casadi.DM(x) for x in (*given_, *guesses)]) for f in (one, other))
            for a, b in zip(found, wanted, strict=True):
                assert np.allclose(a.full(), b.full(), rtol=1e-11, atol=1e-11)


def _parts(answer: Any) -> list[Array]:
    return [np.asarray(part) for part in (answer if isinstance(answer, tuple) else (answer,))]


def test_shapes_labels_and_messages() -> None:
    robot = krhpr.load_grasping(backend="numpy")
    assert krhpr.grasping_robots() == ROBOTS
    assert robot.home.pivot == (0.0, 0.09)
    assert robot.legs == 2 and krhpr.load("planar_rr_a").legs == 3
    assert robot.modes[1] == robot.default_mode == "1-ahead/2-behind"
    assert robot.signature("inverse").inputs[2].shape == (2, 2)
    again = pickle.loads(pickle.dumps(robot.with_geometry(l_j=(0.05, 0.06))))
    assert again.geometry == robot.with_geometry(l_j=(0.05, 0.06)).geometry
    pivot, angles = np.full((4, 1, 2), [0.0, 0.09]), np.full((3, 2), robot.home.angles)
    assert robot.inverse(pivot, angles).shape == (4, 3, 2, 2)
    status, excess = robot.inverse_status([0.0, 0.3], robot.home.angles)
    assert status == Status.UNREACHABLE_LEG_1 and excess.shape == (2,) and (excess > 0.1).all()
    with pytest.raises(krhpr.Unreachable, match=r"leg 1 cannot reach its end point; it is 0\.150019"):
        robot.inverse([0.0, 0.3], robot.home.angles, check=True)
    with pytest.raises(krhpr.UnknownBranch, match="each of the two legs"):
        robot.inverse(*robot.home, mode=["1-ahead/2-behind"] * 3)
    with pytest.raises(krhpr.UnknownRobot, match="load_grasping"):
        krhpr.load("planar_grasp_prr")
    with pytest.raises(krhpr.UnknownRobot, match="planar_grasp_prr"):
        krhpr.load_grasping("planar_grasp_pr")
    with pytest.raises(ValueError, match=r"expected \(\) or \(2,\)"):
        robot.with_geometry(l_j=(0.1, 0.1, 0.1))
    with pytest.raises(ValueError, match="must be positive"):
        robot.with_geometry(l_j=-1.0)
    with pytest.raises(ValueError, match="'angles' has shape"):
        robot.inverse([0.0, 0.09], [0.1, 0.2, 0.3])
    with pytest.raises(krhpr.Unassembled, match="jaws to meet"):
        robot.forward([[-0.3, -0.1], [0.1, 0.3]], check=True)
    assert robot.inverse([np.nan, 0.09], robot.home.angles, status=True)[1] == Status.INVALID_INPUT
    assert np.isnan(robot.forward([[-0.3, -0.1], [0.1, 0.3]]).pivot).all()
    # a sub-leg whose chains do not meet
    answer, status = robot.forward([[-0.3, 0.3], [0.1, 0.3]], status=True)
    assert status == Status.UNREACHABLE_LEG_1 and np.isnan(answer.angles).all()


def test_every_function_is_in_the_documentation() -> None:
    page = (ROOT / "docs" / "grasping.md").read_text(encoding="utf-8")
    for name in ROBOTS:
        for function in krhpr.load_grasping(name, backend="numpy").functions:
            assert f"`{function}`" in page or function in ("inverse_statics_k", "inverse_statics_r"), function
