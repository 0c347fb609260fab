"""Libraries are compiled once for each set of what goes into them, and what goes wrong is said."""

from __future__ import annotations

import os
import pickle
import shlex
import stat
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from krhpr.native import (
    SPEED_FLAGS,
    CompilationError,
    Compiler,
    NoCompiler,
    cache,
    cache_folder,
    compile_library,
    find_compiler,
    load_library,
)
from krhpr.native import compiler as compiler_module
from krhpr.native.compiler import accepted_flags
from tests.native.support import run_python

posix = pytest.mark.skipif(os.name != "posix", reason="needs shell scripts as compilers")


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache that is still empty, in a place whose name has to be quoted."""
    folder = tmp_path / "a cache"
    monkeypatch.setenv("KRHPR_CACHE", str(folder))
    monkeypatch.setattr(cache, "_temporary", None)
    return folder


@pytest.fixture
def source(tmp_path: Path) -> Path:
    folder = tmp_path / "some sources"
    folder.mkdir()
    (folder / "answer.h").write_text('#include "number.h"\n#define ANSWER (NUMBER + 1)\n')
    (folder / "number.h").write_text("#define NUMBER 41\n")
    path = folder / "answer.c"
    path.write_text('#include "answer.h"\n#include <math.h>\nint answer(void) { return ANSWER; }\n')
    return path


class Script:
    """A compiler that keeps a record of how it is called, and can be told to refuse."""

    def __init__(self, path: Path, real: Compiler, refuse: str = "") -> None:
        self.path, self._log = path, path.with_suffix(".log")
        refusal = (
            f'case " $* " in *{refuse}*) echo "I do not know {refuse}" >&2; exit 1;; esac' if refuse else ""
        )
        path.write_text(
            f'#!/bin/sh\necho "$*" >> {shlex.quote(str(self._log))}\n{refusal}\n'
            f'exec {shlex.join(real.command)} "$@"\n'
        )
        path.chmod(0o755)

    def calls(self) -> list[str]:
        return self._log.read_text().splitlines() if self._log.exists() else []

    def compilations(self) -> list[str]:
        return [call for call in self.calls() if "answer.c" in call]


@pytest.fixture
def script(tmp_path: Path, compiler: Compiler, monkeypatch: pytest.MonkeyPatch) -> Script:
    if os.name != "posix":
        pytest.skip("needs shell scripts as compilers")
    made = Script(tmp_path / "my-cc", compiler)
    monkeypatch.setenv("KRHPR_CC", shlex.quote(str(made.path)))
    return made


def answer(path: Path) -> int:
    return int(load_library(path).answer())


# -- the cache -----------------------------------------------------------------------------------------------


def test_compiles_and_loads(compiler: Compiler, own_cache: Path, source: Path) -> None:
    path = compile_library("answer", [source])
    assert path.parent == own_cache
    assert path.name.startswith("answer-")
    assert answer(path) == 42
    assert os.listdir(own_cache) == [path.name]  # neither scratch nor locks stay behind
    if os.name == "posix":
        assert not own_cache.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO)


def test_second_time_runs_no_compiler(script: Script, own_cache: Path, source: Path) -> None:
    first = compile_library("answer", [source])
    before = script.calls()
    assert len(script.compilations()) == 1
    assert compile_library("answer", [source]) == first
    assert script.calls() == before


def test_another_process_asks_for_the_version_only(script: Script, own_cache: Path, source: Path) -> None:
    path = compile_library("answer", [source])
    before = script.calls()
    done = run_python(f"from krhpr.native import *; print(compile_library('answer', [{str(source)!r}]))")
    assert done.stdout.strip() == str(path), done.stderr
    assert script.calls() == [*before, "--version"]


def test_every_file_is_part_of_the_key(script: Script, own_cache: Path, source: Path) -> None:
    assert answer(compile_library("answer", [source])) == 42
    source.with_name("number.h").write_text("#define NUMBER 1\n")
    assert answer(compile_library("answer", [source])) == 2
    source.write_text(source.read_text().replace("ANSWER;", "-ANSWER;"))
    assert answer(compile_library("answer", [source])) == -2
    assert len(script.compilations()) == 3


def test_include_folders(compiler: Compiler, own_cache: Path, source: Path, tmp_path: Path) -> None:
    headers = tmp_path / "headers"
    headers.mkdir()
    source.with_name("number.h").rename(headers / "number.h")
    first = compile_library("answer", [source], include_dirs=[headers])
    assert answer(first) == 42
    (headers / "number.h").write_text("#define NUMBER 1\n")
    assert answer(compile_library("answer", [source], include_dirs=[headers])) == 2
    # Place does not matter, content does.
    (headers / "number.h").write_text("#define NUMBER 41\n")
    moved = headers.rename(tmp_path / "elsewhere")
    assert compile_library("answer", [source], include_dirs=[moved]) == first


def test_other_parts_of_the_key(
    compiler: Compiler, own_cache: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = {
        compile_library("answer", [source]),
        compile_library("answer", [source], flags=("-O0", *SPEED_FLAGS)),
        compile_library("answer", [source], tag="another"),
        compile_library("answer", [source], compiler=Compiler(compiler.command, "another version")),
        compile_library("other_name", [source]),
    }
    monkeypatch.setattr(compiler_module, "processor", lambda: "another processor")
    paths.add(compile_library("answer", [source]))
    assert len(paths) == 6


def test_several_sources(compiler: Compiler, own_cache: Path, source: Path) -> None:
    more = source.with_name("more.c")
    more.write_text("int more(void) { return 5; }\n")
    library = load_library(compile_library("both", [source, more]))
    assert (library.answer(), library.more()) == (42, 5)


@pytest.mark.parametrize("damage", ["cut", "changed", "empty"])
def test_damaged_file_is_made_again(script: Script, own_cache: Path, source: Path, damage: str) -> None:
    path = compile_library("answer", [source])
    content = path.read_bytes()
    middle = len(content) // 2
    changed = bytes([content[middle] ^ 1])
    path.write_bytes(
        {
            "cut": content[:middle],
            "changed": content[:middle] + changed + content[middle + 1 :],
            "empty": b"",
        }[damage]
    )
    again = compile_library("answer", [source])
    assert len(script.compilations()) == 2
    assert answer(again) == 42
    assert os.listdir(own_cache) == [again.name]


def test_threads_compile_once(script: Script, own_cache: Path, source: Path) -> None:
    with ThreadPoolExecutor(8) as pool:
        paths = set(pool.map(lambda _: compile_library("answer", [source]), range(8)))
    assert len(paths) == 1
    assert len(script.compilations()) == 1


def test_processes_compile_at_the_same_time(script: Script, own_cache: Path, source: Path) -> None:
    code = f"""
from krhpr.native import compile_library, load_library
path = compile_library("answer", [{str(source)!r}])
assert load_library(path).answer() == 42
print(path)
"""
    with ThreadPoolExecutor(6) as pool:
        done = list(pool.map(lambda _: run_python(code), range(6)))
    assert all(d.returncode == 0 for d in done), done
    assert len({d.stdout for d in done}) == 1
    assert len(script.compilations()) == 1
    assert len(os.listdir(own_cache)) == 1


def test_without_locks_the_last_one_wins(
    script: Script, own_cache: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the file system knows no locks, work is done twice, and nothing breaks."""
    import contextlib

    monkeypatch.setattr(cache, "_locked", lambda path: contextlib.nullcontext())
    with ThreadPoolExecutor(8) as pool:
        paths = set(pool.map(lambda _: compile_library("answer", [source]), range(8)))
    assert {answer(path) for path in paths} == {42}
    assert set(os.listdir(own_cache)) == {path.name for path in paths}


def test_cache_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("KRHPR_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("KRHPR_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg" / "krhpr"
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    for value in ("", "relative/folder"):
        monkeypatch.setenv("XDG_CACHE_HOME", value)
        assert cache_folder() == tmp_path / ".cache" / "krhpr"


def test_cache_that_cannot_be_written(
    script: Script, source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("KRHPR_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setattr(cache, "_temporary", None)
    with pytest.warns(RuntimeWarning, match="cannot be kept.*KRHPR_CACHE"):
        path = compile_library("answer", [source])
    assert answer(path) == 42
    with warnings.catch_warnings():  # neither a second warning nor a second compilation in this process
        warnings.simplefilter("error")
        assert compile_library("answer", [source]) == path
        compile_library("other", [source])
    assert len(script.compilations()) == 2


def test_temporary_cache_goes_with_the_process(compiler: Compiler, source: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    code = f"from krhpr.native import *; print(compile_library('answer', [{str(source)!r}]))"
    done = run_python(code, KRHPR_CACHE=str(tmp_path / "file" / "cache"))
    assert done.returncode == 0, done.stderr
    assert "cannot be kept" in done.stderr
    assert not Path(done.stdout.strip()).parent.exists()


@posix
def test_cache_that_everybody_can_write_is_not_used(
    compiler: Compiler, own_cache: Path, source: Path
) -> None:
    compile_library("answer", [source])
    own_cache.chmod(0o777)
    with pytest.warns(RuntimeWarning, match="every user may write"):
        path = compile_library("answer", [source])
    assert path.parent != own_cache
    assert answer(path) == 42


@posix
def test_full_cache_that_cannot_be_written_is_still_read(
    compiler: Compiler, own_cache: Path, source: Path
) -> None:
    path = compile_library("answer", [source])
    own_cache.chmod(0o555)
    try:
        assert compile_library("answer", [source]) == path
    finally:
        own_cache.chmod(0o755)


# -- compilers -----------------------------------------------------------------------------------------------


def test_no_compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("KRHPR_CC", raising=False)
    monkeypatch.setenv("CC", "no-such-cc -m64")
    with pytest.raises(NoCompiler, match=r"no-such-cc -m64, cc, gcc, clang.*install gcc or clang"):
        find_compiler()
    monkeypatch.setenv("KRHPR_CC", "no-such-compiler")
    with pytest.raises(NoCompiler, match="no-such-compiler"):
        find_compiler()


@posix
def test_compilers_that_fail_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """With what they say, and what to do."""
    for name, said in (("cc", "no licence"), ("gcc", "broken")):
        (tmp_path / name).write_text(f"#!/bin/sh\necho {said!r} >&2\nexit 1\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("KRHPR_CC", raising=False)
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(NoCompiler) as caught:
        find_compiler()
    assert str(caught.value).startswith(
        f"no C compiler works (tried cc, gcc, clang): `{tmp_path}/cc --version` fails and says 'no licence', "
        f"`{tmp_path}/gcc --version` fails and says 'broken'; mend it, install gcc or clang"
    )
    monkeypatch.setenv("KRHPR_CC", f"{tmp_path}/gcc -m64")
    with pytest.raises(NoCompiler, match=r"gcc -m64', and `.*gcc -m64 --version` fails.*'broken'; name"):
        find_compiler()


@pytest.mark.parametrize("value", ["none", "NONE", " none "])
def test_compilers_can_be_disabled(
    monkeypatch: pytest.MonkeyPatch, own_cache: Path, source: Path, value: str
) -> None:
    monkeypatch.setenv("KRHPR_CC", value)
    with pytest.raises(NoCompiler, match="disabled"):
        compile_library("answer", [source])
    assert not own_cache.exists()


def test_which_compiler(
    compiler: Compiler, script: Script, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found = find_compiler()
    assert found.command == (str(script.path),)
    assert found.version == compiler.version
    monkeypatch.delenv("KRHPR_CC")
    monkeypatch.setenv("CC", f"{shlex.quote(str(script.path))} -DX=1")
    assert find_compiler().command == (str(script.path), "-DX=1")
    monkeypatch.setenv("CC", "no-such-cc")
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    script.path.rename(tmp_path / "cc")
    assert find_compiler().command == (str(tmp_path / "cc"),)


@posix
def test_compiler_that_does_not_answer_is_passed_over(
    compiler: Compiler, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("KRHPR_CC", raising=False)
    monkeypatch.setenv("CC", str(tmp_path / "mute"))
    (tmp_path / "mute").write_text("not a program")
    (tmp_path / "mute").chmod(0o755)
    assert find_compiler().command[0] != str(tmp_path / "mute")


@posix
def test_unknown_flags_are_left_out(
    compiler: Compiler, own_cache: Path, source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    picky = Script(tmp_path / "picky-cc", compiler, refuse="-fno-tree-slp-vectorize")
    monkeypatch.setenv("KRHPR_CC", shlex.quote(str(picky.path)))
    assert answer(compile_library("answer", [source])) == 42
    flags = accepted_flags(find_compiler(), SPEED_FLAGS)
    assert flags == tuple(f for f in SPEED_FLAGS if f != "-fno-tree-slp-vectorize")
    assert "-O3" in picky.compilations()[-1]


def test_all_flags_are_known(compiler: Compiler) -> None:
    assert accepted_flags(compiler, SPEED_FLAGS) == SPEED_FLAGS


@posix
def test_compiler_that_cannot_compile(
    compiler: Compiler, own_cache: Path, source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = Script(tmp_path / "broken-cc", compiler, refuse="-shared")
    monkeypatch.setenv("KRHPR_CC", shlex.quote(str(broken.path)))
    with pytest.raises(NoCompiler, match=r"broken-cc cannot make a shared library.*I do not know -shared"):
        compile_library("answer", [source])


def test_compilation_error_tells_all(compiler: Compiler, own_cache: Path, source: Path) -> None:
    source.write_text("int answer(void) { return undeclared_thing; }\n#error told so\n")
    with pytest.raises(CompilationError) as caught:
        compile_library("answer", [source])
    error = caught.value
    assert error.command[0] == compiler.command[0]
    assert "-O3" in error.command
    for text in ("undeclared_thing", "told so", "answer.c"):
        assert text in error.output
    assert error.output in str(error)
    assert shlex.join(error.command) in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (again.command, again.output, str(again)) == (error.command, error.output, str(error))
    assert os.listdir(own_cache) == []


def test_missing_source_and_bad_name(compiler: Compiler, own_cache: Path, source: Path) -> None:
    with pytest.raises(FileNotFoundError):
        compile_library("answer", [source.with_name("missing.c")])
    for name in ("../answer", "a b", ""):
        with pytest.raises(ValueError, match="no name for a library"):
            compile_library(name, [source])
