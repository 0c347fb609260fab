"""Statements of a function as the C templates see them: calls, iterations, loops over roots and pairs."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.codegen.composition import Only


@dataclass(frozen=True)
class Statement:
    """A statement, for the platform or a leg: a kernel's call, maybe in an iteration or a loop."""

    text: str
    iteration: Iteration | None = None
    at_roots: AtRoots | None = None
    at_pairs: AtPairs | None = None


@dataclass(frozen=True)
class Iteration:
    """A bounded iteration: the state, where it begins and ends, its angles, and when it stops."""

    state: str
    size: int
    start: str
    result: str
    change: str
    tolerance: str
    limit: int
    angle_call: str
    angle_count: int


@dataclass(frozen=True)
class Row:
    """What a kernel gives at a root: its name, where solutions are collected, and the elements of one."""

    name: str
    target: str
    size: int


@dataclass(frozen=True)
class AtRoots:
    """A kernel called at every root of a polynomial: its call, what is collected, and its arctangents."""

    call: str
    polynomial: str
    degree: int
    error: str
    root: str
    miss: str
    tolerance: str
    order: str
    order_at: str
    count: str
    doubtful: str
    found: str
    only: Only | None
    certificate_size: int
    rows: tuple[Row, ...]
    """What the kernel gives."""
    copies: tuple[Row, ...]
    """What of it is an output."""
    tail_count: int
    tail_stores: tuple[tuple[str, str], ...]
    spreads: tuple[tuple[str, str, int], ...] | None
    """Where roots go side by side, what is the same for all of them: name, array, elements."""


@dataclass(frozen=True)
class AtPairs:
    """A kernel called for every pair of links: how many, their ends by number, and the points of the ends."""

    count: int
    ends: int
    """Of one pair."""
    table: tuple[str, ...]
    """Lines of numbers: for each end the first of its three elements."""
    real: str
    size: int
    """Elements of all points."""
    places: tuple[tuple[str, int, int], ...]
    """Variables with the points: name, where the first goes, how many elements."""
