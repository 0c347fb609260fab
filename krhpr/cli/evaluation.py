"""What `krhpr eval` does: numbers in, numbers out."""

from __future__ import annotations

import argparse
import csv
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import krhpr
from krhpr.cli.columns import all_columns
from krhpr.cli.common import Exit, WrongUse
from krhpr.cli.info import find_signature
from krhpr.cli.reading import Given, LabelRows, read_arguments, read_source, split_labels
from krhpr.errors import InvalidInput, UnknownBranch, nearest

if TYPE_CHECKING:
    from krhpr.generated.python.runtime import Signature
    from krhpr.robot import Robot

_ZERO_UNLESS_GIVEN = {
    ("joint_rates", "redundant_rates"),
    ("joint_rates", "swivel_rates"),
    ("inverse_statics", "redundant_forces"),
    ("inverse_statics", "swivel_forces"),
    ("opening", "jaws"),
    ("redundant_of_opening", "centre"),
    ("redundant_of_opening", "jaws"),
    ("grasp", "weight"),
    ("grasp", "mass_centre"),
    ("joint_accelerations", "redundant_accelerations"),
    ("joint_accelerations", "swivel_accelerations"),
}


def run(options: argparse.Namespace) -> int:
    """Evaluate a function and print its results."""
    try:
        robot = krhpr.load(options.robot)
    except ValueError as error:  # KRHPR_BACKEND
        raise WrongUse(str(error)) from None
    signature = find_signature(robot, options.function)
    robot = with_geometry(robot, options.geometry)
    preset = _branches(signature, options)
    optional = [port.name for port in signature.inputs if _is_optional(signature.name, port.name)]
    source = read_source(options.input, options.format)
    calls, is_list = read_arguments(source, signature, optional)
    for given in calls:
        for name in preset.keys() & given.values.keys():
            raise WrongUse(f"{source.name}: {name!r} is given here and by --{name}; leave one out")
    check = not options.no_check_rotation
    answers = [_call(robot, signature, given, preset, check) for given in calls]
    _warn_of_nothing(answers)
    if (options.to or source.format) == "csv":
        _print_csv(signature, answers, options.status)
    else:
        stacked = is_list and calls[0].stacked if calls else False
        _print_json(signature, answers, options.status, is_list, stacked)
    return Exit.OK


# -- what is asked for ---------------------------------------------------------------------------------------


def _is_optional(function: str, argument: str) -> bool:
    return argument in ("mode", "assembly", "swivel") or (function, argument) in _ZERO_UNLESS_GIVEN


def with_geometry(robot: Robot, settings: Sequence[str]) -> Robot:
    """The robot with the fields that `--geometry` changes."""
    fields = robot.geometry.order
    changes: dict[str, list[float] | float] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        name = name.strip()
        if not equals:
            raise WrongUse(f"--geometry {setting}: expected FIELD=VALUE, such as {fields[-1]}=0.1")
        if name not in fields:
            hint = nearest(name, fields)
            raise WrongUse(f"--geometry {setting}: {robot.identifier} has no field {name!r}; {hint}")
        if name in changes:
            raise WrongUse(f"--geometry {setting}: {name!r} is given twice")
        values = [_value(setting, part) for part in text.split(",")]
        if len(values) not in (1, 3):
            raise WrongUse(
                f"--geometry {setting}: found {len(values)} values, expected one, or one for each leg"
            )
        changes[name] = values[0] if len(values) == 1 else values
    try:
        return robot.with_geometry(**changes) if changes else robot
    except ValueError as error:  # not finite, or not positive
        raise WrongUse(f"--geometry: {error}") from None


def _value(setting: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise WrongUse(f"--geometry {setting}: found {text!r}, expected a number") from None


def _branches(signature: Signature, options: argparse.Namespace) -> dict[str, str | list[str]]:
    """Modes that the options give for all configurations."""
    names = [port.name for port in signature.inputs]
    found: dict[str, str | list[str]] = {}
    for option in ("mode", "assembly"):
        text = getattr(options, option)
        if text is None:
            continue
        if option not in names:
            raise WrongUse(f"--{option}: {signature.name} takes no {option}; it takes {', '.join(names)}")
        found[option] = split_labels(text)
    return found


# -- calling -------------------------------------------------------------------------------------------------

Answer = tuple[tuple[np.ndarray[Any, Any], ...], np.ndarray[Any, Any]]
"""Results in order, and the status."""


def _call(
    robot: Robot, signature: Signature, given: Given, preset: dict[str, Any], check_rotation: bool
) -> Answer:
    values = {**preset, **given.values}
    inputs = [
        _branch(robot, port.name, values.get(port.name), given)
        if port.name in ("mode", "assembly")
        else values.get(port.name, np.zeros(port.shape))
        for port in signature.inputs
    ]
    try:
        answer, status = robot.call(signature.name, *inputs, status=True, check_rotation=check_rotation)
    except InvalidInput as error:
        message = str(error).replace("pass check_rotation=False", "add --no-check-rotation")
        raise WrongUse(f"{given.place(error.index)}: {message}") from None
    except ValueError as error:  # batch dimensions that do not fit
        raise WrongUse(f"{given.place(())}: {error}") from None
    results = (answer,) if len(signature.outputs) == 1 else tuple(answer)
    return tuple(np.asarray(result) for result in results), np.asarray(status)


def _branch(robot: Robot, name: str, branch: Any, given: Given) -> Any:
    """The signs of a mode: of labels for all, or of a column of labels."""
    signs = robot.mode_signs if name == "mode" else robot.assembly_signs
    if name not in given.values:
        return signs(branch)
    if not isinstance(branch, LabelRows):
        try:
            return signs(branch)
        except UnknownBranch as error:
            raise WrongUse(f"{given.place(())}: {name}: {error}") from None
    found = []
    for row, label in enumerate(branch.rows):
        try:
            found.append(signs(label))
        except UnknownBranch as error:
            raise WrongUse(f"{given.place((row,))}, column {name}: {error}") from None
    return np.stack(found) if found else np.empty((0, *signs(None).shape))


# -- printing ------------------------------------------------------------------------------------------------


def _warn_of_nothing(answers: Sequence[Answer]) -> None:
    counts = Counter(name for _, status in answers for name in _status_names(status))
    total = sum(counts.values())
    counts.pop("OK", None)
    if counts:
        reasons = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
        print(
            f"krhpr: no answer for {sum(counts.values())} of {total} configurations: {reasons}",
            file=sys.stderr,
        )


def _status_names(status: np.ndarray[Any, Any]) -> list[str]:
    return [krhpr.Status(code).name for code in status.ravel().tolist()]


def _print_json(
    signature: Signature, answers: Sequence[Answer], with_status: bool, is_list: bool, stacked: bool
) -> None:
    objects = []
    for results, status in answers:
        for parts, code in _elements(results, status) if stacked else [(results, status)]:
            entry = {
                port.name: _values(part.tolist()) for port, part in zip(signature.outputs, parts, strict=True)
            }
            if with_status:
                entry["status"] = _status_values(code)
            objects.append(json.dumps(entry, allow_nan=False))
    print("[\n " + ",\n ".join(objects) + "\n]" if is_list and objects else "[]" if is_list else objects[0])


def _elements(results: tuple[Any, ...], status: Any) -> Iterator[Answer]:
    for n in range(len(status)):
        yield tuple(result[n] for result in results), status[n]


def _values(value: Any) -> Any:
    """NaN and infinities become null: JSON has none."""
    if isinstance(value, list):
        return [_values(entry) for entry in value]
    return value if abs(value) < float("inf") else None


def _status_values(status: Any) -> Any:
    names = np.array(_status_names(np.asarray(status)), dtype=object)
    return names.reshape(np.shape(status)).tolist()


def _print_csv(signature: Signature, answers: Sequence[Answer], with_status: bool) -> None:
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow([*all_columns(signature.outputs), *(["status"] if with_status else [])])
    for results, status in answers:
        flat = [result.reshape((status.size, -1)) for result in results]
        names = _status_names(status)
        for row in range(status.size):
            cells = [repr(value) for part in flat for value in part[row].tolist()]
            writer.writerow([*cells, *([names[row]] if with_status else [])])
