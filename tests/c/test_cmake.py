"""The CMake project of the generated C: options, installation, use from another project."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from tests.c.support import CONTROLLED, KINDS, ROBOTS, SOURCES, program, run
from tests.support import need

ROBOT = "planar_rr_a"

CONSUMER = """
cmake_minimum_required(VERSION 3.14)
project(consumer LANGUAGES C CXX)
%s
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE krhpr::planar_rr_a)
"""
MAIN = """
#include <krhpr_planar_rr_a.h>
int main()
{
    krhpr_planar_rr_a_geometry g;
    return krhpr_planar_rr_a_default_geometry(&g);
}
"""


@pytest.fixture(autouse=True)
def cmake() -> str:
    need("cc")
    return program("cmake")


def configure(folder: Path, *options: str) -> dict[str, list[str]]:
    """The words of each source's compile command, after configuring."""
    run(["cmake", "-S", SOURCES, "-B", folder, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options])
    commands = json.loads((folder / "compile_commands.json").read_text())
    return {Path(entry["file"]).name: entry["command"].split() for entry in commands}


def test_every_robot_is_a_target(tmp_path: Path) -> None:
    commands = configure(tmp_path, "-DKRHPR_CASADI=ON")
    expected = {f"krhpr_{robot}{ending}.c" for robot in ROBOTS for ending in (*KINDS, "_casadi")}
    expected |= {f"krhpr_{robot}_control.c" for robot in CONTROLLED}
    assert set(commands) == expected | {"inverse.c"}
    for name, words in commands.items():
        assert "-std=c99" in words and "-O3" in words, "a Release build unless told otherwise"
        if name != "inverse.c":
            assert {"-march=native", "-ffp-contract=fast", "-fno-math-errno"} <= set(words)


def test_options_switch_flags_off(tmp_path: Path) -> None:
    options = (f"-DKRHPR_ROBOTS={ROBOT}", "-DKRHPR_SPEED=OFF", "-DKRHPR_NATIVE=OFF", "-DKRHPR_EXAMPLES=OFF")
    commands = configure(tmp_path, *options, "-DCMAKE_BUILD_TYPE=Debug")
    assert set(commands) == {f"krhpr_{ROBOT}{kind}.c" for kind in KINDS}
    assert not [
        word
        for words in commands.values()
        for word in words
        if word.startswith(("-march", "-ff", "-fno-", "-O"))
    ]


def test_without_its_robot_the_example_is_left_out(tmp_path: Path) -> None:
    assert set(configure(tmp_path, f"-DKRHPR_ROBOTS={ROBOT}")) == {f"krhpr_{ROBOT}{kind}.c" for kind in KINDS}


def test_no_native_instructions_for_another_machine(tmp_path: Path) -> None:
    """A tool chain for another system leaves -march=native out, unless it is asked for."""
    toolchain = tmp_path / "toolchain.cmake"
    toolchain.write_text("set(CMAKE_SYSTEM_NAME Linux)\nset(CMAKE_SYSTEM_PROCESSOR elsewhere)\n")
    options = (f"-DCMAKE_TOOLCHAIN_FILE={toolchain}", f"-DKRHPR_ROBOTS={ROBOT}", "-DKRHPR_EXAMPLES=OFF")
    for words in configure(tmp_path / "a", *options).values():
        assert "-march=native" not in words and "-ffp-contract=fast" in words
    for words in configure(tmp_path / "b", *options, "-DKRHPR_NATIVE=ON").values():
        assert "-march=native" in words


def test_an_unknown_robot_is_told(tmp_path: Path) -> None:
    command = ["cmake", "-S", str(SOURCES), "-B", str(tmp_path), "-DKRHPR_ROBOTS=planar_rr_z"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    said = " ".join(done.stderr.split())
    assert "no robot is called planar_rr_z; there are" in said and ROBOT in said


def test_every_option_is_documented() -> None:
    text = (SOURCES / "CMakeLists.txt").read_text()
    options = set(re.findall(r"option\((KRHPR_\w+)", text)) | set(re.findall(r"set\((KRHPR_\w+)", text))
    head = text[: text.index("cmake_minimum_required")]
    assert len(options) == 6 and all(f"#   {option} " in head for option in options)


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An installation of one robot."""
    folder = tmp_path_factory.mktemp("install")
    need("cmake", "cc")
    options = [
        f"-DKRHPR_ROBOTS={ROBOT}",
        "-DKRHPR_EXAMPLES=OFF",
        "-DKRHPR_CASADI=ON",
        "-DCMAKE_BUILD_TYPE=Debug",
    ]
    run(["cmake", "-S", SOURCES, "-B", folder / "build", *options])
    run(["cmake", "--build", folder / "build"])
    run(["cmake", "--install", folder / "build", "--prefix", folder / "prefix"])
    return folder / "prefix"


def test_what_is_installed(prefix: Path) -> None:
    names = {path.name for path in prefix.rglob("*") if path.is_file()}
    assert {
        f"libkrhpr_{ROBOT}.a",
        f"krhpr_{ROBOT}_casadi.so",
        "krhprConfig.cmake",
        "krhprTargets.cmake",
    } <= names
    assert {path.name for path in SOURCES.glob("*.h")} <= names
    texts = [path.read_text() for path in prefix.rglob("*.cmake")]
    assert not any(str(SOURCES) in text for text in texts), "an installation does not depend on the sources"


@pytest.mark.parametrize("how", ["installed", "sources"])
def test_another_project_uses_it(how: str, prefix: Path, tmp_path: Path) -> None:
    """By find_package, or by add_subdirectory, which then neither installs nor builds the example."""
    need("c++")
    line = (
        "find_package(krhpr 0.1 CONFIG REQUIRED)"
        if how == "installed"
        else f"add_subdirectory({SOURCES} krhpr)"
    )
    (tmp_path / "CMakeLists.txt").write_text(CONSUMER % line)
    (tmp_path / "main.cpp").write_text(MAIN)
    build = tmp_path / "build"
    run(["cmake", "-S", tmp_path, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DKRHPR_ROBOTS={ROBOT}"])
    run(["cmake", "--build", build])
    run([build / "consumer"])
    run(["cmake", "--install", build, "--prefix", tmp_path / "nothing"])
    assert not list((tmp_path / "nothing").rglob("*"))
    assert not list(build.rglob("inverse"))
