"""What the command line says of itself, and what it does with wrong use."""

from __future__ import annotations

import pytest

import krhpr
from krhpr.cli.app import COMMANDS
from tests.cli.support import Cli

NAMES = ["list", "info", "eval", "certify", "generate", "compile", "validate", "study", "optimise", "schema"]


def test_help_names_every_command_and_exit_code(cli: Cli) -> None:
    result = cli("--help")
    assert result.code == 0
    assert [command.name for command in COMMANDS] == NAMES
    assert all(f"\n    {name} " in result.out for name in NAMES)
    assert all(f"\n  {code} " in result.out for code in (0, 1, 2, 3, 130))
    assert "examples:" in result.out and "KRHPR_BACKEND" in result.out


@pytest.mark.parametrize("name", NAMES)
def test_every_command_has_help_with_examples(name: str, cli: Cli) -> None:
    result = cli(name, "--help")
    assert result.code == 0
    assert result.out.startswith(f"usage: krhpr {name}")
    assert f"krhpr {name}" in result.out.partition("examples:")[2]
    assert max(map(len, result.out.splitlines())) <= 90


def test_version(cli: Cli) -> None:
    assert cli("--version").out == f"krhpr {krhpr.__version__}\n"


def test_no_command_shows_the_help(cli: Cli) -> None:
    result = cli()
    assert result.code == 2
    assert "commands:" in result.err


@pytest.mark.parametrize(
    "arguments",
    [["draw"], ["list", "--wrong"], ["info"], ["eval", "spatial_rrr_a"], ["generate", "--ou", "x"]],
)
def test_wrong_use_has_its_own_code(arguments: list[str], cli: Cli) -> None:
    result = cli(*arguments)
    assert result.code == 2
    assert result.err.startswith("usage: krhpr")


@pytest.mark.parametrize(
    "arguments", [["info"], ["compile"], ["validate"], ["generate", "--out", "x"], ["eval"]]
)
def test_an_unknown_robot_gives_the_nearest_names(arguments: list[str], cli: Cli) -> None:
    result = cli(*arguments, "spatial_rr_a", *(["inverse"] if arguments == ["eval"] else []))
    assert result.code == 2
    assert result.out == ""
    assert result.err.startswith("krhpr: no robot is called 'spatial_rr_a'; did you mean spatial_rrr_a")


def test_a_robot_unlike_any_other_gives_all_names(cli: Cli) -> None:
    err = cli("info", "xyz").err
    assert all(identifier in err for identifier in krhpr.catalogue())
