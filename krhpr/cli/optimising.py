"""What `krhpr optimise` does: read, solve, print, write."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import krhpr
from krhpr.cli.common import Exit, WrongUse, progress
from krhpr.trajectory import optimise
from krhpr.trajectory.compiled import Evaluation
from krhpr.trajectory.files import read_request
from krhpr.trajectory.plot import save_plot
from krhpr.trajectory.results import about, save


def run(options: argparse.Namespace) -> int:
    """One trajectory."""
    if options.plot and options.out is None:
        raise WrongUse("--plot takes --out NAME, which says where the picture goes")
    robot = krhpr.load(options.robot)
    slides = robot.signature("end_points").inputs[2].unit != "rad"
    request = read_request(options.path, planar=robot.planar, slides=slides)
    with progress(None) as step:
        found = optimise(
            robot,
            request.path,
            request.objective,
            request.bounds,
            method=options.method or request.method,
            mode=options.mode,
            intervals=request.intervals,
            horizon=request.horizon if options.horizon is None else options.horizon,
            progress=step,
            evaluation=Evaluation.COMPILED if options.compile else Evaluation.SX,
        )
    written: list[Path] = []
    if options.out is not None:
        written = save(found, options.out)
        if options.plot:
            written.append(save_plot(found, options.out.with_name(options.out.name + ".png")))
    if options.json:
        print(json.dumps({**about(found), "files": [str(path) for path in written]}, indent=1))
    else:
        print(found.report())
        for path in written:
            print(path)
    return Exit.OK if found.feasible else Exit.DIFFERENCE
