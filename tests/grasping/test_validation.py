"""`krhpr validate` for the grasping robots: the plan is complete, and it holds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from krhpr.validation.check import Check, Kind, Target
from krhpr.validation.outcome import State
from krhpr.validation.plan import WITH_GAPS, plan
from krhpr.validation.run import carry_out, run
from krhpr.validation.sampling import draw
from tests.grasping.exact import subject
from tests.grasping.support import ROBOTS

ONE_BY_ONE = (Kind.PASSES, Kind.AGREEMENT, Kind.DIGITS, Kind.INVARIANT)


@cache
def planned(name: str) -> tuple[Check, ...]:
    return tuple(plan(subject(name).code))


@pytest.mark.parametrize("name", ROBOTS)
def test_every_function_and_kernel_is_checked_on_every_target(name: str) -> None:
    code = subject(name).code

    def checked(kind: Kind) -> dict[str, set[Target]]:
        found: dict[str, set[Target]] = {}
        for check in planned(name):
            if check.kind is kind:
                found.setdefault(check.function, set()).add(check.target)
        return found

    functions = {function.name for function in code.functions}
    everywhere = {Target.C, Target.NUMPY, Target.CASADI}
    assert checked(Kind.AGREEMENT) == dict.fromkeys(functions, everywhere - {Target.NUMPY})
    exact = functions - set(WITH_GAPS)
    assert checked(Kind.DIGITS) == dict.fromkeys(exact, everywhere)
    kernels = {
        f"{key}.{kernel.name}"
        for key, part in (("subleg", code.subleg), ("platform", code.platform))
        for kernel in part.kernels
        if kernel.name not in WITH_GAPS
    }
    assert checked(Kind.IDENTITY) == dict.fromkeys({*exact, *kernels, "geometry"}, everywhere)
    assert set(checked(Kind.PASSES)) == kernels
    # what is not only compared with the derivation
    invariants = [check for check in planned(name) if check.kind is Kind.INVARIANT]
    taking_part = {function for check in invariants for function in (check.function, *check.also)}
    assert taking_part >= functions - {
        "inverse_status",
        "subleg_forward",
        "link_points",
        "subleg_jacobian",
        "singularity",
    }


@pytest.mark.parametrize("kind", [*ONE_BY_ONE, pytest.param(Kind.IDENTITY, marks=pytest.mark.full)])
@pytest.mark.parametrize("name", ROBOTS)
def test_the_plan_holds(name: str, kind: Kind, full: bool) -> None:
    """Texts in exact arithmetic are in test_printed too, with jaws of any length."""
    size = "large" if full else "small"
    results = [carry_out(subject(name), check, size) for check in planned(name) if check.kind is kind]
    assert results
    assert not [str(result) for result in results if result.state is State.FAILED]
    if all(result.state is State.NOT_RUN for result in results):
        pytest.skip(results[0].remark)


def test_a_run_knows_them() -> None:
    report = run(["planar_pp_a", "planar_grasp_rpr"], folder=None, kinds={Kind.PASSES})
    assert report.ok and {result.check.robot for result in report.results} == {
        "planar_pp_a",
        "planar_grasp_rpr",
    }


@pytest.mark.parametrize("name", ROBOTS)
def test_configurations_are_far_from_singularities_and_hold_an_object(name: str) -> None:
    one = subject(name)
    batch = draw(one, 5, 50)
    v = batch.values
    assert len(batch) == 50 and all(np.isfinite(values).all() for values in v.values())
    found = one.module.singularity(
        pivot=v["pivot"],
        s=v["s"],
        theta=v["theta"],
        geometry=one.module.DEFAULT_GEOMETRY.replace(**dict(batch.geometry)),
    )
    assert np.abs(found.factors).min() > 0.1 and np.abs(found.sine).min() > 0.1
    held, status = one.module.grasp(
        **{port.name: v[port.name] for port in one.code.function("grasp").inputs},
        geometry=one.module.DEFAULT_GEOMETRY,
        status=True,
    )
    assert (status == 0).all() and np.isfinite(held.loads).all()
    # sensors of both jaws, both sides of the joints
    assert 0 < v["sensor"][:, 0, 0].sum() < 50
    if name.endswith("prr"):
        assert len(np.unique(v["mode"].reshape(50 * 2, -1), axis=0)) > 1
