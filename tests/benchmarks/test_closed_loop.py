"""What is left to users of rigid-body libraries, against the formulas of the benchmark."""

from __future__ import annotations

import ctypes
import math
import shutil

import numpy as np
import pytest

from benchmarks.build import run
from benchmarks.measure import Floats, scaled_error
from benchmarks.peers import closed_loop
from benchmarks.robot import L2, L3, L_REDUNDANT, LEGS
from benchmarks.samples import draw, end_points, evaluate
from benchmarks.workloads import WORKLOADS

POSES = 20
SHIM = """#include "closed_loop.h"
#include "geometry.h"
void rows(int i, const double *p, const double *Q, const double *s, const double *columns, double *J,
          double *K) {
    const double *const column[3] = {columns, columns + 3, columns + 6};
    closed_loop_rows(p, Q, CORNER[i], s, column, J, K);
}
void end_point(int i, const double *p, const double *Q, double beta, double *s) {
    closed_loop_end_point(p, Q, CORNER[i], START[i], L_REDUNDANT, beta, s);
}
double redundant(int i, const double *p, const double *Q, const double *s) {
    return closed_loop_beta(p, Q, CORNER[i], START[i], s);
}
double step(const double *wanted, const double *s, const double *columns, double *theta) {
    const double *const column[3] = {columns, columns + 3, columns + 6};
    return closed_loop_step(wanted, s, column, theta);
}
void base(int i, double *at) {
    for (int k = 0; k < 9; ++k) {
        at[k] = BASE[i][k];
    }
}
"""


@pytest.fixture(scope="module")
def shim(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    if shutil.which("gcc") is None:
        pytest.skip("takes gcc")
    folder = tmp_path_factory.mktemp("closed_loop")
    (folder / "geometry.h").write_text(closed_loop.header())
    (folder / "shim.c").write_text(SHIM)
    flags = ["-O1", "-Wall", "-Wextra", "-Werror", "-std=c99", "-shared", "-fPIC"]
    include = [f"-I{folder}", f"-I{closed_loop.FOLDER}"]
    run(["gcc", *flags, *include, str(folder / "shim.c"), "-o", str(folder / "shim.so"), "-lm"])
    library = ctypes.CDLL(str(folder / "shim.so"))
    library.redundant.restype = library.step.restype = ctypes.c_double
    return library


def at(array: Floats) -> ctypes.c_void_p:
    assert array.flags.c_contiguous
    return ctypes.c_void_p(array.ctypes.data)


def chain(i: int, theta: Floats) -> tuple[Floats, Floats]:
    """S_i of a chain and the columns of M_i, from turns about its three axes."""
    leg = LEGS[i]
    e_1, e_x, e_t, c = (np.array(v, float) for v in (leg.e_1, leg.e_x, leg.e_t, leg.c))
    x = math.cos(theta[0]) * e_x - math.sin(theta[0]) * e_t
    axis = np.cross(x, e_1)
    elbow = L2 * (math.cos(theta[1]) * x + math.sin(theta[1]) * e_1)
    both = theta[1] + theta[2]
    wrist = L3 * (math.cos(both) * x + math.sin(both) * e_1)
    reach = elbow + wrist
    return c + reach, np.array([np.cross(e_1, reach), np.cross(axis, reach), np.cross(axis, wrist)])


def test_rows_of_j_and_k_from_end_points_and_jacobians(shim: ctypes.CDLL) -> None:
    p, Q, theta = draw(WORKLOADS["w1"], POSES)
    J, K = np.empty((POSES, 6, 6)), np.empty((POSES, 3, 2, 3))
    for pose in range(POSES):
        for i in range(3):
            s, columns = chain(i, theta[pose].reshape(3, 3)[i])
            shim.rows(i, at(p[pose]), at(Q[pose]), at(s), at(columns), at(J[pose][2 * i :]), at(K[pose][i]))
    assert scaled_error(WORKLOADS["w1"], [J, K], evaluate(WORKLOADS["w1"], [p, Q, theta])) < 1e-13


def test_end_points_and_redundant_angles(shim: ctypes.CDLL) -> None:
    p, Q, beta = draw(WORKLOADS["w2"], POSES)
    expected = end_points(p, Q.reshape(-1, 3, 3), beta)
    found = np.empty(3)
    for pose in range(POSES):
        for i in range(3):
            shim.end_point(i, at(p[pose]), at(Q[pose]), ctypes.c_double(beta[pose, i]), at(found))
            assert found == pytest.approx(expected[pose, i], abs=1e-15)
            assert shim.redundant(i, at(p[pose]), at(Q[pose]), at(found)) == pytest.approx(beta[pose, i])


def test_newtons_method_ends_at_the_inverse_kinematics(shim: ctypes.CDLL) -> None:
    p, Q, beta = draw(WORKLOADS["w2"], POSES)
    (expected,) = evaluate(WORKLOADS["w2"], [p, Q, beta])
    wanted = end_points(p, Q.reshape(-1, 3, 3), beta)
    for pose in range(POSES):
        for i in range(3):
            theta = np.array(closed_loop.home_angles()[3 * i : 3 * i + 3])
            changes = []
            while not changes or changes[-1] > 1e-8:
                s, columns = chain(i, theta)
                changes.append(shim.step(at(wanted[pose, i]), at(s), at(columns), at(theta)))
                assert len(changes) < 10
            assert theta == pytest.approx(expected[pose].reshape(3, 3)[i], abs=1e-12)


def test_the_home_pose_is_where_the_chains_end(shim: ctypes.CDLL) -> None:
    """And the frames that libraries are given are right-handed, with x and z those of the formulas."""
    p, q, beta = (np.array([x]) for x in closed_loop.HOME)
    s = end_points(p, q.reshape(1, 3, 3), beta)[0]
    base = np.empty((3, 3))
    for i in range(3):
        found, _ = chain(i, np.array(closed_loop.home_angles()[3 * i : 3 * i + 3]))
        assert found == pytest.approx(s[i], abs=1e-14)
        shim.base(i, at(base))
        assert np.cross(base[2], base[0]) == pytest.approx(base[1])
        assert base @ base.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.norm(s[0] - [0.125, 0, 0.35]) == pytest.approx(L_REDUNDANT)
