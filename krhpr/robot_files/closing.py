"""Whether a robot of these sizes can be put together at all: its loops are closed with the generated code."""

from __future__ import annotations

import math
import warnings
from types import ModuleType
from typing import Any

import numpy as np

from krhpr.robot_files.problems import Problem, RobotFileWarning, described
from krhpr.robot_files.reader import RobotFile

_LEGS = 3


def geometry_of(file: RobotFile, module: ModuleType) -> Any:
    """The file's sizes as the robot's geometry.

    Raises RobotFileError where they make a quantity of the derivation infinite, or where the robot does not
    close at the file's home pose; warns where no pose is found in which it closes.
    """
    geometry = module.DEFAULT_GEOMETRY.replace(**file.sizes)
    _finite(file, module, geometry)
    if "inverse_all" not in module.SIGNATURES:  # no closed form: nothing to tell without a pose nearby
        return geometry
    if file.home is not None:
        _closes_at_home(file, module, geometry)
    elif not _closes_somewhere(module, geometry):
        suspicion = Problem(
            file.lines.get("geometry", 0),
            "geometry",
            "no pose was found in which all three legs reach the platform; give a pose that you know: "
            "home: {p: [...], redundant: ...}",
        )
        warnings.warn(described(file.path, suspicion), RobotFileWarning, stacklevel=5)
    return geometry


def _finite(file: RobotFile, module: ModuleType, geometry: Any) -> None:
    with np.errstate(all="ignore"):
        prepared = module.prepare(geometry)
    for part in (prepared.subleg, prepared.platform):
        for values in vars(part).values():
            for value in values if isinstance(values, tuple) else (values,):
                bad = ~np.isfinite(np.broadcast_to(value, (_LEGS,)))
                if bad.any():
                    raise file.wrong(
                        "geometry",
                        f"with the sizes of leg {int(np.argmax(bad)) + 1} a quantity of the derivation is a "
                        "quotient by zero: the leg is degenerate; change one of its lengths",
                    )


def _inputs(module: ModuleType, function: str, p: Any, redundant: Any) -> list[Any]:
    """A function's arguments at a pose parallel to the base; swivels are zero."""
    given = {"p": p, "Q": np.eye(3), "phi": 0.0, "redundant": redundant, "swivel": np.zeros(_LEGS)}
    return [given[port.name] for port in module.SIGNATURES[function].inputs]


def _closes_at_home(file: RobotFile, module: ModuleType, geometry: Any) -> None:
    assert file.home is not None
    p, redundant = np.array(file.home.p), np.array(file.home.redundant)
    found = module.inverse_all(*_inputs(module, "inverse_all", p, redundant), geometry=geometry)
    open_legs = [leg for leg in range(_LEGS) if np.isnan(found[leg]).any(axis=-1).all()]
    if open_legs:
        ways = ", ".join(_missing(module, geometry, p, redundant, leg) for leg in open_legs)
        raise file.wrong(
            "home",
            f"the robot does not close there in any working mode: {ways}; change the sizes, the position "
            "or the redundant coordinates",
        )


def _missing(module: ModuleType, geometry: Any, p: Any, redundant: Any, leg: int) -> str:
    """By how much a leg fails to close in the mode in which it fails least."""
    if "inverse_status" not in module.SIGNATURES:
        return f"leg {leg + 1} cannot"
    arguments = [
        argument for argument in module.SIGNATURES["inverse_status"].inputs if argument.name != "mode"
    ]
    given = {"p": p, "Q": np.eye(3), "phi": 0.0, "redundant": redundant}
    takes_mode = len(arguments) < len(module.SIGNATURES["inverse_status"].inputs)
    least = math.inf
    for signs in module.MODES.values():
        more = {"mode": (signs,) * _LEGS} if takes_mode else {}
        excess = module.inverse_status(*(given[port.name] for port in arguments), **more, geometry=geometry)
        least = min(least, float(excess[leg])) if math.isfinite(excess[leg]) else least
    return f"leg {leg + 1} misses by {least:.3g} m" if 0 < least < math.inf else f"leg {leg + 1} cannot"


def _closes_somewhere(module: ModuleType, geometry: Any) -> bool:
    """Whether a coarse grid of poses has one in which all legs close in some mode."""
    positive = [np.abs(geometry.fields[name]).mean() for name in geometry.positive]
    size = max(2.0 * float(np.max(positive)), 1e-9)
    (port,) = (port for port in module.SIGNATURES["inverse_all"].inputs if port.name == "redundant")
    angles = np.radians(np.arange(-180.0, 180.0, 15.0))
    values = angles if port.unit == "rad" else size * np.linspace(-1.0, 1.0, 33)
    heights = size * np.linspace(-1.0, 1.0, 41)
    spatial = module.SIGNATURES["inverse_all"].inputs[0].shape == (3,)
    p = np.zeros((len(heights) if spatial else 1, 1, 3 if spatial else 2))
    if spatial:
        p[:, 0, 2] = heights
    redundant = np.broadcast_to(values[:, np.newaxis], (len(values), _LEGS))
    with np.errstate(all="ignore"):
        found = module.inverse_all(*_inputs(module, "inverse_all", p, redundant), geometry=geometry)
    closes = ~np.isnan(found).any(axis=-1)  # (heights, values, legs, modes)
    return bool(closes.any(axis=-1).all(axis=-1).any())
