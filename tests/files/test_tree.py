"""YAML that is hostile, broken, or no robot: one clear error each, and nothing is ever constructed."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from krhpr.robot_files.problems import RobotFileError
from krhpr.robot_files.tree import MOST_BYTES, MOST_DEPTH, Items, Table, Text, parse
from tests.files.support import FIVEBAR

LAUGHS = "a: &a [x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("data", "line", "words"),
    [
        (b"", 0, "is empty"),
        (b"# nothing\n", 0, "is empty"),
        (b"~\n", 0, "is empty"),
        (b"---\n...\n", 0, "is empty"),
        (b"- a\n- b\n", 1, "a list of 2 at the top"),
        (b"hello\n", 1, "found hello at the top"),
        (b"a: 1\nb: 2\na: 3\n", 3, "'a' stands twice, first in line 1"),
        (b"a: {b: 1, b: 2}\n", 1, "'b' stands twice"),
        (LAUGHS.encode(), 1, "anchors and aliases are not used here: found 'a'"),
        (b"a: 1\nb: *c\n", 2, "anchors and aliases are not used here: found 'c'"),
        (b"a: !!python/object/apply:os.system ['true']\n", 1, "tags are not used here"),
        (b"a: !!float 3\n", 1, "tags are not used here"),
        (b"!mine\na: 1\n", 1, "tags are not used here"),
        (b"a: 1\n---\nb: 2\n", 2, "a second document"),
        (b"a: " + b"[" * 5000, 1, f"nested deeper than {MOST_DEPTH} levels"),
        (b"a: " + b"{b: " * 5000, 1, f"nested deeper than {MOST_DEPTH} levels"),
        (b"a: 1\nb: [1, 2\n", 3, "not YAML"),
        (b"a: 1\n\tb: 2\n", 2, "not YAML"),
        (b"a: 'one\n", 2, "not YAML"),
        (b"a: 1\nb: \x07\n", 2, "not YAML: special characters are not allowed"),
        (b"a: 1\nb: \xff\n", 2, "not UTF-8: found the byte 0xff"),
        (b"\xff\xfea\x00:\x00", 1, "not UTF-8"),
        (b"[a, b]: 1\n", 1, "a list of 2 as the name of a field"),
        (b"a: 1\n#" + b"x" * MOST_BYTES, 0, f"larger than {MOST_BYTES} bytes"),
    ],
)
def test_what_is_no_table_is_refused_with_its_line(data: bytes, line: int, words: str) -> None:
    begin = time.perf_counter()
    with pytest.raises(RobotFileError) as caught:
        parse(data, "arm.yaml")
    assert time.perf_counter() - begin < 5.0
    (problem,) = caught.value.problems
    assert problem.line == line
    assert words in problem.message
    assert str(caught.value).startswith(f"arm.yaml, line {line}: " if line else "arm.yaml: ")


def test_scalars_stay_texts() -> None:
    tree = parse(b"a: yes\nb: 010\nc: 1:30\nd: 2020-01-01\ne: '3'\nf: ~\n", "arm.yaml")
    found = {name: (node.text, node.plain) for name, node in tree.entries.items() if isinstance(node, Text)}
    assert found == {
        "a": ("yes", True),
        "b": ("010", True),
        "c": ("1:30", True),
        "d": ("2020-01-01", True),
        "e": ("3", False),
        "f": ("~", True),
    }


def test_nodes_know_their_lines() -> None:
    tree = parse(b"\n# remark\na:\n  b: [1,\n    2]\n", "arm.yaml")
    inner = tree.entries["a"]
    assert isinstance(inner, Table) and (tree.lines["a"], inner.lines["b"]) == (3, 4)
    items = inner.entries["b"]
    assert isinstance(items, Items) and [item.line for item in items.items] == [4, 5]


def test_a_mark_of_the_byte_order_is_no_harm() -> None:
    assert set(parse(b"\xef\xbb\xbfa: 1\n", "arm.yaml").entries) == {"a"}


def test_windows_line_ends_count_as_one() -> None:
    assert parse(FIVEBAR.replace("\n", "\r\n").encode(), "arm.yaml").lines["arrangement"] == 3


def test_a_file_that_never_ends_is_not_read_whole() -> None:
    from krhpr.robot_files.tree import read_tree

    endless = Path("/dev/zero")
    if not endless.exists():
        pytest.skip("no /dev/zero here")
    with pytest.raises(RobotFileError, match="larger than"):
        read_tree(endless)
