"""Find a C compiler, and compile shared libraries with it: once for each set of what goes into them."""

from __future__ import annotations

import functools
import json
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from krhpr.native import cache

SHARED = ("-fPIC", "-shared")

# Contraction, no errno and the native processor are where the vectors come from; gcc's SLP vectoriser slows
# straight-line code. A flag that the compiler does not know is left out.
SPEED_FLAGS = (
    "-std=gnu11",
    "-O3",
    "-march=native",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-tree-slp-vectorize",
    *SHARED,
)

HINT = (
    "install gcc or clang (Debian, Ubuntu: apt install gcc libc6-dev; macOS: xcode-select --install), "
    "or name a compiler in the environment variable CC"
)
CHOICE = "name another compiler there, or `none` to do without, or unset it"

StrPath = str | os.PathLike[str]

_INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*["<]([^">\n]+)[">]', re.MULTILINE)
_NAME = re.compile(r"[A-Za-z0-9_.]+")


class NoCompiler(RuntimeError):
    """There is nothing to compile with on this machine; the message says what is missing."""


class CompilationError(RuntimeError):
    """The compiler refused; `command` is what was run, `output` all that the compiler said."""

    def __init__(self, command: Sequence[str], output: str) -> None:
        super().__init__(f"compilation failed: {shlex.join(command)}\n{output}")
        self.command = tuple(command)
        self.output = output

    def __reduce__(self) -> tuple[type[CompilationError], tuple[tuple[str, ...], str]]:
        return type(self), (self.command, self.output)


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the command that starts it, its full path first, and what it says of its version."""

    command: tuple[str, ...]
    version: str


def find_compiler() -> Compiler:
    """The first C compiler that answers: $KRHPR_CC if set (`none` for none), else $CC, cc, gcc, clang."""
    chosen = os.environ.get("KRHPR_CC", "")
    if chosen.strip().lower() == "none":
        raise NoCompiler("KRHPR_CC is set to none: compilers are disabled")
    candidates = (chosen,) if chosen else (os.environ.get("CC", ""), "cc", "gcc", "clang")
    refusals = []
    for candidate in candidates:
        found = _identify(candidate, os.environ.get("PATH", os.defpath))
        if isinstance(found, Compiler):
            return found
        if found:
            refusals.append(found)
    if chosen:
        wrong = refusals[0] if refusals else "there is no such compiler"
        raise NoCompiler(f"KRHPR_CC is {chosen!r}, and {wrong}; {CHOICE}")
    names = ", ".join(candidate for candidate in candidates if candidate)
    if refusals:
        raise NoCompiler(f"no C compiler works (tried {names}): {', '.join(refusals)}; mend it, {HINT}")
    raise NoCompiler(f"no C compiler found (looked for {names}): {HINT}")


def compile_library(
    name: str,
    sources: Iterable[StrPath],
    *,
    include_dirs: Iterable[StrPath] = (),
    system_include_dirs: Iterable[StrPath] = (),
    flags: Sequence[str] = SPEED_FLAGS,
    tag: str = "",
    compiler: Compiler | None = None,
) -> Path:
    """Compile C sources into a shared library, or find the one made earlier; returns its path.

    The cache's key holds the content of the sources and of all headers that they include, one from the other,
    from their own folders or `include_dirs`; the compiler and its version; the flags; the processor; and
    `tag`, which stands for whatever else matters, such as the version of what `system_include_dirs` holds.
    """
    if not _NAME.fullmatch(name):
        raise ValueError(f"{name!r} is no name for a library: letters, digits, _ and . only")
    files, folders = [Path(s).absolute() for s in sources], [Path(d).absolute() for d in include_dirs]
    compiler = compiler or find_compiler()
    parts = [
        compiler.command,
        compiler.version,
        tuple(flags),
        processor(),
        tag,
        _contents(files, folders),
    ]
    key = cache.digest(json.dumps(parts).encode())
    if found := cache.find(name, key):
        return found
    with cache.workshop(key) as folder:
        if found := cache.find(name, key):  # made by another while we waited
            return found
        built = folder / f"{name}{cache.SUFFIX}"
        command = [*compiler.command, *accepted_flags(compiler, tuple(flags))]
        command += [f"-I{path}" for path in folders]
        for path in system_include_dirs:
            command += ["-isystem", str(path)]
        _build([*command, *map(str, _objects(command, files, folder)), "-o", str(built), "-lm"], built)
        return cache.store(built, name, key)


def _objects(command: Sequence[str], sources: Sequence[Path], folder: Path) -> Sequence[Path]:
    """Several sources as objects, compiled side by side; one source as it is."""
    if len(sources) == 1:
        return sources
    objects = [folder / f"{number}.o" for number in range(len(sources))]
    compile_only = [word for word in command if word != "-shared"]
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        jobs = [
            pool.submit(_build, [*compile_only, "-c", str(source), "-o", str(target)], target)
            for source, target in zip(sources, objects, strict=True)
        ]
    for job in jobs:
        job.result()
    return objects


def _build(command: Sequence[str], target: Path) -> None:
    """Run the compiler, which is to make a file."""
    succeeded, output = _run(command)
    if not succeeded or not target.exists():
        raise CompilationError(command, output)


@functools.lru_cache
def accepted_flags(compiler: Compiler, flags: tuple[str, ...]) -> tuple[str, ...]:
    """Those of the flags that the compiler takes without complaint."""
    if _accepts(compiler, flags):
        return flags
    works, output = _try(compiler, ())
    if not works:
        said = output.strip() or "nothing"
        raise NoCompiler(
            f"{shlex.join(compiler.command)} cannot make a shared library; it said: {said}\nMend it, {HINT}"
        )
    return tuple(flag for flag in flags if _accepts(compiler, (flag,)))


@functools.lru_cache
def processor() -> str:
    """The processor's model and what it can do, as far as the system tells: -march=native depends on it."""
    wanted = ("vendor_id", "cpu family", "model", "model name", "flags", "CPU ", "Features", "isa", "uarch")
    known = [platform.machine(), platform.processor()]
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            for line in lines:
                if not line.strip():  # the first processor speaks for all
                    break
                if line.startswith(wanted):
                    known.append(" ".join(line.split()))
    except OSError:
        pass
    return "\n".join(known)


@functools.lru_cache
def _identify(candidate: str, search_path: str) -> Compiler | str:
    """The compiler that a command starts; else what is wrong, empty where there is no such program."""
    words = shlex.split(candidate)
    program = shutil.which(words[0], path=search_path) if words else None
    if program is None:
        return ""
    command = (os.path.abspath(program), *words[1:])
    succeeded, output = _run([*command, "--version"])
    if succeeded:
        return Compiler(command, output.strip())
    return f"`{shlex.join(command)} --version` fails and says {_first_line(output)!r}"


def _first_line(output: str) -> str:
    return (output.strip().splitlines() or ["nothing"])[0]


def _contents(sources: Sequence[Path], include_dirs: Sequence[Path]) -> list[tuple[str, str]]:
    """Every file that goes into a library, but system headers: its name as written, its content's digest."""
    found: list[tuple[str, str]] = []
    seen: set[Path] = set()

    def visit(written: str, path: Path) -> None:
        if (place := path.resolve()) in seen:
            return
        seen.add(place)
        content = path.read_bytes()
        found.append((written, cache.digest(content)))
        for match in _INCLUDE.finditer(content):
            header = os.fsdecode(match[1])
            for folder in (path.parent, *include_dirs):
                if (folder / header).is_file():
                    visit(header, folder / header)
                    break

    for source in sources:
        visit(source.name, source)
    return found


def _accepts(compiler: Compiler, flags: tuple[str, ...]) -> bool:
    return _try(compiler, ("-Werror", *flags))[0]


def _try(compiler: Compiler, flags: tuple[str, ...]) -> tuple[bool, str]:
    with tempfile.TemporaryDirectory(prefix="krhpr-") as folder:
        source = Path(folder) / "probe.c"
        source.write_text(
            "#include <math.h>\ndouble probe(double x);\ndouble probe(double x) { return sqrt(x); }\n"
        )
        result = Path(folder) / "probe.so"
        return _run([*compiler.command, *SHARED, *flags, str(source), "-o", str(result), "-lm"])


def _run(command: Sequence[str]) -> tuple[bool, str]:
    """Run a compiler; whether it succeeded, and what it said (untranslated: versions are part of keys)."""
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, "LC_ALL": "C"},
            encoding=sys.getfilesystemencoding(),
            errors="replace",
            check=False,
        )
    except OSError as error:
        return False, str(error)
    return done.returncode == 0, done.stdout
