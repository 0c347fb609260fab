"""Functions of the gripper that the redundant slides of arrangements (b) and (c) carry (Section 5.3)."""

from __future__ import annotations

from krhpr.codegen.composition import SINGULAR_TOLERANCE, Call, Guard, Relation, RobotFunction, Stage
from krhpr.codegen.status import Status
from krhpr.derivations.platforms.grasp import GraspPorts
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

    def _grasp(self) -> RobotFunction:
        platform = self.robot.platform
        ports = GraspPorts(platform)
        determined = range(1 if self.planar else 2)
        pressed, margins = ports.redundant_forces.name, ports.friction_margins.name
        return self._function(
            "grasp",
            "Forces of the jaws on the object between them by its equilibrium, the normal ones measured; and "
            "what they are for the robot: a wrench, and forces along the redundant coordinates, as "
            "inverse_statics takes them.",
            "(5.38), (5.39), (5.62) to (5.68) corrected",
            (
                self.pose[1],
                ports.contacts,
                ports.mass_centre,
                ports.weight,
                ports.normal_forces,
                ports.friction,
            ),
            (ports.contact_forces, ports.wrench, ports.redundant_forces, ports.friction_margins),
            (
                self._on_leg("platform", "tie"),
                Call(Stage.PLATFORM, "platform", "grasp", {}, {}),
            ),
            (
                *(
                    Guard("determined", i, Relation.AT_LEAST, SINGULAR_TOLERANCE**2, Status.UNDETERMINED)
                    for i in determined
                ),
                *(
                    Guard(pressed, leg, Relation.AT_MOST, 0.0, Status.NO_GRASP, ("wrench",))
                    for leg in range(3)
                ),
                *(
                    Guard(margins, leg, Relation.AT_LEAST, 0.0, Status.SLIPS, ("wrench", pressed))
                    for leg in range(3)
                ),
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
