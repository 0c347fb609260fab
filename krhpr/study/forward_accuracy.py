"""How encoder errors become errors of the pose: the seven approaches of Section 3.4.

Along the example trajectory of the 3-RRRSR robot every encoder, those of the approaches included, has a
random error.  The pose that each approach makes of them is compared with the true one:
e_p = |p - p_r|, (3.37), e_oc = |Q - Q_r|_2, (3.38), with Q_r as the equations give it, and e_on, (3.39), with
Q_r made a rotation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import krhpr
from krhpr.study.claims import Claim
from krhpr.study.trajectory import trajectory

Floats = NDArray[np.float64]

CONFIGURATIONS = 720
"""As many as the thesis has: both ends of the trajectory are one configuration."""
SIZES: Mapping[str, float] = MappingProxyType(
    {
        "R_b": 0.25,
        "R_p": 0.125,
        "l_1": 0.05,
        "l_2": 0.3,
        "l_3": 0.45,
        "l_r": 0.05,
        "alpha": float(np.radians(120)),
    }
)
"""Section 3.4, in metres and radians."""
BETA = np.radians(90)
"""The angle at the joints B_i: 60 degrees from the platform's edge, which is 30 from the inward ray."""
ERROR = 0.005
"""The largest error of an encoder, in radians."""
WEIGHTS = (1e3, 2e6 * SIZES["l_r"], 1.0)
"""The thesis' rows in millimetres: s_i = p + Q d_i, squared lengths (2 l times the length), and Q^T Q = 1."""
LIMIT = 2.5e-3
"""No error of p is larger in the thesis, for approaches one, two, and five to seven."""


class Spread(StrEnum):
    """How errors are distributed."""

    UNIFORM = "uniform"
    """Between -ERROR and ERROR."""
    NORMAL = "normal"
    """With a standard deviation of a third of ERROR."""


APPROACHES = (
    "one: all solutions",
    "two: Newton-Raphson",
    "three: one encoder",
    "four: two encoders",
    "five: three encoders",
    "six: Gauss-Newton, two",
    "seven: Gauss-Newton, three",
)
FIRST, SECOND, THIRD, FOURTH, FIFTH, SIXTH, SEVENTH = range(7)


@dataclass(frozen=True)
class Accuracy:
    """Errors of the seven approaches, (7, count)."""

    seed: int
    spread: Spread
    encoder_errors: Floats
    """Of joints 1 to 3 and of the redundant joint of the first leg, (4, count), rad."""
    position: Floats
    """e_p, m."""
    raw: Floats
    """e_oc."""
    orthonormal: Floats
    """e_on."""

    def claims(self) -> tuple[Claim, ...]:
        """The order of the approaches that Section 3.4 reports."""
        p, raw, made = (errors.mean(axis=1) for errors in (self.position, self.raw, self.orthonormal))
        others = [one for one in range(7) if one not in (THIRD, FOURTH)]
        changed = np.abs(self.raw - self.orthonormal).max(axis=1)
        gained = raw - made
        return (
            Claim("approach three is the worst in position", bool(p[THIRD] == p.max())),
            Claim("then approach four", bool(p[FOURTH] > max(p[one] for one in others))),
            Claim("six improves four in position", bool(p[SIXTH] < p[FOURTH])),
            Claim(
                "five and seven are the best in position",
                bool(
                    max(p[FIFTH], p[SEVENTH]) < min(p[one] for one in range(7) if one not in (FIFTH, SEVENTH))
                ),
            ),
            Claim(
                "one and two are the best in orientation",
                bool(max(raw[FIRST], raw[SECOND]) < min(raw[THIRD:])),
            ),
            Claim(
                "five and seven are the worst in orientation", set(np.argsort(raw)[-2:]) == {FIFTH, SEVENTH}
            ),
            Claim(
                "orthonormalising changes nothing in one to three", bool(changed[: THIRD + 1].max() < 1e-9)
            ),
            Claim("orthonormalising helps four to seven", bool((gained[FOURTH:] > 0).all())),
        )

    def beyond(self) -> Floats:
        """How many errors of p are larger than the thesis' 2.5 mm, for each approach."""
        return np.asarray((self.position > LIMIT).sum(axis=1), dtype=float)


def forward_accuracy(
    *,
    seed: int = 0,
    spread: Spread = Spread.UNIFORM,
    error: float = ERROR,
    repeat: int = 1,
    progress: Callable[[str], None] = lambda step: None,
) -> Accuracy:
    """Run the study.

    Args:
        seed: of the random errors.
        spread: how they are distributed.
        error: their bound, or three standard deviations, in radians.
        repeat: how often the trajectory is run through, each time with other errors.
        progress: is told what begins.
    """
    progress("trajectory")
    robot = krhpr.load("spatial_rrr_a").with_geometry(**SIZES)
    p, Q = (np.tile(x[:CONFIGURATIONS], (repeat,) + (1,) * (x.ndim - 1)) for x in trajectory())
    p = p / 1000
    beta = np.full((len(p), 3), BETA)
    theta = robot.inverse(p, Q, beta)
    errors = _errors(np.random.default_rng(seed), spread, error, (len(p), 3, 4))
    s = robot.subleg_forward(theta + errors[..., :3])
    measured = beta + errors[..., 3]
    found = []
    for number, approach in enumerate(APPROACHES):
        progress(f"approach {approach}")
        found.append(_approach(robot, number, s, measured, (p, Q)))
    progress("errors")
    return Accuracy(
        seed,
        spread,
        errors[:, 0].T,
        np.stack([np.linalg.norm(one - p, axis=-1) for one, _, _ in found]),
        np.stack([np.linalg.norm(raw - Q, 2, axis=(-2, -1)) for _, raw, _ in found]),
        np.stack([np.linalg.norm(made - Q, 2, axis=(-2, -1)) for _, _, made in found]),
    )


def _errors(rng: np.random.Generator, spread: Spread, error: float, shape: tuple[int, ...]) -> Floats:
    if spread is Spread.NORMAL:
        return rng.normal(scale=error / 3, size=shape)
    return rng.uniform(-error, error, shape)


def _nearest(found: Any, pose: tuple[Floats, Floats]) -> tuple[Any, Any, Any]:
    """Of several solutions the one that the trajectory means."""
    gap = np.linalg.norm(found.p - pose[0][:, None], axis=-1)
    best = np.nanargmin(gap + np.linalg.norm(found.Q - pose[1][:, None], axis=(-2, -1)), axis=1)
    rows = np.arange(len(gap))
    return found.p[rows, best], found.Q[rows, best], found.Q[rows, best]


def _approach(
    robot: krhpr.Robot, number: int, s: Floats, measured: Floats, pose: tuple[Floats, Floats]
) -> tuple[Any, Any, Any]:
    """Position, orientation as the equations give it, and orientation made a rotation."""
    if number == FIRST:
        return _nearest(robot.forward_all(s), pose)
    if number == SECOND:
        newton = robot.forward_newton(s, *pose)
        return newton.p, newton.Q, newton.Q
    if number == THIRD:
        both = robot.forward_encoders(s, measured[:, :1], tolerance=1.0)
        return _nearest(both, pose)
    count = 2 if number in (FOURTH, SIXTH) else 3
    if number in (FOURTH, FIFTH):
        found = robot.forward_encoders(s, measured[:, :count], tolerance=1.0)
    else:
        found = robot.forward_gauss_newton(s, measured[:, :count], weights=WEIGHTS, tolerance=1.0)
    return found.p, found.raw, found.Q
