"""What declarations say: the types that type nodes mean, structs, typedefs and enumerators."""

from __future__ import annotations

from pycparser import c_ast

from krhpr.validation.c_interpreter import integers
from krhpr.validation.c_interpreter.errors import unsupported
from krhpr.validation.c_interpreter.types import (
    BOOL,
    INT,
    LONG,
    REAL,
    CType,
    Integer,
    Pointer,
    Record,
    Vector,
    Void,
    cells,
    innermost,
)

_INTEGERS = {
    tuple(sorted(name.split())): ctype
    for name, ctype in {
        "_Bool": BOOL,
        "char": Integer(8, True),
        "signed char": Integer(8, True),
        "unsigned char": Integer(8, False),
        "short": Integer(16, True),
        "short int": Integer(16, True),
        "unsigned short": Integer(16, False),
        "int": INT,
        "signed": INT,
        "signed int": INT,
        "unsigned": Integer(32, False),
        "unsigned int": Integer(32, False),
        "long": LONG,
        "long int": LONG,
        "long long": LONG,
        "unsigned long": Integer(64, False),
        "unsigned long int": Integer(64, False),
        "unsigned long long": Integer(64, False),
    }.items()
}
"""By the words of their names, which C takes in any order."""

PRELUDE = """
typedef unsigned long size_t; typedef long ptrdiff_t; typedef _Bool bool;
typedef signed char int8_t; typedef short int16_t; typedef int int32_t; typedef long int64_t;
typedef unsigned char uint8_t; typedef unsigned short uint16_t; typedef unsigned int uint32_t;
typedef unsigned long uint64_t;
"""
"""What the headers of the standard library would declare."""


class Types:
    """The typedefs, structs and enumerators of a program."""

    def __init__(self) -> None:
        self.typedefs: dict[str, CType] = {}
        self.records: dict[str, Record] = {}
        self.enumerators: dict[str, int] = {}

    def resolve(self, node: c_ast.Node, name: str = "") -> CType:
        """The type that a type node means; `name` is given to a struct without a tag."""
        match node:
            case c_ast.TypeDecl() | c_ast.Typename():
                return self.resolve(node.type, name)
            case c_ast.PtrDecl():
                return Pointer(self.resolve(node.type, name), is_const(node.type))
            case c_ast.ArrayDecl():
                length = None if node.dim is None else integers.constant(node.dim, self.enumerators)
                return Vector(self.resolve(node.type, name), length)
            case c_ast.IdentifierType():
                return self._named(node)
            case c_ast.Struct():
                return self._record(node, name)
            case c_ast.Enum():
                self._enumerate(node)
                return INT
            case _:
                raise unsupported(node, f"the type {type(node).__name__}")

    def parameter(self, node: c_ast.Decl) -> tuple[CType, int | None]:
        """The type of a parameter, arrays being pointers, and the number of cells that an array promises."""
        ctype = self.resolve(node.type)
        if not isinstance(ctype, Vector):
            return ctype, None
        extent = None if ctype.length is None else cells(ctype)
        return Pointer(ctype.element, is_const(node.type.type)), extent

    def _named(self, node: c_ast.IdentifierType) -> CType:
        text = " ".join(node.names)
        if text in self.typedefs:
            return self.typedefs[text]
        if text == "double":
            return REAL
        if text == "void":
            return Void()
        words = tuple(sorted(node.names))
        if words not in _INTEGERS:
            raise unsupported(node, f"the type {text}")
        return _INTEGERS[words]

    def _record(self, node: c_ast.Struct, name: str) -> Record:
        tag = node.name or name or "(unnamed)"
        record = self.records.setdefault(node.name, Record(tag)) if node.name else Record(tag)
        if node.decls is not None:
            if record.complete:
                raise unsupported(node, f"struct {tag} is declared twice")
            for declaration in node.decls:
                if not isinstance(declaration, c_ast.Decl) or declaration.bitsize is not None:
                    raise unsupported(declaration, "this member of a struct")
                if declaration.name is None:
                    raise unsupported(declaration, "a member without a name")
                record.fields[declaration.name] = self.resolve(declaration.type, declaration.name)
            record.complete = True
        return record

    def _enumerate(self, node: c_ast.Enum) -> None:
        value = -1
        for item in node.values.enumerators if node.values is not None else ():
            value = value + 1 if item.value is None else integers.constant(item.value, self.enumerators)
            self.enumerators[item.name] = value


def is_const(node: c_ast.Node) -> bool:
    """Whether what a type node describes may not be written; of an array, its elements."""
    while isinstance(node, c_ast.ArrayDecl):
        node = node.type
    return "const" in (getattr(node, "quals", None) or ())


def check_complete(ctype: CType, node: c_ast.Node) -> None:
    """Raise unless the size of a variable of this type is known."""
    kind = innermost(ctype)
    if isinstance(kind, Record) and not kind.complete:
        raise unsupported(node, f"struct {kind.name} is incomplete")
    cells(ctype)
