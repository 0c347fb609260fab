"""Configurations in which every loop closes exactly, with rational coordinates: the points at which
proofs are made.

The platform and its end points are drawn first.  Then each leg is built so that it ends there: its angles
are drawn, and lengths and base follow from them, as rational numbers (they may come out negative:
formulas do not mind).  A sub-leg that is not known here gets its joints from `inverse` in ball
arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from krhpr.codegen.evaluate import Arithmetic
from krhpr.codegen.kernel import LEGS, Kernel
from krhpr.validation.arithmetic import BALLS, RATIONAL
from krhpr.validation.draw import Draw, euler_rotation
from krhpr.validation.linear import dot, minus
from krhpr.validation.numbers import Angle, Ball, Exact, same
from krhpr.validation.sampling import draw
from krhpr.validation.subject import Subject

DOUBLINGS = 4
"""Newton steps, each of which doubles the digits, from those of doubles to those of balls."""

Leg = tuple[dict[str, Any], list[Any]]
"""Geometry fields and joints of one leg."""


@dataclass(frozen=True)
class Configuration:
    """A geometry and a consistent configuration on exact numbers; arguments by port, flat and row by row."""

    subject: Subject
    arithmetic: Arithmetic
    geometry: Mapping[str, Sequence[Any]]
    values: Mapping[str, list[Any]]

    def leg(self, name: str, leg: int) -> list[Any]:
        """One leg's part of a leg-wise argument."""
        values = self.values[name]
        size = len(values) // LEGS
        return values[size * leg : size * (leg + 1)]

    def kernel(self, part: str, kernel: Kernel | str, leg: int, **inputs: Any) -> dict[str, list[Any]]:
        """A kernel of one leg, as derived; what is not given is taken from the configuration."""
        found = self.subject.derived(part, kernel) if isinstance(kernel, str) else kernel
        arguments = {}
        for port in found.inputs:
            if port.name in inputs:
                value = inputs[port.name]
                arguments[port.name] = value if isinstance(value, list) else [value]
            else:
                arguments[port.name] = self.leg(port.name, leg) if port.per_leg else self.values[port.name]
        return self.subject.kernel(part, found, arguments, self.geometry, leg, self.arithmetic)

    def call(self, name: str, **inputs: list[Any]) -> dict[str, list[Any]]:
        """A robot's function by the derivation; what is not given is taken from the configuration."""
        return self.subject.call(name, {**self.values, **inputs}, self.geometry, self.arithmetic)


def configuration(subject: Subject, source: Draw) -> Configuration:
    """A random consistent configuration, with random rates and forces."""
    build = LEGS_BY_NAME.get(subject.code.subleg.name)
    found = configuration_in_balls(subject, source) if build is None else _rational(subject, source, build)
    kind = found.arithmetic.constant
    freedom, n = subject.platform.space.degrees_of_freedom, subject.subleg.n
    sizes = {
        "twist": freedom,
        "twist_rate": freedom,
        "redundant_rates": LEGS,
        "redundant_accelerations": LEGS,
        "swivel_rates": LEGS,
        "swivel_accelerations": LEGS,
        "theta_dot": LEGS * n,
        "theta_ddot": LEGS * n,
    }
    of_statics = {
        "wrench": freedom,
        "redundant_forces": LEGS,
        "swivel_forces": LEGS,
        "actuator_forces": LEGS * n,
        "jaws": LEGS,
        "contacts": LEGS * subject.platform.space.dimension,
        "mass_centre": subject.platform.space.dimension,
        "weight": subject.platform.space.dimension,
        "normal_forces": LEGS,
        "friction": 1,
    }
    rates = {name: [kind(source.nonzero().fraction) for _ in range(size)] for name, size in sizes.items()}
    # statics are linear in forces: any will do at every configuration
    given = Draw(freedom)
    rates |= {
        name: [kind(given.nonzero().fraction) for _ in range(size)] for name, size in of_statics.items()
    }
    return Configuration(subject, found.arithmetic, found.geometry, {**found.values, **rates})


def _rational(subject: Subject, source: Draw, build: Callable[[Draw, list[Any]], Leg]) -> Configuration:
    plate = subject.geometry_types["platform"]
    geometry = source.geometry(plate)
    angular = subject.platform.redundant_joint.kind == "revolute"
    dimension = subject.platform.space.dimension
    values: dict[str, list[Any]] = {
        "p": source.vector(dimension),
        "Q": source.rotation(dimension),
        "redundant": [source.angle() if angular else source.length() for _ in range(LEGS)],
    }
    if subject.planar:
        phi = source.angle()
        values |= {"phi": [phi], "Q": [phi.cos(), -phi.sin(), phi.sin(), phi.cos()]}
    here = Configuration(subject, RATIONAL, geometry, values)
    s = [x for leg in range(LEGS) for x in here.kernel("platform", "end_point", leg)["s"]]
    legs = [build(source, s[dimension * leg : dimension * (leg + 1)]) for leg in range(LEGS)]
    geometry |= {name: [fields[name] for fields, _ in legs] for name in legs[0][0]}
    values |= {"s": s, "theta": [angle for _, theta in legs for angle in theta]}
    return _with_assembly(Configuration(subject, RATIONAL, geometry, values))


def configuration_in_balls(subject: Subject, source: Draw) -> Configuration:
    """A random consistent configuration of doubles, in ball arithmetic."""
    batch = draw(subject, source.random.randrange(1 << 30), 1, spread=0.1)
    geometry = {name: [Ball(x) for x in numbers] for name, numbers in batch.geometry.items()}
    values: dict[str, list[Any]] = {
        name: [Ball(x) for x in batch.values[name][0].ravel().tolist()]
        for name in (*batch.pose, "redundant", "mode", "swivel", "s_near", "theta_near")
    }
    if subject.planar:
        phi = values["phi"][0]
        values["Q"] = [phi.cos(), -phi.sin(), phi.sin(), phi.cos()]
    else:
        values["Q"] = [Ball(x) for x in rational_rotation(batch.values["Q"][0])]
    here = Configuration(subject, BALLS, geometry, values)
    values["s"] = here.call("end_points")["s"]
    if subject.subleg.has_inverse:
        values["theta"] = here.call("inverse")["theta"]
    else:
        near = batch.values["theta"][0]
        values["theta"] = [x for leg in range(LEGS) for x in _refined(here, leg, near[leg].tolist())]
    return _with_assembly(here)


def _refined(here: Configuration, leg: int, theta: list[float]) -> list[Any]:
    """Joints in doubles made good to all digits by Newton steps, between which what is known of their error
    is dropped: balls around them would grow.
    """
    exact = [Ball(x) for x in theta]
    for _ in range(DOUBLINGS):
        exact = [x.centre() for x in here.kernel("subleg", "inverse_step", leg, theta=exact)["theta_next"]]
    return exact


def rational_rotation(Q: Any) -> list[Any]:
    """An exact rotation next to Q (less than a half turn), row by row."""
    # Euler parameters times 4 a, in doubles; their norm does not matter
    parameters = (1 + Q[0][0] + Q[1][1] + Q[2][2], Q[2][1] - Q[1][2], Q[0][2] - Q[2][0], Q[1][0] - Q[0][1])
    return euler_rotation(*(Exact(repr(float(x))) for x in parameters))


def _with_assembly(here: Configuration) -> Configuration:
    """The same with the assembly mode in which each leg's joints lead to its end point."""
    signs = here.subject.code.assembly_signs
    if not signs[0]:
        return here
    found: list[Any] = []
    for leg in range(LEGS):
        for choice in signs:
            s = here.kernel("subleg", "forward", leg, assembly=[Exact(sign) for sign in choice])["s"]
            if all(same(a, b) for a, b in zip(s, here.leg("s", leg), strict=True)):
                found += [Exact(sign) for sign in choice]
                break
        else:
            raise ArithmeticError(f"no assembly mode of {here.subject.identifier} leads to its end point")
    return Configuration(here.subject, here.arithmetic, here.geometry, {**here.values, "assembly": found})


# -- legs that end at a given point ----------------------------------------------------------------


def _direction(angle: Angle) -> list[Any]:
    return [angle.cos(), angle.sin()]


def _resolve(v: Sequence[Any], a: Angle, b: Angle) -> tuple[Any, Any, Angle, Angle]:
    """v = m u(a) + n u(b) with m, n positive, turning a and b round where they are not."""
    ua, ub = _direction(a), _direction(b)
    area = ua[0] * ub[1] - ua[1] * ub[0]
    m = (v[0] * ub[1] - v[1] * ub[0]) / area
    n = (ua[0] * v[1] - ua[1] * v[0]) / area
    if m < 0:
        m, a = -m, a + Angle.half_turn()
    if n < 0:
        n, b = -n, b + Angle.half_turn()
    return m, n, a, b


def _on_first_axis(
    source: Draw, s: list[Any], d: list[Any], lengths: dict[str, Any]
) -> tuple[dict[str, Any], Angle]:
    """The base of a leg whose linkage ends at d = (r, y) in its plane: azimuth, R_b, alpha, l_1 and
    theta_1.

    With s = c + r x + y e_1, along e_t: s . e_t = -r sin(theta_1), which a common scale of the lengths
    fits; along e_x and e_1 the two lengths R_b and l_1 are free.
    """
    azimuth, alpha, theta_1 = source.angle(), source.angle(), source.angle()
    e_r, e_t, e_z = [azimuth.cos(), azimuth.sin(), 0], [-azimuth.sin(), azimuth.cos(), 0], [0, 0, 1]
    e_1 = [-alpha.cos() * a + alpha.sin() * b for a, b in zip(e_r, e_z, strict=True)]
    e_x = [-alpha.sin() * a - alpha.cos() * b for a, b in zip(e_r, e_z, strict=True)]
    scale = -dot(s, e_t) / (theta_1.sin() * d[0])
    if scale < 0:
        theta_1, scale = -theta_1, -scale
    r, y = scale * d[0], scale * d[1]
    radius = (r * theta_1.cos() - dot(s, e_x)) / alpha.sin()
    fields = {name: scale * length for name, length in lengths.items()}
    fields |= {
        "azimuth": azimuth,
        "alpha": alpha,
        "R_b": radius,
        "l_1": dot(s, e_1) + radius * alpha.cos() - y,
    }
    return fields, theta_1


def _rrr(source: Draw, s: list[Any]) -> Leg:
    lengths = {"l_2": source.length(), "l_3": source.length()}
    theta_2, theta_3 = source.angle(), source.angle()
    u, v = _direction(theta_2), _direction(theta_2 + theta_3)
    d = [lengths["l_2"] * a + lengths["l_3"] * b for a, b in zip(u, v, strict=True)]
    fields, theta_1 = _on_first_axis(source, s, d, lengths)
    return fields, [theta_1, theta_2, theta_3]


def _r_fivebar(source: Draw, s: list[Any]) -> Leg:
    while True:
        lengths = {"l_4": source.length(), "l_5": source.length(), "l_6": source.length()}
        theta_2, distal = source.angle(), source.angle()
        u_1 = [lengths["l_4"] * x for x in _direction(theta_2)]
        v_1 = [lengths["l_6"] * x for x in _direction(distal)]
        ratio = 1 - lengths["l_5"] / lengths["l_6"]
        pivot = [a + ratio * b for a, b in zip(u_1, v_1, strict=True)]
        first, second = source.angle(), source.angle()
        # regular: no two of the links that meet are in line, and the rod's pivot is not the crank's
        in_line = [(theta_2 - distal).sin(), (first - second).sin(), (distal - second).sin()]
        if ratio != 0 and all(sine != 0 for sine in in_line):
            break
    lengths["l_2"], lengths["l_3"], theta_3, _ = _resolve(pivot, first, second)
    fields, theta_1 = _on_first_axis(source, s, [a + b for a, b in zip(u_1, v_1, strict=True)], lengths)
    return fields, [theta_1, theta_2, theta_3]


def _planar_rr(source: Draw, s: list[Any]) -> Leg:
    azimuth, radius = source.angle(), source.length()
    arm = minus(s, [radius * azimuth.cos(), radius * azimuth.sin()])
    l_1, l_2, first, second = _resolve(arm, source.angle(), source.angle())
    return {"azimuth": azimuth, "R_b": radius, "l_1": l_1, "l_2": l_2}, [first, second - first]


LEGS_BY_NAME: dict[str, Callable[[Draw, list[Any]], Leg]] = {
    "subleg_rrr": _rrr,
    "subleg_r_fivebar": _r_fivebar,
    "subleg_planar_rr": _planar_rr,
}
"""How a leg of each sub-leg is built."""
