"""The catalogue of generated robots, and loading one by name."""

from __future__ import annotations

from importlib import import_module

import krhpr.generated
from krhpr import __version__
from krhpr.backend import backend_name
from krhpr.errors import GeneratedMismatch, UnknownRobot
from krhpr.robot import Robot


def catalogue() -> tuple[str, ...]:
    """Identifiers of all robots."""
    _check_version()
    return tuple(krhpr.generated.ROBOTS)


def load(identifier: str, *, backend: str | None = None) -> Robot:
    """A robot of the catalogue, with its default geometry.

    `backend` is `auto` (compiled kernels where there is a compiler, else NumPy), `compiled` or `numpy`; the
    environment variable KRHPR_BACKEND sets it for all.
    """
    if identifier not in catalogue():
        raise UnknownRobot.among(identifier, catalogue())
    backend_name(backend)
    return Robot(import_module(f"krhpr.generated.python.{identifier}"), backend=backend)


def _check_version() -> None:
    written = getattr(krhpr.generated, "VERSION", None)
    if written != __version__:
        raise GeneratedMismatch(
            f"the generated robots were written by krhpr {written or 'of an unknown version'}, "
            f"this is krhpr {__version__}; "
            "run `krhpr generate` (or `make generate`)"
        )
