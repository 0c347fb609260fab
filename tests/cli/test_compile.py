"""`krhpr compile`: libraries ahead of their first use."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from krhpr.backend import SLOWER
from tests.cli.support import Cli


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("KRHPR_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.mark.compiler
def test_it_says_where_the_libraries_are(cli: Cli, cache: Path) -> None:
    result = cli("compile", "planar_rr_a")
    assert result.code == 0, result.err
    (row,) = result.out.splitlines()[2:]
    match = re.fullmatch(r"planar_rr_a +(\d+) +(.*\.so)", row)
    assert match is not None and Path(match[2]).parent == cache
    assert sorted(path.name.partition("-")[0] for path in cache.glob("*.so")) == [
        "bound",
        "gufunc",
        "krhpr_planar_rr_a",
    ]
    assert cli("compile", "planar_rr_a").out == result.out


def test_without_a_compiler_it_fails(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KRHPR_CC", "none")
    result = cli("compile")
    assert (result.code, result.out) == (1, "")
    assert result.err == (
        "krhpr: KRHPR_CC is set to none: compilers are disabled.\n"
        f"Until then robots run on the pure NumPy modules: {SLOWER}.\n"
    )


def test_a_compiler_that_fails_is_named(cli: Cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    script = tmp_path / "mycc"
    script.write_text("#!/bin/sh\necho 'no licence' >&2\nexit 1\n")
    script.chmod(0o755)
    monkeypatch.setenv("KRHPR_CC", str(script))
    result = cli("compile")
    assert (result.code, result.out) == (1, "")
    assert f"`{script} --version` fails and says 'no licence'; name another compiler" in result.err


@pytest.mark.compiler
def test_what_the_compiler_says_is_passed_on(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    script = tmp_path / "cc"
    script.write_text(
        '#!/bin/sh\ncase "$*" in *krhpr_planar*) echo "too hard" >&2; exit 1;; esac\nexec cc "$@"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("KRHPR_CC", str(script))
    result = cli("compile", "planar_rr_a")
    assert result.code == 1
    assert "krhpr: compilation failed: " in result.err and "too hard" in result.err
    assert "Traceback" not in result.err
