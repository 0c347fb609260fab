"""The example program: built in every way that it tells, its numbers against Python, its messages."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import krhpr
from tests.c.support import CONFORMANCE, SOURCES, program, run
from tests.support import need

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "c"
ROBOT = "spatial_r_fivebar_a"


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "way" in metafunc.fixturenames:
        metafunc.parametrize("way", ["cc", "generated", "examples", "installed"], scope="session")


@pytest.fixture(scope="session")
def built(way: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program: compiled at once, from either CMake project, against an installed library."""
    folder = tmp_path_factory.mktemp(way)
    if way == "cc":
        return compiled(folder)
    need("cmake", "cc")
    kind = f"-DCMAKE_BUILD_TYPE={'Release' if way == 'generated' else 'Debug'}"
    options = [kind, f"-DKRHPR_ROBOTS={ROBOT}"]
    if way == "installed":
        prefix = folder / "prefix"
        run(["cmake", "-S", SOURCES, "-B", folder / "c", *options, "-DKRHPR_EXAMPLES=OFF"])
        run(["cmake", "--build", folder / "c"])
        run(["cmake", "--install", folder / "c", "--prefix", prefix])
        options = [kind, f"-DCMAKE_PREFIX_PATH={prefix}"]
    run(["cmake", "-S", SOURCES if way == "generated" else EXAMPLE, "-B", folder / "b", *options])
    run(["cmake", "--build", folder / "b"])
    assert (folder / "b" / "krhpr").exists() == (way == "examples"), (
        "sources are built where none are installed"
    )
    return folder / "b" / ("examples/inverse" if way == "generated" else "inverse")


@pytest.fixture(scope="session")
def inverse(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(tmp_path_factory.mktemp("inverse"))


def compiled(folder: Path) -> Path:
    target = folder / "inverse"
    sources = [EXAMPLE / "inverse.c", SOURCES / f"krhpr_{ROBOT}.c"]
    run([program("cc"), "-O0", f"-I{SOURCES}", *sources, "-o", target, "-lm"])
    return target


def poses(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, rotation vectors and redundant angles; some are out of reach."""
    rng = np.random.default_rng(5)
    p = rng.uniform(-0.12, 0.12, (count, 3))
    p[:, 2] += 0.35
    p[::7, 2] += 1.0
    vectors = rng.uniform(-0.4, 0.4, (count, 3))
    vectors[1] *= 1e-7
    return p, vectors, rng.uniform(0.6, 2.5, (count, 3))


def matrix(vectors: np.ndarray) -> np.ndarray:
    """Rotation matrices, through SciPy."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()


def parse(text: str) -> list[tuple[str, np.ndarray, np.ndarray | None]]:
    """Status, theta and J of every pose that was printed."""
    found = []
    for block in re.split(r"^line \d+: ", text, flags=re.MULTILINE)[1:]:
        status, *rows = block.strip().splitlines()
        numbers = [[float(word) for word in row.split()[2:]] for row in rows]
        found.append((status, np.array(numbers[:3]), np.array(numbers[3:]) if numbers[3:] else None))
    return found


def test_numbers_are_those_of_python(built: Path) -> None:
    robot = krhpr.load(ROBOT, backend="numpy")
    p, vectors, beta = poses(60)
    Q = matrix(vectors)
    lines = []
    for k in range(60):
        orientation = vectors[k] if k % 2 else Q[k].ravel()
        lines.append(" ".join(repr(float(x)) for x in (*p[k], *orientation, *beta[k])))
    done = subprocess.run([built], input="\n".join(lines), capture_output=True, text=True, check=False)
    answers = parse(done.stdout)
    assert len(answers) == 60 and done.stderr == ""
    theta, status = robot.inverse(p, Q, beta, status=True)
    J, _ = robot.jacobians(p, Q, robot.end_points(p, Q, beta), theta)
    assert done.returncode == 1 and (status == 0).sum() > 20 and (status != 0).any()
    for k, (said, joints, jacobian) in enumerate(answers):
        assert (said == "ok") == (status[k] == 0)
        if status[k] in (1, 2, 3):
            assert said == f"out of reach of leg {status[k]}"
        np.testing.assert_allclose(joints, theta[k], rtol=0, atol=2e-12)
        assert (jacobian is not None) == (status[k] == 0)
        if jacobian is not None:
            np.testing.assert_allclose(jacobian, J[k], rtol=0, atol=2e-12)


def test_degrees_modes_and_layout(inverse: Path) -> None:
    """Blank lines, comments and commas are read; angles in degrees; other working modes; J left out."""
    robot = krhpr.load(ROBOT, backend="numpy")
    text = "# a comment\n\n0 0 0.35, 0 0 10, 95 100 105 # behind it\n\t0,0,0.36 0 0 0 90 90 90\n"
    answers = parse(run([inverse, "-d", "-n", "--mode", "++-"], text=text))
    assert [said for said, *_ in answers] == ["ok", "ok"] and answers[0][2] is None
    Q = matrix(np.radians([[0, 0, 10], [0, 0, 0]]))
    beta = np.radians([[95, 100, 105], [90, 90, 90]])
    theta = robot.inverse([[0, 0, 0.35], [0, 0, 0.36]], Q, beta, mode=[[1, 1, -1]] * 3)
    np.testing.assert_allclose([joints for _, joints, _ in answers], np.degrees(theta), rtol=0, atol=2e-12)


MISTAKES = {
    "1 2 x": "line 1: 'x' is not a number",
    "1 2 3e": "line 1: '3e' is not a number",
    "\n1 2 3": "line 2: 3 numbers; there should be 9 (p, rotation vector, beta) or 15 (p, Q, beta)",
    "0 " * 16: "line 1: more than 15 numbers",
    "0 0 nan 0 0 0 1 1 1": "line 1: nan is not a finite number",
    "0 0 1e999 0 0 0 1 1 1": "line 1: 1e999 is not a finite number",
    "0 0 0.3 1 0 0 0 1 0 0 0 1.1 1 1 1": "line 1: Q is not a rotation matrix (Q^T Q differs from I by 0.21)",
    "0 0 0.3 1 0 0 0 1 0 0 0 -1 1 1 1": "line 1: Q is not a rotation matrix (Q^T Q differs from I by 2)",
    "0" * 2000: "line 1: longer than 1000 characters",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_malformed_input_is_told(inverse: Path, text: str) -> None:
    done = subprocess.run([inverse], input=text, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"inverse: {MISTAKES[text]}\n")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--mode", "++"], "--mode takes 3 signs, such as ++-, not '++'"),
        (["--mode"], "--mode takes 3 signs, such as ++-, not ''"),
        (["--verbose"], "unknown option '--verbose'; --help tells what there is"),
    ],
)
def test_malformed_options_are_told(inverse: Path, arguments: list[str], said: str) -> None:
    done = subprocess.run([inverse, *arguments], input="", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"inverse: {said}\n")


def test_help_names_every_option(inverse: Path) -> None:
    text = run([inverse, "--help"])
    source = (EXAMPLE / "inverse.c").read_text()
    options = set(re.findall(r'"(--?[a-z-]+)"\) == 0', source))
    assert len(options) == 8 and all(re.search(rf"(?<!\S){option}\b", text) for option in options)
    default = krhpr.load(ROBOT, backend="numpy").default_mode
    assert (
        f"(default {''.join(re.findall(r'[+-]', default.replace('front', '+').replace('back', '-')))})"
        in text
    )
    assert "exit status" in text and max(map(len, text.splitlines())) <= 118


def test_no_input_is_no_mistake(inverse: Path) -> None:
    assert run([inverse], text="") == ""


def test_the_example_is_strict_c99(compiler: str) -> None:
    run([compiler, *CONFORMANCE, "-O2", "-fsyntax-only", f"-I{SOURCES}", EXAMPLE / "inverse.c"])


def test_nothing_but_generated_c_is_used() -> None:
    """System headers aside."""
    included = re.findall(r'#include "([^"]+)"', (EXAMPLE / "inverse.c").read_text())
    assert included == [f"krhpr_{ROBOT}.h"]
