"""Generated NumPy functions on exact numbers: agreement with floats, exact literals, modules left alone."""

from __future__ import annotations

import importlib.util
import math
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from krhpr.validation import numbers
from krhpr.validation.numbers import BALL, EXACT, Angle, Ball, Exact, ball_precision, same
from krhpr.validation.numpy_exact import as_object_array, exact_namespace, exact_numpy

GENERATED = '''
"""A leg, in the manner of a generated module."""

from __future__ import annotations

import functools

import numpy as np

_THIRD = 1/3
_SCALE: float = 0.1*_THIRD
_COUNT = 3
_NAME = "leg"


def checked(function):
    @functools.wraps(function)
    def wrapper(*args, **kwargs):
        return function(*args, **kwargs)
    return wrapper


def leg(c, l, theta):
    """Position of the end point and its derivative."""
    c, l, theta = np.asarray(c), np.asarray(l), np.asarray(theta)
    shape = np.broadcast_shapes(c.shape[:-1], l.shape[:-1], theta.shape[:-1])
    x0 = np.sin(theta[..., 0])
    x1 = np.cos(theta[..., 0])
    x2 = theta[..., 1] + theta[..., 2]
    x3 = l[..., 0]*np.cos(theta[..., 1]) + l[..., 1]*np.cos(x2)
    x4 = l[..., 0]*np.sin(theta[..., 1]) + l[..., 1]*np.sin(x2)
    s = np.empty((*shape, 3), dtype=np.result_type(c, l, theta, np.float64))
    s[..., 0] = c[..., 0] + x1*x3
    s[..., 1] = c[..., 1] + x0*x3
    s[..., 2] = c[..., 2] + x4
    zero = np.zeros_like(x3)
    M = np.stack([np.stack([-x0*x3, -x1*x4], axis=-1), np.stack([x1*x3, -x0*x4], axis=-1),
                  np.stack([zero, x3], axis=-1)], axis=-2)
    return s, M


def inverse(v, l):
    """The elbow, with a guard against points out of reach."""
    v = np.asarray(v, dtype=float)
    l = np.asarray(l, float)
    r = np.hypot(v[..., 0], v[..., 1])
    cosine = (r**2 + v[..., 2]**2 - l[..., 0]**2 - l[..., 1]**2)/(2.0*l[..., 0]*l[..., 1])
    rest = 1.0 - np.square(cosine)
    good = np.isfinite(cosine) & (rest >= 0.0)
    sine = np.sqrt(np.where(good, rest, 0.0))
    theta = np.arctan2(sine, cosine)
    out = np.full((*np.shape(theta), 2), np.nan)
    out[..., 0] = np.where(good, theta, np.nan)
    out[..., 1] = np.maximum(np.abs(sine), np.minimum(cosine, 0.25))
    return out


@checked
def literals(x):
    small = [0.1*x for _ in range(2)]
    return x/3.0 + 1.0/3.0 + 1/3 + (2 + 3*5)/-7 + sum(small) + 1_000.5e-3 + _THIRD - _SCALE


class Gripper:
    def width(self, x):
        return np.sqrt(x) + 0.3

    @property
    def default(self):
        return np.pi
'''


@pytest.fixture
def module(tmp_path: Path) -> ModuleType:
    return load(tmp_path, "generated_leg", GENERATED)


def load(folder: Path, name: str, text: str) -> ModuleType:
    path = folder / f"{name}.py"
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def floats(array: Any) -> Any:
    return np.array([item.to_float() for item in np.ravel(array)]).reshape(np.shape(array))


def test_what_numpy_does_by_itself() -> None:
    x = as_object_array([3, 4])
    t = np.array([Angle("3/5", "4/5"), Angle("5/13", "12/13")], dtype=object)
    for result in (x + 1.5, x / 2, np.sqrt(x * x), np.sin(t), np.cos(t + t[::-1]), np.hypot(x, x[::-1])):
        assert result.dtype == object and all(isinstance(item, Exact) for item in result)
    assert np.sqrt(x * x)[0] == 3 and np.sin(t)[0] == Fraction(4, 5) and np.hypot(x[0], x[1]) == 5
    assert np.arctan2(x[:1], x[1:])[0].congruent(Angle("4/5", "3/5"))
    assert np.abs(-x)[0] == np.fabs(-x)[0] == 3
    assert np.minimum(x, 3)[1] == 3 and np.maximum(x, 3)[1] == 4
    assert (x > 3).dtype == bool and np.where(x > 3, x, x - 1)[0] == 2
    assert x @ x == np.einsum("i,i->", x, x) == np.sum(x * x) == 25
    stacked = np.stack(np.broadcast_arrays(x, x[:1]), axis=-1)
    assert stacked.shape == (2, 2) and stacked[1, 1] == 3
    assert np.cross(as_object_array([1, 2, 3]), as_object_array([3, 2, 1]))[1] == 8
    for function in (np.isfinite, np.isnan):
        with pytest.raises(TypeError):
            function(x)
    with pytest.raises(TypeError):
        np.empty(2)[:] = x


def test_the_namespace_does_the_rest() -> None:
    xp = exact_namespace()
    x = as_object_array([[3, 4], [0, math.nan]])
    assert xp.isfinite(x).dtype == bool and xp.isfinite(x).tolist() == [[True, True], [True, False]]
    assert xp.isnan(x).tolist() == [[False, False], [False, True]]
    assert xp.isfinite(Exact(1)) and not xp.isnan(1.0)
    for array in (xp.zeros(2), xp.ones((2,), float), xp.full(2, 0.1), xp.asarray([0.1, 2], dtype=np.float64)):
        assert array.dtype == object and all(isinstance(item, Exact) for item in array.flat)
    assert (
        xp.eye(2)[0, 0] == 1 and xp.zeros_like(x)[1, 1] == 0 and xp.ones_like(x)[0, 0] / 3 == Fraction(1, 3)
    )
    assert xp.empty(2).dtype == object and xp.empty(2)[0] is None
    assert xp.empty_like(np.zeros(2)).dtype == object
    for array in (xp.zeros(2, dtype=int), xp.ones(2, bool), xp.asarray([1, 2]), xp.empty(2, dtype=np.intp)):
        assert array.dtype != object
    assert xp.asarray(x[:1]).base is x
    assert all(isinstance(item, Exact) for item in xp.where(x[0] > 3, x[0], 0.0))
    assert [list(item) for item in xp.where(x[0] > 3)] == [[1]]
    assert xp.floor(as_object_array([-0.5]))[0] == -1
    assert xp.sqrt(4.0) == 2 and isinstance(xp.sqrt(4.0), Exact)
    assert math.isnan(xp.minimum(math.nan, Exact(1))) and xp.fmin(math.nan, Exact(1)) == 1
    assert xp.maximum(np.zeros(2), x[0])[1] == 4
    out = xp.empty(2)
    assert xp.hypot(x[0], x[0][::-1], out=out) is out and out[0] == 5
    assert xp.pi.congruent(Angle.half_turn())
    assert xp.newaxis is None and xp.float64 is np.float64
    with ball_precision():
        ball = exact_namespace(BALL)
        assert ball.sqrt(2.0).close(Ball(2).sqrt()) and ball.pi.close(Ball.pi())
        assert ball.arctan2(as_object_array([1], BALL), -1)[0].close(Ball.pi() * Fraction(3, 4))


def test_exact_results_agree_with_floats(module: ModuleType) -> None:
    rng = np.random.default_rng(2)
    tangents = np.array([[Fraction(int(k), 9) for k in row] for row in rng.integers(-30, 30, (5, 3))])
    theta = np.frompyfunc(Angle.from_half_tangent, 1, 1)(tangents)
    c, lengths = as_object_array([[1, 2, Fraction(1, 3)]]), as_object_array([Fraction(1, 2), Fraction(2, 7)])
    with exact_numpy(module):
        s, m = module.leg(c, lengths, theta)
        again = module.inverse(s - c, as_object_array([[3, 4]] * 5))
    assert s.dtype == m.dtype == object and s.shape == (5, 3) and m.shape == (5, 3, 2)
    assert all(isinstance(item, Exact) for item in [*s.flat, *m.flat])
    float_s, float_m = module.leg(floats(c), floats(lengths), floats(theta))
    assert np.allclose(floats(s), float_s, atol=1e-12) and np.allclose(floats(m), float_m, atol=1e-12)
    radius = lengths[0] * theta[0, 1].cos() + lengths[1] * (theta[0, 1] + theta[0, 2]).cos()
    assert s[0, 0] == 1 + theta[0, 0].cos() * radius
    assert again.shape == (5, 2) and all(math.isnan(item) for item in again[:, 0])


def test_roots_and_branches(module: ModuleType) -> None:
    with exact_numpy(module):
        elbow, value = module.inverse([3, 0, 4], [3, 4])
        assert elbow.congruent(Angle(0, 1)) and value == 1
    with ball_precision(), exact_numpy(module, arithmetic=BALL):
        elbow, value = module.inverse([Fraction(3, 2), 1, 4], [3, 4])
        cosine = (Ball(Fraction(9, 4)) + 1 + 16 - 25) / 24
        assert elbow.close((1 - cosine * cosine).sqrt().arctan2(cosine))
        assert value.close((1 - cosine * cosine).sqrt())
    assert np.allclose(module.inverse([1.5, 1, 4], [3, 4])[0], elbow.to_float())


def test_literals_are_the_numbers_that_they_show(module: ModuleType) -> None:
    third, tenth = Fraction(1, 3), Fraction(1, 10)
    expected = 1 + 2 * third - Fraction(17, 7) + 6 * tenth + Fraction("1.0005") + third - tenth * third
    constants = module._THIRD, module._SCALE
    assert module.literals(3.0) == pytest.approx(float(expected))
    with exact_numpy(module):
        assert module.literals(Exact(3)) == expected
        assert module.Gripper().width(4) == Fraction(23, 10)
        assert module.Gripper().default.congruent(Angle.half_turn())
        assert third == module._THIRD and third / 10 == module._SCALE and type(module._COUNT) is int
    with ball_precision(), exact_numpy(module, arithmetic=BALL):
        assert same(module.literals(Ball(3)), expected)
    with exact_numpy(module, literals=False):
        assert module.literals(Exact(3)) != expected
    assert constants == (module._THIRD, module._SCALE)
    assert module.literals(3.0) == pytest.approx(float(expected))


def test_the_module_is_left_as_it_was(module: ModuleType) -> None:
    before = dict(vars(module))
    code = module.leg.__code__
    with pytest.raises(numbers.NotRational), exact_numpy(module):
        assert module.np is not np
        module.inverse([1, 1, 4], [3, 4])
    assert vars(module) == before and module.leg.__code__ is code


def test_modules_that_import_one_another(tmp_path: Path, module: ModuleType) -> None:
    text = "import numpy as np\ndef robot(leg, x):\n    return np.sqrt(leg(x)) + 0.1\n"
    robot = load(tmp_path, "generated_robot", text)
    imported = module.Gripper().width
    with exact_numpy(robot, module, arithmetic=EXACT):
        assert robot.robot(lambda x: imported(x) - Fraction(3, 10), 16) == Fraction(21, 10)
    bare = ModuleType("bare")
    exec("def twice(x):\n    return 2.0*x", vars(bare))
    with exact_numpy(bare, literals=False):
        assert bare.twice(Exact(2)) == 4
    with pytest.raises((OSError, TypeError)), exact_numpy(bare):
        pass
