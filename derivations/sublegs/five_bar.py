"""The planar five-bar linkage RR-RRR: two actuated cranks, a distal link to S_i, and a rod that closes the
loop.

Names of Chapter 1: crank u_1 (l_4) and crank u_2 (l_2) stand at angles t_1 and t_2, both measured in the
plane; the distal link v_1 (its part next to S_i is l_6) hangs on u_1; the rod v_2 (l_3) joins the end of u_2
to it:

    u_1 + w = o_12 + u_2 + v_2,   w = k v_1,   d = u_1 + v_1,

with o_12 from the axis of u_1 to that of u_2.  In the hybrid leg of Chapter 1 the cranks are coaxial (o_12 =
0) and k = 1 - l_5/l_6, where l_5 is the whole distal link, so that the rod's pivot P lies beyond E as seen
from S_i; where the bars meet in S_i itself, k = 1.

With the printed sizes the hybrid leg's linkage is a parallelogram: at full extension A and B lose rank
together and the quotient A^-1 B is 0/0 there.  The formulas here are those of general lengths; `regularity`
says when they must not be used.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, Layout, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.carriers import in_plane
from krhpr.derivations.sublegs.circles import meet
from krhpr.derivations.sublegs.linkages import AXES_DISTANCE, Linkage, PlaneForward, PlaneVelocity
from krhpr.derivations.sublegs.two_link import distance, outside, two_link
from krhpr.derivations.terms import Factor, Joint, JointKind, Link, LinkKind, Sign
from krhpr.derivations.vectors import cross2, dot


class FiveBar(Linkage):
    """A five-bar linkage; `coupler` says whether the rod ends on the distal link beyond E, `coaxial` whether
    both cranks turn about one axis.
    """

    signs = (
        Sign("elbow", "elbow+", "elbow-", "sign of u_1 x v_1 about e_2"),
        Sign("rod", "rod+", "rod-", "sign of u_2 x v_2 about e_2"),
    )

    def __init__(self, *, coupler: bool, coaxial: bool) -> None:
        self.coupler, self.coaxial = coupler, coaxial
        meeting = "P" if coupler else "S_i"
        self.forward_signs = (
            Sign(
                "assembly",
                "left",
                "right",
                f"{meeting} lies left or right of the directed line C -> E in the plane",
            ),
        )
        self.passive_joints = (
            Joint("crank_1", JointKind.REVOLUTE, "E, tip of u_1: distal link v_1 relative to u_1"),
            Joint("crank_2", JointKind.REVOLUTE, "C, tip of u_2: rod v_2 relative to u_2"),
            Joint("rod", JointKind.REVOLUTE, f"{meeting}: distal link v_1 relative to the rod v_2"),
        )

    def lengths(self) -> tuple[GeometryField, ...]:
        whole = (
            (GeometryField("l_5", Unit.METRE, "whole distal link", positive=True),) if self.coupler else ()
        )
        part = "part of the distal link from crank u_1 to S_i" if self.coupler else "distal link v_1"
        return (
            *(() if self.coaxial else (AXES_DISTANCE,)),
            GeometryField("l_2", Unit.METRE, "crank u_2", positive=True),
            GeometryField("l_3", Unit.METRE, "rod v_2", positive=True),
            GeometryField("l_4", Unit.METRE, "crank u_1", positive=True),
            *whole,
            GeometryField("l_6", Unit.METRE, part, positive=True),
        )

    def links(self, origin: str) -> tuple[Link, ...]:
        second = origin if self.coaxial else "A_2"
        ground = () if self.coaxial else (Link("l_0", LinkKind.FIXED, origin, second),)
        distal = (
            Link("l_5", LinkKind.DISTAL, "P", "S", ("E",))
            if self.coupler
            else Link("l_6", LinkKind.DISTAL, "E", "S")
        )
        return (
            *ground,
            Link("l_4", LinkKind.PROXIMAL, origin, "E"),
            Link("l_2", LinkKind.CRANK, second, "C"),
            Link("l_3", LinkKind.ROD, "C", "P" if self.coupler else "S"),
            distal,
        )

    def longest(self, k: KernelWriter) -> Any:
        return k.g.l_4 + k.g.l_6

    def _ratio(self, k: KernelWriter) -> Any:
        """k of w = k v_1, (A.16)."""
        return 1 - k.g.l_5 / k.g.l_6 if self.coupler else sp.Integer(1)

    def _second_axis(self, k: KernelWriter) -> sp.Matrix:
        """o_12, from the axis of crank u_1 to that of u_2."""
        return sp.zeros(2, 1) if self.coaxial else k.g.o_12

    def _cranks(self, k: KernelWriter, theta: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
        u_1 = k.let("u_1", k.g.l_4 * in_plane(theta[0]), "crank u_1")
        return u_1, k.let("u_2", k.g.l_2 * in_plane(theta[1]), "crank u_2")

    def forward(self, k: KernelWriter, theta: sp.Matrix, assembly: sp.Matrix) -> PlaneForward:
        u_1, u_2 = self._cranks(k, theta)
        tail = k.let("ratio", self._ratio(k), "k of w = k v_1")
        w2 = (k.g.l_6 - k.g.l_5) ** 2 if self.coupler else k.g.l_6**2
        # P is at distance l_3 from C and |w| from E
        line = k.let("f", u_1 - u_2 - self._second_axis(k), "from C to E")
        found = meet(k, line, k.g.l_3**2, w2, assembly[0])
        w = k.let("w", found.point - line, "P - E")
        return PlaneForward(k.let("d", u_1 + w / tail), {"u_1": u_1, "u_2": u_2}, found.radicand)

    def inverse(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> tuple[list[Any], list[Any]]:
        elbow, rod = signs
        outer = two_link(k, d[0], d[1], k.g.l_4, k.g.l_6, elbow, elbow=False)
        pivot = self._pivot(k, d, outer.link)
        crank = two_link(k, pivot[0], pivot[1], k.g.l_2, k.g.l_3, rod, elbow=False, suffix="_2")
        return [outer.inner, crank.inner], [outer.radicand, crank.radicand]

    def reach(self, k: KernelWriter, d: sp.Matrix, signs: list[Any]) -> Any:
        # the serial part u_1, v_1, then, where that closes, the second crank and the rod
        outer = two_link(k, d[0], d[1], k.g.l_4, k.g.l_6, signs[0], elbow=False)
        pivot = self._pivot(k, d, outer.link)
        rod = outside(k, distance(k, pivot, "reach_2"), k.g.l_2, k.g.l_3)
        return k.maximum(rod, outside(k, distance(k, d, "reach_1"), k.g.l_4, k.g.l_6))

    def _pivot(self, k: KernelWriter, d: sp.Matrix, crank: sp.Matrix) -> sp.Matrix:
        """P from the axis of crank u_2: u_1 + w - o_12, (B.2)."""
        u_1 = k.let("u_1", crank) if self.coupler else sp.zeros(2, 1)
        end = u_1 + self._ratio(k) * (d - u_1)
        return k.let("p", end - self._second_axis(k), "u_1 + w - o_12")

    def posture_ports(self, frame: Frame, plane: str) -> tuple[Port, ...]:
        cranks = (("u_1", f"crank u_1 {plane}"), ("u_2", f"crank u_2 {plane}"))
        return tuple(Port(name, (2,), Unit.METRE, frame, doc, Layout.STACKED) for name, doc in cranks)

    def posture(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> dict[str, sp.Matrix]:
        u_1, u_2 = self._cranks(k, theta)
        return {"u_1": u_1, "u_2": u_2}

    def _distal(self, k: KernelWriter, at: SimpleNamespace) -> tuple[sp.Matrix, sp.Matrix]:
        """Distal link v_1 and rod v_2 in the plane, (1.14), (1.15)."""
        v_1 = k.let("v_1", at.d - at.u_1, "(1.14)")
        end = at.u_1 + self._ratio(k) * v_1
        return v_1, k.let("v_2", end - at.u_2 - self._second_axis(k), "(1.15)")

    def velocity(self, k: KernelWriter, at: SimpleNamespace) -> PlaneVelocity:
        u_1, u_2 = at.u_1, at.u_2
        v_1, v_2 = self._distal(k, at)
        b_22 = k.let("b_22", cross2(u_1, v_1), "v_1^T (e_2 x u_1)")
        if self.coupler:
            rod, b_32, b_33 = self._beyond(k, at, v_1, b_22)
        else:
            rod, b_32, b_33 = v_2, sp.Integer(0), k.let("b_33", cross2(u_2, v_2), "v_2^T (e_3 x u_2)")
        alignment = k.let("delta", cross2(v_1, rod), "e_2^T (v_1 x v_2)")
        ratio = self._ratio(k)
        return PlaneVelocity(
            # (1.10), (1.11) without their first row, which is the carrier's
            A=sp.Matrix([[v_1[0], v_1[1]], [rod[0], rod[1]]]),
            B=sp.Matrix([[b_22, 0], [b_32, b_33]]),
            determinant=b_22 * b_33 / alignment,
            serial=(
                Factor("elbow", b_22 / (k.g.l_4 * k.g.l_6), "crank u_1 and distal link v_1 aligned"),
                Factor("crank", ratio * b_33 / (k.g.l_2 * k.g.l_3), "crank u_2 and rod v_2 aligned"),
            ),
            parallel=(Factor("rod", alignment / (k.g.l_6 * k.g.l_3), "rod v_2 and distal link v_1 aligned"),),
        )

    def _beyond(
        self, k: KernelWriter, at: SimpleNamespace, v_1: sp.Matrix, b_22: Any
    ) -> tuple[sp.Matrix, Any, Any]:
        """The second row of A and B where the rod ends beyond E: that of (1.10), (1.11), with the erratum of
        (1.10), over k and less k times the first row. As v_2 = f + k v_1, it has f for v_2.
        """
        f = k.let("f", at.u_1 - at.u_2 - self._second_axis(k), "from C to E")
        if self.coaxial:
            turn_1 = k.let("u_12", cross2(at.u_1, at.u_2), "f x u_1")
            turn_2 = -turn_1
        else:
            turn_1, turn_2 = cross2(f, at.u_1), cross2(at.u_2, f)
        ratio = self._ratio(k)
        b_32 = k.let("b_32", (1 / ratio - 1) * turn_1 - b_22, "(1.13) over k, less k b_22")
        return f, b_32, k.let("b_33", cross2(at.u_2, v_1) + turn_2 / ratio, "v_2^T (e_3 x u_2) / k")

    def tip(self, k: KernelWriter, at: SimpleNamespace) -> sp.Matrix:
        return self._distal(k, at)[0] / k.g.l_6

    def passive(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        v_1, v_2 = self._distal(k, at)
        pairs = ((at.u_1, v_1), (at.u_2, v_2), (v_2, v_1))
        return [k.atan2(cross2(a, b), dot(a, b)) for a, b in pairs]

    def points(self, k: KernelWriter, at: SimpleNamespace) -> dict[str, sp.Matrix]:
        second = {} if self.coaxial else {"A_2": k.g.o_12}
        found = {**second, "E": at.u_1, "C": at.u_2 + self._second_axis(k)}
        if self.coupler:
            found["P"] = k.let("p", at.u_1 + self._ratio(k) * (at.d - at.u_1), "u_1 + w")
        return found

    def closure(self, k: KernelWriter, d: sp.Matrix, theta: sp.Matrix) -> list[Any]:
        # (A.5), (A.15)
        at = SimpleNamespace(d=d, **self.posture(k, d, theta))
        v_1, v_2 = self._distal(k, at)
        return [dot(v_1, v_1) - k.g.l_6**2, dot(v_2, v_2) - k.g.l_3**2]
