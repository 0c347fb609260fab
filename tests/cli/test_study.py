"""`krhpr study`: a table, claims, pictures and numbers."""

from __future__ import annotations

import json
from pathlib import Path

from krhpr.study.forward_accuracy import APPROACHES, CONFIGURATIONS
from tests.cli.support import Cli


def test_the_command(cli: Cli, tmp_path: Path) -> None:
    done = cli("study", "forward-accuracy", "--seed", "5", "--out", str(tmp_path))
    assert done.out.count("holds: ") == 8 and "DOES NOT HOLD" not in done.out
    assert "seven: Gauss-Newton, three" in done.out
    table = json.loads((tmp_path / "accuracy.json").read_text("utf-8"))
    assert table["seed"] == 5 and sum(table["position"]["counts"][APPROACHES[0]]) == CONFIGURATIONS
    assert (tmp_path / "accuracy_position.png").stat().st_size > 10_000
    refused = cli("study", "forward-accuracy", "--repeat", "0")
    assert refused.code == 2 and "--repeat is 0; it must be 1 or more" in refused.err


def test_the_dexterity_study(cli: Cli, tmp_path: Path) -> None:
    done = cli("study", "dexterity", "--out", str(tmp_path))
    assert done.code == 0 and done.out.count("holds: ") == 4 and "59.96" in done.out
    facts = json.loads((tmp_path / "dexterity.json").read_text("utf-8"))
    assert len(facts["position"]) == 721 and round(max(map(max, facts["range"])), 4) == 1.0466
    assert (tmp_path / "dexterity_ranges.png").stat().st_size > 10_000
    refused = cli("study", "dexterity", "--seed", "1")
    assert refused.code == 2 and "--seed belongs to forward-accuracy" in refused.err


def test_the_trajectory_study(cli: Cli, tmp_path: Path) -> None:
    done = cli("study", "trajectory", "--out", str(tmp_path))
    assert done.code == 0 and done.out.count("holds: ") == 7
    facts = json.loads((tmp_path / "trajectory.json").read_text("utf-8"))
    assert len(facts["compared"]) == 20 and len(facts["filtered"]["method one"]) == 301
    assert (tmp_path / "redundancy_best.png").exists()
