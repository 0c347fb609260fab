"""The ports that every sub-leg's kernels share, with its sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.derivations.terms import Space

if TYPE_CHECKING:
    from krhpr.derivations.sublegs.base import SubLeg


class SubLegPorts:
    """The ports that every sub-leg's kernels share, with its sizes."""

    def __init__(self, subleg: SubLeg) -> None:
        d, n = subleg.space.dimension, subleg.n
        rows = subleg.space.rows_per_leg
        names = tuple(joint.name for joint in subleg.actuators)
        signs = tuple(sign.name for sign in subleg.inverse_signs)
        assembly = tuple(sign.name for sign in subleg.forward_signs)
        stacked = Layout.STACKED
        self.s = Port("s", (d,), Unit.METRE, Frame.BASE, "end point of the sub-leg, S_i", stacked)
        self.theta = Port("theta", (n,), Unit.ACTUATOR, Frame.JOINT, "actuated joints", stacked, names)
        self.theta_all = Port(
            "theta",
            (len(subleg.modes), n),
            Unit.ACTUATOR,
            Frame.JOINT,
            "actuated joints in every working mode",
            stacked,
            tuple(mode.label for mode in subleg.modes),
        )
        self.mode = Port(
            "mode",
            (len(signs),),
            Unit.NONE,
            Frame.NONE,
            "signs of the working mode, +1 or -1",
            stacked,
            signs,
        )
        self.assembly = Port(
            "assembly",
            (len(assembly),),
            Unit.NONE,
            Frame.NONE,
            "signs of the assembly mode, +1 or -1",
            stacked,
            assembly,
        )
        self.s_near = Port(
            "s_near",
            (d,),
            Unit.METRE,
            Frame.BASE,
            "a point near the end point, which chooses the assembly mode",
            stacked,
        )
        self.s_all = Port(
            "s",
            (subleg.assembly_count, d),
            Unit.METRE,
            Frame.BASE,
            "end point of the sub-leg in every assembly mode",
            stacked,
            tuple(mode.label for mode in subleg.assemblies) if assembly else (),
        )
        joint = subleg.swivel
        unit = Unit.RADIAN if joint is None or joint.kind == "revolute" else Unit.METRE
        doc = "" if joint is None else joint.doc
        self.swivel = Port("swivel", (), unit, Frame.JOINT, doc, stacked)
        self.swivel_rates = Port(
            "swivel_rates", (), Unit.ACTUATOR_RATE, Frame.JOINT, "rate of the swivel", stacked
        )
        self.swivel_accelerations = Port(
            "swivel_accelerations",
            (),
            Unit.ACTUATOR_ACCELERATION,
            Frame.JOINT,
            "second rate of the swivel",
            stacked,
        )
        self.swivel_bias = Port(
            "swivel_bias",
            (),
            Unit.ACTUATOR_ACCELERATION,
            Frame.JOINT,
            "second rate of the swivel at theta_ddot = 0",
            stacked,
        )
        # what chooses a branch: signs, a point nearby, or nothing
        self.mode_choice = (self.mode,) if signs else ()
        near = subleg.forward_near or not subleg.has_forward
        self.forward_choice = (self.s_near,) if near else (self.assembly,) if assembly else ()
        self.theta_dot = Port(
            "theta_dot", (n,), Unit.ACTUATOR_RATE, Frame.JOINT, "rates of the actuated joints", stacked, names
        )
        self.s_dot = Port(
            "s_dot", (d,), Unit.METRE_PER_SECOND, Frame.BASE, "velocity of the end point", stacked
        )
        self.bias = Port(
            "bias",
            (d,),
            Unit.METRE_PER_SECOND_SQUARED,
            Frame.BASE,
            "acceleration of the end point at theta_ddot = 0",
            stacked,
        )
        self.M = Port("M", (d, n), Unit.MIXED, Frame.BASE, "Jacobian of the sub-leg", stacked)
        self.N = Port("N", (rows, d), Unit.MIXED, Frame.BASE, "directions of the leg's lines, rows", stacked)
        self.K = Port("K", (rows, n), Unit.MIXED, Frame.BASE, "the leg's block of K", stacked)
        self.characteristic_length = Port(
            "characteristic_length",
            (),
            Unit.METRE,
            Frame.NONE,
            "displacement of a slide that counts as much as one radian",
        )
        self.gram = Port("gram", (d, d), Unit.MIXED, Frame.NONE, "M M^T", stacked)
        self.cofactors = Port(
            "cofactors", (d, d), Unit.MIXED, Frame.NONE, "the inverse of M M^T times its determinant", stacked
        )
        self.square = Port("square", (), Unit.MIXED, Frame.NONE, "det(M M^T)", stacked)
        self.reach = Port(
            "reach",
            (rows * (rows + 1) // 2,),
            Unit.MIXED,
            Frame.NONE,
            "K K^T of the leg, its upper half",
            stacked,
        )
        link = (3, 3) if subleg.space is Space.SPATIAL else (2,)
        self.link = Port(
            "link", link, Unit.NONE, Frame.BASE, "orientation of the link that carries the end point", stacked
        )
        passive = tuple(joint.name for joint in subleg.passive_joints)
        self.passive = Port(
            "passive",
            (len(passive),),
            Unit.RADIAN if all(j.kind == "revolute" for j in subleg.passive_joints) else Unit.ACTUATOR,
            Frame.JOINT,
            "passive joints within the sub-leg",
            stacked,
            passive,
        )

    def points(self, names: tuple[str, ...]) -> Port:
        """The port of the joints' positions."""
        d = self.s.shape[0]
        return Port(
            "points", (len(names), d), Unit.METRE, Frame.BASE, "joints of the sub-leg", Layout.STACKED, names
        )

    def factors(self, count: int) -> Port:
        """The port of the factors of det M_i."""
        return Port(
            "factors", (count,), Unit.NONE, Frame.NONE, "dimensionless factors of det M_i", Layout.STACKED
        )
