"""A robot's functions for CasADi."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from krhpr.generated.python.runtime import Geometry


class CasadiFunctions:
    """A robot's kernels as casadi.Function, made on first use: `robot.casadi.inverse`."""

    def __init__(self, identifier: str, geometry: Geometry) -> None:
        try:
            self._module = import_module(f"krhpr.generated.casadi.{identifier}")
        except ModuleNotFoundError as error:
            if error.name != "casadi":
                raise
            raise ModuleNotFoundError(
                "CasADi is not installed: pip install 'krhpr[casadi]'", name="casadi"
            ) from None
        self._geometry = geometry
        self._made: dict[tuple[str, bool], Any] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The functions that exist in CasADi: kernels, not procedures."""
        return tuple(self._module.FUNCTIONS)

    def symbolic(self, name: str) -> Any:
        """A function with the geometry as its last input, a flat vector in the order of `Geometry.flat()`."""
        import casadi

        if (name, True) not in self._made:
            symbol = casadi.SX.sym("geometry", self._geometry.legs * len(self._module.FIELDS))
            self._made[name, True] = self._builder(name)(symbol)
        return self._made[name, True]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if (name, False) not in self._made:
            self._made[name, False] = self._builder(name)(tuple(self._geometry.flat()))
        return self._made[name, False]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.names]

    def _builder(self, name: str) -> Any:
        try:
            return self._module.FUNCTIONS[name]
        except KeyError:
            raise AttributeError(f"no CasADi function {name!r}; there are {', '.join(self.names)}") from None
