"""What a `Plugin` must be before anything is derived from it, told in the author's terms."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from krhpr.codegen.kernel import LEGS, GeometryType
from krhpr.derivations.catalogue import SUBLEGS, Home
from krhpr.derivations.plugin import Plugin, platform_sizes
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.derivations.terms import Joint, Link, Sign, Space
from krhpr.errors import PluginError, nearest
from krhpr.plugins.traces import told

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")

_ATTRIBUTES: dict[str, tuple[Any, str]] = {
    "name": (str, "what robots are called after, such as 'offset_wrist'"),
    "space": (Space, "Space.SPATIAL or Space.PLANAR"),
    "notation": (str, "joints in the thesis' style, such as 'RRR'"),
    "section": (str, "where it is described, '-' for nowhere"),
    "doc": (str, "one sentence"),
    "actuators": (tuple, "a tuple of Joint"),
}

Result = TypeVar("Result")


def check(candidate: object, source: str) -> Plugin:
    """The plugin, when everything that can be told without deriving robots is right.

    Raises PluginError with the source, what was found and what is expected.
    """
    if not isinstance(candidate, Plugin):
        raise PluginError(
            f"{source}: PLUGIN is {_kind(candidate)}; expected Plugin(YourSubLeg(), sizes=...) of "
            "krhpr.derivations.api"
        )
    _Checker(candidate, source).all()
    return candidate


def _kind(value: object) -> str:
    return f"the class {value.__name__}" if isinstance(value, type) else f"a {type(value).__name__}"


class _Checker:
    def __init__(self, plugin: Plugin, source: str) -> None:
        self.plugin, self.subleg, self.source = plugin, plugin.subleg, source

    def all(self) -> None:
        if not isinstance(self.subleg, SubLeg):
            made = " (write it with parentheses)" if isinstance(self.subleg, type) else ""
            self._fail(f"the sub-leg is {_kind(self.subleg)}{made}; expected an instance of a SubLeg")
        self._attributes()
        self._name()
        self._members("actuators", Joint)
        self._members("passive_joints", Joint)
        self._members("inverse_signs", Sign)
        self._members("forward_signs", Sign)
        self._members("links", Link)
        self._branches()
        if self.subleg.redundant and not self.subleg.has_inverse:
            self._fail(
                "it has a swivel and no `inverse`; Newton steps do not choose a swivel, so state `inverse`"
            )
        geometry = self._stated("geometry", self.subleg.geometry)
        self._geometry(geometry)
        self._sizes(geometry)
        self._home()
        self._stated("kernels", self.subleg.kernels)
        self._stated("closure", self.subleg.closure_kernel)
        self._places()

    def _fail(self, message: str, cause: BaseException | None = None) -> Any:
        name = getattr(self.subleg, "name", None)
        raise PluginError(
            f"{self.source}{f': {name}' if isinstance(name, str) else ''}: {message}"
        ) from cause

    def _stated(self, what: str, make: Callable[[], Result]) -> Result:
        """What the author's code makes; its errors with the line of the author's file."""
        try:
            return make()
        except Exception as error:
            raise PluginError(told(error, self.source, f"the {what} are derived")) from error

    # -- what it is ------------------------------------------------------------------------------------------

    def _attributes(self) -> None:
        for name, (kind, meaning) in _ATTRIBUTES.items():
            if not hasattr(self.subleg, name):
                self._fail(f"the class has no attribute `{name}`; it is {meaning}")
            value = getattr(self.subleg, name)
            if not isinstance(value, kind):
                self._fail(f"`{name}` is {value!r}; expected {meaning}")

    def _name(self) -> None:
        name = self.subleg.name
        if not _NAME.fullmatch(name):
            self._fail(f"`name` is {name!r}; expected lower-case letters, digits and single underscores")
        taken = [subleg.name for subleg, _ in SUBLEGS if subleg.space is self.subleg.space]
        if name in taken:
            self._fail(f"the catalogue has a {self.subleg.space} sub-leg of this name; choose another")

    def _members(self, attribute: str, kind: type) -> None:
        members = getattr(self.subleg, attribute)
        for number, member in enumerate(members):
            if not isinstance(member, kind):
                self._fail(f"`{attribute}[{number}]` is {_kind(member)}; expected a {kind.__name__}")
        if attribute == "actuators" and not members:
            self._fail("`actuators` is empty; expected a Joint for each actuated joint")
        names = [member.name for member in members]
        twice = [name for name in names if names.count(name) > 1]
        if twice and kind is not Link:
            self._fail(f"`{attribute}` has {twice[0]!r} twice; names tell them apart")

    def _branches(self) -> None:
        for attribute, modes in (
            ("default_mode", self.subleg.modes),
            ("default_assembly", self.subleg.assemblies),
        ):
            labels = [mode.label for mode in modes]
            value = getattr(self.subleg, attribute)
            if value not in labels:
                self._fail(f"`{attribute}` is {value!r}; its signs make the labels {', '.join(labels)}")

    # -- sizes and home --------------------------------------------------------------------------------------

    def _geometry(self, geometry: object) -> None:
        if not isinstance(geometry, GeometryType):
            self._fail(
                f"`geometry` returns {_kind(geometry)}; leg_frame_geometry and planar_geometry make one"
            )
            return
        prefix = "" if self.subleg.space is Space.SPATIAL else "planar_"
        expected = f"subleg_{prefix}{self.subleg.name}"
        if geometry.name != expected:
            self._fail(
                f"`geometry` is called {geometry.name!r}; code is named after it, so call it {expected!r}"
            )
        both = [field.name for field in geometry.fields if field.name in platform_sizes(self.plugin)]
        if both:
            self._fail(f"`geometry` has a field {both[0]!r}, and so have the platforms; rename it")

    def _sizes(self, geometry: GeometryType) -> None:
        fields = {field.name: field for field in geometry.fields}
        for name in self.plugin.sizes:
            if name not in fields:
                self._fail(f"`sizes` has {name!r}, which `geometry` has not; {nearest(name, list(fields))}")
        missing = [name for name in fields if name not in self.plugin.sizes]
        if missing:
            self._fail(f"`sizes` lacks {', '.join(missing)}: a value in metres or radians for each field")
        for name, value in self.plugin.sizes.items():
            for number in self._three(f"sizes[{name!r}]", value):
                if fields[name].positive and number <= 0:
                    self._fail(f"`sizes[{name!r}]` is {number:g}; the field is declared positive")

    def _three(self, what: str, value: object) -> Iterator[float]:
        values = value if isinstance(value, tuple) else (value,) * LEGS
        numbers = [x for x in values if isinstance(x, int | float)]
        if len(values) != LEGS or len(numbers) != LEGS:
            self._fail(f"`{what}` is {value!r}; expected a number, or a tuple of three")
        for number in numbers:
            if not math.isfinite(number):
                self._fail(f"`{what}` is {number}; it must be finite")
            yield float(number)

    def _home(self) -> None:
        home = self.plugin.home
        if home is None:
            return
        if not isinstance(home, Home) or len(home.p) != self.subleg.space.dimension:
            p = ("x", "y", "z")[: self.subleg.space.dimension]
            self._fail(f"`home` is {home!r}; expected Home(p=({', '.join(p)}), redundant=(three numbers))")

    # -- points and links ------------------------------------------------------------------------------------

    def _places(self) -> None:
        names = self._stated("points", self.subleg.points_port).labels
        if not names or names[-1] != "S":
            self._fail(f"`points` names {', '.join(names) or 'nothing'}; the last must be S, the end point")
        for link in self.subleg.links:
            for end in (link.start, link.end):
                if end not in names:
                    self._fail(
                        f"link {link.name!r} ends at {end!r}, no name of `points`; {nearest(end, names)}"
                    )
        places = self.subleg.actuated_at
        if places and len(places) != len(self.subleg.actuators):
            self._fail(
                f"`actuated_at` names {len(places)} places for {len(self.subleg.actuators)} actuators; "
                "give one for each, or none"
            )
        known = [*names, *(link.name for link in self.subleg.links)]
        for place in places:
            if place not in known:
                self._fail(
                    f"`actuated_at` names {place!r}, neither a point nor a link; {nearest(place, known)}"
                )
