"""`krhpr info ROBOT`: what a robot is, and what each of its functions takes and gives."""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import krhpr
from krhpr.cli.common import Command, Exit, WrongUse
from krhpr.cli.plugin_option import (
    add_plugin_option,
    known_robots,
    own_robots,
    plugin_entries,
    refuse_unknown,
)
from krhpr.errors import nearest
from krhpr.robot_files.reader import is_robot_file

if TYPE_CHECKING:
    from krhpr.generated.python.runtime import Port, Signature
    from krhpr.limits import Limits
    from krhpr.robot import Robot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "robot", metavar="ROBOT", help="identifier, as `krhpr list` shows it, or a robot file"
    )
    parser.add_argument("--function", metavar="NAME", help="everything about one function")
    parser.add_argument(
        "--picture", metavar="FILE", help="draw the robot at its home pose instead: .png, .svg or .pdf"
    )
    parser.add_argument(
        "--mode", metavar="LABEL", help="with --picture: the working mode, default unless given"
    )
    add_plugin_option(parser)
    parser.add_argument("--json", action="store_true", help="print an object")


def run(options: argparse.Namespace) -> int:
    """Print what a robot, or one of its functions, is."""
    robot = find_robot(options.robot, options.plugin)
    if options.picture is not None:
        return _draw(robot, Path(options.picture), options.mode)
    if options.function is None:
        print(json.dumps(robot_facts(robot), indent=1) if options.json else _robot_text(robot, options.robot))
        return Exit.OK
    signature = find_signature(robot, options.function)
    if options.json:
        print(json.dumps(function_facts(signature), indent=1))
    else:
        print(_function_text(robot, signature, options.robot))
    return Exit.OK


def find_robot(name: str, plugins: Sequence[Path]) -> Robot:
    """A robot of the catalogue or of a file, or one with a sub-leg of one's own, on NumPy."""
    own = plugin_entries(plugins)
    if name in known_robots(own)[len(krhpr.catalogue()) :]:
        return own_robots(own, [name])[0]
    if own and not is_robot_file(name):
        refuse_unknown([name], known_robots(own))
    return krhpr.load(name, backend="numpy")


def _draw(robot: Robot, path: Path, mode: str | None) -> int:
    """Draw a picture; Matplotlib is needed for that alone."""
    try:
        import matplotlib
    except ModuleNotFoundError as error:
        raise WrongUse("a picture needs Matplotlib: pip install 'krhpr[plot]'") from error
    from krhpr.picture import FORMATS, save_picture

    if path.suffix.lower() not in FORMATS:
        raise WrongUse(f"{path}: a picture's name ends in one of {', '.join(FORMATS)}")
    matplotlib.use("Agg")
    save_picture(robot, path, mode)
    print(f"wrote {path}")
    return Exit.OK


def find_signature(robot: Robot, function: str) -> Signature:
    """A function's signature; a wrong name gives the nearest ones."""
    if function not in robot.functions:
        hint = nearest(function, robot.functions)
        raise WrongUse(f"{robot.identifier} has no function {function!r}; {hint}")
    return robot.signature(function)


# -- as data -------------------------------------------------------------------------------------------------


def robot_facts(robot: Robot) -> dict[str, Any]:
    """A robot as JSON values."""
    about = {topic: dict(rows) for topic, rows in robot.documentation.items()}
    return {
        "robot": robot.identifier,
        "name": robot.name,
        "notation": robot.notation,
        "title": robot.title,
        "thesis": about["sections"],
        "actuators": about["actuators"],
        "redundant_coordinate": about["redundant"],
        "passive_joints": passive_joints(robot),
        "working_modes": {
            "labels": robot.modes,
            "default": robot.default_mode,
            "choices": about["working mode"],
        },
        "assembly_modes": {"labels": robot.assemblies, "choices": about["assembly mode"]},
        "geometry": [
            {
                "field": name,
                "unit": about["units"][name],
                "meaning": meaning,
                "default": getattr(robot.geometry, name).tolist(),
            }
            for name, meaning in about["geometry"].items()
        ],
        "limits": limits_facts(robot.limits),
        "singular_factors": about["singular factors"],
        "type_2": about["type II"],
        "functions": [function_facts(robot.signature(name)) for name in robot.functions],
    }


def limits_facts(limits: Limits) -> dict[str, Any]:
    """Limits as JSON values, each for the three legs; only what is limited."""
    found: dict[str, Any] = {
        group: {name: [[leg.low, leg.high] for leg in legs] for name, legs in table.items()}
        for group, table in (("actuators", limits.actuators), ("passive", limits.passive))
        if table
    }
    if limits.spherical is not None:
        found["spherical"] = [
            {"tilt": cone.tilt, "socket": cone.socket, "stud": cone.stud} for cone in limits.spherical
        ]
    if limits.link_radii:
        found["link_radii"] = {name: list(legs) for name, legs in limits.link_radii.items()}
    if limits.clearance is not None:
        found["clearance"] = limits.clearance
    if limits.axis_distance is not None:
        found["axis_distance"] = limits.axis_distance
    if limits.elbow is not None:
        found["elbow"] = [limits.elbow.low, limits.elbow.high]
    return found


def passive_joints(robot: Robot) -> dict[str, str]:
    """Every passive joint with its meaning, from the base to the platform."""
    within = dict(robot.documentation["passive"])
    found: dict[str, str] = {}
    for port in robot.signature("passive_joints").outputs:
        found |= within if port.name == "passive" else {port.name: port.doc}
    return found


def function_facts(signature: Signature) -> dict[str, Any]:
    """A function as JSON values."""
    return {
        "function": signature.name,
        "meaning": signature.doc,
        "thesis": signature.equations,
        "arguments": [_port_facts(port) for port in signature.inputs],
        "results": [_port_facts(port) for port in signature.outputs],
        "gufunc": signature.gufunc,
    }


def _port_facts(port: Port) -> dict[str, Any]:
    return {
        "name": port.name,
        "shape": port.shape,
        "unit": port.unit,
        "frame": port.frame,
        "meaning": port.doc,
        "labels": port.labels,
    }


# -- as text -------------------------------------------------------------------------------------------------


def _robot_text(robot: Robot, source: str) -> str:
    facts = robot_facts(robot)
    parts = [(what, facts["thesis"][what]) for what in ("sub-leg", "platform")]
    sections = "; ".join(f"{what} {section}" for what, section in parts if section)
    own = f"{robot.name}: " if robot.name != robot.identifier else ""
    lines = [f"{own}{robot.identifier}  {robot.notation}"]
    lines += _wrapped(f"{robot.title} (thesis: {sections})", "")
    lines += _section("Actuated joints of a leg, with their zeros", facts["actuators"].items())
    lines += _section("Redundant coordinate of a leg", facts["redundant_coordinate"].items())
    lines += _section("Passive joints", facts["passive_joints"].items())
    lines += _section(
        "Geometry (for each leg; `with_geometry` and `--geometry` change it)",
        _geometry_rows(facts["geometry"]),
    )
    lines += _section("Limits", _limit_rows(robot.limits))
    modes = facts["working_modes"]
    lines += _section("Working modes of a leg (* is the default)", modes["choices"].items())
    lines += _wrapped("  ".join(label + "*" * (label == modes["default"]) for label in modes["labels"]), "  ")
    if robot.assemblies:
        lines += _section("Assembly modes of a leg's closed loop", facts["assembly_modes"]["choices"].items())
        lines += _wrapped("  ".join(robot.assemblies), "  ")
    lines += _section("Factors of det M_i, zero in a type I singularity", facts["singular_factors"].items())
    lines += _section("Factors of det J, zero in a type II singularity", facts["type_2"].items())
    rows = [(name, _call_text(robot.signature(name))) for name in robot.functions]
    lines += _section(f"Functions (krhpr info {source} --function NAME)", rows)
    return "\n".join(lines)


def _geometry_rows(fields: Iterable[dict[str, Any]]) -> list[tuple[str, str]]:
    rows = []
    for field in fields:
        values = field["default"]
        alike = all(value == values[0] for value in values)
        shown = f"{values[0]:.6g}" if alike else "(" + ", ".join(f"{value:.6g}" for value in values) + ")"
        rows.append((f"{field['field']} = {shown} {field['unit']}", field["meaning"]))
    return rows


def _limit_rows(limits: Limits) -> list[tuple[str, str]]:
    def text(legs: Iterable[Any], show: Callable[[Any], str]) -> str:
        shown = [show(leg) for leg in legs]
        return shown[0] if len(set(shown)) == 1 else ", ".join(shown)

    rows = [
        (name, text(legs, lambda leg: f"{leg.low:.6g} to {leg.high:.6g}"))
        for table in (limits.actuators, limits.passive)
        for name, legs in table.items()
    ]
    if limits.spherical is not None:
        rows.append(
            ("spherical", "tilt of at most " + text(limits.spherical, lambda cone: f"{cone.tilt:.6g}"))
        )
    rows += [
        (f"radius of {name}", text(legs, lambda leg: f"{leg:.6g}"))
        for name, legs in limits.link_radii.items()
    ]
    if limits.clearance is not None:
        rows.append(("clearance", f"{limits.clearance:.6g}"))
    if limits.axis_distance is not None:
        rows.append(("axis_distance", f"{limits.axis_distance:.6g}"))
    if limits.elbow is not None:
        rows.append(("elbow", f"{limits.elbow.low:.6g} to {limits.elbow.high:.6g}"))
    return rows


def _function_text(robot: Robot, signature: Signature, source: str) -> str:
    lines = [f"robot.{signature.name}: {_call_text(signature)}", *_wrapped(signature.doc, "")]
    if signature.equations:
        lines.append(f"Thesis: {signature.equations}.")
    lines += _section("Arguments", [(_port_head(port), _port_tail(port)) for port in signature.inputs])
    lines += _section("Results", [(_port_head(port), _port_tail(port)) for port in signature.outputs])
    choices = [
        (port.name, ", ".join(labels))
        for port, labels in (
            (port, {"mode": robot.modes, "assembly": robot.assemblies}.get(port.name))
            for port in signature.inputs
        )
        if labels
    ]
    if choices:
        lines += _section("Labels that may stand for signs", choices)
    columns = " ".join(name for port in signature.inputs for name in _some_columns(port))
    places = [
        ("Python", f"krhpr.load({source!r}).{_method(signature.name)}"),
        ("C", f"krhpr_{robot.name}_{signature.name} and ..._batch in krhpr_{robot.name}.h"),
        ("command line", f"krhpr eval {source} {signature.name}"),
        ("columns", columns),
    ]
    lines += _section("Where", places)
    return "\n".join(lines)


def _method(function: str) -> str:
    return "inverse(..., near=theta_near)" if function == "inverse_near" else f"{function}(...)"


def _some_columns(port: Port) -> list[str]:
    from krhpr.cli.columns import column_names

    names = column_names(port)
    return names if len(names) < 4 else [names[0], "...", names[-1]]


def _call_text(signature: Signature) -> str:
    inputs = ", ".join(port.name for port in signature.inputs)
    return f"{inputs} -> {', '.join(port.name for port in signature.outputs)}"


def _port_head(port: Port) -> str:
    shape = ", ".join(["...", *map(str, port.shape)])
    return f"{port.name} ({shape})"


def _port_tail(port: Port) -> str:
    facts = [
        fact
        for fact in (
            port.unit if port.unit != "1" else "",
            f"{port.frame} frame" if port.frame != "-" else "",
        )
        if fact
    ]
    text = port.doc + (f" ({', '.join(facts)})" if facts else "")
    return text + (f" [{', '.join(port.labels)}]" if port.labels else "")


def _section(title: str, rows: Iterable[tuple[str, str]]) -> list[str]:
    rows = list(rows)
    if not rows:
        return []
    width = min(max(len(name) for name, _ in rows), 50)
    lines = ["", title]
    for name, text in rows:
        lines += _wrapped(text, " " * (width + 4), f"  {name.ljust(width)}  ")
    return lines


def _wrapped(text: str, indent: str, first: str | None = None) -> list[str]:
    width = min(shutil.get_terminal_size().columns, 110) if sys.stdout.isatty() else 110
    start = indent if first is None else first
    return textwrap.wrap(
        text or "-",
        max(width, len(indent) + 30),
        initial_indent=start,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


COMMAND = Command(
    "info",
    "Show what a robot is.  Joints and their zeros, geometry, modes, singularities, functions.",
    "examples:\n  krhpr info spatial_rrr_a\n  krhpr info spatial_rrr_a --function inverse\n"
    "  krhpr info spatial_delta_a --picture delta.svg\n  krhpr info spatial_rrr_a --json",
    add_arguments,
    run,
)
