"""Trajectories of robots with redundant coordinates: which of them to choose along a path of the platform.

    from krhpr import load, trajectory

    robot = load("spatial_rrr_a")
    best = trajectory.optimise(robot, trajectory.translation(), "eta_1", trajectory.chapter_4())
    best.integrals, best.feasible, best.theta

The nonlinear programme takes the extras `casadi` and `trajectory` (CasADi with IPOPT, SciPy).
"""

from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.examine import Examined, Lines, Violation
from krhpr.trajectory.grip import Grip
from krhpr.trajectory.horizon import BadState, Plan, RecedingHorizon, State
from krhpr.trajectory.optimise import Method, Trajectory, optimise
from krhpr.trajectory.paths import (
    BUILT_IN,
    Interpolation,
    Motion,
    Path,
    PathError,
    example,
    function_of_time,
    tilt,
    translation,
    way_points,
)
from krhpr.trajectory.point import NoClosedForm
from krhpr.trajectory.reach import LeavesWorkspace
from krhpr.trajectory.refusals import ContradictoryLimits, UnknownObjective
from krhpr.trajectory.results import Result, ResultError, load_result, save
from krhpr.trajectory.terms import Bounds, Load, Objective, chapter_4
from krhpr.trajectory.transcription import Curve

__all__ = [
    "BUILT_IN",
    "BadState",
    "Bounds",
    "ContradictoryLimits",
    "Curve",
    "Evaluation",
    "Examined",
    "Grip",
    "Interpolation",
    "LeavesWorkspace",
    "Lines",
    "Load",
    "Method",
    "Motion",
    "NoClosedForm",
    "Objective",
    "Path",
    "PathError",
    "Plan",
    "RecedingHorizon",
    "Result",
    "ResultError",
    "State",
    "Trajectory",
    "UnknownObjective",
    "Violation",
    "chapter_4",
    "example",
    "function_of_time",
    "load_result",
    "optimise",
    "save",
    "tilt",
    "translation",
    "way_points",
]
