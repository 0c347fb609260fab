"""Arrangements (b) and (c): S_i slides along a line of the platform (Fig. 2.1b, c).

In the platform frame S_i = m_i + d_i t_i, with the slide's direction t_i, its signed coordinate d_i and the
normal n_i of t_i.  The constraint is that S_i stays on the line: n_i^T Q^T (s_i - p) = n_i^T m_i.  In
arrangement (c) the lines pass through O' and m_i = 0; in (b) a link of length l_r, parallel to n_i, leads
from S_i to a slider on the platform: m_i = b_i - l_r n_i.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.terms import Pose, Space
from krhpr.derivations.vectors import E, cross2, dot


class SlidePlatform(Platform):
    """An arrangement whose redundant links slide on the platform."""

    fields: tuple[GeometryField, ...]
    handedness: int = 1
    """n_i = handedness E t_i."""
    offset: bool
    """Whether the slides' lines miss O'."""

    @abstractmethod
    def slide(self, g: dict[str, Any]) -> sp.Matrix:
        """t_i from the geometry's fields."""

    def middle(self, g: dict[str, Any], normal: sp.Matrix) -> sp.Matrix:
        """m_i from the geometry's fields, where the line misses O'."""
        raise NotImplementedError(self.name)

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
        if self.offset:
            middles = (self.middle(g, n) for g, n in zip(fields, normals, strict=True))
            points = [m + point for m, point in zip(middles, points, strict=True)]
        # det J_a = sum of w_i times the moment of line i, w_i = n_j x n_k
        cyclic = [(i, (i + 1) % 3, (i + 2) % 3) for i in range(3)]
        det_a = sum(
            (cross2(normals[j], normals[l]) * cross2(points[i], normals[i]) for i, j, l in cyclic),
            sp.Integer(0),
        )
        if self.space is Space.PLANAR:
            return [det_a]
        area = sum((cross2(points[i], points[j]) for i, j, _ in cyclic), sp.Integer(0))
        return [det_a, area]
