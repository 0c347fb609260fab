"""Proofs about singularities of platform arrangements: their closed forms equal det J."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from krhpr.codegen.evaluate import evaluate_kernel
from krhpr.codegen.kernel import LEGS, Kernel
from krhpr.codegen.writer import KernelWriter
from krhpr.derivations.platforms.base import Platform
from krhpr.validation.arithmetic import RATIONAL
from krhpr.validation.check import Check
from krhpr.validation.configurations import Configuration, configuration
from krhpr.validation.draw import Draw
from krhpr.validation.jets import HALF
from krhpr.validation.linear import determinant
from krhpr.validation.numbers import Angle, Exact
from krhpr.validation.outcome import Measured, Runner
from krhpr.validation.proofs.platforms import whole
from krhpr.validation.proofs.surd import ROOT, THIRDS, Surd, rational_angle, surd
from krhpr.validation.subject import Subject


def closed_form_kernel(platform: Platform) -> Kernel:
    """The factors of det J in the redundant coordinates and the three legs' fields (`<field>_<leg>`)."""
    k = KernelWriter("closed_form", "Factors of det J.")
    redundant = [k.input(f"redundant_{leg}", ()) for leg in range(LEGS)]
    legs = [
        SimpleNamespace(
            **{field.name: k.input(f"{field.name}_{leg}", ()) for field in platform.geometry().fields}
        )
        for leg in range(LEGS)
    ]
    for index, value in enumerate(platform.closed_form(k, redundant, legs)):
        k.output(f"factor_{index}", value)
    return k.kernel()


def closed_form(platform: Platform, redundant: list[Any], geometry: dict[str, list[Any]]) -> list[Any]:
    """The closed form, evaluated."""
    kernel = closed_form_kernel(platform)
    inputs = {f"redundant_{leg}": [redundant[leg]] for leg in range(LEGS)}
    inputs |= {f"{name}_{leg}": [values[leg]] for name, values in geometry.items() for leg in range(LEGS)}
    results = evaluate_kernel(kernel, inputs, None, RATIONAL)
    return [results[port.name][0] for port in kernel.outputs]


def plate_fields(subject: Subject, geometry: Any) -> dict[str, list[Any]]:
    """The platform's fields alone."""
    return {field.name: list(geometry[field.name]) for field in subject.geometry_types["platform"].fields}


def determinants(subject: Subject, check: Check, count: int) -> Measured:
    """det J, its factors, and their closed forms."""
    found = Measured(check)
    source = Draw(check.seed)
    for _ in range(count):
        here = configuration(subject, source)
        J, gathered = whole(here)
        factors = evaluate_kernel(subject.derived("platform", "type_2"), gathered, None, here.arithmetic)[
            "type_2"
        ]
        product = factors[0] if len(factors) == 1 else factors[0] * factors[1]
        found.equal([product], [determinant(J)], "det J")
        wanted = closed_form(subject.platform, here.values["redundant"], plate_fields(subject, here.geometry))
        found.equal(factors, wanted, "closed form")
        found.samples += 1
    return found


def degree(subject: Subject, check: Check, count: int) -> Measured:
    """Both factors as functions of one redundant coordinate, the others held, from a few of their values."""
    found = Measured(check)
    source = Draw(check.seed)
    angular = subject.platform.redundant_joint.kind == "revolute"
    for _ in range(count):
        here = configuration(subject, source)
        for leg in range(LEGS):

            def factors(value: Any, leg: int = leg, here: Configuration = here) -> list[Any]:
                redundant = list(here.values["redundant"])
                redundant[leg] = value
                return _factors(here, redundant)

            if angular:
                angle = source.angle()
                zero, quarter, half = (Angle(*pair) for pair in ((1, 0), (0, 1), (-1, 0)))
                for index, (f, f_0, f_1, f_2) in enumerate(
                    zip(factors(angle), factors(zero), factors(quarter), factors(half), strict=True)
                ):
                    constant = HALF * (f_0 + f_2) if index else Exact(0)
                    sinusoid = (f_0 - constant) * angle.cos() + (f_1 - constant) * angle.sin()
                    found.equal([f], [constant + sinusoid], f"factor {index}, leg {leg + 1}")
            else:
                value = source.nonzero()
                line = [
                    a + value * (b - a) for a, b in zip(factors(Exact(0)), factors(Exact(1)), strict=True)
                ]
                found.equal(factors(value), line, f"leg {leg + 1}")
        found.samples += 1
    return found


def _factors(here: Configuration, redundant: list[Any]) -> list[Any]:
    """The factors of det J at other redundant coordinates."""
    gathered: dict[str, list[Any]] = {"line": [], "point": [], "scale": []}
    for leg in range(LEGS):
        result = here.kernel("platform", "line_of_redundant", leg, redundant=redundant[leg])
        for name, values in gathered.items():
            values += result[name]
    kernel = here.subject.derived("platform", "type_2")
    return evaluate_kernel(kernel, gathered, None, here.arithmetic)["type_2"]


def equilateral(subject: Subject, check: Check, count: int) -> Measured:
    """The formulas of the errata for an equilateral platform, factors and margins."""
    found = Measured(check)
    source = Draw(check.seed)
    plate = subject.geometry_types["platform"]
    for _ in range(count):
        geometry: dict[str, list[Any]] = {}
        for field in plate.fields:
            value = surd(source.length())
            geometry[field.name] = list(THIRDS) if field.name == "platform_azimuth" else [value] * LEGS
        angular = subject.platform.redundant_joint.kind == "revolute"
        redundant = [
            rational_angle(source.angle()) if angular else surd(source.length()) for _ in range(LEGS)
        ]
        d = subject.platform.space.dimension
        gathered: dict[str, list[Any]] = {"line": [], "point": [], "scale": []}
        pose = {"p": [surd(x) for x in source.vector(d)], "Q": [surd(x) for x in source.rotation(d)]}
        for leg in range(LEGS):
            s = subject.kernel(
                "platform", "end_point", {**pose, "redundant": [redundant[leg]]}, geometry, leg, RATIONAL
            )["s"]
            result = subject.kernel("platform", "line", {**pose, "s": s}, geometry, leg, RATIONAL)
            for name, values in gathered.items():
                values += result[name]
        got = evaluate_kernel(subject.derived("platform", "type_2"), gathered, None, RATIONAL)
        factors, margins = EQUILATERAL[subject.code.platform.name](redundant, geometry)
        for name, wanted in (("type_2", factors), ("margins", margins)):
            for index, (a, b) in enumerate(zip(got[name], wanted, strict=True)):
                found.worse(0.0 if surd(a) == surd(b) else 1.0, f"{name}[{index}]: {a!r} is not {b!r}")
        found.samples += 1
    return found


def _f(beta: list[Any]) -> Any:
    terms = [beta[i].sin() * (THIRDS[1] + beta[(i + 1) % 3] - beta[(i + 2) % 3]).sin() for i in range(3)]
    return terms[0] + terms[1] + terms[2]


def _g(beta: list[Any], r: Any, length: Any) -> Any:
    cosines = beta[0].cos() + beta[1].cos() + beta[2].cos()
    sines = [(THIRDS[1] + beta[i] - beta[(i + 1) % 3]).sin() for i in range(3)]
    return (
        HALF * 3 * ROOT * r * r
        - ROOT * r * length * cosines
        + length * length * (sines[0] + sines[1] + sines[2])
    )


def _spatial_a(beta: list[Any], g: dict[str, list[Any]]) -> tuple[list[Any], list[Any]]:
    r, length = g["R_p"][0], g["l_r"][0]
    f, normal = _f(beta), _g(beta, r, length)
    return [-(length * length * length * r * f), normal], [f, normal / (r * r)]


def _planar_a(beta: list[Any], g: dict[str, list[Any]]) -> tuple[list[Any], list[Any]]:
    r, length = g["R_p"][0], g["l_r"][0]
    return [-(length * length * length * r * _f(beta))], [_f(beta)]


def _spatial_c(d: list[Any], g: dict[str, list[Any]]) -> tuple[list[Any], list[Any]]:
    s_1, s_2 = d[0] + d[1] + d[2], d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    factors = [HALF * ROOT * s_1, HALF * ROOT * s_2]
    return factors, factors


def _spatial_b(d: list[Any], g: dict[str, list[Any]]) -> tuple[list[Any], list[Any]]:
    s_1, s_2 = d[0] + d[1] + d[2], d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    h = g["R_p"][0] - g["l_r"][0]
    along, normal = HALF * ROOT * s_1, HALF * ROOT * (h * h * 3 + s_2)
    return [-along, normal], [along, normal]


def _planar_slides(d: list[Any], g: dict[str, list[Any]]) -> tuple[list[Any], list[Any]]:
    # points b_i that are alike cancel: t_1 + t_2 + t_3 = 0
    factors = [HALF * ROOT * (d[0] + d[1] + d[2])]
    return factors, factors


EQUILATERAL: dict[str, Callable[..., tuple[list[Surd], list[Surd]]]] = {
    "platform_spatial_a": _spatial_a,
    "platform_spatial_b": _spatial_b,
    "platform_spatial_c": _spatial_c,
    "platform_planar_a": _planar_a,
    "platform_planar_b": _planar_slides,
    "platform_planar_c": _planar_slides,
}


# -- redundant link --------------------------------------------------------------------------------


RUNNERS: dict[str, Runner] = {
    "determinant of J": determinants,
    "degree": degree,
    "equilateral": equilateral,
}
