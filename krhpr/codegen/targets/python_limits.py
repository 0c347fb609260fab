"""Limits as Python text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from krhpr.limits import Limits


def python_limits(limits: Limits) -> str:
    """An expression that makes limits again in a module that imports `limits.py`."""
    lines = ["Limits("]
    for name in ("actuators", "passive", "link_radii"):
        table: Mapping[str, Any] = getattr(limits, name)
        if table:
            rows = [f'        "{entry}": {value!r},' for entry, value in table.items()]
            lines += [f"    {name}={{", *rows, "    },"]
    if limits.spherical is not None:
        lines.append(f"    spherical={limits.spherical!r},")
    if limits.clearance is not None:
        lines.append(f"    clearance={limits.clearance!r},")
    if limits.axis_distance is not None:
        lines.append(f"    axis_distance={limits.axis_distance!r},")
    if limits.elbow is not None:
        lines.append(f"    elbow={limits.elbow!r},")
    return "\n".join([*lines, ")"])
