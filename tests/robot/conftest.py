"""Robots on both backends, and all their functions."""

from __future__ import annotations

import pytest

from krhpr import Robot
from tests.robot.support import BACKENDS, CASES, ROBOTS, load


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest, backend: str) -> Robot:
    return load(request.param, backend)


@pytest.fixture
def spatial(backend: str) -> Robot:
    return load("spatial_rrr_a", backend)


@pytest.fixture
def planar(backend: str) -> Robot:
    return load("planar_rr_a", backend)


@pytest.fixture
def fivebar(backend: str) -> Robot:
    return load("spatial_r_fivebar_a", backend)


@pytest.fixture(params=CASES, ids=".".join)
def case(request: pytest.FixtureRequest, backend: str) -> tuple[Robot, str]:
    """Every function of every robot."""
    identifier, function = request.param
    return load(identifier, backend), function
