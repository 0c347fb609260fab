"""Functions of the forward kinematics of a robot (Chapter 3): sub-legs first, then the platform."""

from __future__ import annotations

from dataclasses import replace

from krhpr.codegen.composition import (
    SINGULAR_TOLERANCE,
    Call,
    EachRoot,
    Guard,
    Only,
    Relation,
    Repeat,
    RobotFunction,
    Stage,
    Step,
)
from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.status import Status
from krhpr.derivations.platforms.encoders import (
    MISMATCHES,
    TOLERANCE,
    WEIGHTS,
    measured_port,
    mismatch_port,
    raw_port,
)
from krhpr.derivations.platforms.forward import BOX, CERTIFIED, SIDE, TURNED, forward_ports
from krhpr.derivations.platforms.forward_newton import KANTOROVICH, STATE, near_ports
from krhpr.derivations.platforms.forward_revolute import DEGREE
from krhpr.derivations.robot_functions import FunctionsOf
from krhpr.derivations.roots import COEFFICIENT_ERROR, MISS_TOLERANCE
from krhpr.derivations.sublegs.forward import ForwardRoots

FITS = 1e-6
"""Newton steps end at a pose where the links' squared lengths misfit by less than this, relative to theirs
and the platform's: far above rounding wherever a robot works.
"""

ENCODERS = {2: "two", 3: "three"}


class ForwardFunctions(FunctionsOf):
    """The forward kinematics of one robot."""

    # -- sub-legs -------------------------------------------------------------------------------------------

    def _subleg_forward(self) -> RobotFunction:
        subleg = self.robot.subleg
        doc = "End points of the sub-legs from the actuated joints."
        call = self._on_leg("subleg", "forward")
        guards: tuple[Guard, ...] = ()
        if not subleg.has_forward:
            doc += "  Newton steps from s_near; NaN where they do not converge."
            call, guards = self._newton("forward_step", self.leg.s, "s_near")
        elif subleg.forward_signs or subleg.forward_near or subleg.has_loops():
            doc += "  A closed loop that cannot close gives NaN."
            guards = (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),)
        inputs = (self.leg.theta, *self.leg.forward_choice)
        return self._function("subleg_forward", doc, "3.5", inputs, (self.leg.s,), (call,), guards)

    def _subleg_forward_all(self) -> RobotFunction:
        doc = "End points of the sub-legs in every assembly mode, from the actuated joints"
        roots = self.robot.subleg.assembly_roots
        if roots is not None:
            return self._subleg_at_roots(roots, doc)
        return self._function(
            "subleg_forward_all",
            f"{doc}; NaN where the loop cannot close.",
            "3.5",
            (self.leg.theta,),
            (self.leg.s_all,),
            (self._on_leg("subleg", "forward_all"),),
            (Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),),
        )

    def _subleg_at_roots(self, roots: ForwardRoots, doc: str) -> RobotFunction:
        (coefficients,) = roots.polynomial.outputs
        each = EachRoot(coefficients.name, roots.degree, COEFFICIENT_ERROR, MISS_TOLERANCE, roots.order)
        stacked = Layout.STACKED
        return self._function(
            "subleg_forward_all",
            f"{doc}: {roots.doc}",
            roots.equations,
            (self.leg.theta,),
            (
                *roots.outputs,
                Port(each.count, (), Unit.NONE, Frame.NONE, "number of assembly modes", stacked),
                Port(
                    each.doubtful,
                    (),
                    Unit.NONE,
                    Frame.NONE,
                    "1 where there may be further ones, else 0",
                    stacked,
                ),
            ),
            (
                self._on_leg("subleg", roots.polynomial.name),
                Call(Stage.LEG, "subleg", roots.at_root.name, {}, {}, each=each),
            ),
            (Guard(each.found, 0, Relation.AT_LEAST, 1.0, Status.UNREACHABLE_LEG_1),),
        )

    # -- forward kinematics ---------------------------------------------------------------------------------

    def _forward_all(self) -> RobotFunction:
        ports = forward_ports(self.robot.space, self.plate.redundant, 2)
        outputs = (ports.p, ports.orientation, ports.redundant, ports.det_J, ports.count)
        return self._function(
            "forward_all",
            "Every pose of the platform that holds the end points of the sub-legs, with its redundant "
            "coordinates: two, in closed form, with opposite det J, first the one whose first margin is "
            "positive.",
            "3.6; 3.2 for arrangement (a)",
            (self.leg.s, *(() if self.planar else (TURNED,))),
            outputs,
            (
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "assembly_modes", {}, {}),
            ),
            tuple(
                replace(guard, empties=(ports.count.name,))
                for guard in (*([] if self.planar else [self._sign_guard()]), *self._assembly_guards())
            ),
        )

    def _forward_at_roots(self) -> RobotFunction:
        ports = forward_ports(self.robot.space, self.plate.redundant, DEGREE)
        doubtful = Port(
            "doubtful", (), Unit.NONE, Frame.NONE, "1 where there may be further solutions, else 0"
        )
        each = EachRoot("sextic", DEGREE, COEFFICIENT_ERROR, MISS_TOLERANCE, ports.det_J.name)
        guards = [
            Guard(each.found, 0, Relation.AT_LEAST, 1.0, Status.NO_ASSEMBLY),
            *([] if self.planar else [self._sign_guard(), self._flatness_guard()]),
        ]
        empties = (ports.count.name, doubtful.name)
        return self._function(
            "forward_all",
            "Every pose of the platform that holds the end points of the sub-legs, with its redundant "
            "coordinates: the real roots of a sextic, two to six, in the order of det J.  Where two all but "
            "coincide they are left out and said to be in doubt.",
            "3.2.1",
            (self.leg.s, *(() if self.planar else (TURNED,))),
            (ports.p, ports.orientation, ports.redundant, ports.det_J, ports.count, doubtful),
            (
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "sextic", {}, {}),
                Call(Stage.PLATFORM, "platform", "assembly", {}, {}, each=each),
            ),
            tuple(replace(guard, empties=empties) for guard in reversed(guards)),
        )

    def _forward_only(self) -> RobotFunction:
        subleg = self._subleg_forward()
        ports = forward_ports(self.robot.space, self.plate.redundant, 0)
        only = Only()
        each = EachRoot("sextic", DEGREE, COEFFICIENT_ERROR, MISS_TOLERANCE, ports.det_J.name, only=only)
        family = () if self.planar else (TURNED,)
        guards = [
            *([] if self.planar else [self._sign_guard(), self._flatness_guard()]),
            Guard(only.inside, 0, Relation.AT_LEAST, 1.0, Status.NO_ASSEMBLY),
            Guard(only.ambiguous, 0, Relation.AT_MOST, 0.0, Status.AMBIGUOUS),
        ]
        empties = (ports.count.name, CERTIFIED.name)
        return self._function(
            "forward",
            "The pose of the platform and the redundant coordinates from the actuated joints alone: the only "
            "solution with its redundant angles in the box, without a guess or an extra encoder.  That it is "
            "the only one is certain for equilateral platforms with equal links l < 3 R_p / 4 and a box "
            "within (30, 150) deg.",
            "3.2.1",
            (*subleg.inputs, BOX, *family),
            (ports.p, ports.orientation, ports.redundant, ports.count, CERTIFIED),
            (
                *subleg.calls,
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "uniqueness", {}, {}),
                Call(Stage.PLATFORM, "platform", "sextic", {}, {}),
                Call(Stage.PLATFORM, "platform", "assembly", {}, {}, each=each),
            ),
            (*subleg.guards, *(replace(guard, empties=empties) for guard in guards)),
        )

    def _forward(self) -> RobotFunction:
        subleg = self._subleg_forward()
        ports = forward_ports(self.robot.space, self.plate.redundant, 0)
        return self._function(
            "forward",
            "The pose of the platform and the redundant coordinates from the actuated joints alone, unique "
            "on the known side of type II: no guess and no extra encoder.",
            "3.6",
            (*subleg.inputs, SIDE),
            (ports.p, ports.orientation, ports.redundant, ports.count, CERTIFIED),
            (
                *subleg.calls,
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "assembly_mode", {}, {"radicand": "assembly_radicand"}),
            ),
            (*subleg.guards, self._sign_guard(), *self._assembly_guards("assembly_radicand")),
        )

    def _passive_joints_of_theta(self) -> RobotFunction:
        forward = self._forward() if self.robot.platform.closed_forward else self._forward_only()
        passive = self._passive_joints()
        pose = tuple(port for port in forward.outputs if port.name in ("p", "Q", "phi", "redundant"))
        return RobotFunction(
            "passive_joints_of_theta",
            "Every passive joint from the actuated ones alone, by `forward`; and the pose.",
            "3.2, 3.6",
            forward.inputs,
            (*passive.outputs, *pose),
            (),
            steps=(Step("forward"), Step("end_points"), Step("passive_joints")),
        )

    # -- with a pose nearby, and with encoders --------------------------------------------------------------

    def _forward_newton(self) -> RobotFunction:
        p_near, Q_near = near_ports(self.robot.space)
        pose = (p_near, replace(self.pose[1], name="phi_near") if self.planar else Q_near)
        ports = forward_ports(self.robot.space, self.plate.redundant, 0)
        repeat = Repeat(before=STATE.name, after="state_next", start="start", change="change")
        turn = {"phi": "phi_near"}, {"Q": "Q_near"}
        return self._function(
            "forward_newton",
            "The pose by Newton steps from one nearby, in the platform's plane, where three of nine unknowns "
            "are left; and whether they are certain to converge.",
            "3.2.2",
            (self.leg.s, *pose),
            (ports.p, ports.orientation, ports.redundant, KANTOROVICH),
            (
                *([Call(Stage.SHARED, "algebra", "rotation", *turn)] if self.planar else []),
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "newton_start", {}, {}),
                Call(Stage.PLATFORM, "platform", "newton_step", {}, {"state_next": "state"}, repeat),
                Call(Stage.PLATFORM, "platform", "newton_pose", {}, {}),
            ),
            (*self._flat(), self._converged(repeat), self._fits()),
        )

    def _forward_one_encoder(self) -> RobotFunction:
        ports = forward_ports(self.robot.space, self.plate.redundant, 2)
        return self._function(
            "forward_encoders_1",
            "Both poses with an encoder at the first redundant joint, first the one that fits the third "
            "link's length better; where the other is within the tolerance too, they cannot be told apart.",
            "3.2.3",
            (self.leg.s, measured_port(self.plate.redundant, 1), TOLERANCE),
            (ports.p, ports.orientation, MISMATCHES),
            (*self._measured(1), Call(Stage.PLATFORM, "platform", "one_encoder", {}, {})),
            (
                *self._flat(),
                Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.INCONSISTENT),
                self._agreement(),
            ),
        )

    def _forward_encoders(self, count: int) -> RobotFunction:
        number = ENCODERS[count]
        return self._function(
            f"forward_encoders_{count}",
            f"The pose with encoders at {number} redundant joints, by linear equations; the orientation as "
            "they give it, and made a rotation.",
            {2: "3.2.4, 3.3", 3: "3.2.5, 3.3"}[count],
            (self.leg.s, measured_port(self.plate.redundant, count), TOLERANCE),
            self._encoder_outputs(count),
            (
                *self._measured(count),
                Call(Stage.PLATFORM, "platform", f"{number}_encoders", {}, {}),
                Call(Stage.PLATFORM, "platform", "encoder_pose", {"state": "linear"}, {}),
            ),
            (*self._flat(), *self._spread(), self._agreement()),
        )

    def _forward_gauss_newton(self, count: int) -> RobotFunction:
        # linear convergence: the last step says how far the end is
        repeat = Repeat(before="state", after="state_next", start="linear", change="change", tolerance=1e-24)
        kernel = f"gauss_newton_{count}"
        return self._function(
            f"forward_gauss_newton_{count}",
            f"The pose with encoders at {ENCODERS[count]} redundant joints, by weighted least squares.",
            "3.2.6, 3.3",
            (self.leg.s, measured_port(self.plate.redundant, count), TOLERANCE, WEIGHTS),
            self._encoder_outputs(count),
            (
                *self._measured(count),
                Call(Stage.PLATFORM, "platform", f"{ENCODERS[count]}_encoders", {}, {}),
                Call(Stage.PLATFORM, "platform", kernel, {}, {"state_next": "state"}, repeat),
                Call(Stage.PLATFORM, "platform", "encoder_pose", {}, {}),
            ),
            (*self._flat(), *self._spread(), self._agreement(), self._converged(repeat)),
        )

    def _encoder_outputs(self, count: int) -> tuple[Port, ...]:
        ports = forward_ports(self.robot.space, self.plate.redundant, 0)
        return ports.p, ports.orientation, raw_port(self.robot.space), mismatch_port(count)

    def _measured(self, count: int) -> tuple[Call, ...]:
        """What the legs and the encoders tell before the platform's kernels."""
        tie = self._on_leg("platform", "tie")
        if self.robot.platform.closed_forward:
            return (tie,)
        turns = Call(Stage.SHARED, "platform", f"turns_{count}", {}, {})
        return turns, tie, self._on_leg("platform", "arm")

    def _flat(self) -> tuple[Guard, ...]:
        return () if self.planar else (self._flatness_guard(),)

    @staticmethod
    def _spread() -> tuple[Guard, ...]:
        """Where end points are one or in line, in the platform or by the joints, they tell no orientation."""
        limit = SINGULAR_TOLERANCE**2
        return tuple(
            Guard(name, 0, Relation.AT_LEAST, limit, Status.SINGULAR_IN_PLANE)
            for name in ("spread", "direction")
        )

    @staticmethod
    def _agreement() -> Guard:
        return Guard("agreement", 0, Relation.AT_LEAST, 0.0, Status.INCONSISTENT)

    @staticmethod
    def _converged(repeat: Repeat) -> Guard:
        return Guard(repeat.change, 0, Relation.AT_MOST, repeat.tolerance, Status.NO_CONVERGENCE)

    @staticmethod
    def _fits() -> Guard:
        return Guard("misfit", 0, Relation.AT_MOST, FITS**2, Status.NO_CONVERGENCE)

    # -- guards ---------------------------------------------------------------------------------------------

    def _assembly_guards(self, radicand: str = "radicand") -> tuple[Guard, ...]:
        limit = SINGULAR_TOLERANCE**2  # the kernel gives squares
        guards = [
            Guard("breadth", 0, Relation.AT_LEAST, limit, Status.SINGULAR_IN_PLANE),
            Guard(radicand, 0, Relation.AT_LEAST, 0.0, Status.NO_ASSEMBLY),
        ]
        if not self.planar:
            guards.insert(0, self._flatness_guard())
        return tuple(guards)

    @staticmethod
    def _sign_guard() -> Guard:
        """Where a sign that is given is none there is no platform of that kind."""
        return Guard("sign", 0, Relation.AT_LEAST, 0.5, Status.NO_ASSEMBLY)

    @staticmethod
    def _flatness_guard() -> Guard:
        """Where the end points are collinear they span no plane."""
        return Guard("flatness", 0, Relation.AT_LEAST, SINGULAR_TOLERANCE**2, Status.SINGULAR_NORMAL)
