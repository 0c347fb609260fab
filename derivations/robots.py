"""A robot is a composition: one sub-leg x one platform arrangement.  The functions below are the same for
all.

Read this file to see what every function of a robot computes; the formulas are in `sublegs/` and
`platforms/`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from krhpr.codegen.composition import Call, Guard, Relation, RobotFunction, Stage
from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.status import Status
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.robot_forward import ForwardFunctions
from krhpr.derivations.robot_gripper import GripperFunctions
from krhpr.derivations.robot_indices import IndexFunctions
from krhpr.derivations.robot_links import LinkFunctions
from krhpr.derivations.robot_statics import StaticsFunctions
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.derivations.terms import Space


@dataclass(frozen=True)
class Robot:
    """A composition of a sub-leg and a platform arrangement."""

    subleg: SubLeg
    platform: Platform

    def __post_init__(self) -> None:
        if self.subleg.space is not self.platform.space:
            raise ValueError(
                f"sub-leg {self.subleg.name!r} is {self.subleg.space}, arrangement "
                f"{self.platform.name!r} is {self.platform.space}"
            )

    @property
    def space(self) -> Space:
        """Space or plane."""
        return self.subleg.space

    @property
    def identifier(self) -> str:
        """`<space>_<sub-leg>_<arrangement>`."""
        return f"{self.space}_{self.subleg.name}_{self.platform.arrangement}"

    @property
    def notation(self) -> str:
        """The thesis' notation: 3-RRRSR, 3-[R(RR-RRR)SR]."""
        leg = self.subleg.notation + self.platform.notation
        return f"3-[{leg}]" if "(" in leg else f"3-{leg}"

    def functions(self) -> tuple[RobotFunction, ...]:
        """Every function of the robot, in the order of the documentation."""
        return tuple(_Functions(self).all())


class _Functions(ForwardFunctions, StaticsFunctions, GripperFunctions, IndexFunctions, LinkFunctions):
    """Every function of one robot."""

    def all(self) -> Iterable[RobotFunction]:
        if not self.planar:
            yield self._rotation_error()
        yield self._end_points()
        yield self._redundant_coordinates()
        yield self._subleg_forward()
        if self.robot.subleg.lists_assemblies:
            yield self._subleg_forward_all()
        if self.robot.subleg.has_inverse:
            yield self._subleg_inverse()
        if self.robot.subleg.redundant:
            yield self._swivel()
        yield self._subleg_jacobian()
        yield self._constraints()
        yield self._jacobians()
        yield self._jacobian_blocks()
        yield self._jacobians_n()
        if self.robot.subleg.has_inverse:
            yield self._inverse()
            yield self._inverse_all()
            yield self._inverse_near()
            yield self._inverse_status()
        else:
            yield self._newton_inverse()
        yield self._twist()
        yield self._joint_rates()
        yield self._platform_acceleration()
        yield self._joint_accelerations()
        yield self._inverse_statics()
        yield self._forward_statics()
        if self.robot.platform.carries_gripper:
            yield self._opening()
            yield self._redundant_of_opening()
            yield self._grasp()
        yield self._passive_joints()
        yield self._link_points()
        if not self.planar:
            yield self._clearances()
        yield self._singularity()
        yield self._type_2_of_redundant()
        yield self._indices()
        yield self._index_bounds()
        if self.robot.platform.closed_forward:
            yield self._forward_all()
            yield self._forward()
        else:
            yield self._forward_at_roots()
            yield self._forward_only()
            yield self._forward_newton()
            yield self._forward_one_encoder()
        yield self._passive_joints_of_theta()
        yield self._forward_encoders(2)
        yield self._forward_encoders(3)
        yield self._forward_gauss_newton(2)
        yield self._forward_gauss_newton(3)

    # -- position -------------------------------------------------------------------------------------------

    def _rotation_error(self) -> RobotFunction:
        error = Port("error", (), Unit.NONE, Frame.NONE, "0 for a rotation matrix")
        return self._function(
            "rotation_error",
            "How far Q is from a rotation matrix: the largest element of |Q^T Q - I|, at least 1 - det Q.",
            "",
            (self.plate.Q,),
            (error,),
            (Call(Stage.SHARED, "algebra", "rotation_error", {}, {}),),
        )

    def _end_points(self) -> RobotFunction:
        return self._function(
            "end_points",
            "End points of the sub-legs from the pose and the redundant coordinates.",
            "(1.37), 2.5",
            (*self.pose, self.plate.redundant),
            (self.plate.s,),
            (self._on_leg("platform", "end_point"),),
        )

    def _redundant_coordinates(self) -> RobotFunction:
        return self._function(
            "redundant_coordinates",
            "Redundant coordinates from the pose and the end points.",
            "1.5",
            (*self.pose, self.plate.s),
            (self.plate.redundant,),
            (self._on_leg("platform", "redundant"),),
        )

    def _subleg_inverse(self) -> RobotFunction:
        return self._function(
            "subleg_inverse",
            "Actuated joints of the sub-legs in every working mode, from the end points; NaN "
            "where a mode does not exist.",
            "App. B",
            (self.leg.s, *self._swivel_input()),
            (self.leg.theta_all,),
            (self._on_leg("subleg", "inverse_all"),),
            (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _inverse(self) -> RobotFunction:
        return self._function(
            "inverse",
            "Actuated joints in one working mode for each leg.",
            "1.5, 2.5, App. B",
            (*self.pose, self.plate.redundant, *self.leg.mode_choice, *self._swivel_input()),
            (self.leg.theta,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "inverse")),
            (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _inverse_all(self) -> RobotFunction:
        return self._function(
            "inverse_all",
            "Actuated joints in every working mode; NaN where a mode does not exist.",
            "1.5, 2.5, App. B",
            (*self.pose, self.plate.redundant, *self._swivel_input()),
            (self.leg.theta_all,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "inverse_all")),
            (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _inverse_near(self) -> RobotFunction:
        """A procedure (templates hold its loop): it chooses among the modes that `inverse_all` finds."""
        near = self._theta_near()
        theta = replace(self.leg.theta, doc="actuated joints, continued beyond +-pi")
        return RobotFunction(
            "inverse_near",
            "Actuated joints in the working mode nearest to theta_near, with angles continued beyond +-pi.",
            "1.8",
            (*self.pose, self.plate.redundant, near, *self._swivel_input()),
            (theta,),
            (),
        )

    def _newton_inverse(self) -> RobotFunction:
        """For sub-legs whose inverse has no closed form: Newton steps from joints nearby."""
        call, guards = self._newton("inverse_step", self.leg.theta, "theta_near")
        return self._function(
            "inverse",
            "Actuated joints by Newton steps from theta_near, for there is no closed form; NaN where "
            "they do not "
            "converge.",
            "2.5",
            (*self.pose, self.plate.redundant, self._theta_near()),
            (self.leg.theta,),
            (self._on_leg("platform", "end_point"), call),
            guards,
        )

    def _theta_near(self) -> Port:
        return replace(
            self.leg.theta, name="theta_near", doc="joints to stay near, the previous ones on a path"
        )

    def _swivel_input(self) -> tuple[Port, ...]:
        return (self.leg.swivel,) if self.robot.subleg.redundant else ()

    def _swivel(self) -> RobotFunction:
        return self._function(
            "swivel",
            "Swivels of redundant sub-legs.",
            "2.4.1",
            (self.leg.s, self.leg.theta),
            (self.leg.swivel,),
            (self._posture(), self._on_leg("subleg", "swivel")),
        )

    def _inverse_status(self) -> RobotFunction:
        excess = Port(
            "excess",
            (),
            Unit.METRE,
            Frame.NONE,
            "distance by which the end point is out of reach",
            Layout.STACKED,
        )
        return self._function(
            "inverse_status",
            "Which leg cannot reach its end point, and by how much.",
            "1.5",
            (*self.pose, self.plate.redundant, *self.leg.mode_choice, *self._swivel_input()),
            (excess,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "reach")),
            (Guard("excess", 0, Relation.AT_MOST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _constraints(self) -> RobotFunction:
        return self._function(
            "constraints",
            "Residuals of the constraint equations; all zero where the platform closes.  Their "
            "rates are J t - N s_dot.",
            self.robot.platform.equations,
            (*self.pose, self.plate.s),
            (self.plate.residual,),
            (self._on_leg("platform", "residual"),),
        )

    # -- velocity -------------------------------------------------------------------------------------------

    def _subleg_jacobian(self) -> RobotFunction:
        return self._function(
            "subleg_jacobian",
            "Jacobians M_i of the sub-legs: s_dot_i = M_i theta_dot_i.",
            "(1.16), (2.15)",
            (self.leg.s, self.leg.theta),
            (self.leg.M,),
            (self._posture(), self._on_leg("subleg", "jacobian")),
            self._parallel_guard(),
        )

    def _jacobians(self) -> RobotFunction:
        K = replace(
            self.leg.K, doc="Jacobian of the actuators, legs on the block diagonal", layout=Layout.DIAGONAL
        )
        return self._jacobian_function("jacobians", "J and K of J t = K theta_dot.", K)

    def _jacobian_blocks(self) -> RobotFunction:
        K = replace(self.leg.K, doc="the legs' blocks of K")
        return self._jacobian_function(
            "jacobian_blocks", "J, and K as the legs' blocks without the zeros.", K
        )

    def _jacobian_function(self, name: str, doc: str, K: Port) -> RobotFunction:
        return self._function(
            name,
            doc,
            "(1.30) to (1.32), (2.7), (2.28), (2.29)",
            (*self.pose, self.leg.s, self.leg.theta),
            (self.plate.J, K),
            (self._on_leg("platform", "rows"), self._posture(), self._on_leg("subleg", "project")),
            tuple(replace(guard, spoils=("K",)) for guard in self._parallel_guard()),
        )

    def _twist(self) -> RobotFunction:
        calls = (
            self._on_leg("platform", "line"),
            self._posture(),
            self._on_leg("subleg", "velocity"),
            self._on_leg("algebra", "rate"),
            Call(Stage.PLATFORM, "platform", "solve", {}, {"regularity": "det_regularity"}),
        )
        return self._function(
            "twist",
            "Twist of the platform from the rates of the actuated joints: t = J^-1 K theta_dot.",
            "(1.30)",
            (*self.pose, self.leg.s, self.leg.theta, self.leg.theta_dot),
            (self.plate.twist,),
            calls,
            (*self._parallel_guard(), *self._platform_guards()),
        )

    def _joint_rates(self) -> RobotFunction:
        return self._function(
            "joint_rates",
            "Rates of the actuated joints from the twist and the rates of the redundant coordinates.",
            "(1.30), (1.9)",
            (
                *self.pose,
                self.leg.s,
                self.leg.theta,
                self.plate.twist,
                self.plate.redundant_rates,
                *((self.leg.swivel_rates,) if self.robot.subleg.redundant else ()),
            ),
            (self.leg.theta_dot,),
            (self._on_leg("platform", "end_velocity"), self._posture(), self._on_leg("subleg", "rates")),
            self._serial_guard(),
        )

    # -- acceleration ---------------------------------------------------------------------------------------

    def _platform_acceleration(self) -> RobotFunction:
        theta_ddot = self._theta_ddot()
        calls = (
            self._on_leg("platform", "line"),
            self._on_leg("subleg", "bias"),
            self._posture(),
            self._on_leg("subleg", "velocity", {"s_dot": "along"}, theta_dot="theta_ddot"),
            self._on_leg("algebra", "sum"),
            self._on_leg("platform", "row_bias", {"bias": "row_bias"}),
            self._on_leg("algebra", "rate_with_bias", bias="row_bias"),
            Call(
                Stage.PLATFORM,
                "platform",
                "solve",
                {},
                {"twist": "twist_rate", "regularity": "det_regularity"},
            ),
        )
        return self._function(
            "platform_acceleration",
            "Rate of the twist from the accelerations of the actuated joints; `twist` is the one "
            "that theta_dot gives.",
            "(1.30) differentiated",
            (*self.pose, self.leg.s, self.leg.theta, self.plate.twist, self.leg.theta_dot, theta_ddot),
            (self.plate.twist_rate,),
            calls,
            (*self._parallel_guard(), *self._platform_guards()),
        )

    def _joint_accelerations(self) -> RobotFunction:
        redundant = self.robot.subleg.redundant
        along = {"s_dot": "along", **({"swivel_rates": "swivel_along"} if redundant else {})}
        calls = (
            self._on_leg("platform", "end_acceleration"),
            self._on_leg("subleg", "bias", {"s_dot": "s_dot_again", "regularity": "parallel_regularity"}),
            self._on_leg("algebra", "difference"),
            *((self._on_leg("subleg", "swivel_difference"),) if redundant else ()),
            self._posture(),
            self._on_leg("subleg", "rates", {"theta_dot": "theta_ddot"}, **along),
        )
        return self._function(
            "joint_accelerations",
            "Accelerations of the actuated joints; `theta_dot` are the rates that twist and "
            "redundant rates give.",
            "(1.30) differentiated",
            (
                *self.pose,
                self.leg.s,
                self.leg.theta,
                self.plate.twist,
                self.plate.redundant_rates,
                self.leg.theta_dot,
                self.plate.twist_rate,
                self.plate.redundant_accelerations,
                *((self.leg.swivel_accelerations,) if redundant else ()),
            ),
            (self._theta_ddot(),),
            calls,
            (*self._parallel_guard("parallel_regularity"), *self._serial_guard()),
        )

    def _theta_ddot(self) -> Port:
        return replace(
            self.leg.theta_dot,
            name="theta_ddot",
            unit=Unit.ACTUATOR_ACCELERATION,
            doc="accelerations of the actuated joints",
        )

    # -- passive joints and singularities -------------------------------------------------------------------

    def _link_points(self) -> RobotFunction:
        points = self.robot.subleg.points_port()
        return self._function(
            "link_points",
            "Where the joints of every leg are, and where its redundant link meets the platform: the "
            "ends of all "
            "straight links.",
            "",
            (*self.pose, self.leg.s, self.leg.theta),
            (points, self.plate.attachment),
            (self._posture(), self._on_leg("subleg", "points"), self._on_leg("platform", "attachment")),
            self._loop_guard(),
        )

    def _singularity(self) -> RobotFunction:
        names = self.robot.subleg.factor_names()
        doc = "; ".join(f"{name}: {text}" for name, text in names)
        factors = replace(
            self.leg.factors(len(names)),
            labels=tuple(name for name, _ in names),
            doc=f"factors of det M_i ({doc})",
        )
        what = "sqrt(det(M_i M_i^T))" if self.robot.subleg.redundant else "det M_i"
        type_1 = Port("type_1", (), Unit.MIXED, Frame.NONE, what, Layout.STACKED)
        calls = (
            self._posture(),
            self._on_leg("subleg", "determinant", {"det_M": "type_1"}),
            self._on_leg("platform", "line"),
            Call(Stage.PLATFORM, "platform", "type_2", {}, {}),
        )
        return self._function(
            "singularity",
            "Determinants of the legs and their factors; the factors of det J and margins that "
            "are positive inside the working "
            f"box.  {self.robot.platform.type_2_doc}",
            "1.4, 2.3.2",
            (*self.pose, self.leg.s, self.leg.theta),
            (type_1, factors, self.plate.type_2, self.plate.margins),
            calls,
        )

    def _type_2_of_redundant(self) -> RobotFunction:
        return self._function(
            "type_2_of_redundant",
            "The factors of det J and margins, as `singularity` gives them, from the redundant coordinates "
            "alone: they depend neither on the pose nor on the sub-legs.",
            "1.4, 2.3.2",
            (self.plate.redundant,),
            (self.plate.type_2, self.plate.margins),
            (
                self._on_leg("platform", "line_of_redundant"),
                Call(Stage.PLATFORM, "platform", "type_2", {}, {}),
            ),
        )
