"""A sub-leg's formulas held to its own loop closure, before code is made of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from krhpr.derivations.catalogue import Entry
from krhpr.errors import PluginError
from krhpr.validation.check import Kind
from krhpr.validation.outcome import State
from krhpr.validation.plan import plan
from krhpr.validation.run import Result, carry_out
from krhpr.validation.subject import Subject

_MEANT = {
    "velocity equations": "`velocity` (or `posture`) and the derivative of `closure` differ",
    "forward closes": "`forward` and `closure`, or the postures of `forward` and `posture`, differ",
    "inverse closes": "`inverse` and `closure` differ, or two working modes are the same",
    "determinant of M": "`determinant` or the factors of `velocity` and det(A^-1 B) differ",
    "products of M": "`rates` and B^-1 A differ",
    "accelerations": "`forward` and `velocity` differ along a motion",
    "reach": "`reach` is positive where `inverse` has an answer, or the other way round",
    "passive joints": "the frame that `passive` gives is no rotation",
    "links": "a link of `links` is not as long, between its `points`, as the length it is named after",
    "swivel": "`swivel_angle` and the last row of `velocity` differ",
    "Newton step": "`closure` does not determine the joints",
}
"""What a failed proof says to the author of a sub-leg."""


def prove(entries: Iterable[Entry], progress: Callable[[str], None] = lambda step: None) -> None:
    """Prove the kernels of each sub-leg among the robots, once.

    Raises PluginError with what disagrees.
    """
    seen: set[str] = set()
    for entry in entries:
        name = entry.robot.subleg.name
        if name in seen:
            continue
        seen.add(name)
        progress(f"prove {name}")
        subject = Subject(entry)
        checks = [c for c in plan(subject.code) if c.kind is Kind.PROOF and c.function.startswith("subleg.")]
        results = [carry_out(subject, check, "small") for check in checks]
        failed = [result for result in results if result.state is State.FAILED]
        if failed:
            raise PluginError(
                f"{name}: its formulas contradict one another:\n" + "\n".join(map(_told, failed))
            )


def _told(result: Result) -> str:
    meant = _MEANT.get(result.check.name, result.check.name)
    by = f" by {result.worst:.1e}" if 0 < result.worst < float("inf") else ""
    return f"  {meant}{by} ({result.remark})"
