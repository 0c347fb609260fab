"""What executed x86-64 instructions do: floating-point operations, work for vector unit and divider."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

WIDTHS = {"zmm": 512, "ymm": 256, "xmm": 128}
"""Bits of the registers; an operation on one number counts as one of 128 bits."""

_REGISTER = re.compile(r"\b([xyz]mm)\d+\b")
_OPERATION = re.compile(
    r"v?(?P<name>fn?m(?:add|sub|addsub|subadd)(?:132|213|231)|add|sub|mul|div|sqrt|addsub|hadd|hsub"
    r"|rcp(?:14|28)?|rsqrt(?:14|28)?)(?P<of>[sp][sd])"
)
_PLAIN_MOVE = re.compile(r"v?mov(?!mskp|q2|dq2)\w*")
_FROM_MEMORY = re.compile(r"v?(?:p?broadcast\w*|lddqu|movddup|movs[hl]dup)")
_MEMORY = re.compile(r"\[")


ByWidth = dict[int, float]


def _none() -> ByWidth:
    return defaultdict(float)


@dataclass
class Mix:
    """What a piece of code executes: sums over its instructions."""

    instructions: float = 0.0
    flops: float = 0.0
    vector: ByWidth = field(default_factory=_none)
    """Instructions that the vector unit works on, by width in bits; no loads, stores and copies."""
    divides: ByWidth = field(default_factory=_none)
    """Divisions among them, by width."""
    roots: ByWidth = field(default_factory=_none)
    """Square roots among them, by width."""

    def add(self, mnemonic: str, operands: str, times: float) -> None:
        """An instruction in Intel's syntax that is executed so often."""
        self.instructions += times
        registers = [WIDTHS[name] for name in _REGISTER.findall(operands)]
        if not registers:
            return
        width = max(registers)
        operation = _OPERATION.fullmatch(mnemonic)
        if operation is None:
            if not _moves_only(mnemonic, operands):
                self.vector[width] += times
            return
        name, of = operation["name"], operation["of"]
        width = width if of[0] == "p" else WIDTHS["xmm"]
        lanes = width // (64 if of[1] == "d" else 32) if of[0] == "p" else 1
        self.flops += times * lanes * (2 if name.startswith("f") else 1)
        self.vector[width] += times
        if name == "div":
            self.divides[width] += times
        elif name == "sqrt":
            self.roots[width] += times

    def scaled(self, factor: float) -> Mix:
        """The same per pose, for instance."""
        return self._plus(Mix(), factor)

    def less(self, other: Mix) -> Mix:
        """Without what another piece of code executes."""
        return other._plus(self, -1.0)

    def _plus(self, other: Mix, factor: float) -> Mix:
        """The other and so many times this."""
        return Mix(
            other.instructions + factor * self.instructions,
            other.flops + factor * self.flops,
            *(
                defaultdict(float, {width: theirs[width] + factor * own[width] for width in {*own, *theirs}})
                for own, theirs in zip(self._by_width, other._by_width, strict=True)
            ),
        )

    @property
    def _by_width(self) -> tuple[ByWidth, ByWidth, ByWidth]:
        return self.vector, self.divides, self.roots


def mix_of(executed: Iterable[tuple[str, str, float]]) -> Mix:
    """The sum over (mnemonic, operands, times)."""
    found = Mix()
    for mnemonic, operands, times in executed:
        found.add(mnemonic, operands, times)
    return found


def _moves_only(mnemonic: str, operands: str) -> bool:
    """Loads, stores, copies of registers: other units do them, or nobody."""
    if _PLAIN_MOVE.fullmatch(mnemonic):
        return True
    return _FROM_MEMORY.fullmatch(mnemonic) is not None and _MEMORY.search(operands) is not None
