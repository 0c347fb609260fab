"""The sub-legs of the grasping robots: those of Section 2.2.3 on base joints that are given one by one.

The catalogue's pairs stand symmetrically about the leg's azimuth; here both base joints of both sub-legs may
lie on one line, as in Figs. 5.1 and 5.2.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from krhpr.codegen.kernel import Frame, GeometryField, GeometryType, Kernel, Unit
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.sublegs.carriers import begin_geometry, in_plane
from krhpr.derivations.sublegs.chains import row
from krhpr.derivations.sublegs.kernels import SubLegKernels
from krhpr.derivations.sublegs.planar_parallel import PRR2, RPR2
from krhpr.derivations.sublegs.statics import StaticsKernels
from krhpr.derivations.terms import Joint, JointKind

KERNELS = (
    "forward",
    "forward_all",
    "inverse",
    "inverse_all",
    "reach",
    "posture",
    "jacobian",
    "velocity",
    "rates",
    "determinant",
    "points",
    "end_force",
)
"""The kernels of a sub-leg that two jaws need."""


def _kernels(leg: PRR2 | RPR2) -> tuple[Kernel, ...]:
    base = SubLegKernels(leg)
    written = (*base.all(), *StaticsKernels(base).all())
    return tuple(kernel for kernel in written if kernel.name in KERNELS)


_BASE_JOINTS = tuple(
    GeometryField(f"{axis}_{n}", Unit.METRE, f"base joint {n} of the sub-leg, its {axis}")
    for n in (1, 2)
    for axis in ("x", "y")
)


def _geometry(name: str, doc: str, more: tuple[GeometryField, ...], slides: tuple[str, ...]) -> GeometryType:
    """Both base joints by their coordinates; the directions of slides are prepared as e_1, e_2."""
    fields = (*_BASE_JOINTS, *more)
    k, symbols = begin_geometry(fields)
    first, second = (sp.Matrix([symbols[f"x_{n}"], symbols[f"y_{n}"]]) for n in (1, 2))
    k.output("o", first, Unit.METRE, Frame.BASE, "first base joint")
    k.output("o_12", second - first, Unit.METRE, Frame.BASE, "from the first base joint to the second")
    for n, field in enumerate(slides, start=1):
        k.output(f"e_{n}", in_plane(symbols[field]), Unit.NONE, Frame.BASE, f"direction of slide {n}")
    return GeometryType(f"subleg_planar_{name}", doc, fields, k.kernel())


class GraspPRR(PRR2):
    """Two sliders and two links that meet in P or S (Fig. 5.2): |s - a_k| = u_k, a_k = o_k + rho_k e_k."""

    name = "grasp_prr"
    notation = "2-PRR"
    section = "5.2"
    equations = "(5.1), (5.13)"
    doc = "Sub-leg of a planar grasping robot: two actuated sliders and two links that meet at a jaw."
    default_mode = "1-ahead/2-behind"

    def geometry(self) -> GeometryType:
        """Base joints, directions of the slides, links."""
        lengths = tuple(
            GeometryField(f"l_{n}", Unit.METRE, f"link {n}, u_{n} of the thesis", positive=True)
            for n in (1, 2)
        )
        slides = tuple(
            GeometryField(f"slide_{n}", Unit.RADIAN, f"direction of slide {n}, from the x axis of the base")
            for n in (1, 2)
        )
        return _geometry(self.name, self.doc, (*slides, *lengths), ("slide_1", "slide_2"))

    def kernels(self) -> tuple[Kernel, ...]:
        """Those that two jaws need."""
        return _kernels(self)


class GraspRPR(RPR2):
    """Two struts from the base that meet in P or S (Fig. 5.1): |s - a_k| = rho_k."""

    name = "grasp_rpr"
    notation = "2-RPR"
    section = "5.2"
    equations = "(5.13)"
    doc = "Sub-leg of a planar grasping robot: two actuated struts from the base meet at a jaw."
    passive_joints = (
        Joint("base_1", JointKind.REVOLUTE, "strut 1 on the base, from the x axis of the base"),
        Joint("base_2", JointKind.REVOLUTE, "strut 2 on the base, from the x axis of the base"),
        Joint("meeting", JointKind.REVOLUTE, "strut 2 relative to strut 1"),
    )

    def geometry(self) -> GeometryType:
        """Base joints."""
        return _geometry(self.name, self.doc, (), ())

    def scales(self, k: KernelWriter) -> tuple[Any, Any]:
        """The distance of the base joints by coordinates, which is rational, twice."""
        apart = k.let("apart", k.absolute(k.g.o_12[0]) + k.absolute(k.g.o_12[1]), "between the base joints")
        return apart, apart

    def passive_angles(self, k: KernelWriter, at: SimpleNamespace) -> list[Any]:
        """Those of the struts, and between them."""
        struts = (row(at.w, 0), row(at.w, 1))
        return [*(k.atan2(w[1], w[0]) for w in struts), *self._between(k, at)]

    def kernels(self) -> tuple[Kernel, ...]:
        """Those that two jaws need."""
        return _kernels(self)
