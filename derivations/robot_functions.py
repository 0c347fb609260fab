"""What the functions of one robot are built from: its ports, calls that many share, and guards."""

from __future__ import annotations

from typing import TYPE_CHECKING

from krhpr.codegen.composition import SINGULAR_TOLERANCE, Call, Guard, Relation, Repeat, RobotFunction, Stage
from krhpr.codegen.kernel import Frame, Layout, Port, Unit
from krhpr.codegen.status import Status
from krhpr.derivations.terms import Space

if TYPE_CHECKING:
    from krhpr.derivations.robots import Robot


class FunctionsOf:
    """The ports of one robot, and pieces of its functions."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.leg = robot.subleg.ports()
        self.plate = robot.platform.ports()
        self.planar = robot.space is Space.PLANAR
        phi = Port("phi", (), Unit.RADIAN, Frame.BASE, "orientation of the platform, base from platform")
        self.pose = (self.plate.p, phi if self.planar else self.plate.Q)

    def _function(
        self,
        name: str,
        doc: str,
        equations: str,
        inputs: tuple[Port, ...],
        outputs: tuple[Port, ...],
        calls: tuple[Call, ...],
        guards: tuple[Guard, ...] = (),
    ) -> RobotFunction:
        if self.planar and any(port.name == "phi" for port in inputs):
            calls = (Call(Stage.SHARED, "algebra", "rotation", {}, {}), *calls)
        return RobotFunction(name, doc, equations, inputs, outputs, calls, guards)

    @staticmethod
    def _on_leg(part: str, kernel: str, outputs: dict[str, str] | None = None, **inputs: str) -> Call:
        return Call(Stage.LEG, part, kernel, inputs, outputs or {})

    def _posture(self) -> Call:
        """Sines and cosines of the leg's joints and its vectors, for the kernels that follow."""
        return self._on_leg("subleg", "posture")

    def _parallel_guard(self, variable: str = "regularity") -> tuple[Guard, ...]:
        """A sub-leg with a closed loop has configurations in which M_i does not exist."""
        if not self.robot.subleg.has_parallel_factors():
            return ()
        return (Guard(variable, 0, Relation.AT_LEAST, SINGULAR_TOLERANCE, Status.SINGULAR_LEG_1),)

    def _serial_guard(self) -> tuple[Guard, ...]:
        """Where a sub-leg's actuators cannot give its end point every velocity."""
        if not self.robot.subleg.has_serial_factors():
            return ()
        return (Guard("regularity", 0, Relation.AT_LEAST, SINGULAR_TOLERANCE, Status.SINGULAR_LEG_1),)

    def _platform_guards(self) -> tuple[Guard, ...]:
        limit = SINGULAR_TOLERANCE**2  # the kernel gives squares
        guards = [Guard("det_regularity", 0, Relation.AT_LEAST, limit, Status.SINGULAR_IN_PLANE)]
        if not self.planar:
            guards.append(Guard("det_regularity", 1, Relation.AT_LEAST, limit, Status.SINGULAR_NORMAL))
        return tuple(guards)

    def _newton(self, kernel: str, unknown: Port, start: str) -> tuple[Call, tuple[Guard, ...]]:
        """A bounded Newton iteration on each leg's loop closure, and the guard that says whether it
        converged.
        """
        name = unknown.name
        repeat = Repeat(before=name, after=f"{name}_next", start=start, change="change")
        call = Call(Stage.LEG, "subleg", kernel, {}, {f"{name}_next": name}, repeat)
        guard = Guard("change", 0, Relation.AT_MOST, repeat.tolerance, Status.NO_CONVERGENCE)
        return call, (guard,)

    # -- passive joints, which forward kinematics gives too --------------------------------------------------

    def _passive_joints(self) -> RobotFunction:
        outputs: list[Port] = []
        if self.robot.subleg.passive_joints:
            outputs.append(self.leg.passive)
        if self.planar:
            wrist = "joint at r_i: redundant link (from r_i) relative to the sub-leg's last link"
            outputs.append(Port("wrist", (), Unit.RADIAN, Frame.JOINT, wrist, Layout.STACKED))
        else:
            sphere = (
                "spherical joint at S_i as a rotation: redundant link (x from S_i, z = q_z) seen from"
                " the sub-leg's last link "
                "(x towards S_i, z = e_2)"
            )
            outputs.append(Port("spherical", (3, 3), Unit.NONE, Frame.JOINT, sphere, Layout.STACKED))
        outputs.append(self.plate.platform_joint)
        return self._function(
            "passive_joints",
            "Every passive joint, from the base to the platform.",
            "",
            (*self.pose, self.leg.s, self.leg.theta),
            tuple(outputs),
            (
                self._posture(),
                self._on_leg("subleg", "passive"),
                self._on_leg("platform", "joint"),
                self._on_leg("algebra", "wrist"),
            ),
            self._loop_guard(),
        )

    def _loop_guard(self) -> tuple[Guard, ...]:
        """Where loops of passive joints do not close, or leave a joint undetermined, there are no passive
        joints.
        """
        if not self.robot.subleg.has_loops():
            return ()
        return (
            Guard("radicand", 0, Relation.AT_LEAST, 0.0, Status.UNREACHABLE_LEG_1),
            Guard("regularity", 0, Relation.AT_LEAST, SINGULAR_TOLERANCE**2, Status.SINGULAR_LEG_1),
        )
