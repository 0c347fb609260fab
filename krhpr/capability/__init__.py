"""Grasp capability: which grasping forces actuators and friction allow at a pose, and which external
wrenches on the object they resist.

    found = krhpr.grasp_capability(robot, robot.home, contacts, faces=faces, actuator_limits=60.0,
    friction=0.3) found.grasp_force  # (least, most)

It takes SciPy, whose HiGHS solves the linear programmes.
"""

from krhpr.capability.answer import Extreme, GraspCapability, Limit, LimitKind
from krhpr.capability.grasp import GraspCapabilityMap, grasp_capability, grasp_capability_map

__all__ = [
    "Extreme",
    "GraspCapability",
    "GraspCapabilityMap",
    "Limit",
    "LimitKind",
    "grasp_capability",
    "grasp_capability_map",
]
