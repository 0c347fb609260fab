"""`krhpr eval`: numbers in, numbers out, and exact words for what is wrong with them."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import krhpr
from tests.cli.support import Cli

POSE = {"p": [0.01, -0.02], "phi": 0.1, "redundant": [1.5, 1.4, 1.6]}
SPATIAL: dict[str, Any] = {"p": [0, 0, 0.45], "Q": np.eye(3).tolist(), "redundant": [1.57, 1.5, 1.6]}
HEADER = "p_0,p_1,phi,redundant_0,redundant_1,redundant_2"
ROW = "0.01,-0.02,0.1,1.5,1.4,1.6"

planar = krhpr.load("planar_rr_a", backend="numpy")
spatial = krhpr.load("spatial_rrr_a", backend="numpy")
THETA = planar.inverse(POSE["p"], POSE["phi"], POSE["redundant"])


def rows_of(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def theta_of(row: dict[str, str]) -> list[list[float]]:
    return [[float(row[f"theta_{i}{j}"]) for j in range(2)] for i in range(3)]


# -- what works ----------------------------------------------------------------------------------------------


def test_an_object_gives_an_object(cli: Cli) -> None:
    result = cli("eval", "planar_rr_a", "inverse", stdin=json.dumps(POSE))
    assert (result.code, result.err) == (0, "")
    assert json.loads(result.out) == {"theta": THETA.tolist()}


def test_batches_broadcast(cli: Cli) -> None:
    many = {**POSE, "phi": [[0.1, 0.2], [0.3, 0.4]]}
    found = json.loads(cli("eval", "planar_rr_a", "inverse", stdin=json.dumps(many)).out)
    assert found["theta"] == planar.inverse(POSE["p"], many["phi"], POSE["redundant"]).tolist()


@pytest.mark.parametrize("other", [{}, {"phi": 0.2}, {"phi": [0.1, 0.2]}, {"mode": "elbow-"}])
def test_a_list_gives_a_list(other: dict[str, Any], cli: Cli) -> None:
    elements = [POSE, {**POSE, **other}]
    found = json.loads(cli("eval", "planar_rr_a", "inverse", "--status", stdin=json.dumps(elements)).out)
    mode = other.get("mode")
    second = planar.inverse(POSE["p"], elements[1]["phi"], POSE["redundant"], mode=mode)
    assert [element["theta"] for element in found] == [THETA.tolist(), second.tolist()]
    assert found[1]["status"] == (["OK", "OK"] if other.get("phi") == [0.1, 0.2] else "OK")


def test_no_elements_give_none(cli: Cli) -> None:
    assert json.loads(cli("eval", "planar_rr_a", "inverse", stdin="[]").out) == []
    assert cli("eval", "planar_rr_a", "inverse", "--to", "csv", stdin="[]").out.count("\n") == 1
    assert cli("eval", "planar_rr_a", "inverse", stdin=HEADER).out.count("\n") == 1


def test_rows_give_rows(cli: Cli, tmp_path: Path) -> None:
    place = tmp_path / "poses.csv"
    place.write_text(f"\ufeff{HEADER}\r\n{ROW}\r\n\r\n{ROW}\r\n", encoding="utf-8")
    result = cli("eval", "planar_rr_a", "inverse", "--input", place, "--status")
    assert result.code == 0
    rows = rows_of(result.out)
    assert [theta_of(row) for row in rows] == [THETA.tolist()] * 2
    assert [row["status"] for row in rows] == ["OK", "OK"]


def test_columns_stand_in_any_order(cli: Cli) -> None:
    text = "phi,redundant_2,redundant_1,redundant_0,p_1,p_0\n0.1,1.6,1.4,1.5,-0.02,0.01\n"
    assert theta_of(rows_of(cli("eval", "planar_rr_a", "inverse", stdin=text).out)[0]) == THETA.tolist()


def test_formats_are_told_by_ending_first_character_or_option(cli: Cli, tmp_path: Path) -> None:
    for name, text, options in (
        ("a.json", json.dumps(POSE), []),
        ("a.csv", f"{HEADER}\n{ROW}", ["--to", "json"]),
        ("a.txt", json.dumps(POSE), []),
        ("b.txt", f"{HEADER}\n{ROW}", ["--to", "json"]),
        ("c.txt", json.dumps(POSE), ["--format", "json"]),
    ):
        (tmp_path / name).write_text(text)
        out = cli("eval", "planar_rr_a", "inverse", "--input", tmp_path / name, *options).out
        assert np.ravel(json.loads(out)["theta"]).tolist() == THETA.ravel().tolist()


def test_numbers_survive_the_way_out_and_in_again(cli: Cli) -> None:
    out = cli("eval", "planar_rr_a", "inverse", "--to", "csv", stdin=json.dumps(POSE)).out
    s = cli("eval", "planar_rr_a", "subleg_forward", "--to", "json", stdin=out)
    assert json.loads(s.out)["s"] == [planar.subleg_forward(THETA).tolist()]


def test_modes_by_label_for_all_legs_and_for_each(cli: Cli) -> None:
    for mode in ("elbow-", "elbow+,elbow-,elbow+"):
        wanted = planar.inverse(POSE["p"], POSE["phi"], POSE["redundant"], mode=_labels(mode)).tolist()
        stdin = json.dumps(POSE)
        assert (
            json.loads(cli("eval", "planar_rr_a", "inverse", "--mode", mode, stdin=stdin).out)["theta"]
            == wanted
        )
        given = json.dumps({**POSE, "mode": _labels(mode)})
        assert json.loads(cli("eval", "planar_rr_a", "inverse", stdin=given).out)["theta"] == wanted
        table = f'{HEADER},mode\n{ROW},"{mode}"\n'
        assert theta_of(rows_of(cli("eval", "planar_rr_a", "inverse", stdin=table).out)[0]) == wanted


def _labels(mode: str) -> str | list[str]:
    return mode.split(",") if "," in mode else mode


def test_modes_by_signs(cli: Cli) -> None:
    wanted = planar.inverse(POSE["p"], POSE["phi"], POSE["redundant"], mode=[[1], [-1], [1]]).tolist()
    given = json.dumps({**POSE, "mode": [[1], [-1], [1]]})
    assert json.loads(cli("eval", "planar_rr_a", "inverse", stdin=given).out)["theta"] == wanted
    table = f"{HEADER},mode_00,mode_10,mode_20\n{ROW},1,-1,1\n"
    assert theta_of(rows_of(cli("eval", "planar_rr_a", "inverse", stdin=table).out)[0]) == wanted


def test_assembly_modes(cli: Cli) -> None:
    robot = krhpr.load("spatial_r_fivebar_a", backend="numpy")
    theta = robot.inverse(SPATIAL["p"], SPATIAL["Q"], SPATIAL["redundant"])
    stdin = json.dumps({"theta": theta.tolist()})
    for label in robot.assemblies:
        out = cli("eval", "spatial_r_fivebar_a", "subleg_forward", "--assembly", label, stdin=stdin).out
        assert json.loads(out)["s"] == robot.subleg_forward(theta, label).tolist()


def test_geometry(cli: Cli) -> None:
    options = ["--geometry", "l_1=0.14", "l_2=0.15,0.16,0.17"]
    found = json.loads(cli("eval", "planar_rr_a", "inverse", *options, stdin=json.dumps(POSE)).out)
    changed = planar.with_geometry(l_1=0.14, l_2=(0.15, 0.16, 0.17))
    assert found["theta"] == changed.inverse(POSE["p"], POSE["phi"], POSE["redundant"]).tolist()


def test_several_results_and_many_columns(cli: Cli) -> None:
    s = spatial.end_points(SPATIAL["p"], SPATIAL["Q"], SPATIAL["redundant"])
    theta = spatial.inverse(SPATIAL["p"], SPATIAL["Q"], SPATIAL["redundant"])
    J, K = spatial.jacobians(SPATIAL["p"], SPATIAL["Q"], s, theta)
    given = json.dumps({"p": SPATIAL["p"], "Q": SPATIAL["Q"], "s": s.tolist(), "theta": theta.tolist()})
    found = json.loads(cli("eval", "spatial_rrr_a", "jacobians", stdin=given).out)
    assert list(found) == ["J", "K"] and found["K"] == K.tolist()
    (row,) = rows_of(cli("eval", "spatial_rrr_a", "jacobians", "--to", "csv", stdin=given).out)
    assert float(row["J_21"]) == J[2, 1] and float(row["K_58"]) == K[5, 8]


def test_rates_of_the_redundant_coordinates_are_zero_unless_given(cli: Cli) -> None:
    s = planar.end_points(POSE["p"], POSE["phi"], POSE["redundant"])
    given = {"p": POSE["p"], "phi": POSE["phi"], "s": s.tolist(), "theta": THETA.tolist(), "twist": [1, 0, 0]}
    found = json.loads(cli("eval", "planar_rr_a", "joint_rates", stdin=json.dumps(given)).out)
    assert found["theta_dot"] == planar.joint_rates(POSE["p"], POSE["phi"], s, THETA, [1, 0, 0]).tolist()


def test_no_answer_is_null_or_nan_and_said(cli: Cli) -> None:
    elements = [SPATIAL, {**SPATIAL, "p": [0, 0, 5]}]
    result = cli("eval", "spatial_rrr_a", "inverse", "--status", stdin=json.dumps(elements))
    assert result.code == 0
    assert result.err == "krhpr: no answer for 1 of 2 configurations: UNREACHABLE_LEG_1 (1)\n"
    found = json.loads(result.out)
    assert found[1]["theta"][0] == [None, None, None]
    assert [element["status"] for element in found] == ["OK", "UNREACHABLE_LEG_1"]
    rows = rows_of(cli("eval", "spatial_rrr_a", "inverse", "--to", "csv", stdin=json.dumps(elements)).out)
    assert math.isnan(float(rows[1]["theta_00"]))


def test_a_matrix_that_is_no_rotation_can_be_let_through(cli: Cli) -> None:
    given = json.dumps({**SPATIAL, "Q": (1.01 * np.eye(3)).tolist()})
    assert cli("eval", "spatial_rrr_a", "inverse", stdin=given).code == 2
    assert cli("eval", "spatial_rrr_a", "inverse", "--no-check-rotation", stdin=given).code == 0


def test_the_compiled_backend_gives_the_same(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_BACKEND", "auto")
    found = json.loads(cli("eval", "planar_rr_a", "inverse", stdin=json.dumps(POSE)).out)
    assert np.allclose(found["theta"], THETA, rtol=0, atol=1e-14)


# -- what does not -------------------------------------------------------------------------------------------


def changed(**changes: Any) -> str:
    return json.dumps({**POSE, **changes})


def without(*names: str) -> str:
    return json.dumps({name: value for name, value in POSE.items() if name not in names})


WRONG_JSON = {
    "empty": ("", "standard input: is empty; expected JSON or CSV"),
    "blank": (" \n", "standard input: is empty"),
    "broken": ('{"p": [0,\n 0,}', "standard input, line 2, column 4: not JSON: "),
    "another value": (
        "[1, 2]",
        "found a list with something else in it, expected an object of arguments (p, phi",
    ),
    "twice": ('{"p": [0, 0], "p": [1, 1]}', "'p' stands twice in one object"),
    "unknown": (changed(redundent=0), "unknown argument 'redundent' of inverse; did you mean redundant?"),
    "unlike any": (changed(zzz=0), "unknown argument 'zzz' of inverse; there are p, phi, redundant, mode"),
    "missing": (without("phi"), "missing argument phi; inverse takes p, phi, redundant, mode"),
    "two missing": (without("p", "phi"), "missing arguments p, phi;"),
    "shape": (changed(p=[0, 0, 0]), "standard input: p: found shape (3), expected (..., 2): position of O'"),
    "scalar": (changed(p=0), "standard input: p: found shape (), expected (..., 2)"),
    "ragged": (changed(p=[[0, 0], [0]]), "input: p[1]: ragged: found shape (1), expected (2) as in p[0]"),
    "deeply ragged": (changed(p=[[0, 0], 1]), "input: p[1]: ragged: found shape (), expected (2) as in p[0]"),
    "text": (changed(p=[0, "a"]), "input: p[1]: found the text 'a', expected a number"),
    "true": (changed(phi=True), "input: phi: found true, expected a number"),
    "null": (changed(phi=None), "input: phi: found null, expected a number"),
    "object": (changed(phi={}), "input: phi: found an object, expected a number"),
    "NaN": (changed(phi=math.nan), "input: phi: found nan, expected a finite number"),
    "infinite": (changed(phi=-math.inf), "input: phi: found -inf, expected a finite number"),
    "too large": (
        '{"p": [0, 0], "phi": 1' + "0" * 400 + ', "redundant": [1, 1, 1]}',
        "phi: found 1000",
    ),
    "batches": (
        changed(p=[[0, 0]] * 2, phi=[0] * 3),
        "planar_rr_a.inverse: batch dimensions do not broadcast: p (2,), phi (3,)",
    ),
    "mode": (changed(mode="elbow"), "'elbow' is not a working mode; give one of elbow+, elbow-"),
    "signs": (changed(mode=[[1], [0], [1]]), "the signs of a working mode are +1 or -1"),
    "in a list": (json.dumps([POSE, {**POSE, "phi": "x"}]), "standard input: [1].phi: found the text 'x'"),
    "missing in a list": (f"[{without('phi')}]", "standard input: [0]: missing argument phi"),
    "not text": (b"\xff\xfe{", "standard input: not a text file: byte 0 is not UTF-8"),
    "deep": ("[" * 100_000, "standard input: nested too deeply"),
}

WRONG_CSV = {
    "unknown column": (
        f"{HEADER},p_2\n{ROW},0\n",
        "header: unknown column 'p_2' of inverse; did you mean p_",
    ),
    "missing column": (HEADER.replace("p_1,", ""), "header: missing column p_1; inverse takes p_0, p_1, phi"),
    "column twice": (f"{HEADER},phi\n{ROW},0\n", "header: column 'phi' stands twice"),
    "no header": (f"{ROW}\n", "header: unknown column '0.01' of inverse"),
    "semicolons": (HEADER.replace(",", ";"), "expected columns separated by commas"),
    "few cells": (f"{HEADER}\n{ROW}\n\n0.01,0\n", "line 4: found 2 cells, expected 6 as in the header"),
    "many cells": (f"{HEADER}\n{ROW},0\n", "line 2: found 7 cells, expected 6"),
    "text": (f"{HEADER}\n{ROW.replace('0.1', 'x')}\n", "line 2, column phi: found 'x', expected a number"),
    "no number": (f"{HEADER}\n{ROW.replace('0.1', '')}\n", "line 2, column phi: found '', expected a number"),
    "digit groups": (
        f"{HEADER}\n{ROW.replace('0.1', '1_0')}\n",
        "column phi: found '1_0', expected a number",
    ),
    "NaN": (f"{HEADER}\n{ROW.replace('0.1', 'nan')}\n", "column phi: found nan, expected a finite number"),
    "infinite": (f"{HEADER}\n{ROW.replace('0.1', '1e999')}\n", "column phi: found 1e999, expected a finite"),
    "mode": (
        f"{HEADER},mode\n{ROW},elbow\n",
        "line 2, column mode: planar_rr_a: 'elbow' is not a working mode",
    ),
    "two modes": (f"{HEADER},mode,mode_00\n{ROW},elbow+,1\n", "header: unknown column 'mode_00'"),
    "part of a mode": (f"{HEADER},mode_00\n{ROW},1\n", "header: missing columns mode_10, mode_20"),
    "quotes": (f'{HEADER}\n"{ROW}\n', "not CSV: "),
}


@pytest.mark.parametrize(("stdin", "message"), WRONG_JSON.values(), ids=WRONG_JSON)
def test_wrong_json_is_explained(stdin: str | bytes, message: str, cli: Cli) -> None:
    result = cli("eval", "planar_rr_a", "inverse", stdin=stdin)
    assert (result.code, result.out) == (2, "")
    assert message in result.err
    assert result.err.startswith("krhpr: standard input")


@pytest.mark.parametrize(("stdin", "message"), WRONG_CSV.values(), ids=WRONG_CSV)
def test_wrong_csv_is_explained(stdin: str, message: str, cli: Cli, tmp_path: Path) -> None:
    place = tmp_path / "poses.csv"
    place.write_text(stdin)
    result = cli("eval", "planar_rr_a", "inverse", "--input", place)
    assert (result.code, result.out) == (2, "")
    assert message in result.err
    assert result.err.startswith(f"krhpr: {place}")


def test_a_matrix_that_is_no_rotation_is_found_by_its_line(cli: Cli) -> None:
    columns = ["p_0", "p_1", "p_2", *(f"Q_{i}{j}" for i in range(3) for j in range(3))]
    header = ",".join([*columns, "redundant_0", "redundant_1", "redundant_2"])
    good, bad = "0,0,0.45,1,0,0,0,1,0,0,0,1,1.5,1.5,1.5", "0,0,0.45,1,0,0,0,1,0.1,0,0,1,1.5,1.5,1.5"
    result = cli("eval", "spatial_rrr_a", "inverse", stdin=f"{header}\n{good}\n\n{bad}\n")
    assert result.code == 2
    assert result.err.startswith(
        "krhpr: standard input, line 4: spatial_rrr_a.inverse: Q[1] is not a rotation"
    )
    assert "--no-check-rotation" in result.err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--geometry", "l_9=1"], "planar_rr_a has no field 'l_9'; did you mean l_"),
        (["--geometry", "l_1"], "--geometry l_1: expected FIELD=VALUE, such as l_r=0.1"),
        (["--geometry", "l_1=long"], "--geometry l_1=long: found 'long', expected a number"),
        (["--geometry", "l_1=1,2"], "--geometry l_1=1,2: found 2 values, expected one, or one for each leg"),
        (["--geometry", "l_1=-1"], "a length must be positive"),
        (["--geometry", "l_1=nan"], "it must be finite"),
        (["--geometry", "l_1=1", "--geometry", "l_1=2"], "'l_1' is given twice"),
        (["--mode", "up"], "'up' is not a working mode; give one of elbow+, elbow-"),
        (["--mode", "elbow+,elbow-"], "or one for each of the three legs"),
        (["--assembly", "left"], "--assembly: inverse takes no assembly; it takes p, phi, redundant, mode"),
        (["--input", "/no/such/file.json"], "/no/such/file.json: No such file or directory"),
        (["--input", "/"], "/: Is a directory"),
    ],
)
def test_wrong_options_are_explained(options: list[str], message: str, cli: Cli) -> None:
    result = cli("eval", "planar_rr_a", "inverse", *options, stdin=json.dumps(POSE))
    assert (result.code, result.out) == (2, "")
    assert message in result.err


def test_an_unknown_backend_is_explained(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_BACKEND", "fortran")
    result = cli("eval", "planar_rr_a", "inverse", stdin=json.dumps(POSE))
    assert result.code == 2
    assert result.err == (
        "krhpr: no backend is called 'fortran' (KRHPR_BACKEND); there are auto, compiled, numpy\n"
    )


def test_a_mode_given_twice_is_explained(cli: Cli) -> None:
    result = cli("eval", "planar_rr_a", "inverse", "--mode", "elbow+", stdin=changed(mode="elbow-"))
    assert result.code == 2
    assert "'mode' is given here and by --mode; leave one out" in result.err
