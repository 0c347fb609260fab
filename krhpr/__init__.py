"""krhpr: kinematics of kinematically redundant (hybrid) parallel robots.

    import krhpr

    robot = krhpr.load("spatial_rrr_a")
    theta = robot.inverse(p, Q, beta)

Using the generated functions needs NumPy alone; deriving and printing them needs the extra `generate`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from krhpr.capability import GraspCapability, grasp_capability, grasp_capability_map
    from krhpr.errors import (
        Ambiguous,
        GeneratedMismatch,
        Inconsistent,
        InvalidInput,
        KrhprError,
        NoConvergence,
        NoGrasp,
        Singular,
        Unassembled,
        UnknownBranch,
        UnknownRobot,
        Unreachable,
    )
    from krhpr.generated.python.runtime import Geometry, Status
    from krhpr.grasping import Force, GraspingRobot, measured_force
    from krhpr.limits import Cone, Interval, Limits
    from krhpr.loading import catalogue, grasping_robots, load, load_grasping
    from krhpr.robot import Robot
    from krhpr.robot_files.problems import RobotFileError, RobotFileWarning

# found on first use, so that generating works while generated/ is empty or of another version
_HOME = {
    "Cone": "krhpr.limits",
    "GeneratedMismatch": "krhpr.errors",
    "Geometry": "krhpr.generated.python.runtime",
    "Interval": "krhpr.limits",
    "InvalidInput": "krhpr.errors",
    "KrhprError": "krhpr.errors",
    "Limits": "krhpr.limits",
    "NoConvergence": "krhpr.errors",
    "NoGrasp": "krhpr.errors",
    "Robot": "krhpr.robot",
    "RobotFileError": "krhpr.robot_files.problems",
    "RobotFileWarning": "krhpr.robot_files.problems",
    "Singular": "krhpr.errors",
    "Status": "krhpr.generated.python.runtime",
    "Ambiguous": "krhpr.errors",
    "Inconsistent": "krhpr.errors",
    "Unassembled": "krhpr.errors",
    "UnknownBranch": "krhpr.errors",
    "UnknownRobot": "krhpr.errors",
    "Unreachable": "krhpr.errors",
    "GraspCapability": "krhpr.capability",
    "grasp_capability": "krhpr.capability",
    "grasp_capability_map": "krhpr.capability",
    "Force": "krhpr.grasping",
    "GraspingRobot": "krhpr.grasping",
    "measured_force": "krhpr.grasping",
    "grasping_robots": "krhpr.loading",
    "load_grasping": "krhpr.loading",
    "catalogue": "krhpr.loading",
    "load": "krhpr.loading",
}

__all__ = [
    "Ambiguous",
    "Cone",
    "Force",
    "GeneratedMismatch",
    "Geometry",
    "GraspCapability",
    "GraspingRobot",
    "Inconsistent",
    "Interval",
    "InvalidInput",
    "KrhprError",
    "Limits",
    "NoConvergence",
    "NoGrasp",
    "Robot",
    "RobotFileError",
    "RobotFileWarning",
    "Singular",
    "Status",
    "Unassembled",
    "UnknownBranch",
    "UnknownRobot",
    "Unreachable",
    "__version__",
    "catalogue",
    "grasp_capability",
    "grasp_capability_map",
    "grasping_robots",
    "load",
    "load_grasping",
    "measured_force",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        try:
            return getattr(import_module(_HOME[name]), name)
        except ImportError as error:
            if (error.name or "").startswith("krhpr.generated"):
                from krhpr.errors import GeneratedMismatch

                raise GeneratedMismatch(
                    f"the generated robots are missing or damaged ({error}); run `krhpr generate` "
                    "(or `make generate`)"
                ) from error
            raise
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
