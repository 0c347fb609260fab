"""Functions of the gripper that the redundant slides of arrangements (b) and (c) carry (Section 5.3)."""

from __future__ import annotations

from krhpr.codegen.composition import Call, Guard, Relation, RobotFunction, Stage, Status
from krhpr.derivations.platforms.opening import CENTRE, JAWS, OPENING, SHARES
from krhpr.derivations.robot_functions import FunctionsOf


class GripperFunctions(FunctionsOf):
    """The gripper of one robot."""

    def _opening(self) -> RobotFunction:
        return self._function(
            "opening",
            "The opening of a gripper with a jaw on each slide: diameter and centre of the round object that "
            "touches all three, and the shares in which they press on it.",
            "5.1, 5.3",
            (self.plate.redundant, JAWS),
            (OPENING, CENTRE, SHARES),
            (
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "opening", {}, {}),
            ),
            tuple(
                Guard(SHARES.name, leg, Relation.AT_LEAST, 0.0, Status.NO_GRASP) for leg in range(SHARES.size)
            ),
        )

    def _redundant_of_opening(self) -> RobotFunction:
        return self._function(
            "redundant_of_opening",
            "Redundant coordinates at which the jaws touch a round object with given diameter and centre.",
            "5.1, 5.3",
            (OPENING, CENTRE, JAWS),
            (self.plate.redundant,),
            (self._on_leg("platform", "redundant_of_opening"),),
        )
