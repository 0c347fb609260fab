"""A sub-leg of one's own: RRR whose last link is bent, so that S_i lies beside the linkage plane.

The first axis and the two links l_2 and l_3 are those of the RRR sub-leg of Section 2.3.  From the end of
link l_3, W, an offset h leads to S_i along e_2, the normal of the linkage plane:

    s = c + d_0 x + d_1 e_1 + h e_2,    d = l_2 u(t_2) + l_3 u(t_2 + t_3),    u(t) = (cos t, sin t).

    krhpr generate --plugin examples/plugins/offset_wrist.py --out offset_wrist
    krhpr validate --plugin examples/plugins/offset_wrist.py

It states no `inverse`: the inverse kinematics of the generated code is a bounded Newton iteration from
joints nearby.  docs/adding-a-sub-leg.md adds the closed form.
"""

from __future__ import annotations

from types import SimpleNamespace

import sympy as sp

from krhpr.derivations.api import (
    FIRST_LINK,
    E,
    Factor,
    FirstAxis,
    Forward,
    Frame,
    GeometryField,
    GeometryType,
    Joint,
    JointKind,
    KernelWriter,
    Layout,
    Link,
    LinkKind,
    Passive,
    Plugin,
    Port,
    Posture,
    Space,
    SubLeg,
    Unit,
    VelocityEquations,
    base_points,
    cross2,
    dot,
    in_plane,
    leg_frame_geometry,
)


class OffsetWrist(SubLeg):
    """Three actuated revolute joints, the last link bent out of the linkage plane by h."""

    # -- what it is: names, joints, links ------------------------------------------------------------------

    name = "offset_wrist"  # robots are called spatial_offset_wrist_a, _b, _c
    space = Space.SPATIAL
    notation = "RRR'"
    section = "-"  # of the thesis; this one is not in it
    doc = "Serial sub-leg RRR with an offset wrist: S_i lies beside the linkage plane."
    actuators = (
        Joint("theta_1", JointKind.REVOLUTE, "about e_1; zero where e_2 is tangential"),
        Joint("theta_2", JointKind.REVOLUTE, "about e_2; link i2 from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about e_2; link i3 relative to link i2"),
    )
    # straight links between the points that `points` names, called as their lengths are
    links = (
        FIRST_LINK,
        Link("l_2", LinkKind.PROXIMAL, "c", "E"),
        Link("l_3", LinkKind.PROXIMAL, "E", "W"),
        Link("h", LinkKind.DISTAL, "W", "S"),
    )
    actuated_at = ("A", "c", "E")
    first_axis = FirstAxis()

    # -- geometry: what a person sets, and what is prepared from it once -----------------------------------

    def geometry(self) -> GeometryType:
        lengths = (
            GeometryField("l_2", Unit.METRE, "link i2, to the elbow", positive=True),
            GeometryField("l_3", Unit.METRE, "link i3, from the elbow to the wrist W_i", positive=True),
            GeometryField("h", Unit.METRE, "offset of S_i from W_i along e_2", positive=True),
        )
        return leg_frame_geometry(f"subleg_{self.name}", self.doc, lengths)

    # -- position: joints -> end point ---------------------------------------------------------------------

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        x, e_2 = self.first_axis.frame(k, theta[0])
        v = k.let("v", k.g.l_3 * in_plane(theta[1] + theta[2]), "link i3")
        d = k.let("d", k.g.l_2 * in_plane(theta[1]) + v, "W - c in (x, e_1)")
        s = k.g.c + d[0] * x + d[1] * k.g.e_1 + k.g.h * e_2
        return Forward(s, {"x": x, "e_2": e_2, "d": d, "v": v})

    # -- velocity: what it depends on, and its equations ---------------------------------------------------

    def posture_ports(self) -> tuple[Port, ...]:
        return (
            Port("x", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_x", Layout.STACKED),
            Port("e_2", (3,), Unit.NONE, Frame.BASE, "Rot(e_1, theta_1) e_t", Layout.STACKED),
            Port("d", (2,), Unit.METRE, Frame.JOINT, "W - c in the linkage plane (x, e_1)", Layout.STACKED),
            Port("v", (2,), Unit.METRE, Frame.JOINT, "link i3 in the linkage plane", Layout.STACKED),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        x, e_2 = self.first_axis.frame(k, theta[0])
        arm = k.let("arm", s - k.g.c, "s - c")
        d = k.let("d", sp.Matrix([dot(arm, x), dot(arm, k.g.e_1)]), "W - c")
        return {"x": x, "e_2": e_2, "d": d, "v": k.let("v", d - k.g.l_2 * in_plane(theta[1]), "link i3")}

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        # F^T s_dot = B theta_dot in F = (x, e_1, e_2); columns e_1 x (s - c), e_2 x d and e_2 x v
        second, third = E * at.d, E * at.v
        elbow = k.let("elbow", cross2(at.d, at.v), "l_2 l_3 sin(theta_3)")
        return VelocityEquations(
            F=sp.Matrix.hstack(at.x, k.g.e_1, at.e_2),
            A=sp.eye(3),
            B=sp.Matrix([[k.g.h, second[0], third[0]], [0, second[1], third[1]], [-at.d[0], 0, 0]]),
            determinant=-at.d[0] * elbow,
            serial=(
                Factor(
                    "shoulder", at.d[0] / (k.g.l_2 + k.g.l_3), "W_i in the plane of the first axis and e_2"
                ),
                Factor("elbow", elbow / (k.g.l_2 * k.g.l_3), "links i2 and i3 aligned, sin(theta_3) = 0"),
            ),
        )

    # -- passive joints and points -------------------------------------------------------------------------

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        u = k.let("dir", at.v / k.g.l_3, "direction of link i3 in (x, e_1)")
        along = k.let("along", u[0] * at.x + u[1] * k.g.e_1)
        return Passive((), sp.Matrix.hstack(along, u[0] * k.g.e_1 - u[1] * at.x, at.e_2))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        wrist = k.let("wrist", s - k.g.h * at.e_2)
        elbow = wrist - at.v[0] * at.x - at.v[1] * k.g.e_1
        return {**base_points(k), "E": elbow, "W": wrist, "S": s}

    # -- what it is all held to: equations that are zero where joints and end point belong together --------

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s


PLUGIN = Plugin(
    OffsetWrist(),
    sizes={
        "azimuth": (0.0, 2.0943951023931953, 4.1887902047863905),  # the legs, 120 degrees apart
        "R_b": 0.25,
        "alpha": 2.0943951023931953,
        "l_1": 0.05,
        "l_2": 0.3,
        "l_3": 0.45,
        "h": 0.04,
    },
    title="RRR sub-legs with an offset wrist",
    source="examples/plugins/offset_wrist.py",
)
