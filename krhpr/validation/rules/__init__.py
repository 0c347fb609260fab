"""The rules of the plan as tables: a row says what is checked, how closely, and in one sentence what it
means.
"""

from krhpr.validation.rules.differences import DIFFERENCES
from krhpr.validation.rules.invariants import INVARIANTS
from krhpr.validation.rules.jaws import INVARIANTS_OF_JAWS
from krhpr.validation.rules.known import FIRST_PRINCIPLES, THESIS_ROWS, THESIS_VELOCITY
from krhpr.validation.rules.proofs import FEW, MANY, PLATFORM_PROOFS, ROBOT_PROOFS, SUBLEG_PROOFS, Proof
from krhpr.validation.rules.references import REFERENCES
from krhpr.validation.rules.rule import EVERY, Rule

__all__ = [
    "DIFFERENCES",
    "EVERY",
    "FEW",
    "FIRST_PRINCIPLES",
    "INVARIANTS",
    "INVARIANTS_OF_JAWS",
    "MANY",
    "PLATFORM_PROOFS",
    "REFERENCES",
    "ROBOT_PROOFS",
    "SUBLEG_PROOFS",
    "THESIS_ROWS",
    "THESIS_VELOCITY",
    "Proof",
    "Rule",
]
