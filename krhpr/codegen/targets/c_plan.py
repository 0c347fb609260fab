"""The statements of a robot's function in the order of the source: calls of kernels, iterations,
and loops over roots and pairs.
"""

from __future__ import annotations

import textwrap
from math import prod

from krhpr.codegen.composition import Call, EachPair, EachRoot, Repeat, RobotFunction, Stage, Variable
from krhpr.codegen.kernel import Kernel, Layout, Port
from krhpr.codegen.part import Part
from krhpr.codegen.phases import Phases
from krhpr.codegen.printers.c import print_kernel
from krhpr.codegen.robot_code import RobotCode
from krhpr.codegen.targets.base import broken
from krhpr.codegen.targets.c_numbers import LANES, Writing
from krhpr.codegen.targets.c_statements import AtPairs, AtRoots, Iteration, Row, Statement


class Plan:
    """The statements of a function: calls of kernels, with all legs' sines, cosines and arctangents put
    together.
    """

    def __init__(
        self,
        robot: RobotCode,
        function: RobotFunction,
        known: dict[str, Variable],
        outside: set[str],
        writing: Writing,
        *,
        leave_out: Stage | None,
    ) -> None:
        self.robot, self.known, self.outside, self.writing = robot, known, outside, writing
        self.read = function.read(robot.parts, guards=True)
        self.angle_count = self.tail_count = 0
        self.shared_angle_calls: list[str] = []
        self.leg_angle_calls: list[str] = []
        self.tail_stores: list[tuple[str, str]] = []
        self.platform_tail_stores: list[tuple[str, str]] = []
        self.shared_calls: list[str] = []
        self.leg_calls: list[Statement] = []
        self.platform_calls: list[Statement] = []
        self._offsets: dict[str, str] = {}
        for call in function.calls:
            if call.stage is not leave_out:
                self._add(call)

    def _add(self, call: Call) -> None:
        part = self.robot.parts[call.part]
        phases = part.phases[call.kernel]
        if call.repeat is not None:
            self._iterate(call, call.repeat, part, phases)
            return
        if call.each is not None:
            self._place(call, Statement("", at_roots=self._at_roots(call, call.each, part, phases)))
            return
        if call.pairs is not None:
            self._place(call, self._at_pairs(call, call.pairs, part, phases))
            return
        special = self._angles(call, part, phases)
        special |= self._tails(call, phases)
        text = self._text(call, part, phases.body, special)
        self._place(call, Statement(text))

    def _place(self, call: Call, statement: Statement) -> None:
        if call.stage is Stage.SHARED:
            self.shared_calls.append(statement.text)
        else:
            (self.leg_calls if call.stage is Stage.LEG else self.platform_calls).append(statement)

    def _iterate(self, call: Call, repeat: Repeat, part: Part, phases: Phases) -> None:
        """A loop around a kernel, with its sines and cosines inside it."""
        if phases.tails:
            raise ValueError(f"{part.name}.{call.kernel}: arctangents cannot be put off in an iteration")
        state, following = f"{repeat.before}_at", f"{repeat.before}_on"
        special = {repeat.before: state, repeat.after: following}
        if self.writing is LANES:  # lanes that have converged keep what they have
            special[repeat.change] = f"{repeat.change}_on"
        angles, count = "", 0
        if phases.angles is not None:
            count = phases.angles.output_port("angle").size
            angles = self._text(call, part, phases.angles, {**special, "angle": "step_angle"}, indent=8)
            special |= {"sine": "step_sine", "cosine": "step_cosine"}
        iteration = Iteration(
            state=repeat.before,
            size=phases.body.output_port(repeat.after).size,
            start=self._reference(repeat.start, call.stage),
            result=self._reference(call.variable_out(repeat.after), call.stage),
            change=self._element(call.variable_out(repeat.change), call.stage),
            tolerance=repr(repeat.tolerance),
            limit=repeat.limit,
            angle_call=angles,
            angle_count=count,
        )
        self._place(call, Statement(self._text(call, part, phases.body, special, indent=8), iteration))

    def _at_roots(self, call: Call, each: EachRoot, part: Part, phases: Phases) -> AtRoots:
        """A loop over the roots; what one gives lies in variables of its own until it is known to count."""
        if phases.angles is not None:
            raise ValueError(f"{part.name}.{call.kernel}: sines at roots come too late")
        kernel = part.kernel(call.kernel)
        names = {call.variable_out(port.name): port.size for port in kernel.outputs if port.name != each.miss}
        rows = tuple(Row(name, self._collected(name, call.stage), size) for name, size in names.items())
        others = [port for port in phases.body.inputs if port.name != each.root]
        side_by_side = kernel.geometry is None  # in lanes, geometry is that of several legs
        spreads = tuple(self._spread(call, port) for port in others) if side_by_side else None
        end = "roots" if side_by_side else "at"
        special = {name: f"{name}_{end}" for name in (*names, each.miss)}
        special |= {"tail_y": f"tail_y_{end}", "tail_x": f"tail_x_{end}", each.root: each.root}
        if spreads is not None:
            for port, (name, _, _) in zip(others, spreads, strict=True):
                special[port.name] = name if port.shape else f"{name}[0]"
        stores = [
            (f"{call.variable_out(tail.port.name)}_{end}[{index}]", f"tail_{end}[{slot}]")
            for tail in phases.tails
            for index, slot in enumerate(tail.slots)
        ]
        return AtRoots(
            call=self._text(call, part, phases.body, special, 12, lanes=side_by_side),
            polynomial=each.polynomial,
            degree=each.degree,
            error=repr(each.error),
            root=each.root,
            miss=each.miss,
            tolerance=repr(each.tolerance),
            order=each.order,
            order_at=self._order(each.order, call.stage),
            count=self._number(each.count, call.stage),
            doubtful=self._number(each.doubtful, call.stage) if each.only is None else "",
            found=self._number(each.found, call.stage) if each.only is None else "",
            only=each.only,
            certificate_size=self.known[each.only.certificate].port.size if each.only else 0,
            rows=rows,
            copies=tuple(row for row in rows if self.known[row.name].kind == "output"),
            tail_count=phases.tail_size,
            tail_stores=tuple(stores),
            spreads=spreads,
        )

    def _spread(self, call: Call, port: Port) -> tuple[str, str, int]:
        """What a kernel reads, in every lane: the lanes, the array they come from, and how many there are."""
        name = call.variable_in(port.name)
        variable = self.known[name]
        array = name if variable.port.shape or variable.per_leg else f"&{name}"
        return f"{name}_roots", array, port.size

    def _at_pairs(self, call: Call, pairs: EachPair, part: Part, phases: Phases) -> Statement:
        """A loop over the pairs of links."""
        if phases.angles is not None or phases.tails:
            raise ValueError(f"{part.name}.{call.kernel}: no sines or arctangents for pairs of links")
        places, first = [], 0
        for name in pairs.places:
            variable = self.known[name]
            size = variable.port.size * (self.robot.legs if variable.per_leg else 1)
            places.append((name, first, size))
            first += size
        kernel = part.kernel(call.kernel)
        count = len(kernel.inputs)
        ends = [f"points_of_links + ends[{count} * pair + {k}]" for k in range(count)]
        special = {port.name: text for port, text in zip(kernel.inputs, ends, strict=True)}
        (port,) = kernel.outputs
        special[port.name] = f"{call.variable_out(port.name)} + pair"
        table = ", ".join(str(3 * end) for of_pair in pairs.ends for end in of_pair)
        return Statement(
            self._text(call, part, phases.body, special, indent=8),
            at_pairs=AtPairs(
                count=len(pairs.ends),
                ends=count,
                table=tuple(textwrap.wrap(table, 100)),
                real=self.writing.real,
                size=first,
                places=tuple(places),
            ),
        )

    def _element(self, name: str, stage: Stage) -> str:
        """A number, which guards of the platform want in an array of one."""
        return f"{name}[0]" if self.known[name].port.shape else self._reference(name, stage)

    def _collected(self, name: str, stage: Stage) -> str:
        """Where solutions are collected."""
        port = self.known[name].port
        return f"{name} + {port.size} * i" if stage is Stage.LEG else name

    def _order(self, name: str, stage: Stage) -> str:
        """The value that orders the solution number `below`."""
        return f"{name}[{self.known[name].port.size} * i + below]" if stage is Stage.LEG else f"{name}[below]"

    def _number(self, name: str, stage: Stage) -> str:
        """A number of the platform, or of a leg, as what is assigned to."""
        if stage is Stage.LEG:
            return f"{name}[i]"
        return f"*{name}" if self.known[name].kind == "output" else f"{name}[0]"

    def _angles(self, call: Call, part: Part, phases: Phases) -> dict[str, str]:
        """Where the body finds its sines and cosines; the angles are computed before."""
        if phases.angles is None:
            return {}
        kernel = phases.angles
        late = [
            port.name for port in kernel.inputs if self.known[call.variable_in(port.name)].kind != "input"
        ]
        if late or call.stage is Stage.PLATFORM:
            raise ValueError(
                f"{part.name}.{call.kernel}: sines of {late or 'the platform stage'} come too late"
            )
        count = kernel.output_port("angle").size
        per_leg = call.stage is Stage.LEG
        # two kernels that read the same angles share them
        key = (
            f"{[call.variable_in(port.name) for port in kernel.inputs]} "
            f"{print_kernel(kernel).results} {per_leg}"
        )
        if key not in self._offsets:
            first = str(self.angle_count) if self.angle_count else ""
            self._offsets[key] = " + ".join(
                term for term in (first, f"{count} * i" if per_leg else "") if term
            )
            self.angle_count += count * (self.robot.legs if per_leg else 1)
            target = self.leg_angle_calls if per_leg else self.shared_angle_calls
            target.append(self._text(call, part, kernel, {"angle": self._offset("angle", key)}))
        return {name: self._offset(name, key) for name in ("sine", "cosine")}

    def _offset(self, name: str, key: str) -> str:
        return f"{name} + {self._offsets[key]}" if self._offsets[key] else name

    def _tails(self, call: Call, phases: Phases) -> dict[str, str]:
        """Where the body leaves the operands of its arctangents; they are computed after the loop over the
        legs, or after the platform's kernels.
        """
        if not phases.tails:
            return {}
        if call.stage is Stage.SHARED:
            raise ValueError(f"{call.part}.{call.kernel}: arctangents of shared kernels are not put off")
        per_leg = call.stage is Stage.LEG
        stores = self.tail_stores if per_leg else self.platform_tail_stores
        first = str(self.tail_count) if self.tail_count else ""
        where = " + ".join(term for term in (first, f"{phases.tail_size} * i" if per_leg else "") if term)
        for tail in phases.tails:
            variable = self.known[call.variable_out(tail.port.name)]
            if variable.kind != "output" and variable.name not in self.read:
                continue  # nobody wants them
            if variable.kind != "output":
                raise ValueError(
                    f"{call.part}.{call.kernel}: the arctangents {tail.port.name!r} are not an output"
                )
            size = len(tail.slots)
            for index, slot in enumerate(tail.slots):
                place = str(index)
                if per_leg:
                    place = f"{size} * i + {index}" if size > 1 else "i"
                scalar = not per_leg and not variable.port.shape
                target = f"*{variable.name}" if scalar else f"{variable.name}[{place}]"
                stores.append((target, f"tail[{where} + {slot}]" if where else f"tail[{slot}]"))
        self.tail_count += phases.tail_size * (self.robot.legs if per_leg else 1)
        return {name: f"{name} + {where}" if where else name for name in ("tail_y", "tail_x")}

    def _text(
        self,
        call: Call,
        part: Part,
        kernel: Kernel,
        special: dict[str, str],
        indent: int | None = None,
        *,
        lanes: bool = False,
    ) -> str:
        arguments = [f"&g->{call.part}", "i"] if kernel.geometry is not None else []
        for port in kernel.inputs:
            arguments.append(
                special.get(port.name) or self._reference(call.variable_in(port.name), call.stage)
            )
        for port in kernel.outputs:
            text = special.get(port.name)
            arguments.append(text or self._reference(call.variable_out(port.name), call.stage, output=True))
        if indent is None:
            indent = 8 if call.stage is Stage.LEG else 4
        suffix = LANES.suffix if lanes else self.writing.suffix
        return broken(f"krhpr_{part.name}_{kernel.name}{suffix}", arguments, ";", indent)

    def _reference(self, name: str, stage: Stage, *, output: bool = False) -> str:
        """How a kernel's argument is written: a value, an array, or a pointer to a leg's part of an array."""
        variable = self.known[name]
        size, scalar = prod(variable.port.shape), not variable.port.shape
        if variable.port.layout is Layout.DIAGONAL:
            return f"{name}_block"
        if stage is Stage.LEG and variable.per_leg and (variable.kind != "local" or name in self.outside):
            if scalar:
                return f"&{name}[i]" if output else f"{name}[i]"
            return f"{name} + {size} * i" if size > 1 else f"{name} + i"
        if scalar and output and variable.kind == "local":
            return f"&{name}"
        if scalar and not variable.per_leg and variable.kind == "input" and self.writing is LANES:
            return f"{name}[0]"
        return name
