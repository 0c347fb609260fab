/* W1 and W2 with MuJoCo: what it computes are the sites S_i, their Jacobians and the constraints' Jacobian;
   closed_loop.h makes J, K and the joint angles of it. MODEL_CHAINS and MODEL_LOOPS are files in its format. */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "closed_loop.h"
#include "geometry.h"

typedef struct {
    mjModel *model;
    mjData *data;
} Simulation;

static Simulation load(const char *path)
{
    char why[1000] = "";
    Simulation made = {mj_loadXML(path, NULL, why, sizeof why), NULL};
    if (made.model == NULL) {
        fprintf(stderr, "%s: %s\n", path, why);
        abort();
    }
    made.data = mj_makeData(made.model);
    return made;
}

/* Sites 0 to 2 are S_1 to S_3 of the chains; columns[i][k] is the k-th column of M_i. */
static void chains(const Simulation *at, double columns[LEGS][3][3])
{
    mj_kinematics(at->model, at->data);
    mj_comPos(at->model, at->data);
    for (int i = 0; i < LEGS; ++i) {
        double rows[3][9];
        mj_jacSite(at->model, at->data, rows[0], NULL, i);
        for (int k = 0; k < 3; ++k) {
            for (int m = 0; m < 3; ++m) {
                columns[i][k][m] = rows[m][3 * i + k];
            }
        }
    }
}

void mujoco_chains_w1(const double *p, const double *Q, const double *theta, double *J, double *K)
{
    static Simulation at;
    double columns[LEGS][3][3];
    if (at.model == NULL) {
        at = load(MODEL_CHAINS);
    }
    memcpy(at.data->qpos, theta, 9 * sizeof *theta);
    chains(&at, columns);
    for (int i = 0; i < LEGS; ++i) {
        const double *const column[3] = {columns[i][0], columns[i][1], columns[i][2]};
        closed_loop_rows(p, Q, CORNER[i], at.data->site_xpos + 3 * i, column, J + 12 * i, K + 6 * i);
    }
}

void mujoco_loops_w1(const double *p, const double *Q, const double *theta, double *J, double *K)
{
    static Simulation at;
    if (at.model == NULL) {
        at = load(MODEL_LOOPS);
    }
    mjData *const d = at.data;
    memcpy(d->qpos, theta, 9 * sizeof *theta);
    memcpy(d->qpos + 9, p, 3 * sizeof *p);
    mju_mat2Quat(d->qpos + 12, Q);
    /* The redundant angles are not given: the chains' ends are known once the joint angles are. */
    mj_kinematics(at.model, d);
    for (int i = 0; i < LEGS; ++i) {
        d->qpos[16 + i] = -closed_loop_beta(p, Q, CORNER[i], START[i], d->site_xpos + 3 * i);
    }
    mj_kinematics(at.model, d);
    mj_comPos(at.model, d);
    mj_makeConstraint(at.model, d);
    for (int i = 0; i < LEGS; ++i) {
        const double *const rows = d->efc_J + 3 * 18 * i; /* velocity of the chain's end less that of the link's */
        double across[2][3], corner[3];
        closed_loop_turn(Q, CORNER[i][0], CORNER[i][1], corner);
        for (int m = 0; m < 3; ++m) {
            across[0][m] = p[m] + corner[m] - d->site_xpos[3 * i + m];
            across[1][m] = Q[3 * m + 2];
        }
        for (int row = 0; row < 2; ++row) {
            double along[18], *const j = J + 12 * i + 6 * row;
            for (int k = 0; k < 18; ++k) {
                along[k] = across[row][0] * rows[k] + across[row][1] * rows[18 + k] + across[row][2] * rows[36 + k];
            }
            for (int m = 0; m < 3; ++m) {
                K[6 * i + 3 * row + m] = along[3 * i + m];
                j[m] = -along[9 + m];
                j[3 + m] = -closed_loop_dot(Q + 3 * m, along + 12); /* it turns in the platform's frame */
            }
        }
    }
}

void mujoco_w2(const double *p, const double *Q, const double *beta, double *theta)
{
    static Simulation at;
    double wanted[LEGS][3], columns[LEGS][3][3], change = 1.0;
    if (at.model == NULL) {
        at = load(MODEL_CHAINS);
    }
    for (int i = 0; i < LEGS; ++i) {
        closed_loop_end_point(p, Q, CORNER[i], START[i], L_REDUNDANT, beta[i], wanted[i]);
    }
    memcpy(at.data->qpos, HOME, sizeof HOME);
    for (int step = 0; step < MOST_STEPS && change > ACCURATE; ++step) {
        chains(&at, columns);
        change = 0.0;
        for (int i = 0; i < LEGS; ++i) {
            const double *const column[3] = {columns[i][0], columns[i][1], columns[i][2]};
            change = fmax(change, closed_loop_step(wanted[i], at.data->site_xpos + 3 * i, column,
                                                   at.data->qpos + 3 * i));
        }
    }
    memcpy(theta, at.data->qpos, 9 * sizeof *theta);
}
