"""Arrangements (b) and (c): S_i slides along a line of the platform (Fig. 2.1b, c).

In the platform frame S_i = m_i + d_i t_i, with the slide's direction t_i, its signed coordinate d_i and the
normal n_i of t_i.  The constraint is that S_i stays on the line: n_i^T Q^T (s_i - p) = n_i^T m_i.  In
arrangement (c) the lines pass through O' and m_i = 0; in (b) a link of length l_r, parallel to n_i, leads
from S_i to a slider on the platform: m_i = b_i - l_r n_i.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Kernel, Port, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms import encoders
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.platforms.forward import (
    CERTIFIED,
    SIDE,
    TURNED,
    Hold,
    Mode,
    forward_ports,
    plane_of,
    stacked,
    unit_sign,
    write_modes,
)
from krhpr.derivations.platforms.grasp import grasp_kernel
from krhpr.derivations.platforms.kernels import PlatformPorts, all_legs
from krhpr.derivations.platforms.opening import SLIDE, START, opening_kernels
from krhpr.derivations.terms import Pose, Space
from krhpr.derivations.vectors import E, concurrence, cross2, dependence, dot, lines_meet, turned

DISTANCE = stacked("distance", (), Unit.METRE, "h_i, distance of the slide's line from O' along n_i")
RADICAND = Port(
    "radicand",
    (1,),
    Unit.MIXED,
    Frame.NONE,
    "A^2 + B^2 - C^2, negative where no platform fits",
)
BREADTH = Port("breadth", (1,), Unit.NONE, Frame.NONE, "A^2 + B^2, scaled: zero where phi is undetermined")


class SlidePlatform(Platform):
    """An arrangement whose redundant links slide on the platform."""

    fields: tuple[GeometryField, ...]
    handedness: int = 1
    """n_i = handedness E t_i."""
    offset: bool
    """Whether the slides' lines miss O'."""
    closed_forward = True
    carries_gripper = True

    @abstractmethod
    def slide(self, g: dict[str, Any]) -> sp.Matrix:
        """t_i from the geometry's fields."""

    def middle(self, g: dict[str, Any], normal: sp.Matrix) -> sp.Matrix:
        """m_i from the geometry's fields: 0 where the lines pass through O'."""
        return sp.zeros(2, 1)

    def geometry(self) -> GeometryType:
        k = KernelWriter("prepare", "Vectors and sub-expressions that depend on the geometry alone.")
        g = {field.name: k.input(field.name, (), field.unit, doc=field.doc) for field in self.fields}
        t = k.let("t", self.slide(g))
        k.output("t", t, Unit.NONE, Frame.PLATFORM, "t_i, along the slide")
        if self.offset:
            m = self.middle(g, self._across(t))
            k.output("m", m, Unit.METRE, Frame.PLATFORM, "m_i, S_i where d_i = 0")
        return GeometryType(f"platform_{self.name}", self.doc, self.fields, k.kernel())

    def _across(self, t: sp.Matrix) -> sp.Matrix:
        """n_i."""
        return self.handedness * (E * t)

    @staticmethod
    def _turned(pose: Pose, local: sp.Matrix) -> sp.Matrix:
        """A vector of the platform's plane in the base frame."""
        return pose.Q[:, :2] * local

    def _along(self, k: KernelWriter, pose: Pose) -> sp.Matrix:
        return k.let("Qt", self._turned(pose, k.g.t), "Q t_i")

    def end_point(self, k: KernelWriter, pose: Pose, redundant: Any) -> sp.Matrix:
        if not self.offset:
            return pose.p + redundant * self._along(k, pose)
        local = k.let("s_l", k.g.m + redundant * k.g.t, "S_i in the platform frame")
        return pose.p + self._turned(pose, local)

    def redundant(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> Any:
        along = dot(s - pose.p, self._along(k, pose))
        return along - dot(k.g.m, k.g.t) if self.offset else along

    def residual(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        u = k.let("u", s - pose.p, "O' to S_i")
        across = -dot(u, self.direction(k, pose, s))
        first = dot(k.g.m, self._across(k.g.t)) + across if self.offset else across
        return sp.Matrix([first] if self.space is Space.PLANAR else [first, -dot(u, pose.Q.col(2))])

    def direction(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return k.let("Qn", self._turned(pose, self._across(k.g.t)), "Q n_i")

    def anchor(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return s - pose.p

    def end_velocity(
        self, k: KernelWriter, pose: Pose, s: sp.Matrix, carried: sp.Matrix, rate: Any
    ) -> sp.Matrix:
        return carried + rate * self._along(k, pose)

    def joint(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        # along the link from S_i to its slider, or along the slide where S_i is the slider
        along, normal = self._along(k, pose), self.direction(k, pose, s)
        if self.space is Space.PLANAR:
            return normal if self.redundant_link else along
        if self.redundant_link:
            return sp.Matrix.hstack(normal, -self.handedness * along, pose.Q.col(2))
        return sp.Matrix.hstack(along, self.handedness * normal, pose.Q.col(2))

    def attachment(self, k: KernelWriter, pose: Pose, s: sp.Matrix) -> sp.Matrix:
        return s + k.g.l_r * self.direction(k, pose, s) if self.redundant_link else s

    def scale(self, k: KernelWriter) -> list[Any]:
        return [sp.Integer(1), sp.Integer(1)]

    def margins(self, k: KernelWriter, det_a: Any, det_n: Any, scale: sp.Matrix) -> list[Any]:
        return [self.handedness * det_a, *([] if det_n is None else [det_n])]

    def closed_form(self, k: KernelWriter, redundant: list[Any], geometry: list[Any]) -> list[Any]:
        fields = [{field.name: getattr(g, field.name) for field in self.fields} for g in geometry]
        slides = [self.slide(g) for g in fields]
        normals = [self._across(t) for t in slides]
        points = [d * t for d, t in zip(redundant, slides, strict=True)]
        middles = (self.middle(g, n) for g, n in zip(fields, normals, strict=True))
        points = [m + point for m, point in zip(middles, points, strict=True)]
        det_a = concurrence(dependence(normals), normals, points)
        return [det_a] if self.space is Space.PLANAR else [det_a, _area(points)]

    def kernels(self) -> tuple[Kernel, ...]:
        return (*super().kernels(), *opening_kernels(self), grasp_kernel(self))

    # -- forward kinematics, in closed form -----------------------------------------------------------------

    def forward_kernels(self) -> tuple[Kernel, ...]:
        return (
            self._tie(),
            self._assembly_modes(),
            self._assembly_mode(),
            *encoders.encoder_kernels(self),
        )

    def hold(self, k: KernelWriter, count: int) -> Hold:
        measured = k.add_input(encoders.measured_port(PlatformPorts(self).redundant, count))
        slides = all_legs(k, SLIDE)
        normals = [self._across(t) for t in slides]
        ends = [measured[i] * slides[i] for i in range(count)]
        if self.offset:
            distances, starts = all_legs(k, DISTANCE), all_legs(k, START)
            ends = [(measured[i] + starts[i]) * slides[i] + distances[i] * normals[i] for i in range(count)]
        order = sum(dependence(normals), sp.Integer(0))
        return Hold(
            order, tuple(k.let(f"e_{i + 1}", end, "S_i in the platform frame") for i, end in enumerate(ends))
        )

    def tie_residual(self, k: KernelWriter, state: Any, point: Any) -> tuple[list[Any], Any]:
        """The distance of S_3 from its slide: U t_3 x (s_3 - p - U m_3)."""
        t = all_legs(k, SLIDE)[2]
        m = sp.zeros(2, 1)
        if self.offset:
            m = k.let("m_3", all_legs(k, DISTANCE)[2] * self._across(t), "where the slide is closest to O'")
        U, p = encoders.columns(state)
        w = k.let("w_3", U * t, "along the slide")
        a = k.let("a_3", point - p - U * m, "from there to S_3")
        row = [t[0] * a[1] + m[0] * w[1], -t[0] * a[0] - m[0] * w[0]]
        row += [t[1] * a[1] + m[1] * w[1], -t[1] * a[0] - m[1] * w[0]]
        return [*row, w[1], -w[0]], cross2(w, a)

    def _tie(self) -> Kernel:
        k = KernelWriter(
            "tie",
            "How the leg holds the platform, for the forward kinematics.",
            "",
            self.geometry(),
        )
        k.add_output(SLIDE, k.g.t)
        if self.offset:
            normal = k.let("n", self._across(k.g.t))
            k.add_output(DISTANCE, dot(normal, k.g.m))
            k.add_output(START, dot(k.g.t, k.g.m))
        return k.kernel()

    def _assembly_modes(self) -> Kernel:
        return self._assemblies(
            "assembly_modes", "Both poses of the platform that hold the three end points.", None
        )

    def _assembly_mode(self) -> Kernel:
        return self._assemblies(
            "assembly_mode",
            "The pose of the platform that holds the three end points, on one side of type II.",
            SIDE,
        )

    def _assemblies(self, name: str, doc: str, choice: Port | None) -> Kernel:
        """With sum lambda_i n_i = 0 the constraints n_i^T Q^T (s_i - p) = h_i lose p: A cos(phi) + B sin(phi)
        = C, whose roots have opposite det J_a (errata, 4; planar 3.2).
        """
        k = KernelWriter(name, doc, self.equations)
        s = all_legs(k, PlatformPorts(self).s)
        slides = all_legs(k, SLIDE)
        zeros = [sp.Integer(0)] * 3  # the slides' lines meet in O'
        distances = all_legs(k, DISTANCE) if self.offset else zeros
        starts = all_legs(k, START) if self.offset else zeros
        spatial = self.space is Space.SPATIAL
        family: Any = sp.Integer(1)
        if choice is not None:
            side = k.add_input(choice)
        elif spatial:
            family = k.add_input(TURNED)
        normals = [self._across(t) for t in slides]
        weights = [k.let(f"lambda_{i + 1}", w) for i, w in enumerate(dependence(normals))]
        plane = plane_of(k, self.space, s, sum(weights, sp.Integer(0)), family)
        points = plane.points
        a = k.let("A", sum(w * dot(n, r) for w, n, r in zip(weights, normals, points, strict=True)))
        b = k.let("B", sum(w * cross2(n, r) for w, n, r in zip(weights, normals, points, strict=True)))
        c = k.let("C", sum(w * h for w, h in zip(weights, distances, strict=True)))
        square = k.let("AB_2", a**2 + b**2)
        radicand = k.let("radicand", square - c**2)
        size = k.let("size", sum(w**2 for w in weights) * sum(dot(r, r) for r in points))
        k.add_output(BREADTH, [square / size])
        k.add_output(RADICAND, [radicand])
        ratio = radicand if choice is None else k.let("ratio", radicand / unit_sign(k, side))
        root = k.let("root", sp.sqrt(ratio) / square)
        middle = k.let("middle", c / square)
        first = sp.Integer(self.handedness)  # where the first margin is positive
        signs = [first, -first] if choice is None else [first * side]
        modes = []
        for number, sign in enumerate(signs, 1):
            at = f"_{number}" if len(signs) > 1 else ""
            cosine = k.let(f"cos{at}", a * middle - sign * b * root)
            sine = k.let(f"sin{at}", b * middle + sign * a * root)
            modes.append(self._mode(k, at, (cosine, sine), points, slides, distances, starts, weights))
        joint = PlatformPorts(self).redundant
        write_modes(k, plane, modes, joint, several=choice is None)
        if choice is not None:
            # the other solution is on the other side
            k.add_output(forward_ports(self.space, joint, 0).count, sp.Integer(2))
            k.add_output(CERTIFIED, sp.Integer(1))
        return k.kernel()

    def _mode(
        self,
        k: KernelWriter,
        at: str,
        turn: tuple[Any, Any],
        points: Sequence[sp.Matrix],
        slides: Sequence[sp.Matrix],
        distances: Sequence[Any],
        starts: Sequence[Any],
        weights: Sequence[Any],
    ) -> Mode:
        """Where the platform stands once its orientation is known: n_i^T Q^T p is linear in p."""
        cosine, sine = turn
        local = [k.let(f"q_{i + 1}{at}", turned(cosine, -sine, r)) for i, r in enumerate(points)]
        normals = [self._across(t) for t in slides]
        along = [
            k.let(f"g_{i + 1}{at}", dot(n, q) - h)
            for i, (n, q, h) in enumerate(zip(normals, local, distances, strict=True))
        ]
        centre = k.let(f"o{at}", lines_meet(normals, along, weights), "Q^T (p - s_1)")
        ends = [k.let(f"S_{i + 1}{at}", q - centre, "S_i in the platform frame") for i, q in enumerate(local)]
        det_j = concurrence(weights, normals, ends)
        if self.space is Space.SPATIAL:
            det_j = det_j * _area(ends)
        return Mode(
            cosine,
            sine,
            turned(cosine, sine, centre),
            tuple(dot(t, end) - start for t, end, start in zip(slides, ends, starts, strict=True)),
            det_j,
        )


def _area(points: Sequence[sp.Matrix]) -> Any:
    """det J_n: twice the signed area of S_1 S_2 S_3."""
    return sum((cross2(points[i], points[j]) for i, j in ((0, 1), (1, 2), (2, 0))), sp.Integer(0))
