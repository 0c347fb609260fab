"""Controllers of the grasping force in C: for every grasping robot a step of the schemes of Section 5.5.

The laws of control, settings and state are the same for all and stand in one header; a robot's own source
joins them with its kinematics and its static model, which are functions of its own C.
"""

from __future__ import annotations

from collections.abc import Iterable

from krhpr.codegen.part import Part
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import File, render

ENOUGH_FRICTION = 1e6
"""A coefficient with which no contact slips: the static model takes friction to hold the object."""

_NEEDED = {"inverse", "forward", "end_points", "grasp", "inverse_statics_n"}
"""Functions that a step calls; robots without them are not controlled."""


class CControlTarget:
    """Prints controllers in C99."""

    name = "c control"

    def shared(self) -> Iterable[File]:
        """Settings, state and laws of control."""
        yield File("c/krhpr_control.h", render("c/krhpr_control.h.j2"))

    def part(self, part: Part) -> Iterable[File]:
        """Nothing: controllers call the functions of robots."""
        return ()

    def robot(self, robot: RobotCode) -> Iterable[File]:
        """A grasping robot's controller: a header and a source."""
        if not is_controlled(robot):
            return
        geometry = [] if robot.baked else [f"const krhpr_{robot.identifier}_geometry *g"]
        settings = "const krhpr_control_settings *c"
        given = [] if robot.baked else ["g"]
        context = {
            "robot": robot,
            "given": "".join(f"{name}, " for name in given),
            "inverse": [*given, *_arguments(robot, "inverse"), "error"],
            "forward": [*given, *_arguments(robot, "forward"), "pivot", "angles"],
            "enough_friction": repr(ENOUGH_FRICTION),
            "step": [
                *geometry,
                settings,
                "krhpr_control_state *state",
                "const double pivot[2]",
                "const double angles[2]",
                "double grasp_force",
                "const double theta[4]",
                "double measured_force",
                "double *KRHPR_RESTRICT torques",
            ],
            "statics": [
                *geometry,
                settings,
                "const double theta[4]",
                "double grasp_force",
                "double *KRHPR_RESTRICT actuator_forces",
            ],
        }
        for ending in ("h", "c"):
            text = render(f"c/control.{ending}.j2", **context)
            yield File(f"c/krhpr_{robot.identifier}_control.{ending}", text)


_ARGUMENTS = {"mode": "NULL", "assembly": "c->assembly", "side": "c->side"}
"""What inputs of positions get in a step; the others get the variable of their name."""


def _arguments(robot: RobotCode, name: str) -> list[str]:
    """The inputs of one of a robot's functions; struts have no working modes, so robots differ."""
    (function,) = (function for function in robot.functions if function.name == name)
    return [_ARGUMENTS.get(port.name, port.name) for port in function.inputs]


def is_controlled(robot: RobotCode) -> bool:
    """Whether a robot has jaws and everything else that a controller calls."""
    return {function.name for function in robot.functions} >= _NEEDED
