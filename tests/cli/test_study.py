"""`krhpr study`: a table, claims, pictures and numbers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from krhpr.study.forward_accuracy import APPROACHES, CONFIGURATIONS
from tests.cli.support import Cli
from tests.support import ROOT


def test_the_command(cli: Cli, tmp_path: Path) -> None:
    done = cli("study", "forward-accuracy", "--seed", "5", "--out", str(tmp_path))
    assert done.out.count("holds: ") == 8 and "DOES NOT HOLD" not in done.out
    assert "seven: Gauss-Newton, three" in done.out
    table = json.loads((tmp_path / "accuracy.json").read_text("utf-8"))
    assert table["seed"] == 5 and sum(table["position"]["counts"][APPROACHES[0]]) == CONFIGURATIONS
    assert (tmp_path / "accuracy_position.png").stat().st_size > 10_000
    refused = cli("study", "forward-accuracy", "--repeat", "0")
    assert refused.code == 2 and "--repeat is 0; it must be 1 or more" in refused.err


def test_grasping(cli: Cli, tmp_path: Path) -> None:
    example = str(ROOT / "examples" / "grasping_prototype.yaml")
    done = cli("study", "grasp", "--file", example, "--out", str(tmp_path))
    assert done.code == 0 and done.out.count("holds: ") == 2
    assert "0.8061 to 2.2605               0.3508" in done.out and "k = 21.15 N/rad" in done.out
    table = json.loads((tmp_path / "grasp.json").read_text("utf-8"))
    assert [len(row["torques_Nm"]) for row in table["trajectories"]] == [401] * 6
    assert (tmp_path / "grasp.png").stat().st_size > 10_000
    assert cli("study", "grasp", "--out", str(tmp_path)).out == done.out
    refused = cli("study", "forward-accuracy", "--file", example)
    assert (
        refused.code == 2
        and "--file belongs to grasp, grasp-capability, grasp-control; forward" in refused.err
    )
    slippery = tmp_path / "slippery.yaml"
    slippery.write_text(Path(example).read_text("utf-8").replace("friction: 0.5", "friction: 0.01"), "utf-8")
    done = cli("study", "grasp", "--file", str(slippery), "--out", str(tmp_path))
    assert (
        done.code == 3
        and "DOES NOT HOLD: every pose" in done.out
        and "no answer for (5.73) along x, 0.3 N: SLIPS at 0 s" in done.out
    )
    slippery.write_text("robot: arm\n", "utf-8")
    done = cli("study", "grasp", "--file", str(slippery), "--out", str(tmp_path))
    assert done.code == 2 and "missing: geometry" in done.err


def test_grasp_capability(cli: Cli, tmp_path: Path) -> None:
    example = str(ROOT / "examples" / "grasping_prototype.yaml")
    command = ("study", "grasp-capability", "--coarser", "18", "--out", str(tmp_path))
    done = cli(*command, "--file", example)
    assert done.code == 0 and done.out.count("holds: ") == 1
    assert "at the pose, most: 90.56 N: actuator" in done.out and " slips" in done.out
    table = json.loads((tmp_path / "grasp_capability.json").read_text("utf-8"))
    assert (
        len(table["turns"]) == 3 and [len(table[name]) for name in ("heights", "most", "moment")] == [11] * 3
    )
    assert (tmp_path / "grasp_capability.png").stat().st_size > 10_000
    weak = cli(*command, "--torque", "1e-6")
    assert weak.code == 3 and "at the pose the object cannot be held: " in weak.out
    for wrong, said in (("--torque", "--torque is -1"), ("--coarser", "--coarser is -1")):
        refused = cli("study", "grasp-capability", wrong, "-1")
        assert refused.code == 2 and said in refused.err
    refused = cli("study", "grasp", "--torque", "1")
    assert (
        refused.code == 2 and "--torque belongs to grasp-capability; grasp has no such option" in refused.err
    )


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


def test_designs(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_BACKEND", "auto")  # with NumPy alone it takes long
    quick = ("--coarser", "6", "--generations", "1", "--objectives", "volume")
    store = ("--store", str(tmp_path / "log"), "--vary", "redundant=1.2:2.2,R_p=0.1:0.15")
    done = cli("study", "design", *quick, *store, "--out", str(tmp_path))
    assert done.code == 0, done.err
    assert done.out.count("holds: ") == 8 and "DOES NOT HOLD" not in done.out
    assert "angles, 55 to 175    reach alone            546 to 625" in done.out
    assert "best volume" in done.out and "samples: " in done.err
    numbers = json.loads((tmp_path / "design.json").read_text("utf-8"))
    assert len(numbers["section_4_2"]) == 9 and len(numbers["front"]) == 1
    assert numbers["settings"]["objectives"] == ["volume"]
    names = ("design_families.png", "design_slices.png", "design_front.png")
    assert all((tmp_path / name).stat().st_size > 10_000 for name in names)
    assert "name: best_volume" in (tmp_path / "designs" / "best_volume.yaml").read_text("utf-8")
    for wrong, message in {
        ("--vary", "l_9=1:2"): "there is no l_9 to vary",
        ("--vary", "R_p=0.2:0.1"): "the bounds are 0.2 and 0.1",
        ("--vary", "R_b=0.9:0.95"): "designs works; the nearest",
        ("--objectives", "size"): "there is no objective 'size'",
        ("--workers", "0"): "0 processes; expected 1 or more",
        ("--robot", "planar_rr_a"): "spatial robots",
        ("--file", "x.yaml"): "--file belongs to grasp",
    }.items():
        refused = cli("study", "design", "--robot", "spatial_rrr_c", "--generations", "1", *wrong)
        assert refused.code == 2 and message in refused.err, refused.err
