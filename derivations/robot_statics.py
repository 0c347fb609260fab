"""Functions of the statics of a robot (Chapter 5): actuator forces from what the robot does to its
environment, and back.

Virtual work, F^T dD + phi^T d(redundant) = f^T d(theta), (5.9), with forces that the robot applies to its
environment, and moments about O'.  With no force along the redundant coordinates this is f = (J^-1 K)^T F,
the kinematically redundant view (5.12); with them it is the non-redundant one, (5.44), and what they alone
give is the null space of the redundantly actuated one, (5.25).
"""

from __future__ import annotations

from dataclasses import replace

from krhpr.codegen.composition import SINGULAR_TOLERANCE, Call, Guard, Relation, RobotFunction, Stage
from krhpr.codegen.kernel import Layout
from krhpr.codegen.status import Status
from krhpr.derivations.platforms.statics import StaticsPorts as PlatformStatics
from krhpr.derivations.robot_functions import FunctionsOf
from krhpr.derivations.sublegs.statics import StaticsPorts as SubLegStatics


class StaticsFunctions(FunctionsOf):
    """The statics of one robot."""

    def _jacobians_n(self) -> RobotFunction:
        subleg = self.robot.subleg
        leg = SubLegStatics(subleg)
        swivels = " and of the swivels" if subleg.redundant else ""
        J = replace(leg.J_n, name="J", doc=f"Jacobian of the twist, of the redundant coordinates{swivels}")
        K = replace(
            leg.K_n,
            name="K",
            shape=(leg.count, subleg.n),
            doc="Jacobian of the actuators, legs on the block diagonal",
            layout=Layout.DIAGONAL,
        )
        guards = self._leg_guards(subleg.has_parallel_factors())
        return self._function(
            "jacobians_n",
            f"J_n and K_n of J_n [t, rates of the redundant coordinates{swivels}] = K_n theta_dot: the "
            "non-redundant view.  Without its last columns J_n is J_r, with redundant coordinates blocked.",
            "(5.55) to (5.60)",
            (*self.pose, self.leg.s, self.leg.theta),
            (J, K),
            (
                self._on_leg("platform", "rows", {"J": "J_lines"}),
                self._on_leg("platform", "redundant_line"),
                self._posture(),
                self._on_leg("subleg", "transmission", {"K_n": "K"}),
                Call(Stage.PLATFORM, "subleg", "non_redundant", {"J": "J_lines"}, {"J_n": "J"}),
            ),
            tuple(replace(guard, spoils=("K",)) for guard in guards),
        )

    def _inverse_statics(self) -> RobotFunction:
        subleg = self.robot.subleg
        plate, leg = PlatformStatics(self.robot.platform), SubLegStatics(subleg)
        calls = (
            self._on_leg("platform", "line"),
            self._on_leg("platform", "redundant_line"),
            self._posture(),
            self._on_leg("subleg", "transmission"),
            Call(Stage.PLATFORM, "platform", "balance", {}, {"regularity": "det_regularity"}),
            Call(Stage.PLATFORM, "subleg", "torques", {}, {}),
        )
        return self._function(
            "inverse_statics",
            "Forces of the actuators with which the robot applies a wrench, and forces along the redundant "
            "coordinates, to its environment: f = (J^-1 K)^T F where those are zero.",
            "(5.12), (5.44)",
            (
                *self.pose,
                self.leg.s,
                self.leg.theta,
                plate.wrench,
                plate.redundant_forces,
                *((leg.swivel_forces,) if subleg.redundant else ()),
            ),
            (leg.all_forces,),
            calls,
            (*self._leg_guards(subleg.has_parallel_factors()), *self._platform_guards()),
        )

    def _forward_statics(self) -> RobotFunction:
        subleg = self.robot.subleg
        plate, leg = PlatformStatics(self.robot.platform), SubLegStatics(subleg)
        return self._function(
            "forward_statics",
            "What the robot applies to its environment with given forces of the actuators: a wrench, and "
            "forces along the redundant coordinates.",
            "(5.24), (5.36)",
            (*self.pose, self.leg.s, self.leg.theta, leg.actuator_forces),
            (
                plate.wrench,
                plate.redundant_forces,
                *((leg.swivel_forces,) if subleg.redundant else ()),
            ),
            (
                self._posture(),
                self._on_leg("subleg", "end_force"),
                self._on_leg("platform", "reaction"),
                Call(Stage.PLATFORM, "algebra", "total", {}, {}),
            ),
            self._leg_guards(subleg.has_serial_factors()),
        )

    def _leg_guards(self, has_factors: bool) -> tuple[Guard, ...]:
        """Where a leg's forces do not exist; for redundant ones also where the swivel does not."""
        if not has_factors and not self.robot.subleg.has_swivel_factors():
            return ()
        return (Guard("regularity", 0, Relation.AT_LEAST, SINGULAR_TOLERANCE, Status.SINGULAR_LEG_1),)
