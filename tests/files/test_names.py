"""Names of robots end up in files, symbols and modules: only plain identifiers get through."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

import krhpr
from krhpr.robot_files.names import LONGEST, wrong_name


@pytest.mark.parametrize("name", ["my_robot", "arm", "arm2", "a", "my_arm_3", "spatial", "x" * LONGEST])
def test_names(name: str) -> None:
    assert wrong_name(name, krhpr.catalogue()) is None


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("while", "a word of Python"),
        ("match", "a word of Python"),
        ("lambda", "a word of Python"),
        ("typedef", "a word of C"),
        ("restrict", "a word of C"),
        ("namespace", "a word of C or C++"),
        ("runtime", "generated code uses itself"),
        ("limits", "generated code uses itself"),
        ("subleg_rrr", "generated code uses itself"),
        ("casadi", "generated code uses itself"),
        ("nul", "generated code uses itself"),
        *((identifier, "a robot of the catalogue") for identifier in krhpr.catalogue()),
        *(
            (name, "expected a name of lower-case letters")
            for name in (
                "",
                "2arm",
                "_arm",
                "arm_",
                "my__arm",
                "My",
                "my-arm",
                "my arm",
                "arm.c",
                "../arm",
                "arm\n",
                "ärm",
                "a" * 41,
                "arm;",
                "{{x}}",
                "x*/",
                'a"b',
                "$(id)",
                "`id`",
            )
        ),
    ],
)
def test_other_names_are_refused(name: str, words: str) -> None:
    why = wrong_name(name, krhpr.catalogue())
    assert why is not None and words in why and "\n" not in why


@given(st.text(max_size=12))
def test_whatever_passes_is_an_identifier(name: str) -> None:
    if wrong_name(name, krhpr.catalogue()) is None:
        assert re.fullmatch(r"[a-z][a-z0-9_]*", name, re.ASCII) and name.isidentifier()
