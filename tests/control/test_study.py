"""`krhpr study grasp-control`: its claims, files and messages."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import krhpr.study.grasp_control as study
from krhpr.cli import main
from krhpr.study.grasp_control import CONTROLLERS, grasp_control
from tests.support import ROOT

GRASP = ROOT / "examples" / "grasping_prototype.yaml"
CONTROL = ROOT / "examples" / "grasping_control.yaml"


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A study of seconds: few inputs, led to quickly, and short trajectories; the file that says so."""
    for name, value in {"SHARES": (0.5, 1.0), "RAMP": 0.1, "HOLD": 0.1, "LOOK": 0.05, "AFTER": 1.6}.items():
        monkeypatch.setattr(study, name, value)
    path = tmp_path / "grasp.yaml"
    path.write_text(GRASP.read_text().replace("duration: 20", "duration: 0.3"))
    return path


@pytest.mark.compiler
@pytest.mark.parametrize("controller", ["c", pytest.param("python", marks=pytest.mark.full)])
def test_the_command(
    controller: str, short: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    options = {"--file": short, "--control": CONTROL, "--out": out, "--controller": controller}
    code = main(["study", "grasp-control", *(str(word) for pair in options.items() for word in pair)])
    said = capsys.readouterr().out
    # too quick for rest: what is said of slopes need not hold; scheme iii does
    assert code in (0, 3) and "holds: scheme iii: a step settles" in said
    assert all(f"holds: scheme iii: on the reference along (5.7{k})" in said for k in (3, 4, 5))
    facts = json.loads((out / "grasp_control.json").read_text())
    assert facts["scheme_iii"]["settling_s"] < 0.3 and len(facts["scheme_i"]["grasp_N"]) == 2
    assert {path.name for path in out.glob("*.png")} == {
        f"grasp_control_{name}.png" for name in ("indirect", "step", "along")
    }
    with (out / "grasp_control_iii_2.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head[:4] == ["time_s", "wanted_N", "measured_N", "grasp_N"] and len(head) == len(rows[0]) == 14
    table = np.array(rows, dtype=float)
    assert np.diff(table[:, 0]) == pytest.approx(0.01) and table[-1, 0] == pytest.approx(1.29)
    assert (table[:, 1] == 2.0).all() and np.abs(table[-1, 3] - 2.0) < 0.1


def test_wrong_use(short: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wide = tmp_path / "wide.yaml"
    wide.write_text(short.read_text().replace("width: 42.7 mm", "width: 42.7 cm"))
    assert main(["study", "grasp-control", "--file", str(wide), "--out", str(tmp_path)]) == 2
    assert "the object is wider than the jaws open: 427 mm" in capsys.readouterr().err
    assert main(["study", "dexterity", "--file", str(short)]) == 2
    assert (
        "--file belongs to grasp, grasp-capability, grasp-control; dexterity has no such"
        in capsys.readouterr().err
    )
    assert main(["study", "grasp", "--control", str(CONTROL)]) == 2
    assert "--control belongs to grasp-control; grasp has no such option" in capsys.readouterr().err
    wrong = tmp_path / "control.yaml"
    wrong.write_text(CONTROL.read_text().replace("150 N/mm", "-150 N/mm"))
    assert main(["study", "grasp-control", "--control", str(wrong)]) == 2
    assert "line 17: contact: stiffness is -150000" in capsys.readouterr().err


def test_without_a_compiler_the_controller_in_c_is_told(
    short: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("KRHPR_CC", "none")
    words = ["study", "grasp-control", "--file", str(short), "--controller", "c", "--out", str(tmp_path)]
    assert main(words) != 0
    assert "compilers are disabled" in capsys.readouterr().err


@pytest.mark.compiler
@pytest.mark.full
def test_every_claim_holds() -> None:
    """The whole study, as the documentation shows it, and with other noise."""
    for seed in (0, 5):
        found = grasp_control(control=replace(study.CONTROL, seed=seed), make=CONTROLLERS["c"])
        assert [claim.text for claim in found.claims() if not claim.holds] == []
        assert len(found.claims()) == 9
        assert found.position.line.slope == pytest.approx(found.expected_slope, rel=0.05)
        assert np.abs(found.easy_feedforward.line.slope - 1 / (1 + found.grip.held_back)) < 5e-3
        assert all(one.position_error < 1e-3 for one in found.along)
