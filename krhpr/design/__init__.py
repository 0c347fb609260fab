"""Designs: what sizes and redundant coordinates make of the whole workspace (Section 4.2 and beyond).

    from krhpr import design, load, workspace

    robot = load("spatial_rrr_a")
    varied = [design.Variable("redundant", 1.0, 2.6), design.Variable("l_r", 0.03, 0.09)]
    space = design.DesignSpace(robot, varied)
    problem = design.Problem(space, ("volume", "eta_2"), workspace.section_1_7(robot))
    found = design.search(problem)
    found.front  # what no other design beats

`search` takes the extra `design` (cma, SciPy).
"""

from krhpr.design.connected import connected, largest_cube
from krhpr.design.evaluation import Evaluation, Grid, Problem
from krhpr.design.files import best, held, write_design
from krhpr.design.front import front, non_dominated
from krhpr.design.objectives import Objective
from krhpr.design.search import Effort, Found, search
from krhpr.design.variables import HEIGHT, REDUNDANT, DesignSpace, Tie, Variable

__all__ = [
    "HEIGHT",
    "REDUNDANT",
    "DesignSpace",
    "Effort",
    "Evaluation",
    "Found",
    "Grid",
    "Objective",
    "Problem",
    "Tie",
    "Variable",
    "best",
    "connected",
    "front",
    "held",
    "largest_cube",
    "non_dominated",
    "search",
    "write_design",
]
