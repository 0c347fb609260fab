"""casadi.external on the compiled C: values, Jacobians and a solver's answer are those of the SX functions.

The same graph stands behind both, but this project's own code prints, lays out and differentiates the C, and
CasADi the SX functions.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from itertools import pairwise
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr.defaults import SIGNS
from tests.c.support import CHOICES, CONFORMANCE, ROBOTS, SOURCES, program, run, sections
from tests.support import large

ca = pytest.importorskip("casadi")

SHIMS = SOURCES / "casadi"
SANITIZE = ("-fsanitize=address", "-fno-sanitize-recover=all")
Load = Callable[..., Path]


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Load:
    """Makes a robot's library, each kind once; the object that it is linked from lies beside it (.o)."""
    folder = tmp_path_factory.mktemp("external")

    @cache
    def library(robot: str, *flags: str) -> Path:
        target = folder / f"{len(list(folder.iterdir()))}_{robot}.so"
        source, compiled = SHIMS / f"krhpr_{robot}_casadi.c", target.with_suffix(".o")
        run([program("cc"), "-O0", *flags, "-fPIC", "-c", source, "-o", compiled])
        run([program("cc"), "-shared", compiled, "-o", target, "-lm"])
        return target

    return library


@cache
def sx(robot: str) -> Mapping[str, Any]:
    """The SX functions for the default geometry."""
    module = import_module(f"krhpr.generated.casadi.{robot}")
    geometry = np.ravel(module.DEFAULT_GEOMETRY)
    return {name: make(geometry) for name, make in module.FUNCTIONS.items()}


@cache
def without_jacobian(robot: str) -> frozenset[str]:
    """Functions with a kink, as CasADi's own instructions tell, and constant ones."""
    kinks = {ca.OP_FABS, ca.OP_FMIN, ca.OP_FMAX}
    return frozenset(
        name
        for name, function in sx(robot).items()
        if kinks & {function.instruction_id(k) for k in range(function.n_instructions())}
        or not function.jacobian().nnz_out()
    )


@pytest.fixture
def external(robot: str, library: Load) -> Callable[[str], Any]:
    return lambda name: ca.external(f"krhpr_{robot}_{name}", str(library(robot)))


@cache
def configurations(identifier: str, count: int) -> list[dict[str, np.ndarray]]:
    """Configurations in reach and away from singularities of the legs, in the default working mode, with
    rates and accelerations; CasADi's shapes.
    """
    robot = krhpr.load(identifier, backend="numpy")
    rng = np.random.default_rng(11)
    many = 60 * count
    slide = robot.signature("end_points").inputs[2].unit == "m"
    redundant = rng.uniform(0.0, 0.2, (many, 3)) if slide else rng.uniform(0.8, 2.3, (many, 3))
    if robot.planar:
        p, turn = rng.uniform(-0.1, 0.1, (many, 2)), rng.uniform(-0.4, 0.4, many)
    else:
        p = rng.uniform([-0.1, -0.1, 0.25], [0.1, 0.1, 0.45], (many, 3))
        turn = np.linalg.qr(np.eye(3) + 0.2 * rng.normal(size=(many, 3, 3)))[0]
        turn *= np.sign(np.einsum("...ii->...i", turn))[..., None, :]
    # redundant sub-legs off the swivel at which an angle of theirs is a half turn, as good as minus one
    swivel = {"swivel": np.full(3, 0.3)} if robot.redundant_legs else {}
    theta, status = robot.inverse(p, turn, redundant, **swivel, status=True)
    s = robot.end_points(p, turn, redundant)
    factors = robot.singularity(p, turn, s, theta, check=False).factors
    good = np.flatnonzero((status == 0) & (np.abs(factors) > 0.1).all(axis=(1, 2)))[:count]
    assert len(good) == count
    held = grasp(robot) if "grasp" in robot.functions else {}
    return [
        {
            "p": p[k],
            "phi" if robot.planar else "Q": turn[k],
            "redundant": redundant[k],
            "theta": theta[k],
            "s": s[k],
            "swivel": np.full(3, 0.3),
            **held,
            "rates": rng.normal(size=100),
        }
        for k in good
    ]


def grasp(robot: krhpr.Robot) -> dict[str, np.ndarray]:
    """Jaws that hold an object by friction, whatever it weighs, with contacts along the slides."""
    still = (np.zeros(2), 0.0) if robot.planar else (np.zeros(3), np.eye(3))
    near, far = (robot.end_points(*still, np.full(3, slide)) for slide in (0.0, 0.03))
    centre = np.full(len(still[0]), 0.001)
    return {
        "contacts": far - near,
        "mass_centre": centre,
        "normal_forces": np.array([2.0, 2.1, 1.9]),
        "friction": np.full(1, 10.0),
    }


def arguments(identifier: str, function: Any, at: Mapping[str, np.ndarray]) -> list[Any]:
    """The inputs of a CasADi function at a configuration."""
    robot = krhpr.load(identifier, backend="numpy")
    branches = {"mode": robot.mode_signs, "assembly": robot.assembly_signs}
    found, used = [], 0
    for k in range(function.n_in()):
        name, shape = function.name_in(k), function.size_in(k)
        if name in branches:
            default = robot.default_mode if name == "mode" else robot.assemblies[0]
            value = branches[name](default)
        elif name in at:
            value = at[name]
        elif name == "measured":  # off the poses at which mismatches are zero, and have a kink
            value = at["redundant"][: prod(shape)] + 1e-3 * np.arange(1, 1 + prod(shape))
        elif name == "tolerance":
            value = np.full(shape, 0.05)
        elif name == "characteristic_length":
            value = np.full(shape, 0.3)
        elif name in SIGNS:
            value = np.ones(shape)
        else:
            value, used = at["rates"][used : used + shape[0] * shape[1]], used + shape[0] * shape[1]
        found.append(ca.DM(np.reshape(value, shape)))
    return found


def matrices(values: Any) -> list[np.ndarray]:
    return [np.asarray(value.full()) for value in values]


# -- the interface ------------------------------------------------------------------------------------------


def test_every_kernel_function_is_there(robot: str, external: Callable[[str], Any]) -> None:
    """With the names, shapes and sparsity of the SX function, and a Jacobian of the same shape."""
    for name, expected in sx(robot).items():
        found = external(name)
        assert found.name_in() == expected.name_in() and found.name_out() == expected.name_out()
        for k in range(expected.n_in()):
            assert found.sparsity_in(k) == expected.sparsity_in(k)
            assert found.is_diff_in(k) == (found.name_in(k) not in CHOICES)
        for k in range(expected.n_out()):
            assert found.sparsity_out(k) == expected.sparsity_out(k)
        if name in without_jacobian(robot):
            with pytest.raises(RuntimeError, match="jacobian"):
                found.jacobian()
        else:
            jacobian, whole = found.jacobian(), expected.jacobian()
            assert jacobian.name_in() == whole.name_in() and jacobian.name_out() == whole.name_out()
            for k in range(whole.n_in()):
                assert jacobian.sparsity_in(k) == whole.sparsity_in(k)
            for k in range(whole.n_out()):
                assert jacobian.size_out(k) == whole.size_out(k)


def test_values_are_those_of_sx(robot: str, external: Callable[[str], Any], full: bool) -> None:
    for name, expected in sx(robot).items():
        found = external(name)
        for at in configurations(robot, 200 if large(robot, full) else 20):
            given = arguments(robot, expected, at)
            for got, want in zip(found.call(given), expected.call(given), strict=True):
                scale = max(1.0, np.abs(want.full()).max())
                np.testing.assert_allclose(got.full(), want.full(), rtol=0, atol=1e-12 * scale)


def test_jacobians_are_those_of_sx(robot: str, external: Callable[[str], Any], full: bool) -> None:
    """Block by block, and no element is left out of the sparsity."""
    for name in sx(robot).keys() - without_jacobian(robot):
        expected, found = sx(robot)[name].jacobian(), external(name).jacobian()
        outputs = [0] * sx(robot)[name].n_out()
        branches = [f"_{branch}" for branch in CHOICES]
        for at in configurations(robot, 100 if large(robot, full) else 10):
            given = [*arguments(robot, sx(robot)[name], at), *outputs]
            blocks = zip(expected.name_out(), found.call(given), expected.call(given), strict=True)
            for block, got, want in blocks:
                if block.endswith(tuple(branches)):
                    assert got.nnz() == 0
                    continue
                scale = max(1.0, np.abs(want.full()).max())
                np.testing.assert_allclose(got.full(), want.full(), rtol=0, atol=1e-10 * scale, err_msg=block)


def test_jacobians_against_finite_differences(robot: str, external: Callable[[str], Any], full: bool) -> None:
    """Of the compiled functions themselves, input by input; central differences of sixth order."""
    step = 1e-4
    for name in sx(robot).keys() - without_jacobian(robot):
        function = external(name)
        jacobian = function.jacobian()
        ports = krhpr.load(robot, backend="numpy").signature(name).outputs
        angular = {port.name for port in ports if port.unit in ("rad", "rad or m")}
        # what has three dimensions is a matrix for each leg, numbered
        angles = [function.name_out(o).rstrip("123") in angular for o in range(function.n_out())]
        for at in configurations(robot, 2):
            given = arguments(robot, function, at)
            blocks = matrices(jacobian.call([*given, *[0] * function.n_out()]))
            for i in range(function.n_in()):
                if function.name_in(i) in CHOICES:
                    continue
                for column in range(given[i].numel()):
                    slopes = central(function, given, i, column, step, angles)
                    for o, slope in enumerate(slopes):
                        exact = blocks[o * function.n_in() + i][:, column]
                        scale = max(1.0, np.abs(exact).max())
                        np.testing.assert_allclose(exact, slope, rtol=0, atol=2e-6 * scale)


def central(
    function: Any, given: list[Any], i: int, element: int, step: float, angles: list[bool]
) -> list[np.ndarray]:
    """The slope of every output along one element of input i; of angles along the smaller arc."""

    def values(distance: float) -> list[np.ndarray]:
        moved = list(given)
        moved[i] = ca.DM(given[i])
        moved[i][element] += distance
        return [ca.vec(ca.densify(value)).full().ravel() for value in function.call(moved)]

    slopes = [np.zeros(function.numel_out(o)) for o in range(function.n_out())]
    for place, weight in ((1, 45), (2, -9), (3, 1)):
        pairs = zip(values(place * step), values(-place * step), strict=True)
        for slope, (high, low), angle in zip(slopes, pairs, angles, strict=True):
            gap = high - low
            slope += weight / 60 / step * (np.arctan2(np.sin(gap), np.cos(gap)) if angle else gap)
    return slopes


def test_branches_not_given_are_the_default(robot: str, external: Callable[[str], Any]) -> None:
    at = configurations(robot, 1)[0]
    function = external("inverse")
    given = arguments(robot, function, {**at, "swivel": np.zeros(3)})
    without = dict(zip(function.name_in()[:3], given[:3], strict=True))
    np.testing.assert_array_equal(function(**without)["theta"].full(), function.call(given)[0].full())
    whole = arguments(robot, function, at)
    np.testing.assert_allclose(function.call(whole)[0].full(), at["theta"], rtol=0, atol=1e-12)


def test_no_answer_is_nan(robot: str, external: Callable[[str], Any]) -> None:
    """Out of reach of leg 1: its angles and their derivatives are NaN, those of the others are not."""
    at = dict(configurations(robot, 1)[0])
    s = np.array(at["s"])
    s[0] += 10.0
    function = external("subleg_inverse")
    if not krhpr.load(robot, backend="numpy").subleg_inverse(s, status=True)[1]:
        pytest.skip("every point is within reach of its sub-legs")
    given = arguments(robot, function, {**at, "s": s})
    values = matrices(function.call(given))
    blocks = matrices(function.jacobian().call([*given, *[0] * function.n_out()]))
    assert np.isnan(values[0]).all() and np.isnan(blocks[0]).any(axis=1).all()
    assert not np.isnan(values[1]).all() and not np.isnan(blocks[1]).all()


@pytest.mark.usefixtures("in_turns")
def test_work_is_enough_and_null_pointers_are_taken(
    robot: str, compiler: str, tmp_path: Path, full: bool
) -> None:
    """CasADi's C interface itself, under sanitizers, with buffers of exactly the stated sizes."""
    undefined = ["-fsanitize=undefined"] if full else []  # takes the compiler as long as all the rest
    names = [f"krhpr_{robot}_{name}" for name in sx(robot)]
    names += [f"jac_krhpr_{robot}_{name}" for name in sx(robot) if name not in without_jacobian(robot)]
    (tmp_path / "entries.h").write_text("".join(f"ENTRY({name}),\n" for name in names))
    harness = Path(__file__).with_name("casadi_calls.c")
    shim = f'-DSHIM="{SHIMS / f"krhpr_{robot}_casadi.c"}"'
    run(
        [
            compiler,
            "-std=c11",
            "-O0",
            "-g",
            *SANITIZE,
            *undefined,
            shim,
            f"-I{tmp_path}",
            harness,
            "-o",
            tmp_path / "calls",
            "-lm",
        ]
    )
    run([tmp_path / "calls"])


# -- the source ---------------------------------------------------------------------------------------------


def test_strict_c99(robot: str, compiler: str) -> None:
    source = SHIMS / f"krhpr_{robot}_casadi.c"
    run([compiler, *CONFORMANCE, "-O2", "-fsyntax-only", source])


def test_no_writable_data_and_no_other_names(robot: str, library: Load) -> None:
    """Tables are constant; what is exported is what CasADi looks up."""
    compiled = library(robot).with_suffix(".o")
    written = re.compile(r"\.(data(?!\.rel\.ro)|bss|tdata|tbss)\b")
    assert not {name: size for name, size in sections(compiled).items() if written.match(name) and size}
    names = [line.split() for line in run([program("nm"), compiled]).splitlines()]
    offered = {name for *_, kind, name in names if kind == "T"}
    wanted = r"_n_in|_n_out|_name_in|_name_out|_sparsity_in|_sparsity_out|_work|_diff_in|"
    functions = "|".join(sx(robot))
    assert all(re.fullmatch(rf"(jac_)?krhpr_{robot}_({functions})({wanted})", name) for name in offered)


@pytest.mark.parametrize("robot", ["planar_rr_a"])
def test_a_name_and_a_geometry_of_ones_own(robot: str, tmp_path: Path) -> None:
    """Another prefix, so that a program can hold the plain C as well; the geometry from a header."""
    module = import_module(f"krhpr.generated.casadi.{robot}")
    from krhpr.codegen.bake import baked_geometry
    from krhpr.codegen.pipeline import derive
    from krhpr.derivations.catalogue import catalogue

    (code,) = derive([entry for entry in catalogue() if entry.identifier == robot]).robots
    sizes = {name: tuple(1.1 * x for x in values) for name, values in code.default_geometry.items()}
    (tmp_path / "mine.h").write_text(baked_geometry(code, "geometry", sizes))
    target = tmp_path / "mine.so"
    flags = ['-DKRHPR_CASADI_GEOMETRY="mine.h"', "-DKRHPR_CASADI_PREFIX=my_", f"-I{tmp_path}"]
    sources = [SHIMS / f"krhpr_{robot}_casadi.c", SOURCES / f"krhpr_{robot}.c"]
    run([program("cc"), "-O0", *flags, "-fPIC", "-shared", *sources, "-o", target, "-lm"])
    flat = [sizes[name][leg] for leg in range(3) for name in module.FIELDS]
    expected, found = module.end_points(flat), ca.external("my_end_points", str(target))
    given = arguments(robot, expected, configurations(robot, 1)[0])
    np.testing.assert_allclose(
        found.call(given)[0].full(), expected.call(given)[0].full(), rtol=0, atol=1e-14
    )
    assert found.jacobian().name() == "jac_my_end_points"


# -- in use -------------------------------------------------------------------------------------------------


def test_inside_an_expression(robot: str, external: Callable[[str], Any]) -> None:
    """Forward and reverse derivatives of an expression that calls it, and a map over threads."""
    function, reference = external("end_points"), sx(robot)["end_points"]
    at = configurations(robot, 1)[0]
    values = arguments(robot, function, at)

    def slope(f: Any) -> Any:
        symbols = [ca.MX.sym(f.name_in(k), *f.size_in(k)) for k in range(f.n_in())]
        cost = ca.sumsqr(f(*symbols)) ** 2
        x = symbols[2]
        results = [ca.gradient(cost, x), ca.jtimes(cost, x, ca.sin(x)), ca.jacobian(ca.vec(f(*symbols)), x)]
        return ca.Function("slope", symbols, results)

    for got, want in zip(slope(function).call(values), slope(reference).call(values), strict=True):
        np.testing.assert_allclose(got.full(), want.full(), rtol=1e-12, atol=1e-12)
    columns = [ca.horzcat(*[value] * 8) for value in values]
    mapped = function.map(8, "thread", 2).call(columns)[0]
    np.testing.assert_array_equal(mapped.full(), np.tile(function.call(values)[0].full(), 8))


@pytest.mark.parametrize("robot", ["planar_rr_a"])
def test_in_code_that_casadi_generates(robot: str, library: Load, tmp_path: Path) -> None:
    """C from casadi.CodeGenerator calls the shim by its name: both compile into one library."""
    inner = ca.external(f"krhpr_{robot}_end_points", str(library(robot)))
    symbols = [ca.MX.sym(inner.name_in(k), *inner.size_in(k)) for k in range(inner.n_in())]
    cost = ca.sumsqr(inner(*symbols))
    outer = ca.Function("outer", symbols, [cost, ca.gradient(cost, symbols[2])])
    generator = ca.CodeGenerator("outer.c")
    generator.add(outer)
    generator.generate(f"{tmp_path}/")
    sources = [tmp_path / "outer.c", SHIMS / f"krhpr_{robot}_casadi.c"]
    run([program("cc"), "-O0", "-fPIC", "-shared", *sources, "-o", tmp_path / "outer.so", "-lm"])
    compiled = ca.external("outer", str(tmp_path / "outer.so"))
    values = arguments(robot, inner, configurations(robot, 1)[0])
    for got, want in zip(compiled.call(values), outer.call(values), strict=True):
        np.testing.assert_allclose(got.full(), want.full(), rtol=1e-14)


def least_motion(functions: Callable[[str], Any], identifier: str) -> tuple[np.ndarray, float, str, float]:
    """Redundant coordinates along a small motion of the platform for which the actuated joints move least.

    IPOPT with approximate Hessians (externals have no second derivatives); type II margins stay positive.
    """
    end_points, inverse, singularity = (functions(name) for name in ("end_points", "inverse", "singularity"))
    robot = krhpr.load(identifier, backend="numpy")
    mode = robot.mode_signs(robot.default_mode)
    steps, least, which = 4, 0.002, "phi" if robot.planar else "Q"

    def margin(at: Mapping[str, np.ndarray]) -> float:
        return float(robot.singularity(at["p"], at[which], at["s"], at["theta"]).margins.min())

    at = next(at for at in configurations(identifier, 20) if margin(at) > 10 * least)
    turn = at[which]
    redundant = ca.MX.sym("redundant", 3, steps)
    joints, limits = [ca.DM(at["theta"])], []
    direction = np.array([0.02, -0.01, 0.015])[: at["p"].size]
    for k in range(steps):
        p = at["p"] + (k + 1) / steps * direction
        known = {"p": p, which: turn, "redundant": redundant[:, k], "mode": mode, "swivel": at["swivel"]}
        theta = inverse(*(known[name] for name in inverse.name_in()))
        joints.append(theta)
        margins = singularity(p, turn, end_points(p, turn, redundant[:, k]), theta)[3]
        limits.append(margins)
    cost = sum(ca.sumsqr(b - a) for a, b in pairwise(joints))
    problem = {"x": ca.vec(redundant), "f": cost, "g": ca.vertcat(*limits)}
    options = {
        "ipopt": {"hessian_approximation": "limited-memory", "print_level": 0, "sb": "yes", "tol": 1e-7},
        "print_time": False,
    }
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    guess = ca.repmat(ca.DM(at["redundant"]), steps, 1)
    found = solver(x0=guess, lbg=least, ubg=ca.inf)
    at_guess = ca.Function("cost", [problem["x"]], [cost])(guess)
    return found["x"].full().ravel(), float(found["f"]), solver.stats()["return_status"], float(at_guess)


def test_ipopt_finds_the_same(robot: str, external: Callable[[str], Any], full: bool) -> None:
    """The same problem on externals and on SX functions: the same optimum, better than the first guess."""
    x, cost, said, guess = least_motion(external, robot)
    expected_x, expected_cost, expected_said, _ = least_motion(lambda name: sx(robot)[name], robot)
    assert said == expected_said == "Solve_Succeeded"
    assert cost < 0.9 * guess
    assert cost == pytest.approx(expected_cost, rel=1e-6)
    np.testing.assert_allclose(x, expected_x, rtol=0, atol=1e-4)


def test_a_missing_library_is_told(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError):
        ca.external("krhpr_planar_rr_a_twist", str(tmp_path / "none.so"))


def test_the_head_of_the_source_says_how_to_use_it() -> None:
    for robot in ROBOTS:
        text = (SHIMS / f"krhpr_{robot}_casadi.c").read_text()
        assert f'casadi.external("krhpr_{robot}_twist"' in text[:900]
