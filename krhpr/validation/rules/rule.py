"""What a rule for generated functions says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from krhpr.codegen.robot_code import RobotCode
from krhpr.validation.check import Samples, Target

NUMERIC = (Target.C, Target.NUMPY)

EVERY = "every function"
"""The name under which checks of all functions together go."""

BATCH = Samples(40, 2000)


@dataclass(frozen=True)
class Rule:
    """A check of a generated function in doubles."""

    name: str
    function: str
    tolerance: float
    samples: Samples
    statement: str
    also: tuple[str, ...] = ()
    applies: Callable[[RobotCode], bool] = lambda robot: True
    targets: Sequence[Target] = NUMERIC
