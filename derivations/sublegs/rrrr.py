"""The redundant serial 4R sub-leg of Section 2.4.1: a first axis, and an arm whose elbow may leave the plane
of e_1.

RRR with a joint along the upper arm between its two parallel joints: u = l_2 (x cos t_2 + e_1 sin t_2) is
the upper arm, the third joint turns about u, and the fourth is the elbow, with the axis e_4 (e_2 at theta_3
= 0) and the forearm v.

For one end point the elbow moves on a circle about the line from c to S_i.  The swivel is its angle on that
circle from where it is farthest along e_1, about s - c; there the arm lies in a plane with e_1, as RRR does
(outer elbow).  It has no meaning where S_i is on the first axis (r = 0), though the arm itself is not
singular there.

Vectors below are components in the frame (x, e_1, e_2), which turns with theta_1.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.base import Forward, Passive, Posture, SubLeg, VelocityEquations
from krhpr.derivations.sublegs.carriers import FirstAxis, base_points, leg_frame_geometry
from krhpr.derivations.sublegs.two_link import distance, outside
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign, Space
from krhpr.derivations.vectors import cross, dot

E_1 = sp.Matrix([0, 1, 0])
E_2 = sp.Matrix([0, 0, 1])


class RRRR(SubLeg):
    """Four actuated revolute joints in series, (2.32)."""

    name = "rrrr"
    space = Space.SPATIAL
    notation = "4R"
    section = "2.4.1"
    doc = "Redundant serial sub-leg: RRR with a further joint along its upper arm."
    equations = "2.4.1, 2.5"
    axis = FirstAxis()
    actuators = (
        axis.joint,
        Joint("theta_2", JointKind.REVOLUTE, "about e_2; link i2 from x towards e_1"),
        Joint("theta_3", JointKind.REVOLUTE, "about link i2; zero where the elbow's axis is e_2"),
        Joint("theta_4", JointKind.REVOLUTE, "elbow; link i3 relative to link i2"),
    )
    swivel = Joint(
        "swivel",
        JointKind.REVOLUTE,
        "angle of the elbow about the line from c to S_i, zero where it is farthest along e_1",
    )
    inverse_signs = (
        Sign("shoulder", "front", "back", "side of the first axis on which x points to the elbow"),
        Sign("elbow", "elbow+", "elbow-", "sign of sin(theta_4)"),
    )
    links = (
        *axis.links,
        Link("l_2", LinkKind.PROXIMAL, "c", "E"),
        Link("l_3", LinkKind.DISTAL, "E", "S"),
    )
    actuated_at = ("A", "c", "l_2", "E")
    default_mode = "back/elbow-"

    def geometry(self) -> GeometryType:
        lengths = (
            GeometryField("l_2", Unit.METRE, "link i2, to the elbow", positive=True),
            GeometryField("l_3", Unit.METRE, "link i3, from the elbow to S_i", positive=True),
        )
        return leg_frame_geometry(f"subleg_{self.name}", self.doc, lengths)

    # -- position -------------------------------------------------------------------------------------------

    def _arm(self, k: KernelWriter, theta: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
        """Upper arm u and elbow axis e_4."""
        (c_2, s_2), (c_3, s_3) = (
            (k.let(f"cos_{j}", sp.cos(theta[j - 1])), k.let(f"sin_{j}", sp.sin(theta[j - 1]))) for j in (2, 3)
        )
        u = k.let("u", k.g.l_2 * sp.Matrix([c_2, s_2, 0]), "upper arm in (x, e_1, e_2)")
        return u, k.let("e_4", sp.Matrix([s_2 * s_3, -c_2 * s_3, c_3]), "elbow axis in (x, e_1, e_2)")

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> Forward:
        u, e_4 = self._arm(k, theta)
        across = cross(e_4, u) / k.g.l_2
        v = (u / k.g.l_2) * sp.cos(theta[3]) + across * sp.sin(theta[3])
        v = k.let("v", k.g.l_3 * v, "forearm in (x, e_1, e_2)")
        x, e_2 = self.axis.frame(k, theta[0])
        d = k.let("d", u + v, "s - c in (x, e_1, e_2)")
        s = k.g.c + d[0] * x + d[1] * k.g.e_1 + d[2] * e_2
        return Forward(s, {"x": x, "e_2": e_2, "d": d, "v": v, "e_4": e_4})

    def inverse(
        self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any
    ) -> tuple[list[Any], list[Any]]:
        shoulder, elbow = mode
        a, b = k.g.l_2, k.g.l_3
        arm = k.let("arm", s - k.g.c, "s - c")
        d = k.let("d", sp.Matrix([dot(arm, axis) for axis in (k.g.e_x, k.g.e_1, k.g.e_t)]))
        d2 = k.let("d2", dot(d, d))
        r = k.let("r", sp.sqrt(d[0] ** 2 + d[2] ** 2), "distance from the first axis")
        radicand = k.let("h2", ((a + b) ** 2 - d2) * (d2 - (a - b) ** 2), "4 l_2^2 l_3^2 sin^2(theta_4)")
        root = k.let("root", sp.sqrt(radicand))
        # the elbow's circle: its centre on the line, its radius along m = e_1 - (e_1^T d) d / d^2 at swivel
        # zero
        m = k.let("m", E_1 - (d[1] / d2) * d)
        side = k.let("side", cross(d, E_1) / k.let("distance", sp.sqrt(d2)))
        out = sp.cos(swivel) * m + sp.sin(swivel) * side
        u = k.let(
            "u", (d2 + a**2 - b**2) / (2 * d2) * d + root / (2 * r) * out, "upper arm in (e_x, e_1, e_t)"
        )
        level = k.let("level", shoulder * sp.sqrt(u[0] ** 2 + u[2] ** 2))
        theta_1 = k.atan2(-shoulder * u[2], shoulder * u[0])
        theta_2 = k.atan2(u[1], level)
        n = k.let("n", elbow * cross(u, d), "l_2 l_3 |sin(theta_4)| e_4")
        e_2 = k.let("e_2", shoulder * sp.Matrix([-u[2], 0, u[0]]), "e_2 times |level|")
        theta_3 = k.atan2(dot(cross(u, e_2), n) / a, dot(e_2, n))
        theta_4 = k.atan2(elbow * root, d2 - a**2 - b**2)
        return [theta_1, theta_2, theta_3, theta_4], [radicand]

    def reach(self, k: KernelWriter, s: sp.Matrix, mode: sp.Matrix, swivel: Any) -> Any:
        return outside(k, distance(k, k.let("arm", s - k.g.c, "s - c")), k.g.l_2, k.g.l_3)

    # -- posture and velocity -------------------------------------------------------------------------------

    def posture_ports(self) -> tuple[Port, ...]:
        x, e_2, _ = self.axis.posture_ports()
        vectors = (
            ("d", Unit.METRE, "s - c in (x, e_1, e_2)"),
            ("v", Unit.METRE, "forearm in (x, e_1, e_2)"),
            ("e_4", Unit.NONE, "elbow axis in (x, e_1, e_2)"),
        )
        return (
            x,
            e_2,
            *(Port(name, (3,), unit, Frame.JOINT, doc, Layout.STACKED) for name, unit, doc in vectors),
        )

    def posture(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> Posture:
        x, e_2 = self.axis.frame(k, theta[0])
        arm = k.let("arm", s - k.g.c, "s - c")
        d = k.let("d", sp.Matrix([dot(arm, axis) for axis in (x, k.g.e_1, e_2)]))
        u, e_4 = self._arm(k, theta)
        return {"x": x, "e_2": e_2, "d": d, "v": k.let("v", d - u), "e_4": e_4}

    def _levers(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, list[sp.Matrix]]:
        """The upper arm's direction, and the columns e_j x r_j of (2.32)."""
        direction = k.let("dir", (at.d - at.v) / k.g.l_2, "along the upper arm")
        pairs = ((E_1, at.d), (E_2, at.d), (direction, at.v), (at.e_4, at.v))
        return direction, [
            k.let(f"m_{j}", cross(*pair), f"column {j} of (2.32)") for j, pair in enumerate(pairs, 1)
        ]

    def _circle(self, k: KernelWriter, at: SimpleNamespace) -> tuple[Any, Any, Any]:
        """Squared distance of S_i from the first axis, its distance from c, and the square of that."""
        r2 = k.let("r2", at.d[0] ** 2 + at.d[2] ** 2)
        d2 = k.let("d2", r2 + at.d[1] ** 2)
        return r2, k.let("distance", sp.sqrt(d2)), d2

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> VelocityEquations:
        direction, columns = self._levers(k, at)
        r2, length, _ = self._circle(k, at)
        # swivel: the turn of the arm about s - c, less that of the plane through e_1 from which it is
        # measured
        level = k.let("level", cross(E_1, at.d), "e_1 x d")
        turns = (at.d[1], at.d[2], dot(direction, at.d), sp.Integer(0))
        lean = k.let("lean", at.d[1] / r2)
        row = [
            (turn - lean * dot(level, column)) / length for turn, column in zip(turns, columns, strict=True)
        ]
        row[0] = sp.Integer(0)  # the first axis turns both alike
        elbow = k.let("sin_4", dot(at.e_4, cross(at.d - at.v, at.v)) / (k.g.l_2 * k.g.l_3))
        return VelocityEquations(
            F=sp.Matrix.hstack(at.x, k.g.e_1, at.e_2),
            A=sp.eye(4),
            B=sp.Matrix.vstack(sp.Matrix.hstack(*columns), sp.Matrix([row])),
            determinant=None,
            serial=(
                Factor("shoulder", direction[0], "the upper arm on the first axis, cos(theta_2) = 0"),
                Factor("elbow", elbow, "links i2 and i3 aligned, sin(theta_4) = 0"),
                Factor("distance", length / (k.g.l_2 + k.g.l_3), "S_i in c"),
            ),
            others=(
                Factor(
                    "axis", k.let("r", sp.sqrt(r2)) / (k.g.l_2 + k.g.l_3), "S_i on the first axis: no swivel"
                ),
            ),
        )

    def rates(
        self, k: KernelWriter, at: SimpleNamespace, equations: VelocityEquations, task: sp.Matrix
    ) -> sp.Matrix:
        # d^T s_dot gives the elbow, as d^T (e_4 x v) = -l_2 l_3 sin(theta_4); the rest turns the arm by
        # omega = rate_1 e_1 + rate_2 e_2 + rate_3 u / l_2.  What it divides by are the factors themselves,
        # which the caller compares with a tolerance.
        direction, columns = self._levers(k, at)
        sine = next(factor.value for factor in equations.serial if factor.name == "elbow")
        r2, length, d2 = self._circle(k, at)
        s_dot = sp.Matrix(task[:3])
        elbow = k.let("rate_4", -dot(at.d, s_dot) / (k.g.l_2 * k.g.l_3 * sine))
        turned = k.let("turned", s_dot - elbow * columns[3], "omega x d")
        about = length * task[3] + at.d[1] / r2 * dot(cross(E_1, at.d), s_dot)
        omega = k.let("omega", (cross(at.d, turned) + k.let("about", about, "omega^T d") * at.d) / d2)
        third = k.let("rate_3", omega[0] / direction[0])
        return sp.Matrix([omega[1] - direction[1] * third, omega[2], third, elbow])

    def swivel_angle(self, k: KernelWriter, at: SimpleNamespace) -> Any:
        _, length, d2 = self._circle(k, at)
        u = k.let("u", at.d - at.v, "upper arm")
        return k.atan2(dot(u, cross(at.d, E_1)), length * (u[1] - at.d[1] * dot(u, at.d) / d2))

    # -- joints ---------------------------------------------------------------------------------------------

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> Passive:
        along = k.let("dir", at.v / k.g.l_3, "along the forearm")
        across = cross(at.e_4, along)
        frame = sp.Matrix.hstack(at.x, k.g.e_1, at.e_2)
        return Passive((), frame * sp.Matrix.hstack(along, k.let("across", across), at.e_4))

    def points(self, k: KernelWriter, at: SimpleNamespace, s: sp.Matrix) -> dict[str, sp.Matrix]:
        elbow = s - (at.v[0] * at.x + at.v[1] * k.g.e_1 + at.v[2] * at.e_2)
        return {**base_points(k), "E": elbow, "S": s}

    def closure(self, k: KernelWriter, s: sp.Matrix, theta: sp.Matrix) -> sp.Matrix:
        return s - self.forward(k, theta, sp.Matrix(0, 1, [])).s
