"""No kernel takes more operations than it used to, unless that is meant."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from krhpr.codegen.pipeline import Derived
from tools import record_budgets

REMEDY = (
    "where that is meant, run `make budgets` (python tools/record_budgets.py) and commit "
    "tests/codegen/budgets.json"
)


@pytest.fixture(scope="module")
def budgets() -> dict[str, int]:
    return json.loads(record_budgets.BUDGETS.read_text())  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def operations(derived: Derived) -> dict[str, int]:
    return record_budgets.operations(derived.parts)


def test_no_kernel_grows(operations: dict[str, int], budgets: dict[str, int]) -> None:
    grown = [
        f"{name} takes {count} operations, {count - budgets[name]} more than its budget of {budgets[name]}"
        for name, count in operations.items()
        if count > budgets.get(name, count)
    ]
    assert not grown, "; ".join([*grown, REMEDY])


def test_every_kernel_has_a_budget(operations: dict[str, int], budgets: dict[str, int]) -> None:
    assert sorted(operations.keys() - budgets.keys()) == [], f"no budget; {REMEDY}"
    assert sorted(budgets.keys() - operations.keys()) == [], f"budgets of kernels that are gone; {REMEDY}"


def test_recording_says_what_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], derived: Derived
) -> None:
    place = tmp_path / "budgets.json"
    monkeypatch.setattr(record_budgets, "BUDGETS", place)
    monkeypatch.setattr(record_budgets, "derive", lambda: derived)
    record_budgets.main()
    recorded = json.loads(place.read_text())
    assert recorded["subleg_rrr.prepare"] > 0
    count = recorded["subleg_rrr.inverse"]
    place.write_text(json.dumps({**recorded, "subleg_rrr.inverse": count - 1, "subleg_old.inverse": 3}))
    capsys.readouterr()
    record_budgets.main()
    out = capsys.readouterr().out
    assert f"subleg_rrr.inverse: {count - 1} -> {count}\n" in out
    assert "subleg_old.inverse: 3 -> gone\n" in out
    assert json.loads(place.read_text()) == recorded
