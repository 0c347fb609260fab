"""`krhpr optimise`: words, files, exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from krhpr.cli.optimise_command import METHODS
from krhpr.trajectory import Method
from tests.cli.support import Cli

EXAMPLE = str(Path(__file__).resolve().parents[2] / "examples" / "translation.yaml")


def test_the_command(cli: Cli, tmp_path: Path) -> None:
    done = cli("optimise", EXAMPLE, "spatial_rrr_a", "--out", str(tmp_path / "best"), "--plot")
    assert done.code == 0 and "all limits met; integral of eta_1^2 0.476" in done.out
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "best.csv",
        "best.npz",
        "best.png",
        "best_joints.yaml",
    ]
    assert all(str(path) in done.out for path in tmp_path.iterdir())


def test_limits_that_are_not_met_have_an_exit_code(cli: Cli) -> None:
    done = cli("optimise", EXAMPLE, "spatial_rrr_a", "--method", "scan", "--json")
    found = json.loads(done.out)
    assert done.code == 3 and not found["feasible"] and found["violations"][0]["relative"] > 1


@pytest.mark.compiler
def test_compiled_functions(cli: Cli) -> None:
    done = cli("optimise", EXAMPLE, "spatial_rrr_a", "--compile")
    assert done.code == 0 and "all limits met; integral of eta_1^2 0.476" in done.out


def test_the_gripper_of_the_example(cli: Cli, tmp_path: Path) -> None:
    folder = Path(EXAMPLE).parent
    arguments = (str(folder / "carry.yaml"), str(folder / "gripper.yaml"), "--out", str(tmp_path / "carry"))
    done = cli("optimise", *arguments, "--json")
    found = json.loads(done.out)
    assert done.code == 0 and found["feasible"] and found["limits"]["grip"]["opening"] == 0.06
    assert "opening [m]" in (tmp_path / "carry.csv").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["missing.yaml", "spatial_rrr_a"], "No such file"),
        ([EXAMPLE, "planar_rr_a"], "limits.margins: found a list of 2, expected a list of 1"),
        ([EXAMPLE, "spatial_rrr_a", "--plot"], "--plot takes --out NAME"),
        ([EXAMPLE, "spatial_prr_a"], "no factor of det M_i is called 'shoulder'"),
    ],
)
def test_wrong_use(arguments: list[str], message: str, cli: Cli) -> None:
    done = cli("optimise", *arguments)
    assert done.code in (1, 2) and message in done.err


def test_the_command_offers_every_method() -> None:
    """The help takes no NumPy, and therefore its own list."""
    assert tuple(Method) == METHODS
