"""What a robot is: its names, sizes, legs, branches and functions, as its generated module states them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from krhpr.generated.python.runtime import LEGS, Geometry, Signature
from krhpr.limits import Limits


class Home(NamedTuple):
    """A pose with its redundant coordinates, in the order in which functions take them."""

    p: tuple[float, ...]
    orientation: Any
    """Q, or phi for a planar robot."""
    redundant: tuple[float, float, float]


class Described:
    """A generated module with a geometry."""

    def __init__(
        self,
        module: ModuleType,
        geometry: Geometry | None = None,
        *,
        name: str | None = None,
        limits: Limits | None = None,
        home: tuple[Sequence[float], Sequence[float]] | None = None,
    ) -> None:
        self._module = module
        self.name: str = self.identifier if name is None else name
        """What it is called: the name in its robot file, else the catalogue's identifier."""
        self.limits: Limits = Limits() if limits is None else limits
        """Limits of joints and links that its robot file gives; nothing is held to them by itself."""
        self._own_home = home
        self.geometry: Geometry = module.DEFAULT_GEOMETRY if geometry is None else geometry

    def __repr__(self) -> str:
        own = "" if self.name == self.identifier else f"{self.name}, "
        return f"<Robot {own}{self.identifier} {self.notation}: {self.title}>"

    @property
    def identifier(self) -> str:
        """The catalogue's name, `spatial_rrr_a`."""
        return str(self._module.IDENTIFIER)

    @property
    def notation(self) -> str:
        """The thesis' notation, `3-RRRSR`."""
        return str(self._module.NOTATION)

    @property
    def title(self) -> str:
        """What it is, in a few words."""
        return str(self._module.TITLE)

    @property
    def legs(self) -> int:
        """How many legs it has: three, or the two sub-legs of a grasping robot."""
        return int(getattr(self._module, "LEGS", LEGS))

    @property
    def planar(self) -> bool:
        """Whether it moves in the plane (p, phi) or in space (p, Q)."""
        return self.identifier.startswith("planar")

    @property
    def home(self) -> Home:
        """Its home pose: `robot.inverse(*robot.home)`.

        That of its robot file, else the catalogue's, which is chosen for the default sizes.
        """
        p, redundant = self._own_home or (self._module.HOME_P, self._module.HOME_REDUNDANT)
        first, second, third = redundant
        return Home(tuple(p), 0.0 if self.planar else np.eye(3), (first, second, third))

    @property
    def degrees_of_freedom(self) -> tuple[int, int]:
        """Those of the platform, and the redundant ones: (6, 3)."""
        freedom = dict(self.documentation["freedom"])
        return int(freedom["platform"]), int(freedom["redundancy"])

    @property
    def modes(self) -> tuple[str, ...]:
        """Labels of the working modes, in the order of `inverse_all`."""
        return tuple(self._module.MODES)

    @property
    def default_mode(self) -> str:
        """The working mode that `inverse` uses unless another is given."""
        return str(self._module.DEFAULT_MODE)

    @property
    def assemblies(self) -> tuple[str, ...]:
        """Labels of the sub-legs' assembly modes (empty for serial sub-legs)."""
        return tuple(self._module.ASSEMBLIES)

    @property
    def links(self) -> tuple[tuple[str, str, str, str], ...]:
        """The straight links of a leg: name, kind, and the two points of `link_points` that each joins."""
        return self._module.LINKS  # type: ignore[no-any-return]

    @property
    def link_pairs(self) -> tuple[tuple[int, int, int, int], ...]:
        """The ends of every two links that no joint joins, in the order of `clearances`: points by number,
        those of `link_points` leg by leg, then where redundant links meet the platform; empty for planar
        robots.
        """
        return getattr(self._module, "LINK_PAIRS", ())

    @property
    def redundant_link(self) -> str:
        """The field with the length of the redundant link from S_i to its attachment; empty where they
        coincide.
        """
        return str(self._module.REDUNDANT_LINK)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of all functions."""
        return tuple(self._module.SIGNATURES)

    @property
    def documentation(self) -> Mapping[str, tuple[tuple[str, str], ...]]:
        """Geometry, joints, modes, singular factors, margins, sections of the thesis: names with their
        meanings.
        """
        return self._module.DOCUMENTATION  # type: ignore[no-any-return]

    @property
    def angular(self) -> tuple[bool, ...]:
        """Whether each actuator of a leg turns; the others slide."""
        return tuple(self._module.ANGULAR)

    def signature(self, function: str) -> Signature:
        """Arguments and results of a function: names, shapes, units, frames, meanings."""
        if function not in self._module.SIGNATURES:
            raise self._unknown(function)
        return self._module.SIGNATURES[function]  # type: ignore[no-any-return]

    @property
    def redundant_legs(self) -> bool:
        """Whether its sub-legs have a swivel: one more actuator than their end point has coordinates."""
        return "swivel" in self.functions

    def _unknown(self, function: str) -> AttributeError:
        return AttributeError(
            f"{self.identifier} has no function {function!r}; it has {', '.join(self.functions)}"
        )
