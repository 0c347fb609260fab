"""Working and assembly modes as users give them: labels, a label for each leg, or signs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from krhpr.description import Described
from krhpr.errors import UnknownBranch

Branch = str | Sequence[str] | ArrayLike
"""A working or assembly mode: its label, a label for each leg, or signs of shape (..., 3, signs)."""


class Branches(Described):
    """Turns the branch that a caller asks for into the arguments of a function."""

    def mode_signs(self, mode: Branch | None = None) -> np.ndarray[Any, Any]:
        """Signs (..., 3, signs) of a working mode given as `inverse` takes it; the default one unless
        given.
        """
        return self._signs(mode, self._module.MODES, self._module.DEFAULT_MODE, "a working mode")

    def assembly_signs(self, assembly: Branch | None = None) -> np.ndarray[Any, Any]:
        """Signs (..., 3, signs) of an assembly mode given as `subleg_forward` takes it; the default one
        unless given.
        """
        if not self.assemblies:
            raise UnknownBranch(
                f"{self.identifier}: no assembly modes of its sub-legs are told apart by signs"
            )
        return self._signs(
            assembly, self._module.ASSEMBLIES, self._module.DEFAULT_ASSEMBLY, "an assembly mode"
        )

    def _signs(
        self, branch: Branch | None, table: Mapping[str, Sequence[int]], default: str, what: str
    ) -> np.ndarray[Any, Any]:
        """Signs (..., legs, k) of a branch given as a label, a label for each leg, or signs."""
        one = default if branch is None else branch
        labels = [one] * self.legs if isinstance(one, str) else one
        if isinstance(labels, (list, tuple)) and all(isinstance(label, str) for label in labels):
            unknown = [label for label in labels if label not in table]
            if unknown or len(labels) != self.legs:
                raise UnknownBranch(
                    f"{self.identifier}: {branch!r} is not {what}; give one of {', '.join(table)}, or one "
                    f"for each of the {('two', 'three')[self.legs - 2]} legs"
                )
            return np.array([table[str(label)] for label in labels], dtype=float)
        signs = np.asarray(branch, dtype=float)
        others = np.unique(signs[~np.isin(signs, (-1.0, 1.0))])
        if others.size:
            got = ", ".join(f"{value:g}" for value in others[:3])
            raise UnknownBranch(f"{self.identifier}: the signs of {what} are +1 or -1, got {got}")
        return signs

    def _takes(self, function: str, argument: str) -> bool:
        return any(port.name == argument for port in self.signature(function).inputs)

    def _assembly_choice(
        self, function: str, assembly: Branch | None, near: ArrayLike | None
    ) -> tuple[Any, ...]:
        """The argument that chooses the sub-legs' assembly modes, where they have several."""
        if self._takes(function, "s_near"):
            if near is None or assembly is not None:
                raise UnknownBranch(
                    f"{self.identifier}.{function}: the assembly mode of its sub-legs is chosen "
                    "by a point near "
                    "each end point: near=... of shape (..., 3, 3)"
                )
            return (near,)
        if near is not None:
            raise UnknownBranch(f"{self.identifier}.{function} takes no point near the end points")
        if self.assemblies or assembly is not None:
            return (self.assembly_signs(assembly),)
        return ()

    def _mode_input(self, function: str, mode: Branch | None) -> list[Any]:
        """The signs of a working mode, where the robot's sub-legs have more than one."""
        signs = self.mode_signs(mode)
        return [signs] if self._takes(function, "mode") else []

    def _swivels(self, function: str, given: ArrayLike | None, name: str = "swivel") -> list[Any]:
        """An argument that redundant sub-legs alone take; zero unless given."""
        if self._takes(function, name):
            return [self._per_leg(0.0 if given is None else given)]
        if given is not None:
            raise UnknownBranch(
                f"{self.identifier}.{function}: its sub-legs are not redundant and take no {name}"
            )
        return []

    def _per_leg(self, values: ArrayLike) -> Any:
        array = np.asarray(values, dtype=float)
        return np.broadcast_to(array, (self.legs,)) if array.ndim == 0 else array
