"""Plugin files that are wrong: each is told with file, line where there is one, and what is expected."""

from __future__ import annotations

from pathlib import Path

import pytest

from krhpr.cli import main
from krhpr.errors import PluginError
from krhpr.plugins import load_plugin, load_plugins
from tests.plugins.support import EXAMPLE

TEXT = EXAMPLE.read_text(encoding="utf-8")

WRONG = {
    "no plugin": ("PLUGIN = Plugin(", "ANOTHER = Plugin(", "nothing is called PLUGIN"),
    "not a plugin": (
        "PLUGIN = Plugin(",
        "PLUGIN = dict(subleg=OffsetWrist()) or Plugin(",
        "PLUGIN is a dict",
    ),
    "a class": ("OffsetWrist(),\n", "OffsetWrist,\n", "write it with parentheses"),
    "syntax": ("def forward(self", "def forward(self,,", "line 8"),
    "an error at import": ("PLUGIN = Plugin(", "1 / 0\nPLUGIN = Plugin(", "ZeroDivisionError"),
    "an abstract method left out": ("def velocity(", "def speed(", "velocity"),
    "a name": ('name = "offset_wrist"', 'name = "Offset Wrist"', "lower-case letters"),
    "a name of the catalogue": ('name = "offset_wrist"', 'name = "rrr"', "of this name"),
    "no notation": ("    notation = ", "    notes = ", "no attribute `notation`"),
    "a space": ("space = Space.SPATIAL", "space = 3", "Space.SPATIAL or Space.PLANAR"),
    "no actuators": ("    actuators = (\n", "    actuators = ()\n    others = (\n", "`actuators` is empty"),
    "a joint twice": ('Joint("theta_2"', 'Joint("theta_1"', "'theta_1' twice"),
    "a mode": ("    actuated_at =", '    default_mode = "up"\n    actuated_at =', "labels only"),
    "a link's end": ('"E", "W")', '"E", "V")', "no name of `points`"),
    "an actuator's place": ('("A", "c", "E")', '("A", "c", "F")', "neither a point nor a link"),
    "too few places": ('("A", "c", "E")', '("A", "c")', "names 2 places for 3 actuators"),
    "the geometry's name": ('f"subleg_{self.name}"', '"wrist"', "call it 'subleg_offset_wrist'"),
    "a size missing": ('        "h": 0.04,\n', "", "lacks h"),
    "an unknown size": ('"h": 0.04', '"h": 0.04, "l_4": 1.0', "'l_4', which `geometry` has not"),
    "a negative size": ('"h": 0.04', '"h": -0.04', "declared positive"),
    "two sizes": ('"h": 0.04', '"h": (0.04, 0.05)', "a number, or a tuple of three"),
    "an infinite size": ('"h": 0.04', '"h": float("inf")', "must be finite"),
    "a swivel without inverse": (
        "    actuated_at =",
        '    swivel = Joint("swivel", JointKind.REVOLUTE, "free")\n    actuated_at =',
        "state `inverse`",
    ),
    "a method that fails": (
        "second, third = E * at.d, E * at.v",
        "second, third = E * at.q, E * at.v",
        "in velocity",
    ),
    "a shape": (
        "s = k.g.c + d[0] * x + d[1] * k.g.e_1 + k.g.h * e_2",
        "s = (k.g.c + d[0] * x + d[1] * k.g.e_1 + k.g.h * e_2)[:2, 0]",
        "output 's' of 'forward' has 2 elements",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_file_is_told(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, said = WRONG[what]
    assert TEXT.count(old) >= 1
    file = tmp_path / "mine.py"
    file.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(PluginError) as caught:
        load_plugin(file)
    assert said in str(caught.value) and "mine.py" in str(caught.value)


def test_the_command_line_tells_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--plugin", str(tmp_path / "none.py")]) == 2
    assert "there is no such file" in capsys.readouterr().err


def test_two_plugins_of_one_name(tmp_path: Path) -> None:
    file = tmp_path / "again.py"
    file.write_text(TEXT)
    with pytest.raises(PluginError, match="rename one of them"):
        load_plugins([EXAMPLE, file])


def test_an_entry_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A package that is installed beside krhpr offers its sub-leg without an option."""
    (tmp_path / "their_legs.py").write_text(TEXT)
    about = tmp_path / "their_legs-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: their-legs\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[krhpr.sublegs]\nwrist = their_legs:PLUGIN\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert main(["list", "--sub-leg", "offset_wrist"]) == 0
    assert "spatial_offset_wrist_c" in capsys.readouterr().out
    (tmp_path / "their_legs.py").write_text("PLUGIN = 3\n")
    (about / "entry_points.txt").write_text("[krhpr.sublegs]\nwrist = their_legs_gone:PLUGIN\n")
    assert main(["list", "--sub-leg", "offset_wrist"]) == 2
    assert "the entry point wrist = their_legs_gone:PLUGIN" in capsys.readouterr().err
