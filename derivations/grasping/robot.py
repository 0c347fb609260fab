"""The functions of a planar grasping robot: calls of the kernels of its sub-legs and of its jaws.

Names and order of arguments follow the catalogue's robots, with the pivot B in place of p and the jaws'
angles phi and beta in place of the orientation and the redundant coordinates.  `_n`, `_k`, `_r` are the views
of Section 5.2: non-redundant, kinematically redundant, redundantly actuated.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from krhpr.codegen.composition import SINGULAR_TOLERANCE, Call, Guard, Relation, RobotFunction, Stage
from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.status import Status
from krhpr.derivations.grasping.jaws import SOLUTIONS, Jaws
from krhpr.derivations.grasping.ports import (
    ACTUATORS,
    ANGLE,
    ANGLE_RATE,
    CONTACT,
    CONTACT_FORCES,
    DETERMINANT,
    END,
    FACE,
    FRICTION,
    INTERNAL,
    JAWS,
    LOAD,
    MARGINS,
    MASS_CENTRE,
    MEASURED,
    PIVOT,
    PIVOT_RATE,
    PULLS,
    SENSOR,
    SIDE,
    TWIST,
    WEIGHT,
    WIDTHS,
    WRENCH,
    of_jaws,
    together,
)
from krhpr.derivations.grasping.statics import LEAST, NULL_SPACE
from krhpr.derivations.grasping.sublegs import GraspPRR, GraspRPR
from krhpr.derivations.terms import Space


@dataclass(frozen=True)
class GraspingRobot:
    """Two sub-legs and two jaws."""

    subleg: GraspPRR | GraspRPR
    platform: Jaws
    notation: str
    """The thesis names its legs alone: 4-PRR, 4-RPR."""

    @property
    def space(self) -> Space:
        """The plane."""
        return self.subleg.space

    @property
    def identifier(self) -> str:
        """`planar_grasp_prr`."""
        return f"{self.space}_{self.subleg.name}"

    def functions(self) -> tuple[RobotFunction, ...]:
        """Every function, in the order in which it is printed."""
        return tuple(_Functions(self).all())


class _Functions:
    def __init__(self, robot: GraspingRobot) -> None:
        self.robot = robot
        self.leg = robot.subleg.ports()
        self.place = (PIVOT, ANGLE)
        self.posture = (PIVOT, END, self.leg.theta)

    def all(self) -> Iterable[RobotFunction]:
        yield self._end_points()
        yield self._subleg_inverse()
        yield self._inverse()
        yield self._inverse_all()
        yield self._inverse_status()
        yield self._subleg_forward()
        yield self._forward()
        yield self._forward_all()
        yield self._link_points()
        yield self._subleg_jacobian()
        yield self._jacobians_n()
        yield self._jacobians_k()
        yield self._jacobians_r()
        yield self._twist()
        yield self._joint_rates()
        yield self._singularity()
        yield self._inverse_statics_n()
        yield self._inverse_statics_k()
        yield self._inverse_statics_r()
        yield self._forward_statics()
        yield self._grasp()

    @staticmethod
    def _function(
        name: str,
        doc: str,
        equations: str,
        inputs: tuple[Port, ...],
        outputs: tuple[Port, ...],
        calls: tuple[Call, ...],
        guards: tuple[Guard, ...] = (),
    ) -> RobotFunction:
        given, found = (tuple(of_jaws(port) for port in ports) for ports in (inputs, outputs))
        return RobotFunction(name, doc, equations, given, found, calls, guards, legs=JAWS)

    @staticmethod
    def _on_leg(part: str, kernel: str, outputs: dict[str, str] | None = None) -> Call:
        return Call(Stage.LEG, part, kernel, {}, outputs or {})

    @staticmethod
    def _on_both(kernel: str, outputs: dict[str, str] | None = None) -> Call:
        return Call(Stage.PLATFORM, "platform", kernel, {}, outputs or {})

    # -- position -------------------------------------------------------------------------------------------

    def _end_points(self) -> RobotFunction:
        return self._function(
            "end_points",
            "End points of the sub-legs, P and S.",
            "(5.32), (5.33)",
            self.place,
            (END,),
            (self._on_leg("platform", "end_point"),),
        )

    def _reaches(self) -> tuple[Guard, ...]:
        return (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),)

    def _subleg_inverse(self) -> RobotFunction:
        return self._function(
            "subleg_inverse",
            "Actuated joints of the sub-legs in every working mode, from the end points; NaN where a mode "
            "does not exist.",
            "(5.13)",
            (END,),
            (self.leg.theta_all,),
            (self._on_leg("subleg", "inverse_all"),),
            self._reaches(),
        )

    def _inverse(self) -> RobotFunction:
        return self._function(
            "inverse",
            "Actuated joints in one working mode for each sub-leg.",
            "(5.26), (5.27)",
            (*self.place, *self.leg.mode_choice),
            (self.leg.theta,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "inverse")),
            self._reaches(),
        )

    def _inverse_all(self) -> RobotFunction:
        return self._function(
            "inverse_all",
            "Actuated joints in every working mode; NaN where a mode does not exist.",
            "(5.26), (5.27)",
            self.place,
            (self.leg.theta_all,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "inverse_all")),
            self._reaches(),
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
            "Which sub-leg cannot reach its end point, and by how much.",
            "(5.26), (5.27)",
            (*self.place, *self.leg.mode_choice),
            (excess,),
            (self._on_leg("platform", "end_point"), self._on_leg("subleg", "reach")),
            (Guard("excess", 0, Relation.AT_MOST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _closes(self) -> Guard:
        return Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1)

    def _subleg_forward(self) -> RobotFunction:
        return self._function(
            "subleg_forward",
            "End points of the sub-legs, P and S, from the actuated joints.",
            "5.2",
            (self.leg.theta, *self.leg.forward_choice),
            (END,),
            (self._on_leg("subleg", "forward"),),
            (self._closes(),),
        )

    def _forward(self) -> RobotFunction:
        return self._function(
            "forward",
            "Pivot and angles of the jaws from the actuated joints: of the eight solutions the one with "
            "these assembly modes of P and S, and B on this side of the line from P to S.",
            "5.2; errata 2.1",
            (self.leg.theta, *self.leg.forward_choice, SIDE),
            (PIVOT, together(ANGLE)),
            (
                self._on_leg("subleg", "forward"),
                self._on_leg("platform", "length"),
                self._on_both("pivot"),
            ),
            (
                replace(self._closes(), spoils=()),
                Guard("radicands", 0, Relation.AT_LEAST, 0.0, Status.NO_ASSEMBLY),
            ),
        )

    def _forward_all(self) -> RobotFunction:
        return self._function(
            "forward_all",
            "Pivot and angles of the jaws from the actuated joints, all eight solutions: by the assembly "
            "modes "
            "of P (slowest) and S, then by the side of the line PS on which B lies, left before right; NaN "
            "where one does not exist.",
            "5.2; errata 2.1",
            (self.leg.theta,),
            (
                replace(PIVOT, shape=(SOLUTIONS, 2), doc="pivot B of every solution"),
                replace(together(ANGLE), shape=(SOLUTIONS, JAWS), doc="phi and beta of every solution"),
            ),
            (
                self._on_leg("subleg", "forward_all"),
                self._on_leg("platform", "length"),
                self._on_both("pivots"),
            ),
            (self._closes(),),
        )

    def _link_points(self) -> RobotFunction:
        points = self.robot.subleg.points_port()
        return self._function(
            "link_points",
            "Where the joints of the sub-legs are.",
            "",
            (END, self.leg.theta),
            (points,),
            (self._on_leg("subleg", "posture"), self._on_leg("subleg", "points")),
        )

    # -- velocity -------------------------------------------------------------------------------------------

    def _regular(self) -> tuple[Guard, ...]:
        """A sub-leg's two chains are not aligned, or its actuators move its end point."""
        return (Guard("regularity", 0, Relation.AT_LEAST, SINGULAR_TOLERANCE, Status.SINGULAR_LEG_1),)

    @staticmethod
    def _not(variable: str, index: int = 0, status: Status = Status.SINGULAR_IN_PLANE) -> Guard:
        """A squared measure of regularity, of both jaws."""
        return Guard(variable, index, Relation.AT_LEAST, SINGULAR_TOLERANCE**2, status)

    def _subleg_jacobian(self) -> RobotFunction:
        return self._function(
            "subleg_jacobian",
            "Jacobians M of the sub-legs: s_dot = M rho_dot.",
            "(5.15), (5.16)",
            (END, self.leg.theta),
            (self.leg.M,),
            (self._on_leg("subleg", "posture"), self._on_leg("subleg", "jacobian")),
            self._regular(),
        )

    def _jacobians(
        self,
        name: str,
        kernel: str,
        doc: str,
        equations: str,
        rows: int,
        columns: int,
        guards: tuple[Guard, ...] = (),
    ) -> RobotFunction:
        inputs = (END, self.leg.theta) if name.endswith("_r") else self.posture
        J = Port("J", (rows, columns), Unit.MIXED, Frame.BASE, "Jacobian of the coordinates")
        K = Port("K", (rows, 2 * JAWS), Unit.MIXED, Frame.BASE, "Jacobian of the actuators")
        calls = (self._on_leg("subleg", "posture"), self._on_both(kernel))
        return self._function(name, doc, equations, inputs, (J, K), calls, guards)

    def _jacobians_n(self) -> RobotFunction:
        return self._jacobians(
            "jacobians_n",
            "non_redundant",
            "J_n and K_n of J_n [b_dot, phi_dot, beta_dot] = K_n rho_dot: both jaws are the end-effector.",
            "(5.34), (5.35)",
            4,
            4,
        )

    def _jacobians_k(self) -> RobotFunction:
        return self._jacobians(
            "jacobians_k",
            "kinematically_redundant",
            "J_k and K_k of J_k [p_dot, phi_dot] = K_k rho_dot: the right jaw is the end-effector, the "
            "left one a link.",
            "(5.3) to (5.5); errata 2.1",
            3,
            3,
            (replace(self._not("aligned", 0, Status.SINGULAR_LEG_2), spoils=("K",)),),
        )

    def _jacobians_r(self) -> RobotFunction:
        return self._jacobians(
            "jacobians_r",
            "redundantly_actuated",
            "J_r and K_r of J_r [p_dot, phi_dot] = K_r rho_dot: a rigid object between the jaws makes "
            "them one body.",
            "(5.20) to (5.22)",
            4,
            3,
        )

    def _twist(self) -> RobotFunction:
        return self._function(
            "twist",
            "Velocities of the pivot, the jaws' angles and P from the rates of the actuated joints.",
            "(5.3), (5.34)",
            (*self.posture, self.leg.theta_dot),
            (PIVOT_RATE, together(ANGLE_RATE), TWIST),
            (
                self._on_leg("subleg", "posture"),
                self._on_leg("subleg", "velocity"),
                self._on_both("solve"),
            ),
            (*self._regular(), self._not("aligned")),
        )

    def _joint_rates(self) -> RobotFunction:
        return self._function(
            "joint_rates",
            "Rates of the actuated joints from those of the pivot and of the jaws' angles.",
            "(5.34)",
            (*self.posture, PIVOT_RATE, ANGLE_RATE),
            (self.leg.theta_dot,),
            (
                self._on_leg("platform", "end_velocity"),
                self._on_leg("subleg", "posture"),
                self._on_leg("subleg", "rates"),
            ),
            self._regular(),
        )

    def _singularity(self) -> RobotFunction:
        names = self.robot.subleg.factor_names()
        doc = "; ".join(f"{name}: {text}" for name, text in names)
        factors = replace(
            self.leg.factors(len(names)),
            labels=tuple(name for name, _ in names),
            doc=f"factors of det M ({doc})",
        )
        type_1 = Port(
            "type_1", (2,), Unit.MIXED, Frame.NONE, "kappa of each chain, K_n = diag(kappa)", Layout.STACKED
        )
        determinants = Port(
            "determinants", (2,), Unit.MIXED, Frame.NONE, "of J_k and J_n", labels=("det J_k", "det J_n")
        )
        sine = Port("sine", (), Unit.NONE, Frame.NONE, "sin gamma, gamma = beta - phi between the jaws")
        return self._function(
            "singularity",
            "What vanishes in a singular configuration: type I where a kappa does (type_1, factors chain_1, "
            "chain_2), type II where the chains of a sub-leg are aligned (factor volume) or the jaws are "
            "(sine).",
            "5.2; errata 2.1",
            self.posture,
            (type_1, factors, determinants, sine),
            (
                self._on_leg("subleg", "posture", {"b": "type_1"}),
                Call(Stage.LEG, "subleg", "determinant", {"b": "type_1"}, {}),
                self._on_leg("platform", "length"),
                self._on_both("type_2"),
            ),
        )

    # -- statics --------------------------------------------------------------------------------------------

    def _statics(
        self,
        name: str,
        kernel: str,
        doc: str,
        equations: str,
        inputs: tuple[Port, ...],
        outputs: tuple[Port, ...],
        guards: tuple[Guard, ...],
    ) -> RobotFunction:
        calls = (
            self._on_leg("subleg", "posture"),
            self._on_leg("subleg", "jacobian"),
            self._on_both(kernel),
        )
        return self._function(name, doc, equations, inputs, outputs, calls, (*self._regular(), *guards))

    def _inverse_statics_n(self) -> RobotFunction:
        return self._statics(
            "inverse_statics_n",
            "loads",
            "Forces of the actuators with which the robot applies loads to its environment: a force, and "
            "moments about B by each jaw.  Valid for every load.",
            "(5.44)",
            (*self.posture, LOAD),
            (together(ACTUATORS),),
            (self._not("aligned"),),
        )

    def _inverse_statics_k(self) -> RobotFunction:
        return self._statics(
            "inverse_statics_k",
            "right_jaw",
            "Forces of the actuators with which the right jaw applies a wrench, with the moment about P, "
            "to its "
            "environment.  Wrong where anything loads the left jaw, as an object between the jaws does.",
            "(5.12)",
            (*self.posture, WRENCH),
            (together(ACTUATORS),),
            (self._not("aligned"),),
        )

    def _inverse_statics_r(self) -> RobotFunction:
        return self._statics(
            "inverse_statics_r",
            "one_body",
            "Forces of the actuators with which both jaws as one body apply a wrench, with the moment "
            "about P, "
            "to their environment: the least ones, and `internal_force` times the null space.  The wrench "
            "of an object between the jaws does not say how hard it is held; the internal force does.",
            "(5.25)",
            (END, self.leg.theta, WRENCH, INTERNAL),
            (together(ACTUATORS), LEAST, NULL_SPACE),
            (self._not("apart", 0), self._not("apart", 1)),
        )

    def _forward_statics(self) -> RobotFunction:
        return self._function(
            "forward_statics",
            "What the robot applies to its environment with given forces of the actuators: loads of both "
            "jaws, and the wrench of both as one body.",
            "(5.24), (5.36)",
            (*self.posture, ACTUATORS),
            (LOAD, WRENCH),
            (
                self._on_leg("subleg", "posture"),
                self._on_leg("subleg", "end_force"),
                self._on_both("total"),
            ),
            self._regular(),
        )

    def _grasp(self) -> RobotFunction:
        loads, forces = LOAD.name, CONTACT_FORCES.name
        return self._function(
            "grasp",
            "Forces of the jaws on the object between them by its equilibrium, any one of the four "
            "measured; and what they are for the robot, as inverse_statics_n takes them.",
            "(5.38) to (5.43)",
            (ANGLE, CONTACT, FACE, MASS_CENTRE, WEIGHT, SENSOR, MEASURED, FRICTION),
            (CONTACT_FORCES, LOAD, MARGINS, DETERMINANT, WIDTHS, PULLS),
            (self._on_leg("platform", "contact"), self._on_both("held")),
            (
                replace(
                    self._not("determined", 0, Status.UNDETERMINED), spoils=(forces, loads, MARGINS.name)
                ),
                *(
                    Guard(WIDTHS.name, jaw, Relation.AT_LEAST, 0.0, Status.NO_GRASP, (loads,))
                    for jaw in range(JAWS)
                ),
                *(
                    Guard(forces, 2 * jaw, Relation.AT_LEAST, 0.0, Status.NO_GRASP, (loads,))
                    for jaw in range(JAWS)
                ),
                *(
                    Guard(MARGINS.name, jaw, Relation.AT_LEAST, 0.0, Status.SLIPS, (loads,))
                    for jaw in range(JAWS)
                ),
            ),
        )
