"""Identity: optimised kernels and printed texts equal the derivation, on numbers without rounding.

Every length and angle of every leg is random, and so are the arguments.  Functions of rational
operations, sines and cosines are compared without tolerance; those with roots or arctangents in ball
arithmetic, at reachable configurations, in every working and assembly mode.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from krhpr.codegen.composition import Guard, Relation, RobotFunction
from krhpr.codegen.evaluate import Arithmetic, evaluate_kernel, prepare_geometry
from krhpr.codegen.kernel import LEGS, Port
from krhpr.validation.arithmetic import BALLS, RATIONAL
from krhpr.validation.check import Check, Target
from krhpr.validation.draw import Draw
from krhpr.validation.numbers import BALL, EXACT, Ball, Exact, ball_precision
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.plan import has_roots, needs_balls
from krhpr.validation.printed import KERNELS, PRINTED, c_program
from krhpr.validation.sampling import Batch, draw
from krhpr.validation.subject import Fields, Inputs, Outputs, Subject

TURN = Fraction("6.283185307179586")
"""A full turn as the texts have it."""

OTHER_FORMS = 1
"""On how many samples the forms of a text beyond the first are run: they have its graphs, and no branches."""

NOT_CHOSEN: tuple[tuple[int, ...], ...] = ((),)
"""The signs of a mode that a function does not have, or that stays as drawn."""


# -- kernels ---------------------------------------------------------------------------------------


def optimised(subject: Subject, check: Check, count: int) -> Measured:
    """A kernel after all passes against the kernel as derived, its prepared geometry included."""
    part_name, name = check.function.split(".")
    part = subject.code.parts[part_name]
    kernel, derived = part.kernel(name), subject.derived(part_name, name)
    roots = has_roots(derived)
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for index in range(count):
            if roots:
                geometry, inputs = _reachable(subject, check.seed + index, derived.inputs, source)
            else:
                geometry = source.geometry(
                    *([part.geometry] if part.geometry else []), legs=subject.code.legs
                )
                inputs = {
                    port.name: source.port(port, subject.code.angular, full=False) for port in derived.inputs
                }
            arithmetic = BALLS if roots else RATIONAL
            results = []
            for version, kind in ((derived, subject.geometry_types.get(part_name)), (kernel, part.geometry)):
                prepared = None
                if kind is not None:
                    fields = {field.name: geometry[field.name][0] for field in kind.fields}
                    prepared = prepare_geometry(kind, fields, arithmetic)
                results.append(evaluate_kernel(version, inputs, prepared, arithmetic))
            found.samples += 1
            for port in derived.outputs:
                found.equal(results[1][port.name], results[0][port.name], port.name)
    return found


SQUARES = ("gram", "cofactors", "square", "position_gram", "rotation_gram", "largest", "smallest")
"""Inputs of kernels that are squares: positive, or positive definite."""


def _reachable(
    subject: Subject, seed: int, ports: tuple[Port, ...], source: Draw
) -> tuple[dict[str, list[Any]], dict[str, list[Any]]]:
    """Balls for a kernel with roots: the first leg of a consistent configuration with its posture, anything
    for what it lacks.
    """
    batch = draw(subject, seed, 1, spread=0.1)
    geometry = _balls(batch.geometry)
    inputs: dict[str, list[Any]] = {}
    joints = {name: [Ball(x) for x in batch.values[name][0][0].tolist()] for name in ("s", "theta")}
    posture = subject.kernel("subleg", "posture", joints, geometry, 0, BALLS)
    ties = subject.ties(geometry, BALLS)
    for port in ports:
        value = batch.values.get(port.name)
        if port.name == "turns":
            angles = [Ball(x) for x in batch.values["measured"][0][: port.shape[0]].tolist()]
            inputs[port.name] = [x for angle in angles for x in (angle.cos(), angle.sin())]
            continue
        if value is None and port.name in posture:
            inputs[port.name] = posture[port.name]
            continue
        if value is None and port.name in ties:
            inputs[port.name] = ties[port.name]
            continue
        if port.name in SQUARES:
            inputs[port.name] = [Ball(x) for x in source.positive(port.shape)]
            continue
        if value is None:
            inputs[port.name] = [Ball(source.nonzero()) for _ in range(port.size)]
            continue
        value = batch.argument(port)[0]
        numbers = (value[0] if port.per_leg else value).ravel().tolist()
        inputs[port.name] = [Ball(number) for number in numbers]
    if any(port.name == "Q" for port in ports) and subject.planar:
        inputs["Q"] = [Ball(value) for value in source.rotation(2)]
    return geometry, inputs


# -- printed texts ---------------------------------------------------------------------------------


def printed_text(subject: Subject, check: Check, count: int) -> Measured:
    """A function of a printed text against the derivation."""
    function = subject.code.function(check.function)
    balls = needs_balls(subject.code, function)
    found = Measured(check)
    with ball_precision():
        cases = (
            _cases_in_balls(subject, check, function, count)
            if balls
            else _rational_cases(subject, check, function, count)
        )
        for inputs, geometry in cases:
            numbers = BALL if balls else EXACT
            wanted = derivation(subject, function, inputs, geometry, BALLS if balls else RATIONAL)
            found.samples += 1
            first, *others = PRINTED[check.target]
            for run in (first, *(others if found.samples <= OTHER_FORMS else ())):
                if not found.ok:
                    break
                got = run(subject, function, inputs, geometry, numbers)
                if got is None:
                    continue
                for port in function.outputs:
                    found.equal(got[port.name], wanted[port.name], port.name)
    return found


def _rational_cases(
    subject: Subject, check: Check, function: RobotFunction, count: int
) -> Iterator[tuple[Inputs, Fields]]:
    source = Draw(check.seed)
    given = {port.name for port in function.outputs}
    guards = [g for g in function.guards if g.variable in given and g.relation is Relation.AT_LEAST]
    for _ in range(count):
        while True:
            inputs = source.inputs(subject.code, function)
            geometry = source.geometry(*subject.geometry_types.values(), legs=subject.code.legs)
            if not guards or _answered(derivation(subject, function, inputs, geometry, RATIONAL), guards):
                break
        yield inputs, geometry


def _answered(outputs: Outputs, guards: Sequence[Guard]) -> bool:
    """Whether what a function gives is not too small for it to be an answer."""
    return all(outputs[guard.variable][guard.index] >= Exact(Fraction(guard.limit)) for guard in guards)


def _cases_in_balls(
    subject: Subject, check: Check, function: RobotFunction, count: int
) -> Iterator[tuple[Inputs, Fields]]:
    """Reachable configurations, each in every working (or assembly) mode: leg i in the mode i places
    further.
    """
    names = {port.name for port in function.inputs}
    modes = subject.code.mode_signs if "mode" in names else NOT_CHOSEN
    one_platform = "side" in names  # in other assembly modes of legs the end points are not a platform's
    assemblies = subject.code.assembly_signs if "assembly" in names and not one_platform else NOT_CHOSEN
    for index in range(count):
        batch = draw(subject, check.seed + index, 1, spread=0.1)
        geometry = _balls(batch.geometry)
        for choice in range(max(len(modes), len(assemblies))):
            inputs = in_balls(batch, function, 0)
            for name, signs in (("mode", modes), ("assembly", assemblies)):
                if signs[0]:
                    inputs[name] = [
                        Ball(s)
                        for leg in range(subject.code.legs)
                        for s in signs[(choice + leg) % len(signs)]
                    ]
            yield inputs, geometry


def in_balls(batch: Batch, function: RobotFunction, index: int) -> dict[str, list[Any]]:
    """The arguments of one configuration, each double by its exact value."""
    return {
        name: [Ball(value) for value in values] for name, values in batch.element(function, index).items()
    }


def _balls(geometry: Fields) -> dict[str, list[Any]]:
    return {name: [Ball(value) for value in values] for name, values in geometry.items()}


def derivation(
    subject: Subject, function: RobotFunction, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic
) -> Outputs:
    """A function by the derivation; procedures by their definition."""
    if function.steps:
        found = dict(inputs)
        for step in function.steps:
            called = subject.code.function(step.function)
            given = {port.name: found[step.variable_in(port.name)] for port in called.inputs}
            found |= derivation(subject, called, given, geometry, arithmetic)
        return {port.name: list(found[port.name]) for port in function.outputs}
    if not function.chooses:
        return subject.function(function, inputs, geometry, arithmetic)
    return {"theta": nearest_mode(subject, inputs, geometry, arithmetic)}


def nearest_mode(subject: Subject, inputs: Inputs, geometry: Fields, arithmetic: Arithmetic) -> list[Any]:
    """`inverse_near` by its definition: the nearest of all modes, each angle with the full turns that
    bring it near.
    """
    every = subject.call("inverse_all", inputs, geometry, arithmetic)["theta"]
    n, modes = subject.subleg.n, len(subject.code.mode_signs)
    turn = arithmetic.constant(TURN)
    result: list[Any] = []
    for leg in range(LEGS):
        wanted = inputs["theta_near"][leg * n : (leg + 1) * n]
        candidates = []
        for mode in range(modes):
            start = (leg * modes + mode) * n
            theta = every[start : start + n]
            theta = [
                angle + turn * ((near - angle) / turn + Fraction(1, 2)).floor() if angular else angle
                for angle, near, angular in zip(theta, wanted, subject.code.angular, strict=True)
            ]
            distance = sum(
                ((a - b) * (a - b) for a, b in zip(theta, wanted, strict=True)),
                arithmetic.constant(Fraction(0)),
            )
            candidates.append((distance, theta))
        best = candidates[0]
        for candidate in candidates[1:]:
            if candidate[0] < best[0]:
                best = candidate
        result += best[1]
    return result


# -- kernels by themselves -----------------------------------------------------------------


def kernel_text(subject: Subject, check: Check, count: int) -> Measured:
    """A printed kernel by itself against the derivation, for the first leg."""
    key, name = check.function.split(".")
    derived = subject.derived(key, name)
    roots = has_roots(derived)
    found = Measured(check)
    source = Draw(check.seed)
    with ball_precision():
        for index in range(count):
            if roots:
                geometry, inputs = _reachable(subject, check.seed + index, derived.inputs, source)
            else:
                geometry = source.geometry(*subject.geometry_types.values(), legs=subject.code.legs)
                inputs = {
                    port.name: source.port(port, subject.code.angular, full=False) for port in derived.inputs
                }
            wanted = subject.kernel(key, derived, inputs, geometry, 0, BALLS if roots else RATIONAL)
            found.samples += 1
            first, *others = KERNELS[check.target]
            for run in (first, *(others if found.samples <= OTHER_FORMS else ())):
                if not found.ok:
                    break
                got = run(subject, key, derived, inputs, geometry, BALL if roots else EXACT)
                for port in derived.outputs:
                    found.equal(got[port.name], wanted[port.name], port.name)
    return found


# -- default sizes ---------------------------------------------------------------------------------


def default_sizes(subject: Subject, check: Check, count: int) -> Measured:
    """The default geometry of a target against the catalogue, digit by digit."""
    found = Measured(check, samples=1)
    legs = range(subject.code.legs)
    wanted = [Exact(repr(subject.entry.sizes[name][leg])) for leg in legs for name in subject.fields]
    found.equal(_default_sizes(subject, check.target), wanted, "sizes")
    return found


def _default_sizes(subject: Subject, target: Target) -> list[Any]:
    if target is Target.NUMPY:
        return [Exact(repr(value)) for value in subject.module.DEFAULT_GEOMETRY.flat().tolist()]
    if target is Target.CASADI:
        return [Exact(repr(value)) for value in subject.casadi.DEFAULT_GEOMETRY]
    # the interpreter reads each literal as the decimal number that it shows; sines are computed in balls
    with ball_precision():
        program = c_program(subject, BALL)
        structure = program.new_struct(f"krhpr_{subject.identifier}_geometry")
        program.call(f"krhpr_{subject.identifier}_default_geometry", structure)
        return [
            _decimal(getattr(getattr(structure, part), field.name)[leg])
            for leg in range(subject.code.legs)
            for part, kind in subject.geometry_types.items()
            for field in kind.fields
        ]


def _decimal(value: Ball) -> Exact:
    """The shortest decimal number in a narrow enclosure."""
    return Exact(repr(float(value.enclosure.mid())))


RUNNERS: dict[str, Runner] = {
    "optimised": optimised,
    "printed text": printed_text,
    "kernel text": kernel_text,
    "default sizes": default_sizes,
}
"""The code of each check by its name in the plan."""
