"""Functions bound to buffers: the same answers as calls, no copies, and no way to pull a buffer away."""

from __future__ import annotations

import sys
import weakref
from collections import namedtuple

import numpy as np
import pytest

import krhpr
from krhpr.generated.python.runtime import Status
from krhpr.native import Bound, bind, function_address, load_library
from tests.support import THOROUGH

ROBOT = THOROUGH[0]
Arrays = namedtuple("Arrays", ["x"])


@pytest.fixture(params=["compiled", "numpy"])
def robot(request: pytest.FixtureRequest) -> krhpr.Robot:
    return krhpr.load(ROBOT, backend=request.param)


def test_every_function_answers_as_when_it_is_called(robot: krhpr.Robot) -> None:
    """At the home pose and its neighbours; sines, modes and boxes have their defaults."""
    p, Q, redundant = robot.home
    known = {"p": np.asarray(p), "Q": np.asarray(Q), "redundant": np.asarray(redundant)}
    known["theta"] = robot.inverse(p, Q, redundant)
    known["s"] = robot.end_points(p, Q, redundant)
    known |= {"theta_near": known["theta"], "p_near": known["p"], "Q_near": known["Q"]}
    rng = np.random.default_rng(5)
    for name in robot.functions:
        bound = robot.bind(name)
        given = []
        for port, array in zip(robot.signature(name).inputs, bound.inputs, strict=True):
            assert getattr(bound.inputs, port.name) is array and array.shape == port.shape
            if np.isnan(array).any():
                array[...] = known.get(port.name, rng.uniform(0.1, 0.2, port.shape))
            given.append(array.copy())
        status = bound()
        wanted, code = robot.call(name, *given, status=True, check_rotation=False)
        assert status == code, name
        for got, want in zip(bound.outputs, wanted if isinstance(wanted, tuple) else (wanted,), strict=True):
            np.testing.assert_allclose(got, want, rtol=1e-12, atol=1e-12, err_msg=name)


def test_what_was_not_given_is_an_invalid_input(robot: krhpr.Robot) -> None:
    bound = robot.bind("inverse")
    assert bound() == Status.INVALID_INPUT
    assert np.isnan(bound.outputs.theta).all()


def test_numbers_of_the_method_have_their_defaults(robot: krhpr.Robot) -> None:
    assert robot.bind("forward_encoders_1").inputs.tolerance == 0.02
    assert robot.bind("forward_gauss_newton_2").inputs.weights.shape == (3,)
    assert np.isfinite(robot.bind("forward_gauss_newton_2").inputs.weights).all()


def test_new_inputs_give_new_outputs_in_place(robot: krhpr.Robot) -> None:
    p, Q, redundant = robot.home
    bound = robot.bind("end_points")
    place = bound.outputs.s
    for x in (0.0, 0.01):
        bound.inputs.p[:] = np.add(p, (x, 0.0, 0.0))
        bound.inputs.Q[:], bound.inputs.redundant[:] = Q, redundant
        assert bound() == Status.OK
        assert bound.outputs.s is place
        np.testing.assert_allclose(place, robot.end_points(bound.inputs.p, Q, redundant), atol=1e-15)


def test_an_unknown_function_is_named(robot: krhpr.Robot) -> None:
    with pytest.raises(AttributeError, match="no function 'inverze'; it has"):
        robot.bind("inverze")


# -- what holds the buffers ----------------------------------------------------------------------------------


@pytest.fixture
def compiled() -> Bound:
    return krhpr.load(ROBOT, backend="compiled").bind("inverse")


def test_arguments_are_refused(compiled: Bound) -> None:
    for arguments, names in (((1,), {}), ((), {"p": 1})):
        with pytest.raises(TypeError, match="takes no arguments"):
            compiled(*arguments, **names)  # type: ignore[call-arg]


def test_buffers_can_neither_be_resized_nor_replaced(compiled: Bound) -> None:
    with pytest.raises(ValueError, match="resize"):
        compiled.inputs.p.resize(7)
    with pytest.raises(AttributeError):
        compiled.inputs.p = np.zeros(3)
    with pytest.raises(AttributeError):
        compiled.inputs = ()  # type: ignore[misc]


def test_it_keeps_its_arrays_and_lets_them_go() -> None:
    bound = krhpr.load(ROBOT, backend="compiled").bind("inverse")
    p, kept = weakref.ref(bound.inputs.p), bound.outputs.theta
    bound()
    del bound  # nothing refers to it in turn
    assert p() is None
    kept.resize((2, 3), refcheck=False)  # nobody holds its buffer any more


def test_calls_allocate_nothing(compiled: Bound) -> None:
    compiled()
    before = sys.getallocatedblocks()
    for _ in range(1000):
        compiled()
    assert sys.getallocatedblocks() - before < 20


def test_arrays_that_do_not_fit_are_refused(compiled: Bound) -> None:
    from krhpr.backend import compile_robot

    library = load_library(compile_robot(ROBOT))
    address = function_address(library, f"krhpr_{ROBOT}_rotation_error_batch")
    good = Arrays(np.eye(3))
    with pytest.raises(TypeError, match="doubles"):
        bind(address, None, Arrays(np.eye(3, dtype=np.float32)), good, library)
    with pytest.raises(ValueError, match="contiguous"):
        bind(address, None, Arrays(np.zeros((3, 6))[:, ::2]), good, library)
    fixed = np.zeros(1)
    fixed.setflags(write=False)
    with pytest.raises(ValueError, match="read-only"):
        bind(address, None, good, Arrays(fixed), library)
    with pytest.raises(ValueError, match="at most 32"):
        bind(address, None, tuple([np.zeros(1)] * 32), good, library)
    with pytest.raises(TypeError):
        bind(address, None, [np.eye(3)], good, library)  # type: ignore[arg-type]
