"""Programs: C texts whose functions Python calls."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import Function
from krhpr.validation.c_interpreter.declarations import PRELUDE, Types
from krhpr.validation.c_interpreter.errors import Unsupported, unsupported
from krhpr.validation.c_interpreter.memory import Block, Struct, from_python
from krhpr.validation.c_interpreter.preprocessor import Preprocessor
from krhpr.validation.c_interpreter.scope import Environment
from krhpr.validation.c_interpreter.source import Definition, parsed, take_apart
from krhpr.validation.c_interpreter.statements import compile_function, constant_table
from krhpr.validation.c_interpreter.types import CType, Record, Void
from krhpr.validation.numbers import EXACT, Arithmetic


class CProgram:
    """Parsed C, whose functions can be called on numbers of one arithmetic.

    `constants` adds to, or replaces, the values of NAN, INFINITY and M_PI: a number, or a function without
    arguments that makes one.  By default NAN and INFINITY are the floats of that name, which can be written
    and tested but not calculated with in exact arithmetic, and M_PI is the arithmetic's pi.

    `macros` are object-like macros that are defined beforehand, as a compiler's -D does.
    """

    def __init__(
        self,
        sources: Iterable[tuple[str, str]],
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
    ) -> None:
        self.arithmetic = arithmetic
        values: dict[str, Callable[[], Any]] = {
            "NAN": lambda: math.nan,
            "INFINITY": lambda: math.inf,
            "M_PI": arithmetic.pi,
        }
        for name, value in (constants or {}).items():
            values[name] = value if callable(value) else _constantly(arithmetic.lift(value))
        self._types = Types()
        self._definitions: dict[str, Definition] = {}
        self._functions: dict[str, Function] = {}
        self._tables: dict[str, tuple[CType, Block]] = {}
        self._environment = Environment(arithmetic, self._types, values, self._tables, self._function)
        preprocessor = Preprocessor([*values, "NULL", "true", "false"])
        preprocessor.macros |= macros or {}
        texts = [PRELUDE]
        for name, source in sources:
            between, functions = take_apart(preprocessor.process(source, name), name)
            texts.append(between)
            for function in functions:
                if function.name in self._definitions:
                    raise Unsupported(f"{name}: {function.name} is defined twice")
                self._definitions[function.name] = function
        for node in parsed("\n".join(texts)).ext:
            self._external(node)

    @classmethod
    def from_files(
        cls,
        paths: Iterable[str | Path],
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
    ) -> CProgram:
        """The program in these files, headers before what uses them."""
        files = [Path(path) for path in paths]
        texts = [(file.name, file.read_text(encoding="utf-8")) for file in files]
        return cls(texts, arithmetic, constants, macros)

    @classmethod
    def from_text(
        cls,
        text: str,
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
        name: str = "text.c",
    ) -> CProgram:
        """The program in this text."""
        return cls([(name, text)], arithmetic, constants, macros)

    @property
    def functions(self) -> tuple[str, ...]:
        """The names of the functions that are defined, in their order."""
        return tuple(self._definitions)

    @property
    def enumerators(self) -> dict[str, int]:
        """The enumeration constants by name, status codes for one."""
        return dict(self._types.enumerators)

    def check(self) -> None:
        """Compile all functions, so that what is unsupported shows without a call."""
        for name in self._definitions:
            self._known(name)

    def new_struct(self, name: str) -> Struct:
        """A struct of the type with this typedef name or tag, all fields unset."""
        record = self._types.typedefs.get(name, self._types.records.get(name))
        if not isinstance(record, Record) or not record.complete:
            raise KeyError(f"no struct {name}")
        return Struct(record, self.arithmetic, name)

    def call(self, name: str, *arguments: Any) -> Any:
        """Call a function.

        Pointers take an `Array`, a `Struct` or None; a pointer to const takes a plain sequence too.
        Plain numbers become numbers of the program's arithmetic, in arrays in place.
        """
        function = self._known(name)
        if len(arguments) != len(function.parameters):
            raise TypeError(f"{name} takes {len(function.parameters)} arguments, {len(arguments)} given")
        return function.call(
            [
                from_python(value, ctype, self.arithmetic, parameter)
                for value, (parameter, ctype, _) in zip(arguments, function.parameters, strict=True)
            ]
        )

    def parameters(self, name: str) -> tuple[str, ...]:
        """The names of a function's parameters, in their order."""
        return tuple(parameter for parameter, _, _ in self._known(name).parameters)

    def _known(self, name: str) -> Function:
        function = self._function(name)
        if function is None:
            raise KeyError(f"no function {name}")
        return function

    def _function(self, name: str) -> Function | None:
        """A function, compiled when it is first asked for."""
        if name in self._definitions and name not in self._functions:
            node = self._definitions[name].parsed(tuple(self._types.typedefs))
            function = self._functions[name] = self._head(node)  # its body may name it
            try:
                compile_function(function, node.body, self._environment)
            except BaseException:
                del self._functions[name]
                raise
        return self._functions.get(name)

    def _head(self, node: c_ast.FuncDef) -> Function:
        name, head = node.decl.name, node.decl.type
        parameters = []
        for item in head.args.params if head.args is not None else ():
            if isinstance(item, c_ast.Typename) and isinstance(self._types.resolve(item), Void):
                continue
            if not isinstance(item, c_ast.Decl) or isinstance(item.type, c_ast.FuncDecl):
                raise unsupported(item, f"this parameter of {name}")
            parameters.append((item.name, *self._types.parameter(item)))
        return Function(name, self._types.resolve(head.type), parameters)

    def _external(self, node: c_ast.Node) -> None:
        match node:
            case c_ast.Typedef():
                self._types.typedefs[node.name] = self._types.resolve(node.type, node.name)
            case c_ast.Decl() if isinstance(node.type, c_ast.Struct | c_ast.Enum):
                self._types.resolve(node.type)
            case c_ast.Decl() if isinstance(node.type, c_ast.FuncDecl):
                pass  # a prototype: calls need the definition
            case c_ast.Decl():
                self._tables[node.name] = constant_table(node, self._environment)
            case c_ast.Pragma():
                pass
            case _:
                raise unsupported(node, f"{type(node).__name__} outside of functions")


def _constantly(value: Any) -> Callable[[], Any]:
    return lambda: value
