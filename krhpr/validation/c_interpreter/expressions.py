"""Expressions: what their syntax means, and the operators that write, `=`, `+=`, `++` and their like."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter import conversions, integers, operators, places
from krhpr.validation.c_interpreter.calls import call
from krhpr.validation.c_interpreter.compiled import Condition, Expression, Frame, Get
from krhpr.validation.c_interpreter.errors import unsupported, where
from krhpr.validation.c_interpreter.memory import put
from krhpr.validation.c_interpreter.scope import Scope
from krhpr.validation.c_interpreter.types import INT, REAL, CType, Record, Vector, Void


class Expressions:
    """Compiles the expressions of a function, whose names are those of its `scope`."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.types = scope.environment.types
        self.arithmetic = scope.environment.arithmetic

    def truth(self, node: c_ast.Node) -> Condition:
        """An expression as a condition."""
        return conversions.truth(self.expression(node), node)

    def value(self, node: c_ast.Node, ctype: CType, at: c_ast.Node | None = None) -> Get:
        """An expression as a value of type `ctype`; errors name the line of `at`."""
        return conversions.converted(self.expression(node), ctype, self.arithmetic, at or node)

    def effect(self, node: c_ast.Node) -> Get:
        """An expression whose value nobody needs, as of a call without one."""
        return self._expression(node).get

    def expression(self, node: c_ast.Node) -> Expression:
        """Any expression; array values are pointers to the first element."""
        expression = self._expression(node)
        if isinstance(node, c_ast.FuncCall) and isinstance(expression.ctype, Void):
            raise unsupported(node, f"{node.name.name} has no value")
        return expression

    def _expression(self, node: c_ast.Node) -> Expression:
        match node:
            case c_ast.Constant():
                return self._constant(node)
            case c_ast.ID():
                return self.scope.identifier(node)
            case c_ast.ArrayRef():
                return places.element(self.expression(node.name), self.expression(node.subscript), node)
            case c_ast.StructRef():
                base = self.expression(node.name)
                struct = places.target(base, node, "-> on") if node.type == "->" else base
                return places.field(struct, node.field.name, node)
            case c_ast.UnaryOp():
                return self._unary(node)
            case c_ast.BinaryOp(op="&&" | "||"):
                return operators.logical(node.op, self.truth(node.left), self.truth(node.right))
            case c_ast.BinaryOp():
                left, right = self.expression(node.left), self.expression(node.right)
                return operators.binary(node.op, left, right, self.arithmetic, node)
            case c_ast.Assignment():
                return self._assignment(node)
            case c_ast.TernaryOp():
                condition = self.truth(node.cond)
                then, other = self.expression(node.iftrue), self.expression(node.iffalse)
                return operators.conditional(condition, then, other, self.arithmetic, node)
            case c_ast.Cast():
                return self._cast(node)
            case c_ast.FuncCall():
                return self._call(node)
            case c_ast.ExprList():
                parts = [self._expression(item) for item in node.exprs]
                return Expression(parts[-1].ctype, lambda frame: [part.get(frame) for part in parts][-1])
            case _:
                raise unsupported(node, f"the expression {type(node).__name__}")

    def _constant(self, node: c_ast.Constant) -> Expression:
        if "char" in node.type or node.type == "string":
            raise unsupported(node, f"the literal {node.value}")
        if "int" in node.type:
            value, ctype = integers.literal(node)
            return Expression(ctype, lambda frame: value)
        real, shown = self.arithmetic.real, _decimal(node)
        if self.arithmetic.fixed:
            number = real(shown)
            return Expression(REAL, lambda frame: number)
        return Expression(REAL, lambda frame: real(shown))

    def _unary(self, node: c_ast.UnaryOp) -> Expression:
        if node.op in ("++", "--", "p++", "p--"):
            return self._step(node)
        if node.op == "sizeof":
            raise unsupported(node, "sizeof")
        operand = self.expression(node.expr)
        if node.op == "&":
            return places.address(operand, node)
        if node.op == "*":
            return places.target(operand, node, "* on")
        return operators.unary(node.op, operand, node)

    def _step(self, node: c_ast.UnaryOp) -> Expression:
        target = self.expression(node.expr)
        one = Expression(INT, lambda frame: 1)
        old, new = self._update(target, node.op[-1], one, node)
        return Expression(target.ctype, old if node.op.startswith("p") else new)

    def _update(self, target: Expression, sign: str, amount: Expression, node: c_ast.Node) -> tuple[Get, Get]:
        """The two readings of `target = target sign amount`: the former value, and the new one."""
        if target.locate is None or isinstance(target.ctype, Vector | Record):
            raise unsupported(node, "this target of an assignment")
        locate, line = target.locate, where(node)
        held: list[Any] = [None]
        before = Expression(target.ctype, lambda frame: held[0])
        after = operators.binary(sign, before, amount, self.arithmetic, node)
        get = conversions.converted(after, target.ctype, self.arithmetic, node)

        def update(frame: Frame) -> tuple[Any, Any]:
            location = locate(frame)
            old = held[0] = places.read(location, line)
            new = get(frame)
            location[0].cells[location[1]] = new
            return old, new

        return lambda frame: update(frame)[0], lambda frame: update(frame)[1]

    def _assignment(self, node: c_ast.Assignment) -> Expression:
        target = self.expression(node.lvalue)
        if node.op != "=":
            amount = self.expression(node.rvalue)
            return Expression(target.ctype, self._update(target, node.op[:-1], amount, node)[1])
        if target.locate is None or isinstance(target.ctype, Vector):
            raise unsupported(node, "this target of an assignment")
        locate, get = target.locate, self.value(node.rvalue, target.ctype, node)

        def assign(frame: Frame) -> Any:
            item = get(frame)
            block, cell, _, _ = locate(frame)
            put(block, cell, item)
            return item

        return Expression(target.ctype, assign)

    def _cast(self, node: c_ast.Cast) -> Expression:
        ctype = self.types.resolve(node.to_type)
        if isinstance(ctype, Void):
            return Expression(ctype, self.expression(node.expr).get)
        return Expression(ctype, self.value(node.expr, ctype, node))

    def _call(self, node: c_ast.FuncCall) -> Expression:
        if not isinstance(node.name, c_ast.ID):
            raise unsupported(node, "a call through a pointer")
        arguments = [self.expression(item) for item in (node.args.exprs if node.args is not None else ())]
        return call(node, arguments, self.scope.environment)


def _decimal(node: c_ast.Constant) -> Fraction:
    """The number that a floating literal shows."""
    text = node.value
    hexadecimal = text.lower().startswith("0x")
    if text[-1] in "lLdD" or (text[-1] in "fF" and not hexadecimal):
        raise unsupported(node, f"the literal {text}: only double is known")
    return Fraction(float.fromhex(text)) if hexadecimal else Fraction(text)
