"""Statements and the variables that they declare: the bodies of functions, and tables outside of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import BREAK, CONTINUE, Frame, Function, Get, Run, new_frame
from krhpr.validation.c_interpreter.declarations import check_complete, is_const
from krhpr.validation.c_interpreter.errors import unsupported, where
from krhpr.validation.c_interpreter.expressions import Expressions
from krhpr.validation.c_interpreter.initialisers import initialiser
from krhpr.validation.c_interpreter.memory import Block, new_block
from krhpr.validation.c_interpreter.scope import Environment, Scope
from krhpr.validation.c_interpreter.types import CType, Vector, Void, innermost


def compile_function(function: Function, body: c_ast.Compound, environment: Environment) -> None:
    """Give a function whose head is known its body."""
    scope = Scope(environment)
    for name, ctype, _ in function.parameters:
        scope.declare(name, ctype)
    function.body = _Statements(scope, function.returns).statement(body)
    function.slots = scope.slots


def constant_table(declaration: c_ast.Decl, environment: Environment) -> tuple[CType, Block]:
    """The type of a constant outside of functions, and the memory that holds it."""
    if not is_const(declaration.type) or declaration.init is None:
        raise unsupported(declaration, f"{declaration.name}: variables outside of functions must be constant")
    scope = Scope(environment)
    run = _Statements(scope, Void()).statement(declaration)
    frame = new_frame(scope.slots)
    run(frame)
    variable = scope.variable(declaration.name)
    assert variable is not None
    slot, ctype = variable
    return ctype, frame[slot]


class _Statements:
    """Compiles the statements of a function that returns the type `returns`."""

    def __init__(self, scope: Scope, returns: CType) -> None:
        self.scope = scope
        self.returns = returns
        self.expressions = Expressions(scope)

    def statement(self, node: c_ast.Node) -> Run:
        """A statement as a function of the frame; an arithmetic error in it is noted with the line."""
        run = self._statement(node)
        # The parts of these have lines of their own.
        return run if isinstance(node, c_ast.Compound | c_ast.For | c_ast.If) else _located(run, node)

    def _statement(self, node: c_ast.Node) -> Run:
        match node:
            case c_ast.Compound():
                with self.scope.nested():
                    return _sequence([self.statement(item) for item in node.block_items or ()])
            case c_ast.Decl():
                return self._declaration(node)
            case c_ast.DeclList():
                return _sequence([self.statement(item) for item in node.decls])
            case c_ast.For():
                with self.scope.nested():
                    return self._for(node)
            case c_ast.If():
                return self._if(node)
            case c_ast.Return():
                return self._return(node)
            case c_ast.Break():
                return lambda frame: BREAK
            case c_ast.Continue():
                return lambda frame: CONTINUE
            case c_ast.EmptyStatement() | c_ast.Pragma():
                return _nothing
            case c_ast.Assignment() | c_ast.UnaryOp() | c_ast.FuncCall() | c_ast.ExprList() | c_ast.Cast():
                return self._effect(node)
            case _:
                raise unsupported(node, f"the statement {type(node).__name__}")

    def _effect(self, node: c_ast.Node) -> Run:
        get = self.expressions.effect(node)

        def run(frame: Frame) -> None:
            get(frame)

        return run

    def _for(self, node: c_ast.For) -> Run:
        start = self.statement(node.init) if node.init is not None else _nothing
        condition = self.expressions.truth(node.cond) if node.cond is not None else None
        advance = self.expressions.effect(node.next) if node.next is not None else _nothing
        body = self.statement(node.stmt)

        def run(frame: Frame) -> Any:
            start(frame)
            while condition is None or condition(frame):
                outcome = body(frame)
                if outcome is BREAK:
                    break
                if outcome is not None and outcome is not CONTINUE:
                    return outcome
                advance(frame)
            return None

        return run

    def _if(self, node: c_ast.If) -> Run:
        condition = _located(self.expressions.truth(node.cond), node)
        then = self.statement(node.iftrue) if node.iftrue is not None else _nothing
        other = self.statement(node.iffalse) if node.iffalse is not None else _nothing
        return lambda frame: then(frame) if condition(frame) else other(frame)

    def _return(self, node: c_ast.Return) -> Run:
        if node.expr is None:
            if not isinstance(self.returns, Void):
                raise unsupported(node, "return without a value")
            return lambda frame: (None,)
        get = self.expressions.value(node.expr, self.returns, node)
        return lambda frame: (get(frame),)

    def _declaration(self, node: c_ast.Decl) -> Run:
        types, arithmetic = self.expressions.types, self.expressions.arithmetic
        if isinstance(node.type, c_ast.Struct | c_ast.Enum):
            types.resolve(node.type)
            return _nothing
        if "extern" in node.storage or ("static" in node.storage and not is_const(node.type)):
            raise unsupported(node, f"{node.name}: static or external variables inside functions")
        if isinstance(node.type, c_ast.FuncDecl):
            raise unsupported(node, f"{node.name}: a function declared inside a function")
        ctype = types.resolve(node.type)
        if isinstance(ctype, Vector) and ctype.length is None and isinstance(node.init, c_ast.InitList):
            ctype = Vector(ctype.element, len(node.init.exprs))
        if isinstance(innermost(ctype), Void):
            raise unsupported(node, f"{node.name}: a variable of type void")
        check_complete(ctype, node)
        name: str = node.name
        slot = self.scope.declare(name, ctype)  # C: the name is known within its own initialiser
        fill = initialiser(ctype, node.init, self.expressions) if node.init is not None else None

        def run(frame: Frame) -> None:
            block = frame[slot] = new_block(ctype, name, arithmetic)
            if fill is not None:
                fill(frame, block, 0)

        return run


def _nothing(frame: Frame) -> None:
    """Do nothing, and go on."""


def _sequence(statements: Sequence[Run]) -> Run:
    def run(frame: Frame) -> Any:
        for statement in statements:
            outcome = statement(frame)
            if outcome is not None:
                return outcome
        return None

    return run


def _located(get: Get, node: c_ast.Node) -> Get:
    """The same, but that an arithmetic error is noted with the line, once."""
    line = where(node)

    def located(frame: Frame) -> Any:
        try:
            return get(frame)
        except (ArithmeticError, TypeError) as error:
            if not getattr(error, "__notes__", ()):
                error.add_note(f"at {line}")
            raise

    return located
