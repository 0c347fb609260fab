"""W3 with GSL's complex solver (balanced companion matrix, QR) in place of this project's real roots.

Everything else is the same code: the sextic, the pose at a root, the test of its links.
"""

from __future__ import annotations

from pathlib import Path

from benchmarks.contender import Contender
from benchmarks.ours import baked, write_robot
from benchmarks.peers.driver import main
from benchmarks.workloads import Workload

HEADER = Path("/usr/include/gsl/gsl_poly.h")

GLUE = """#include <gsl/gsl_poly.h>
#include "krhpr_spatial_rrr_a.c"
@GEOMETRY@
@PROTOTYPE@
{
    static gsl_poly_complex_workspace *workspace = NULL;
    double anchor[6], length[3], sign[1], flatness[1], points[6], axes[9], sextic[7], z[12], order[6];
    int kept = 0;
    if (workspace == NULL) {
        workspace = gsl_poly_complex_workspace_alloc(7);
    }
    for (int i = 0; i < 3; ++i) {
        krhpr_platform_spatial_a_tie(&geometry.platform, i, anchor + 2 * i, length + i);
    }
    krhpr_platform_spatial_a_sextic(s, anchor, length, 1.0, sign, flatness, points, axes, sextic);
    gsl_poly_complex_solve(sextic, 7, workspace, z);
    for (int k = 0; k < 6; ++k) {
        double p[3], Q[9], det_J[1], miss[1], tail[KRHPR_PADDED(3)];
        double tail_y[KRHPR_PADDED(3)] = {0.0}, tail_x[KRHPR_PADDED(3)] = {0.0};
        const double root[2] = {z[2 * k], 1.0};
        if (fabs(z[2 * k + 1]) > 1e-7 * (1.0 + fabs(z[2 * k]))) {
            continue;
        }
        krhpr_platform_spatial_a_assembly(
            root, s, anchor, length, points, axes, p, Q, det_J, miss, tail_y, tail_x);
        if (!(miss[0] <= 1e-18)) {
            continue;
        }
        krhpr_atan2_array(3, tail_y, tail_x, tail);
        int place = kept++;
        for (; place > 0 && order[place - 1] > det_J[0]; --place) {
            order[place] = order[place - 1];
            krhpr_copy(p_all + 3 * place, p_all + 3 * (place - 1), 3);
            krhpr_copy(Q_all + 9 * place, Q_all + 9 * (place - 1), 9);
            krhpr_copy(beta_all + 3 * place, beta_all + 3 * (place - 1), 3);
        }
        order[place] = det_J[0];
        krhpr_copy(p_all + 3 * place, p, 3);
        krhpr_copy(Q_all + 9 * place, Q, 9);
        krhpr_copy(beta_all + 3 * place, tail, 3);
    }
    count[0] = (double)kept;
    for (int k = kept; k < 6; ++k) {
        krhpr_fill_zero(p_all + 3 * k, 3);
        krhpr_fill_zero(Q_all + 9 * k, 9);
        krhpr_fill_zero(beta_all + 3 * k, 3);
    }
}
"""


def generate(workload: Workload, folder: Path) -> list[Contender]:
    """One contender; a message where GSL's headers are not installed."""
    if not HEADER.exists():
        raise FileNotFoundError(f"{HEADER} is not there: install libgsl-dev")
    robot = write_robot(workload, folder / workload.key)
    glue = GLUE.replace("@GEOMETRY@", ZERO + baked(robot)).replace("@PROTOTYPE@", workload.prototype())
    return [
        Contender(
            name="GSL",
            workload=workload.key,
            variant="gsl_poly_complex_solve",
            glue=glue,
            include_dirs=(str(folder / workload.key),),
            libraries=("-lgsl", "-lgslcblas"),
            self_contained=False,
        )
    ]


ZERO = """
static void krhpr_fill_zero(double *x, int n)
{
    for (int k = 0; k < n; ++k) {
        x[k] = 0.0;
    }
}
"""


if __name__ == "__main__":
    main(generate, ())
