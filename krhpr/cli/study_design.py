"""What `krhpr study design` does: the families of Section 4.2, a search of designs, print, write."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import krhpr
from krhpr.cli.common import Column, Step, WrongUse, print_table, progress
from krhpr.cli.studying import tell, write
from krhpr.design import Evaluation, Grid, Objective
from krhpr.study.design import (
    EFFORT,
    OBJECTIVES,
    DesignStudy,
    design_study,
    objectives_from,
    problem_of,
    variables_from,
)
from krhpr.study.design_pictures import enlargement_figures, front_figure
from krhpr.study.enlargement import ALL, CASES, FREE, REACH, ROBOT, Enlargement, Slice, enlargement

TENTHS = 20
"""Progress of the search is told so often."""
RAYS = 360


def run(options: argparse.Namespace) -> int:
    """The design study."""
    for name in ("coarser", "generations"):
        if getattr(options, name) < 1:
            raise WrongUse(f"--{name} is {getattr(options, name)}; it must be 1 or more")
    if options.seed < 0:
        raise WrongUse(f"--seed is {options.seed}; it must be 0 or more")
    robot = krhpr.load(options.robot or ROBOT)
    variables = () if options.vary is None else variables_from(options.vary)
    objectives = OBJECTIVES if options.objectives is None else objectives_from(options.objectives)
    problem = problem_of(robot, variables, objectives, Grid().coarser(options.coarser))
    section = None
    with progress(None) as step:
        if options.robot in (None, ROBOT):
            rays = max(60, RAYS // options.coarser)
            section = enlargement(rays=rays, coarser=min(options.coarser, 3), progress=_parts(step))
        found = design_study(
            problem,
            replace(EFFORT, generations=options.generations, seed=options.seed),
            workers=options.workers,
            log=None if options.store is None else options.store / f"{robot.name}.jsonl",
            progress=_parts(step),
        )
    files = found.write(options.out / "designs")
    written = write(options.out, "design", _facts(section, found), lambda: _figures(section, found))
    if section is not None:
        _print_section(section)
    _print_designs(found)
    code = tell(() if section is None else section.claims())
    print(", ".join(map(str, [*written, *files])))
    return code


def _parts(step: Step) -> Callable[[str, int, int], None]:
    """Tells a step whenever another part of the search is there."""
    told: set[int] = set()

    def tell_one(name: str, done: int, of: int) -> None:
        few = of <= TENTHS
        at = TENTHS * done // max(of, 1)
        if few or at not in told:
            told.add(at)
            step(f"{name}: {done} of {of}")

    return tell_one


def _figures(section: Enlargement | None, found: DesignStudy) -> dict[str, object]:
    marked = {"the robot itself": found.own.design} if found.own.design.works else {}
    marked |= {one.name: one.design for one in found.chosen}
    figures = front_figure(found.found.designs, found.problem.objectives, marked)
    return figures if section is None else {**enlargement_figures(section), **figures}


def _print_section(found: Enlargement) -> None:
    columns = [Column("Section 4.2", whole=True), Column("limits", whole=True)]
    columns += [Column(title, numeric=True) for title in ("x (mm)", "tilt (deg)", "layer (m^2)")]
    rows = []
    for case in CASES:
        for reading in (ALL, FREE, REACH):
            one = found.found[case.name, reading]
            ends = one.along_x.values[[0, -1]]
            layers = one.areas()[0]
            rows.append(
                (
                    f"{case.name}, {ends[0] / case.unit:.0f} to {ends[1] / case.unit:.0f}",
                    reading,
                    " to ".join(f"{1e3 * one.along_x.at(value):.0f}" for value in ends),
                    " to ".join(f"{np.degrees(one.tilt.at(value)):.0f}" for value in ends),
                    f"{layers[0]:.3f} to {layers[-1]:.3f}",
                )
            )
    print_table(columns, rows)
    print()


def _print_designs(found: DesignStudy) -> None:
    space = found.problem.space
    columns = [Column("design", whole=True)]
    columns += [Column(f"{one.value} ({one.unit})".removesuffix(" (1)"), numeric=True) for one in Objective]
    columns += [Column(name, numeric=True) for name in space.names]
    rows = []
    for one in (found.own, *found.chosen):
        numbers = [f"{one.finer.results[name]:.4g}" if one.finer.works else "-" for name in Objective]
        rows.append((one.name.replace("_", " "), *numbers, *(f"{value:.4g}" for value in one.design.values)))
    print_table(columns, rows)
    works = sum(one.works for one in found.found.designs)
    print(
        f"{len(found.found.designs)} designs, {works} of which can be at home; "
        f"{len(found.found.front)} on the front; the table is that of finer grids"
    )
    if not found.own.design.works:
        print(f"the robot itself: {found.own.design.reason}")
    if not all(one.finer.proven for one in found.chosen):
        print("cubes are checked at the nodes of the grid alone: for such legs or limits there is no proof")
    if any(one.finer.cut for one in found.chosen):
        print("a workspace reaches the end of the grid, and is larger than is counted")


def _facts(section: Enlargement | None, found: DesignStudy) -> dict[str, object]:
    facts: dict[str, object] = {"settings": found.problem.settings()}
    if section is not None:
        facts["section_4_2"] = [
            {
                "case": name,
                "limits": reading,
                "along_x_m": _slice(one.along_x),
                "tilt_rad": _slice(one.tilt),
                "layers_m2": _plain(one.areas()[0]),
                "tilts_rad2": _plain(one.areas()[1]),
            }
            for (name, reading), one in section.found.items()
        ]
    facts["best"] = {
        one.name: {"design": one.design.as_json(), "finer": one.finer.as_json()}
        for one in (found.own, *found.chosen)
    }
    facts["front"] = [one.as_json() for one in found.found.front]
    facts["designs"] = [_short(one) for one in found.found.designs if one.works]
    return facts


def _short(one: Evaluation) -> dict[str, object]:
    return {"values": list(one.values), **{str(name): value for name, value in one.results.items()}}


def _slice(of: Slice) -> dict[str, object]:
    return {
        "values": of.values.tolist(),
        "boundary": _plain(of.boundary),
        "eta": [_plain(row) for row in of.eta],
        "stops": list(of.stops),
    }


def _plain(values: np.ndarray) -> list[float | None]:
    """Numbers as JSON has them: no NaN."""
    return [None if np.isnan(x) else float(x) for x in values]
