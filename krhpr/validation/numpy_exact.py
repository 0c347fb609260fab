"""Running generated NumPy functions on object arrays of exact numbers.

NumPy does most of the work: on arrays with dtype=object its arithmetic, comparisons, `abs`, `where`, `stack`,
`broadcast_arrays`, `matmul`, `einsum`, `cross` and sums use the elements' own operators, and `sqrt`, `sin`,
`cos`, `arctan2`, `hypot` their methods of that name.  What does not work is replaced for the time of a call:

- `isfinite` and `isnan` do not exist for objects;
- `empty`, `zeros`, `ones`, `full`, `asarray`, ... make float arrays, or objects that are Python ints and
  floats, which know no `sqrt`;
- `where` and `minimum` let Python floats through for the same reason;
- Python computes `1.0 / 3.0` in floats before NumPy sees it, and a literal `0.1` is not a tenth.

`exact_numpy(module)` replaces `np` in a module by a namespace that takes care of the first three, and runs
the module's functions with each number literal replaced by the exact number that its text shows.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeAlias

import numpy as np

from krhpr.validation import numbers
from krhpr.validation.numbers import EXACT, Arithmetic

ObjectArray: TypeAlias = "np.ndarray[Any, np.dtype[np.object_]]"

_LITERAL = "__exact_literal__"


def as_object_array(nested: Any, arithmetic: Arithmetic = EXACT) -> ObjectArray:
    """The nested sequences (or array) as an object array; plain numbers become numbers of the arithmetic."""
    lift = np.frompyfunc(arithmetic.lift, 1, 1)
    return np.asarray(lift(np.array(nested, dtype=object)), dtype=object)


# The namespace


# Functions that make arrays, with the position of their argument dtype.
_MAKERS = {
    "array": 1,
    "asarray": 1,
    "asanyarray": 1,
    "ascontiguousarray": 1,
    "empty": 1,
    "zeros": 1,
    "ones": 1,
    "full": 2,
    "eye": 3,
    "identity": 1,
    "empty_like": 1,
    "zeros_like": 1,
    "ones_like": 1,
    "full_like": 2,
}


class ExactNamespace:
    """Stands in for `numpy`: all of it, with the functions replaced that do not do on exact numbers."""

    def __init__(self, arithmetic: Arithmetic = EXACT) -> None:
        self._arithmetic = arithmetic
        self._replaced: dict[str, Any] = {
            **_elementwise(arithmetic),
            **{name: _test(name) for name in ("isfinite", "isnan")},
            **{name: self._maker(name, position) for name, position in _MAKERS.items()},
            "where": self._where,
            "result_type": _result_type,
        }

    def __getattr__(self, name: str) -> Any:
        if name == "pi":
            return self._arithmetic.pi()
        replaced = self._replaced.get(name)
        return getattr(np, name) if replaced is None else replaced

    def _maker(self, name: str, position: int) -> Callable[..., Any]:
        """A function that makes arrays: of exact numbers where NumPy makes floats."""
        make: Callable[..., Any] = getattr(np, name)

        def build(*args: Any, **kwargs: Any) -> Any:
            if len(args) > position and _is_float(args[position]):
                args = (*args[:position], object, *args[position + 1 :])
            if _is_float(kwargs.get("dtype")):
                kwargs["dtype"] = object
            array = make(*args, **kwargs)
            if name.startswith("empty"):
                # Nothing is there to be read yet; None makes sure that a use of it fails.
                unset = array.dtype.kind in "fO"
                return np.full_like(array, None, dtype=object) if unset else array
            return self._lifted(array)

        return build

    def _where(self, condition: Any, *branches: Any) -> Any:
        chosen = np.where(condition, *branches)
        return self._lifted(chosen) if branches else chosen

    def _lifted(self, array: Any) -> Any:
        """Floats and objects as exact numbers; the array itself if it holds them already."""
        if array.dtype.kind not in "fO":
            return array
        if array.dtype.kind == "O" and all(self._arithmetic.lift(item) is item for item in array.flat):
            return array
        return as_object_array(array, self._arithmetic)


def _result_type(*operands: Any) -> Any:
    """NumPy's `result_type`, which takes a number that it does not know for the name of a type."""
    known = (np.ndarray, np.generic, np.dtype, type, str, int, float, complex)
    return np.result_type(*(item if isinstance(item, known) else object for item in operands))


def _is_float(dtype: Any) -> bool:
    return dtype is not None and np.dtype(dtype).kind == "f"


def _test(name: str) -> Callable[[Any], Any]:
    test = np.frompyfunc(getattr(numbers, name), 1, 1)
    return lambda x: np.asarray(test(x), dtype=bool)[()]


def _elementwise(arithmetic: Arithmetic) -> dict[str, Any]:
    lift = arithmetic.lift

    def lifted(function: Callable[..., Any], count: int) -> Any:
        return np.frompyfunc(lambda *operands: function(*map(lift, operands)), count, 1)

    def propagating(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def apply(x: Any, y: Any) -> Any:
            return x if numbers.isnan(x) else y if numbers.isnan(y) else function(x, y)

        return apply

    absolute = lifted(numbers.fabs, 1)
    return {
        "sqrt": lifted(numbers.sqrt, 1),
        "sin": lifted(numbers.sin, 1),
        "cos": lifted(numbers.cos, 1),
        "floor": lifted(numbers.floor, 1),
        "abs": absolute,
        "absolute": absolute,
        "fabs": absolute,
        "arctan2": lifted(numbers.arctan2, 2),
        "hypot": lifted(numbers.hypot, 2),
        "fmin": lifted(numbers.fmin, 2),
        "fmax": lifted(numbers.fmax, 2),
        "minimum": lifted(propagating(numbers.fmin), 2),
        "maximum": lifted(propagating(numbers.fmax), 2),
    }


def exact_namespace(arithmetic: Arithmetic = EXACT) -> ExactNamespace:
    """What takes the place of `np` in a generated module while it runs on exact numbers."""
    return ExactNamespace(arithmetic)


@contextmanager
def exact_numpy(
    *modules: ModuleType, arithmetic: Arithmetic = EXACT, literals: bool = True, alias: str = "np"
) -> Iterator[None]:
    """Within the context, the modules' functions run on exact numbers.

    `np` (or another `alias`) means the exact namespace, and literals have the value that their text shows;
    with `literals=False` they stay floats, which takes no source text.  Name each module that is involved,
    those that a generated module imports too.  Functions keep their identity: who imported one runs the exact
    one.  Floats among default arguments keep the value of the double.
    """
    namespace = exact_namespace(arithmetic)
    with ExitStack() as stack:
        for module in modules:
            if vars(module).get(alias) is np:
                stack.enter_context(_patched(module, {alias: namespace}))
            if literals:
                stack.enter_context(_exact_literals(module, arithmetic))
        yield


@contextmanager
def _patched(module: ModuleType, changes: dict[str, Any]) -> Iterator[None]:
    missing = object()
    former = {name: vars(module).get(name, missing) for name in changes}
    vars(module).update(changes)
    try:
        yield
    finally:
        for name, value in former.items():
            if value is missing:
                del vars(module)[name]
            else:
                vars(module)[name] = value


# Literals


@contextmanager
def _exact_literals(module: ModuleType, arithmetic: Arithmetic) -> Iterator[None]:
    """Within the context, the module's functions and constants are as if its literals were exact numbers."""
    source = inspect.getsource(module)
    tree = _LiteralMarker(source).visit(ast.parse(source))
    ast.fix_missing_locations(tree)
    file = getattr(module, "__file__", None) or "<generated>"
    codes = {
        (code.co_qualname, code.co_firstlineno): code for code in _code_objects(compile(tree, file, "exec"))
    }
    functions = list(_functions_of(module))
    former = [function.__code__ for function in functions]
    with _patched(module, {_LITERAL: _literal_reader(arithmetic)}):
        constants = _exact_constants(module, tree, file)
        try:
            for function, code in zip(functions, former, strict=True):
                function.__code__ = codes.get((code.co_qualname, code.co_firstlineno), code)
            with _patched(module, constants):
                yield
        finally:
            for function, code in zip(functions, former, strict=True):
                function.__code__ = code


class _LiteralMarker(ast.NodeTransformer):
    """Writes `__exact_literal__("0.1")` for 0.1, and makes the quotient of two whole numbers exact."""

    def __init__(self, source: str) -> None:
        self.lines = [line.encode() for line in source.split("\n")]

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, float):
            return node
        text = self.lines[node.lineno - 1][node.col_offset : node.end_col_offset].decode()
        return _marked(ast.Constant(text), node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        if isinstance(node.op, ast.Div) and _is_whole(node.left):
            node.left = _marked(node.left, node.left)
        return self.generic_visit(node)  # type: ignore[return-value]

    def visit_MatchValue(self, node: ast.MatchValue) -> ast.MatchValue:
        return node  # a pattern takes no call


def _marked(value: ast.expr, place: ast.expr) -> ast.expr:
    call = ast.Call(ast.Name(_LITERAL, ast.Load()), [value], [])
    return ast.copy_location(call, place)


def _is_whole(node: ast.expr) -> bool:
    """Whether an expression consists of integer literals."""
    match node:
        case ast.Constant():
            return type(node.value) is int
        case ast.UnaryOp():
            return _is_whole(node.operand)
        case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult()):
            return _is_whole(node.left) and _is_whole(node.right)
        case _:
            return False


def _literal_reader(arithmetic: Arithmetic) -> Callable[[str | int], Any]:
    values: dict[str | int, Any] = {}

    def read(text: str | int) -> Any:
        if text not in values:
            value = Fraction(text.replace("_", "")) if isinstance(text, str) else Fraction(text)
            values[text] = arithmetic.real(value) if arithmetic.fixed else value
        return values[text] if arithmetic.fixed else arithmetic.real(values[text])

    return read


def _exact_constants(module: ModuleType, tree: ast.Module, file: str) -> dict[str, Any]:
    """The exact values of the floats that the module defines at its top level."""
    constants: dict[str, Any] = {}
    for statement in tree.body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                pass
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                pass
            case _:
                continue
        if isinstance(vars(module).get(name), float):
            code = compile(ast.Expression(value), file, "eval")
            constants[name] = eval(code, {**vars(module), **constants})
    return constants


def _code_objects(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code_objects(constant)


def _functions_of(module: ModuleType) -> Iterator[FunctionType]:
    """The functions that the module defines, those behind decorators and in classes included."""
    seen: set[int] = set()
    waiting = list(vars(module).values())
    while waiting:
        item = waiting.pop()
        if id(item) in seen:
            continue
        seen.add(id(item))
        if hasattr(item, "__wrapped__"):
            waiting.append(item.__wrapped__)
        if isinstance(item, type) and item.__module__ == module.__name__:
            waiting.extend(vars(item).values())
        if isinstance(item, FunctionType) and item.__globals__ is vars(module):
            yield item
