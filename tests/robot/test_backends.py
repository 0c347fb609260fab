"""Both backends agree; which one is taken, and what is done without a compiler."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import Robot
from krhpr import backend as backend_module
from tests.robot.support import BACKENDS, CASES, Array, arguments, assert_same, load, poses, results


def found_in_doubt(robot: Robot, name: str) -> bool:
    """Whether solutions may be in doubt behind a function: it says so, or it counts those in a box."""
    signature = robot.signature(name)
    inputs, outputs = ({port.name for port in ports} for ports in (signature.inputs, signature.outputs))
    return "doubtful" in outputs or {"box", "count"} <= inputs | outputs


def doubtful(robot: Robot, name: str, given: tuple[Array, ...], found: Any) -> Array:
    """How many places may hold further solutions, for each call of a function with `found_in_doubt`."""
    if "doubtful" in found._fields:
        return found.doubtful
    known = dict(zip((port.name for port in robot.signature(name).inputs), given, strict=True))
    for before in ("subleg_forward", "forward_all"):
        inputs = [known[port.name] for port in robot.signature(before).inputs]
        found = robot.call(before, *inputs)
        known["s"] = known.get("s", results(found)[0])
    return found.doubtful


@pytest.mark.compiler
@pytest.mark.parametrize(("identifier", "name"), CASES, ids=map(".".join, CASES))
def test_backends_agree(identifier: str, name: str, full: bool) -> None:
    robots = [load(identifier, backend) for backend in BACKENDS]
    given = arguments(robots[0], name, 20_000 if full else 200)
    numpy, compiled = (robot.call(name, *given, status=True) for robot in robots)
    assert np.array_equal(numpy[1], compiled[1])
    sure = np.full(np.shape(numpy[1]), True)
    if found_in_doubt(robots[0], name):  # what is in doubt may be found by one alone
        doubts = [
            doubtful(robot, name, given, found)
            for robot, (found, _) in zip(robots, (numpy, compiled), strict=True)
        ]
        assert np.array_equal(*doubts)
        sure = doubts[0] == 0
        assert sure.mean() > 0.95
    one, other = ([values[sure] for values in results(found)] for found in (numpy[0], compiled[0]))
    assert_same(tuple(one), tuple(other), 1e-9)


@pytest.mark.compiler
def test_backends_agree_where_there_is_no_answer() -> None:
    robots = [load("spatial_r_fivebar_a", name) for name in BACKENDS]
    p, Q, redundant = poses(robots[0], 300)
    p = p * np.random.default_rng(3).uniform(0, 3, (300, 1))
    for name in ("inverse", "inverse_all", "inverse_status"):
        inputs = (p, Q, redundant, robots[0].mode_signs())[: len(robots[0].signature(name).inputs)]
        numpy, compiled = (robot.call(name, *inputs, status=True) for robot in robots)
        assert np.array_equal(numpy[1], compiled[1])
        assert 0 < np.count_nonzero(numpy[1]) < 300
        assert np.array_equal(np.isnan(numpy[0]), np.isnan(compiled[0]))
        assert_same(numpy[0], compiled[0], 1e-9)


def test_the_backend_is_chosen_by_name_or_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    assert krhpr.load("planar_rr_a", backend="numpy").backend == "numpy"
    monkeypatch.setenv("KRHPR_BACKEND", "numpy")
    assert krhpr.load("planar_rr_a").backend == "numpy"
    assert krhpr.load("planar_rr_a").with_geometry(l_1=0.2).backend == "numpy"
    monkeypatch.setenv("KRHPR_BACKEND", "fortran")
    with pytest.raises(ValueError, match=r"'fortran' \(KRHPR_BACKEND\); there are auto, compiled, numpy"):
        krhpr.load("planar_rr_a")
    with pytest.raises(ValueError, match="no backend is called 'C'; there are"):
        krhpr.load("planar_rr_a", backend="C")


@pytest.mark.compiler
def test_compiled_kernels_are_chosen_by_name_or_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    assert krhpr.load("planar_rr_a", backend="compiled").backend == "compiled"
    monkeypatch.setenv("KRHPR_BACKEND", "numpy")
    assert krhpr.load("planar_rr_a", backend="compiled").backend == "compiled"
    monkeypatch.setenv("KRHPR_BACKEND", "compiled")
    assert krhpr.load("planar_rr_a").backend == "compiled"


@pytest.fixture
def no_compiler(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No compiler, and nothing compiled before."""
    memories: tuple[Callable[[], None], ...] = (
        backend_module._library.cache_clear,
        backend_module._extension.cache_clear,
        backend_module._warn_slow.cache_clear,
    )
    for forget in memories:
        forget()
    monkeypatch.setenv("KRHPR_CC", "none")
    monkeypatch.delenv("KRHPR_BACKEND", raising=False)
    yield
    for forget in memories:
        forget()


@pytest.mark.usefixtures("no_compiler")
def test_without_a_compiler_it_warns_once_and_works() -> None:
    with pytest.warns(
        RuntimeWarning, match="KRHPR_CC is set to none.* pure NumPy modules are used"
    ) as caught:
        robot = krhpr.load("planar_rr_a")
        theta = robot.inverse(*poses(robot))
        krhpr.load("spatial_rrr_a").end_points(*poses(krhpr.load("spatial_rrr_a")))
        robot.with_geometry(l_1=0.2).inverse(*poses(robot))
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert robot.backend == "numpy"
    assert_same(theta, load("planar_rr_a", "numpy").inverse(*poses(robot)))


@pytest.mark.usefixtures("no_compiler")
def test_without_a_compiler_compiled_kernels_cannot_be_had() -> None:
    with pytest.raises(krhpr.backend.NoCompiler, match="KRHPR_CC is set to none"):
        _ = krhpr.load("planar_rr_a", backend="compiled").backend


def test_without_the_headers_of_python_it_falls_back_too(monkeypatch: pytest.MonkeyPatch) -> None:
    from krhpr.native import NoCompiler

    def missing() -> None:
        raise NoCompiler("Python's C headers are missing")

    backend_module._extension.cache_clear()
    backend_module._warn_slow.cache_clear()
    monkeypatch.setattr(backend_module, "extension_paths", missing)
    with pytest.warns(RuntimeWarning, match="headers are missing"):
        assert krhpr.load("planar_rr_a").backend == "numpy"


def test_robots_can_be_sent_to_other_processes(robot: Robot) -> None:
    changed = robot.with_geometry(l_2=robot.geometry.l_2 * 1.1)
    pose = poses(robot)
    wanted = changed.inverse(*pose)
    for again in (pickle.loads(pickle.dumps(changed)), copy.deepcopy(changed), copy.copy(changed)):
        assert again.geometry == changed.geometry and again.backend == changed.backend
        assert_same(again.inverse(*pose), wanted)
