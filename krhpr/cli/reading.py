"""Arguments of a function from JSON or CSV: strict, and exact about what is wrong and where."""

from __future__ import annotations

import csv
import io
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from krhpr.cli.columns import column_names
from krhpr.cli.common import WrongUse
from krhpr.errors import nearest

if TYPE_CHECKING:
    from krhpr.generated.python.runtime import Port, Signature

BRANCHES = ("mode", "assembly")
"""Arguments that may be given as labels."""

Values = dict[str, Any]
"""Arguments by name: arrays; a mode as a label or three, or as labels row by row."""


@dataclass(frozen=True)
class LabelRows:
    """A mode's label, or three, for each row of a table."""

    rows: tuple[str | list[str], ...]


def split_labels(text: str) -> str | list[str]:
    """A label, or three separated by commas."""
    labels = [label.strip() for label in text.split(",")]
    return labels[0] if len(labels) == 1 else labels


@dataclass(frozen=True)
class Source:
    """What was read, and from where."""

    name: str
    format: str
    text: str


@dataclass(frozen=True)
class Given:
    """Arguments of one call, and what to call an element of its batch in a message.

    `stacked`: the elements of a list were put together, and come apart again in the answer.
    """

    values: Values
    place: Callable[[tuple[int, ...]], str]
    stacked: bool = False


def read_source(path: str, wanted: str | None) -> Source:
    """The text of a file (`-`: standard input); its format, unless wanted, by ending or first character."""
    name = "standard input" if path == "-" else path
    if path == "-" and sys.stdin.isatty():
        print("Reading standard input; it ends with Ctrl-D on a line of its own", file=sys.stderr)
    try:
        data = sys.stdin.buffer.read() if path == "-" else Path(path).read_bytes()
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise WrongUse(f"{name}: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise WrongUse(f"{name}: not a text file: byte {error.start} is not UTF-8") from None
    if not text.strip():
        raise WrongUse(f"{name}: is empty; expected JSON or CSV")
    ending = Path(path).suffix.lower().removeprefix(".")
    if wanted is None:
        wanted = ending if ending in ("json", "csv") else "json" if text.lstrip()[0] in "{[" else "csv"
    return Source(name, wanted, text)


def read_arguments(source: Source, signature: Signature, optional: Sequence[str]) -> tuple[list[Given], bool]:
    """Arguments for each call, and whether what was read is a list of elements."""
    if source.format == "csv":
        return [_from_csv(source, signature, optional)], False
    return _from_json(source, signature, optional)


# -- JSON ----------------------------------------------------------------------------------------------------


def _from_json(source: Source, signature: Signature, optional: Sequence[str]) -> tuple[list[Given], bool]:
    try:
        found = json.loads(source.text, object_pairs_hook=_no_duplicates)
    except json.JSONDecodeError as error:
        raise WrongUse(
            f"{source.name}, line {error.lineno}, column {error.colno}: not JSON: {error.msg}"
        ) from None
    except _Duplicate as error:
        raise WrongUse(f"{source.name}: {error.args[0]!r} stands twice in one object") from None
    except RecursionError:
        raise WrongUse(f"{source.name}: nested too deeply") from None
    if isinstance(found, dict):
        return [Given(_element(found, signature, optional, source.name, ""), _in_batch(source.name))], False
    if not isinstance(found, list) or not all(isinstance(entry, dict) for entry in found):
        what = "a list with something else in it" if isinstance(found, list) else _kind(found)
        raise WrongUse(
            f"{source.name}: found {what}, expected an object of arguments ({_names(signature)}) "
            "or a list of such objects"
        )
    elements = [_element(entry, signature, optional, source.name, f"[{n}]") for n, entry in enumerate(found)]
    return _stacked(elements, signature, source.name), True


class _Duplicate(Exception):
    """A name that stands twice in an object."""


def _no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _Duplicate(name)
        found[name] = value
    return found


def _element(
    found: Mapping[str, Any], signature: Signature, optional: Sequence[str], source: str, path: str
) -> Values:
    where = f"{source}: {path}" if path else source
    ports = {port.name: port for port in signature.inputs}
    _check_names(found, list(ports), optional, where, "argument", signature.name)
    values: Values = {}
    for name, value in found.items():
        if name in BRANCHES and _is_label(value):
            values[name] = value
        else:
            values[name] = _array(value, ports[name], source, f"{path}.{name}" if path else name)
    return values


def _is_label(value: Any) -> bool:
    return isinstance(value, str) or (
        isinstance(value, list) and bool(value) and all(isinstance(v, str) for v in value)
    )


def _array(value: Any, port: Port, source: str, path: str) -> np.ndarray[Any, Any]:
    numbers: list[float] = []
    shape = _collect(value, source, path, numbers)
    core = len(port.shape)
    if len(shape) < core or shape[len(shape) - core :] != port.shape:
        raise WrongUse(
            f"{source}: {path}: found shape {_shape(shape)}, expected {_shape(('...', *port.shape))}: "
            f"{port.doc}"
        )
    return np.array(numbers, dtype=float).reshape(shape)


def _collect(value: Any, source: str, path: str, numbers: list[float]) -> tuple[int, ...]:
    """Append the numbers of nested lists; returns their shape, which has to be the same in every branch."""
    if not isinstance(value, list):
        numbers.append(_number(value, f"{source}: {path}"))
        return ()
    shapes = [_collect(entry, source, f"{path}[{n}]", numbers) for n, entry in enumerate(value)]
    for n, shape in enumerate(shapes):
        if shape != shapes[0]:
            raise WrongUse(
                f"{source}: {path}[{n}]: ragged: found shape {_shape(shape)}, expected {_shape(shapes[0])} "
                f"as in {path}[0]"
            )
    return (len(value), *(shapes[0] if shapes else ()))


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise WrongUse(f"{where}: found {_kind(value)}, expected a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise WrongUse(f"{where}: found {value}, expected a finite number")
    return number


def _kind(value: Any) -> str:
    if isinstance(value, str):
        return f"the text {value!r}"
    return (
        "a list" if isinstance(value, list) else "an object" if isinstance(value, dict) else json.dumps(value)
    )


def _stacked(elements: list[Values], signature: Signature, source: str) -> list[Given]:
    """One call for all elements where each is a single configuration, else a call for each."""
    cores = {port.name: port.shape for port in signature.inputs}

    def single(values: Values) -> bool:
        return all(isinstance(v, np.ndarray) and v.shape == cores[name] for name, v in values.items())

    alike = elements and all(values.keys() == elements[0].keys() and single(values) for values in elements)
    if alike:
        together = {name: np.stack([values[name] for values in elements]) for name in elements[0]}
        return [Given(together, lambda index: f"{source}: [{index[0]}]" if index else source, stacked=True)]
    return [Given(values, _in_batch(f"{source}: [{n}]")) for n, values in enumerate(elements)]


def _in_batch(where: str) -> Callable[[tuple[int, ...]], str]:
    return lambda index: f"{where}, element {list(index)}" if index else where


# -- CSV -----------------------------------------------------------------------------------------------------


def _from_csv(source: Source, signature: Signature, optional: Sequence[str]) -> Given:
    reader = csv.reader(io.StringIO(source.text, newline=""), strict=True, skipinitialspace=True)
    try:
        header = [name.strip() for name in next(row for row in reader if row)]
        rows = [(reader.line_num, row) for row in reader if row]
    except csv.Error as error:
        raise WrongUse(f"{source.name}, line {reader.line_num}: not CSV: {error}") from None
    columns = _columns(header, signature, optional, source.name)
    table: dict[str, list[Any]] = {name: [] for name in header}
    for line, row in rows:
        if len(row) != len(header):
            raise WrongUse(
                f"{source.name}, line {line}: found {len(row)} cells, expected {len(header)} as in the header"
            )
        for name, cell in zip(header, row, strict=True):
            where = f"{source.name}, line {line}, column {name}"
            table[name].append(cell.strip() if name in columns.labels else _cell(cell, where))
    values: Values = {name: LabelRows(tuple(map(split_labels, table[name]))) for name in columns.labels}
    for port in columns.ports:
        stacked = np.array([table[name] for name in column_names(port)], dtype=float)
        values[port.name] = stacked.T.reshape((len(rows), *port.shape))
    lines = [line for line, _ in rows]
    return Given(values, lambda index: f"{source.name}, line {lines[index[0]]}" if index else source.name)


@dataclass(frozen=True)
class _Columns:
    """Which arguments a header holds: as numbers, and as labels."""

    ports: tuple[Port, ...]
    labels: tuple[str, ...]


def _columns(header: Sequence[str], signature: Signature, optional: Sequence[str], source: str) -> _Columns:
    for name in header:
        if header.count(name) > 1:
            raise WrongUse(f"{source}, header: column {name!r} stands twice")
    if len(header) == 1 and (";" in header[0] or "\t" in header[0]):
        raise WrongUse(f"{source}, header: found {header[0]!r}, expected columns separated by commas")
    labels = tuple(
        name for name in header if name in BRANCHES and any(name == port.name for port in signature.inputs)
    )
    known = [name for port in signature.inputs if port.name not in labels for name in column_names(port)]
    given = tuple(
        port
        for port in signature.inputs
        if port.name not in labels and any(name in header for name in column_names(port))
    )
    needed = [
        name
        for port in signature.inputs
        if port in given or (port.name not in optional and port.name not in labels)
        for name in column_names(port)
    ]
    _check_names(
        header,
        known + list(labels),
        [n for n in known if n not in needed],
        f"{source}, header",
        "column",
        signature.name,
    )
    return _Columns(given, labels)


def _cell(text: str, where: str) -> float:
    try:
        if "_" in text:  # Python's own digit groups
            raise ValueError
        number = float(text)
    except ValueError:
        raise WrongUse(f"{where}: found {text!r}, expected a number") from None
    if not math.isfinite(number):
        raise WrongUse(f"{where}: found {text}, expected a finite number")
    return number


# -- words ---------------------------------------------------------------------------------------------------


def _check_names(
    found: Sequence[str] | Mapping[str, Any],
    known: Sequence[str],
    optional: Sequence[str],
    where: str,
    what: str,
    function: str,
) -> None:
    for name in found:
        if name not in known:
            raise WrongUse(f"{where}: unknown {what} {name!r} of {function}; {nearest(name, known)}")
    missing = [name for name in known if name not in found and name not in optional]
    if missing:
        plural = "s" if len(missing) > 1 else ""
        raise WrongUse(
            f"{where}: missing {what}{plural} {', '.join(missing)}; {function} takes {', '.join(known)}"
        )


def _names(signature: Signature) -> str:
    return ", ".join(port.name for port in signature.inputs)


def _shape(shape: Sequence[object]) -> str:
    return "(" + ", ".join(map(str, shape)) + ")"
