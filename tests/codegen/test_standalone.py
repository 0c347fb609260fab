"""A gathered folder works on its own: as a Python package without krhpr, as C with CMake."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import krhpr
from krhpr.codegen.output import write
from krhpr.codegen.pipeline import derive, print_all
from krhpr.codegen.standalone import standalone_files
from krhpr.derivations.catalogue import catalogue
from tests.support import contents, need

STRICT = (
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wvla",
    "-Werror",
)

USE = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("krhpr", "sympy", "jinja2", "rich"):
            raise ImportError(f"{name} is not for a folder that stands alone")

sys.meta_path.insert(0, Blocked())
sys.path.insert(0, sys.argv[1])

import my_arm
from my_arm import planar_rr_a, spatial_rrr_c

p, phi, redundant = [0.01, -0.02], 0.1, [1.5, 1.4, 1.6]
print(planar_rr_a.inverse(p, phi, redundant).ravel().tolist())
print(spatial_rrr_c.__file__)
try:
    my_arm.spatial_rrr_a
except AttributeError as error:
    print(error)
"""

USE_CASADI = """
import sys

sys.path.insert(0, sys.argv[1])
from my_arm.casadi import planar_rr_a

inverse = planar_rr_a.inverse(planar_rr_a.DEFAULT_GEOMETRY)
print(inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6], [1, 1, 1]).full().ravel().tolist())
"""

PROGRAM = """
#include <stdio.h>
#include "krhpr_planar_rr_a.h"
#include "krhpr_spatial_rrr_c.h"

int main(void)
{
    krhpr_planar_rr_a_geometry plane;
    krhpr_spatial_rrr_c_geometry space;
    const double p[2] = {0.01, -0.02}, redundant[3] = {1.5, 1.4, 1.6};
    double theta[6];
    int status = krhpr_planar_rr_a_default_geometry(&plane) | krhpr_spatial_rrr_c_default_geometry(&space);
    status |= krhpr_planar_rr_a_inverse(&plane, p, 0.1, redundant, NULL, theta);
    for (int i = 0; i < 6; ++i) printf("%.17g ", theta[i]);
    return status;
}
"""


@pytest.fixture(scope="session")
def gathered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two robots gathered in a folder called my_arm."""
    folder = tmp_path_factory.mktemp("gathered") / "my_arm"
    derived = derive([entry for entry in catalogue() if entry.identifier in ("planar_rr_a", "spatial_rrr_c")])
    write(standalone_files(derived, print_all(derived), folder.name), folder)
    return folder


@pytest.fixture(scope="session")
def expected() -> list[float]:
    robot = krhpr.load("planar_rr_a", backend="numpy")
    return robot.inverse([0.01, -0.02], 0.1, [1.5, 1.4, 1.6]).ravel().tolist()  # type: ignore[no-any-return]


def run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_it_holds_what_the_robots_need_and_nothing_else(gathered: Path) -> None:
    found = contents(gathered)
    c = {path for path in found if path.startswith("c/")}
    assert c == {
        "c/CMakeLists.txt",
        *(
            f"c/krhpr_{name}{ending}"
            for name in ("planar_rr_a", "spatial_rrr_c")
            for ending in (".h", ".c", "_batch.c")
        ),
        *(f"c/casadi/krhpr_{name}_casadi.c" for name in ("planar_rr_a", "spatial_rrr_c")),
    }
    assert {"README.md", "__init__.py", "python/subleg_rrr.py", "casadi/planar_rr_a.py"} <= found.keys()
    assert not [path for path in found if "fivebar" in path or "spatial_a" in path]
    assert not [path for path, text in found.items() if b"krhpr.generated" in text or b"krhpr.load" in text]


def test_the_python_package_works_without_krhpr(gathered: Path, expected: list[float]) -> None:
    out = run(sys.executable, "-c", USE, str(gathered.parent)).splitlines()
    assert np.allclose(eval_list(out[0]), expected, rtol=0, atol=1e-15)
    assert out[1] == str(gathered / "python" / "spatial_rrr_c.py")
    assert "robots: spatial_rrr_c, planar_rr_a" in out[2]


def test_the_casadi_modules_work_there(gathered: Path, expected: list[float]) -> None:
    (line,) = run(sys.executable, "-c", USE_CASADI, str(gathered.parent)).splitlines()
    assert np.allclose(sorted(eval_list(line)), sorted(expected), rtol=0, atol=1e-14)


def eval_list(text: str) -> list[float]:
    return [float(number) for number in text.strip("[]").split(",")]


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_both_robots_compile_into_one_program(
    compiler: str, gathered: Path, tmp_path: Path, expected: list[float]
) -> None:
    need(compiler)
    program = tmp_path / "program.c"
    program.write_text(PROGRAM)
    sources = [str(path) for path in sorted((gathered / "c").glob("*.c"))]
    binary = str(tmp_path / "program")
    run(compiler, *STRICT, f"-I{gathered / 'c'}", str(program), *sources, "-o", binary, "-lm")
    assert np.allclose([float(word) for word in run(binary).split()], expected, rtol=0, atol=1e-14)


def test_a_pair_of_files_is_enough(gathered: Path, tmp_path: Path) -> None:
    need("cc")
    for ending in ("h", "c"):
        shutil.copy(gathered / "c" / f"krhpr_spatial_rrr_c.{ending}", tmp_path)
    text = (tmp_path / "krhpr_spatial_rrr_c.h").read_text()
    assert not re.findall(r'#include "', text)
    run("cc", *STRICT, "-c", str(tmp_path / "krhpr_spatial_rrr_c.c"), "-o", str(tmp_path / "robot.o"))


def test_cmake_builds_it(gathered: Path, tmp_path: Path) -> None:
    need("cmake", "cc")
    run("cmake", "-S", str(gathered / "c"), "-B", str(tmp_path), "-DCMAKE_BUILD_TYPE=Debug")
    run("cmake", "--build", str(tmp_path))
    assert len(list(tmp_path.rglob("*krhpr_*.a"))) == 2
