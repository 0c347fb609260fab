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


def test_the_workspace(cli: Cli, tmp_path: Path) -> None:
    done = cli(
        "study", "workspace", "--coarser", "12", "--out", str(tmp_path), "--store", str(tmp_path / "maps")
    )
    assert done.code == 0
    assert done.out.count("holds: ") == 4 and "DOES NOT HOLD" not in done.out
    numbers = json.loads((tmp_path / "workspace.json").read_text("utf-8"))
    assert numbers["settings"]["robot"] == "spatial_r_fivebar_a"
    assert len(numbers["layers_m"]) == len(numbers["heights_m"])
    assert (tmp_path / "workspace_level.png").stat().st_size > 10_000
    assert "layers: " in done.err
    refused = cli("study", "workspace", "--coarser", "7")
    assert refused.code == 2 and "--coarser is 7; it must be a divisor of 360" in refused.err
    planar = cli("study", "workspace", "--robot", "planar_rr_a", "--out", str(tmp_path))
    assert planar.code == 2 and "spatial robots" in planar.err
