"""A sub-leg from outside the project, with what a robot needs besides."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from krhpr.derivations.catalogue import PLATFORMS, Entry, Home, Sizes, entry
from krhpr.derivations.sublegs.base import SubLeg


@dataclass(frozen=True)
class Plugin:
    """A sub-leg of your own with default sizes.

    `sizes` has a value for each field of its geometry (metres and radians): one for all legs, or three.
    `home` is a pose at which robots with it can be assembled, for pictures and as the middle of random
    tests; the catalogue's unless given.  `title` and `source` (a paper, a section) are for people.
    """

    subleg: SubLeg
    sizes: Sizes
    home: Home | None = None
    title: str = ""
    source: str = ""

    def entries(self) -> tuple[Entry, ...]:
        """Robots with the sub-leg, in all arrangements of its space."""
        found = (
            entry(self.subleg, platform, {**self.sizes, **places}, self.home)
            for platform, places in PLATFORMS
            if platform.space is self.subleg.space
        )
        return tuple(self._told(one) for one in found)

    def _told(self, one: Entry) -> Entry:
        title = f"{self.title}, arrangement ({one.robot.platform.arrangement})" if self.title else one.title
        return Entry(one.robot, one.sizes, one.home, title, self.source or one.thesis)


def platform_sizes(plugin: Plugin) -> Mapping[str, object]:
    """The fields that the arrangements of its space have already."""
    return {
        name: value
        for platform, places in PLATFORMS
        if platform.space is plugin.subleg.space
        for name, value in places.items()
    }
