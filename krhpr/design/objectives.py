"""What a design is judged by."""

from __future__ import annotations

from enum import StrEnum


class Objective(StrEnum):
    """A number for each design; the value is its name."""

    VOLUME = "volume"
    """Of the positions in the home orientation that are connected with the home pose (m^3)."""
    ORIENTATIONS = "orientations"
    """The share of all orientations, at the home position, that are connected with the home pose."""
    BOX = "box"
    """Edge of the largest cube of positions (m): proven where the sub-leg allows it, else checked."""
    ETA_1 = "eta_1"
    ETA_2 = "eta_2"
    ETA_3 = "eta_3"
    """The largest value of the index at any node of both workspaces (m, 1, 1)."""
    LENGTH = "length"
    """Of all links of the three legs and of the redundant links (m)."""

    @property
    def more_is_better(self) -> bool:
        """Whether it is to be as large as possible, and not as small."""
        return self in (Objective.VOLUME, Objective.ORIENTATIONS, Objective.BOX)

    @property
    def unit(self) -> str:
        """Its unit."""
        return {
            Objective.VOLUME: "m^3",
            Objective.BOX: "m",
            Objective.ETA_1: "m",
            Objective.LENGTH: "m",
        }.get(self, "1")

    @property
    def words(self) -> str:
        """What it is, for tables and pictures."""
        return {
            Objective.VOLUME: "volume of positions",
            Objective.ORIENTATIONS: "share of orientations",
            Objective.BOX: "edge of the cube",
            Objective.ETA_1: "largest eta_1",
            Objective.ETA_2: "largest eta_2",
            Objective.ETA_3: "largest eta_3",
            Objective.LENGTH: "length of links",
        }[self]
