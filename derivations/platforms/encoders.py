"""Forward kinematics with encoders at redundant joints: approaches three to seven (Sections 3.2.3 to 3.2.6).

An encoder tells where S_i is in the platform frame, d_i, so that s_i = p + Q d_i.  Seen from S_1 in the
platform's plane, with r_i = s_i - s_1 and U the first two columns of Q there:

* one encoder: |U (b_2 - d_1) - r_2| = l_2 has two solutions for phi, and l_3 tells which fits, (3.13);
* two: U d_12 = r_2, (3.24); three: U d_12 = r_2 and U d_13 = r_3, (3.30), for U of any form;
* Gauss-Newton, (3.32): the least squares of s_i = p + U d_i, of the third leg's tie (its link's length, or
  that S_3 is on its slide) where there is no third encoder, and of U^T U = 1, with a weight for each kind.
  Out of the plane all residuals are zero, so that six of the nine unknowns are left.

With errors in the encoders U is not a rotation; it is made one as by (3.34) to (3.36), q_x first.  Slides are
encoders of arrangements (b) and (c) just the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from krhpr.codegen.kernel import Frame, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.least_squares import normal_step
from krhpr.derivations.platforms.forward import Hold, Plane, forward_ports, plane_of, stacked
from krhpr.derivations.platforms.forward_revolute import ANCHOR, AXES, LENGTH, POINTS
from krhpr.derivations.platforms.kernels import all_legs
from krhpr.derivations.terms import Space
from krhpr.derivations.vectors import cross2, dot, turned

if TYPE_CHECKING:
    from krhpr.derivations.platforms.base import Platform

ARM = stacked("arm", (2,), Unit.METRE, "l_i e_r, along b_i")
TOLERANCE = Port("tolerance", (), Unit.METRE, Frame.NONE, "by how much encoders and end points may disagree")
MISMATCHES = Port(
    "mismatch",
    (2,),
    Unit.METRE,
    Frame.NONE,
    "by how much the third link is longer or shorter than it is, for each solution",
)
SPREAD = Port(
    "spread", (1,), Unit.NONE, Frame.NONE, "squared: zero where encoders leave the orientation open"
)
DIRECTION = Port(
    "direction", (1,), Unit.NONE, Frame.NONE, "|q_x|^2: zero where the end points leave the orientation open"
)
AGREEMENT = Port("agreement", (1,), Unit.METRE, Frame.NONE, "not negative within the tolerance")
REAL = Port("radicand", (1,), Unit.NONE, Frame.NONE, "not negative where the second link reaches")
WEIGHTS = Port(
    "weights",
    (3,),
    Unit.MIXED,
    Frame.NONE,
    "of s_i = p + Q d_i (1/m), of the third leg's tie (1/m) and of Q^T Q = 1",
)
STATE = Port("state", (6,), Unit.MIXED, Frame.NONE, "U column by column, and p in the plane, from S_1")
LINEAR = replace(STATE, name="linear", doc=f"{STATE.doc}: by linear equations")
CHANGE = Port("change", (1,), Unit.NONE, Frame.NONE, "squared step, relative to the platform's size")
COST = Port("cost", (), Unit.MIXED, Frame.NONE, "the sum of the weighted squares")


def measured_port(joint: Port, count: int) -> Port:
    """What encoders at the first legs measure."""
    legs = " to ".join(["1", str(count)][: 1 + (count > 1)])
    doc = f"redundant coordinates measured at leg{'s' if count > 1 else ''} {legs}"
    return Port("measured", (count,), joint.unit, Frame.JOINT, doc)


def mismatch_port(count: int) -> Port:
    """By how much end points and encoders disagree."""
    pairs = ("12", "13", "23")[: count * (count - 1) // 2]
    doc = f"|S_i S_j| less what encoders say, for the legs {', '.join(pairs)}"
    return Port("mismatch", (len(pairs),), Unit.METRE, Frame.NONE, doc, labels=pairs)


def raw_port(space: Space) -> Port:
    """The orientation before it is made a rotation."""
    d = space.dimension
    return Port("raw", (d, d), Unit.NONE, Frame.BASE, "orientation as the equations give it")


def turn_port(count: int) -> Port:
    """Cosines and sines of measured angles."""
    return Port("turns", (count, 2), Unit.NONE, Frame.NONE, "cosine and sine of measured angles")


def encoder_kernels(plate: Platform) -> tuple[Kernel, ...]:
    """Kernels of the approaches that the arrangement has."""
    kernels = []
    if plate.ports().redundant.unit is Unit.RADIAN:
        kernels += [_arm(plate), *(_turns(plate, count) for count in (1, 2, 3))]
        kernels.append(_one(plate))
    return (
        *kernels,
        *(_several(plate, count) for count in (2, 3)),
        *(_step(plate, count) for count in (2, 3)),
        _pose(plate),
    )


def _arm(plate: Platform) -> Kernel:
    k = KernelWriter("arm", "The redundant link where its angle is a half turn.", "", plate.geometry())
    k.add_output(ARM, k.g.l_r * k.g.e_r)
    return k.kernel()


def _turns(plate: Platform, count: int) -> Kernel:
    k = KernelWriter(f"turns_{count}", "Cosines and sines of measured angles.")
    angles = k.add_input(measured_port(plate.ports().redundant, count))
    k.add_output(turn_port(count), [entry for x in list(angles) for entry in (sp.cos(x), sp.sin(x))])
    return k.kernel()


def hold_by_angles(k: KernelWriter, count: int) -> Hold:
    """Arrangement (a): d_i = b_i - cos(beta_i) l_i e_r + sin(beta_i) l_i e_t."""
    turns = k.add_input(turn_port(count))
    anchors, lengths, arms = all_legs(k, ANCHOR), all_legs(k, LENGTH), all_legs(k, ARM)
    ends = [
        k.let(
            f"e_{i + 1}",
            anchors[i] - turned(turns[i, 0], -turns[i, 1], arms[i]),
            "S_i in the platform frame",
        )
        for i in range(count)
    ]
    order = cross2(anchors[1] - anchors[0], anchors[2] - anchors[0])
    return Hold(order, tuple(ends), tuple(anchors), tuple(lengths))


def length_residual(k: KernelWriter, state: Any, point: Any) -> tuple[list[Any], Any]:
    """Arrangement (a): (|S_3 B_3|^2 - l_3^2) / (2 l_3), which is the link's error but for its square."""
    b, length = all_legs(k, ANCHOR)[2], all_legs(k, LENGTH)[2]
    U, p = columns(state)
    a_3 = k.let("a_3", p + U * b - point, "S_3 to B_3")
    row = [a_3[0] * b[0], a_3[1] * b[0], a_3[0] * b[1], a_3[1] * b[1], a_3[0], a_3[1]]
    return [entry / length for entry in row], (dot(a_3, a_3) - length**2) / (2 * length)


def columns(state: Any) -> tuple[sp.Matrix, sp.Matrix]:
    """U and p of a state."""
    return sp.Matrix([[state[0], state[2]], [state[1], state[3]]]), state[4:6, 0]


def _one(plate: Platform) -> Kernel:
    k = KernelWriter("one_encoder", "The pose from the end points and the first redundant angle.", "3.2.3")
    s, hold, tolerance = all_legs(k, plate.ports().s), plate.hold(k, 1), k.add_input(TOLERANCE)
    plane = plane_of(k, plate.space, s, hold.order, sp.Integer(1))
    lengths = hold.lengths
    arms = [k.let(f"w_{i + 1}", hold.anchors[i] - hold.ends[0], "S_1 to B_i") for i in (1, 2)]
    r_2, r_3 = plane.points[1:]
    # |U w - r|^2 = l^2 with r . U w = (w . r) cos + (w x r) sin
    A, B = k.let("M", dot(arms[0], r_2)), k.let("L", cross2(arms[0], r_2))
    C = k.let("N", (dot(arms[0], arms[0]) + dot(r_2, r_2) - lengths[1] ** 2) / 2)
    square = k.let("ML_2", A**2 + B**2)
    radicand = k.let("radicand", 1 - C**2 / square)
    k.add_output(REAL, [radicand])
    root = k.let("root", sp.sqrt(radicand / square))
    middle = k.let("middle", C / square)

    def turn(sign: Any) -> tuple[Any, Any]:
        return A * middle - sign * B * root, B * middle + sign * A * root

    misses = []
    for name, sign in (("plus", 1), ("minus", -1)):
        cosine, sine = (
            k.let(f"{part}_{name}", x) for part, x in zip(("cos", "sin"), turn(sign), strict=True)
        )
        a_3 = k.let(f"a_3_{name}", turned(cosine, sine, arms[1]) - r_3, "S_3 to B_3")
        misses.append(k.let(f"miss_{name}", sp.sqrt(dot(a_3, a_3)) - lengths[2]))
    # +1 where the first fits better, or both alike
    sizes = [k.absolute(miss) for miss in misses]
    gap = k.let("gap", sizes[1] - sizes[0])
    sign = k.let("sign", k.sign(gap))
    poses = []
    for name, side in (("best", sign), ("other", -sign)):
        cosine, sine = (
            k.let(f"{part}_{name}", x) for part, x in zip(("cos", "sin"), turn(side), strict=True)
        )
        poses.append((cosine, sine, -turned(cosine, sine, hold.ends[0])))
    _write_poses(k, plate, plane, poses, several=True)
    middle, half = (misses[0] + misses[1]) / 2, sign * (misses[0] - misses[1]) / 2
    k.add_output(MISMATCHES, [middle + half, middle - half])
    k.add_output(AGREEMENT, [tolerance - k.minimum(*sizes)])
    return k.kernel()


def _several(plate: Platform, count: int) -> Kernel:
    number = {2: "two", 3: "three"}[count]
    k = KernelWriter(
        f"{number}_encoders",
        f"Orientation and position in the plane from the end points and {number} redundant coordinates.",
        {2: "3.2.4, (3.24)", 3: "3.2.5, (3.30)"}[count],
    )
    s, hold, tolerance = all_legs(k, plate.ports().s), plate.hold(k, count), k.add_input(TOLERANCE)
    plane = plane_of(k, plate.space, s, hold.order, sp.Integer(1))
    k.add_output(POINTS, [entry for point in plane.points for entry in point])
    if plane.axes is not None:
        k.add_output(AXES, plane.axes)
    k.add_output(_ends_port(count), [entry for end in hold.ends for entry in end])
    d = [k.let(f"d_1{j + 1}", hold.ends[j] - hold.ends[0]) for j in range(1, count)]
    r = plane.points[1:]
    if count == 2:
        square = k.let("d_12_2", dot(d[0], d[0]))
        sizes = sum(dot(end, end) for end in hold.ends)
        k.add_output(SPREAD, [square / (sizes + dot(r[0], r[0]))])
        cosine, sine = k.let("cos", dot(d[0], r[0]) / square), k.let("sin", cross2(d[0], r[0]) / square)
        U = sp.Matrix([[cosine, -sine], [sine, cosine]])
    else:
        area = k.let("area", cross2(d[0], d[1]))
        k.add_output(SPREAD, [area**2 / (dot(d[0], d[0]) * dot(d[1], d[1]))])
        x = (r[0] * d[1][1] - r[1] * d[0][1]) / area
        y = (r[1] * d[0][0] - r[0] * d[1][0]) / area
        U = sp.Matrix.hstack(k.let("u_x", x), k.let("u_y", y))
    k.add_output(LINEAR, [*U.col(0), *U.col(1), *(-U * hold.ends[0])])
    pairs = [(d[0], r[0])]
    if count == 3:
        pairs += [(d[1], r[1]), (d[1] - d[0], r[1] - r[0])]
    gaps = []
    for i, (a, b) in enumerate(pairs):
        # in space S_2 is on the x axis: the root of its square would be an absolute value
        far = b[0] if b[1] == 0 else sp.sqrt(k.let(f"r_2_{i}", dot(b, b)))
        gaps.append(k.let(f"gap_{i}", far - sp.sqrt(k.let(f"d_2_{i}", dot(a, a)))))
    k.add_output(mismatch_port(count), gaps)
    k.add_output(AGREEMENT, [tolerance - _largest(k, gaps)])
    return k.kernel()


def _step(plate: Platform, count: int) -> Kernel:
    k = KernelWriter(
        f"gauss_newton_{count}",
        f"One Gauss-Newton step with encoders at {count} legs.",
        "3.2.6, (3.32), (3.33)",
    )
    state, weights = k.add_input(STATE), k.add_input(WEIGHTS)
    points, whole = _rows(k, POINTS), _rows(k, _ends_port(count))
    U, p = columns(state)
    rows: list[list[Any]] = []
    values: list[Any] = []
    for i in range(count):
        d = whole[i]
        miss = k.let(f"f_{i + 1}", p + U * d - points[i], "of s_i = p + Q d_i")
        for axis in (0, 1):
            row = [sp.Integer(0)] * 6
            row[axis], row[2 + axis], row[4 + axis] = d[0], d[1], sp.Integer(1)
            rows.append([weights[0] * entry for entry in row])
            values.append(weights[0] * miss[axis])
    if count == 2:
        row, value = plate.tie_residual(k, state, points[2])
        rows.append([weights[1] * entry for entry in row])
        values.append(weights[1] * value)
    x, y = U.col(0), U.col(1)
    zero = sp.Integer(0)
    rows += [
        [weights[2] * entry for entry in row]
        for row in (
            [2 * x[0], 2 * x[1], zero, zero, zero, zero],
            [zero, zero, 2 * y[0], 2 * y[1], zero, zero],
            [y[0], y[1], x[0], x[1], zero, zero],
        )
    ]
    values += [weights[2] * (dot(x, x) - 1), weights[2] * (dot(y, y) - 1), weights[2] * dot(x, y)]
    step = normal_step(k, rows, values)
    k.add_output(STATE.one_step_on(), state + step)
    size = k.let("size", sum(dot(d, d) for d in whole))
    U_step, p_step = step[:4, 0], step[4:6, 0]
    k.add_output(CHANGE, [dot(U_step, U_step) + dot(p_step, p_step) / size])
    return k.kernel()


def _pose(plate: Platform) -> Kernel:
    k = KernelWriter("encoder_pose", "The pose from U and p in the plane, U made a rotation.", "3.3")
    s, state = all_legs(k, plate.ports().s), k.add_input(STATE)
    axes = k.add_input(AXES) if plate.space is Space.SPATIAL else None
    plane = Plane(plate.space, s[0], axes, ())
    x, y = state[0:2, 0], state[2:4, 0]
    square = k.let("square", dot(x, x))
    k.add_output(DIRECTION, [square])
    norm = k.let("norm", 1 / sp.sqrt(square))
    # (3.34) to (3.36): in the plane q_y follows from q_x
    pose = k.let("cos", x[0] * norm), k.let("sin", x[1] * norm), state[4:6, 0]
    _write_poses(k, plate, plane, [pose], several=False)
    raw = sp.Matrix.hstack(x, y)
    if plane.axes is not None:
        raw = sp.Matrix.hstack(plane.axes[:, :2] * raw, plane.axes.col(2))
    k.add_output(raw_port(plate.space), raw)
    return k.kernel()


def _largest(k: KernelWriter, values: Sequence[Any]) -> Any:
    sizes = [k.absolute(value) for value in values]
    return k.maximum(*sizes) if len(sizes) > 1 else sizes[0]


def _ends_port(count: int) -> Port:
    return Port("ends", (count, 2), Unit.METRE, Frame.PLATFORM, "S_i of the legs with encoders")


def _rows(k: KernelWriter, port: Port) -> list[sp.Matrix]:
    whole = k.add_input(port)
    return [whole.row(i).T for i in range(port.shape[0])]


def _write_poses(
    k: KernelWriter,
    plate: Platform,
    plane: Plane,
    poses: Sequence[tuple[Any, Any, sp.Matrix]],
    *,
    several: bool,
) -> None:
    """The poses of angles and positions in the plane."""
    ports = forward_ports(plate.space, plate.ports().redundant, len(poses) if several else 0)
    k.add_output(ports.p, [entry for _, _, position in poses for entry in plane.position(position)])
    if plane.axes is None:
        k.add_output(ports.orientation, [k.atan2(sine, cosine) for cosine, sine, _ in poses])
    else:
        turns = [entry for cosine, sine, _ in poses for entry in plane.orientation(cosine, sine)]
        k.add_output(ports.orientation, turns)
