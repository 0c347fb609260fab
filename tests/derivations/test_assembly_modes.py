"""Which sub-legs list their assembly modes: those that state them all."""

from __future__ import annotations

from krhpr.derivations.catalogue import catalogue
from krhpr.derivations.platforms.spatial_a import SpatialA
from krhpr.derivations.robots import Robot
from krhpr.derivations.sublegs.cpr import CPR3
from krhpr.derivations.sublegs.delta import Delta


class NewtonAlone(CPR3):
    """A sub-leg of which nothing but Newton steps is known."""

    def forward_roots(self) -> None:  # type: ignore[override]
        return None


def names(subleg: CPR3 | Delta) -> set[str]:
    return {function.name for function in Robot(subleg, SpatialA()).functions()}


def test_what_is_not_stated_is_not_offered() -> None:
    kernels = {kernel.name for kernel in NewtonAlone().kernels()}
    assert "forward_step" in kernels and not {"octic", "at_root", "forward_all"} & kernels
    assert "subleg_forward_all" not in names(NewtonAlone())
    assert {"subleg_forward", "forward"} <= names(NewtonAlone())
    assert "subleg_forward_all" in names(CPR3()) & names(Delta())


def test_every_closed_loop_of_the_catalogue_lists_its_modes() -> None:
    for entry in catalogue():
        subleg = entry.robot.subleg
        assert subleg.lists_assemblies == (subleg.assembly_count > 1), subleg.name
