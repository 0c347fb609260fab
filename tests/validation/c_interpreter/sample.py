"""A C text like those that the project prints, and the numbers that the tests run it on."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from krhpr.validation.c_interpreter import CProgram, Struct
from krhpr.validation.numbers import Angle

HEADER = """
/* A leg with three revolute joints: header. */
#ifndef SAMPLE_LEG_H
#define SAMPLE_LEG_H

#include <math.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SAMPLE_LEGS 3   // legs of the robot
#define SAMPLE_JOINTS (3)
#ifndef M_PI
#define M_PI 3.14159265358979323846
#endif

typedef enum { SAMPLE_OK, SAMPLE_UNREACHABLE = 10, SAMPLE_INVALID = SAMPLE_UNREACHABLE + 10 } sample_status;

typedef struct {
    double c[3];            /* shoulder */
    double cos_psi, sin_psi;
    double l2;
    double l3;
} sample_leg;

typedef struct sample_geometry {
    sample_leg leg[SAMPLE_LEGS];
    double tool[2][3];
    int modes[SAMPLE_LEGS];
} sample_geometry;

int sample_robot_forward(const sample_geometry *g, const double theta[9], double s[9], double M[27]);

#ifdef __cplusplus
}
#endif
#endif
"""

SOURCE = r"""
#include "sample_leg.h"

static const double unit[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

/* The leg kernel: straight-line. */
static inline void sample_leg_kernel(const sample_leg *restrict g, const double theta[3],
                                     double *restrict s, double *restrict M)
{
    const double x0 = sin(theta[0]), x1 = cos(theta[0]);
    const double x2 = sin(theta[1]);
    const double x3 = cos(theta[1]);
    const double x4 = theta[1] + theta[2];
    const double x5 = g->l3*sin(x4);
    const double x6 = g->l3*cos(x4);
    const double x7 = g->l2*x3 + x6;  /* radius */
    const double x8 = -(g->l2*x2 + x5);
    const double x9 = x1*g->cos_psi - x0*g->sin_psi;
    const double x10 = x1*g->sin_psi + x0*g->cos_psi;
    s[0] = g->c[0] + x7*x9;
    s[1] = g->c[1] + x7*x10;
    s[2] = g->c[2] - x8;
    M[0] = -x7*x10; M[1] = x8*x9;   M[2] = -x5*x9;
    M[3] = x7*x9;   M[4] = x8*x10;  M[5] = -x5*x10;
    M[6] = 0.0;     M[7] = x7;      M[8] = x6;
}

int sample_robot_forward(const sample_geometry *g, const double theta[9], double s[9], double M[27])
{
    int i;
    size_t k;
    for (k = 0; k < 9; k += 1) {
        if (!isfinite(theta[k])) {
            for (size_t j = 0; j < 9; ++j) s[j] = NAN;
            return SAMPLE_INVALID;
        }
    }
    for (i = 0; i < SAMPLE_LEGS; ++i) {
        const sample_leg *const leg = &g->leg[i];
        sample_leg_kernel(leg, theta + SAMPLE_JOINTS*i, s + 3*i, &M[9*i]);
    }
    return SAMPLE_OK;
}

double sample_wrapped(double angle)
{
    return atan2(sin(angle), cos(angle)) + 2*M_PI*floor(angle/(2*M_PI) + 0.5);
}

double sample_distance(double x, double y)
{
    return hypot(x, y);
}

/* Inverse of the last two joints, with branches, casts, conditionals and compound assignments. */
int sample_leg_inverse(const sample_leg *g, const double s[3], int mode, double theta[3])
{
    double v[3], radius, square = 0.0;
    double sum[2] = {0};
    for (int k = 0; k < 3; k++) {
        v[k] = s[k] - g->c[k];
        square += v[k]*v[k];
    }
    radius = sqrt(v[0]*v[0] + v[1]*v[1]);
    const double cosine = (square - g->l2*g->l2 - g->l3*g->l3)/(2*g->l2*g->l3);
    const double rest = 1 - cosine*cosine;
    if (rest < 0.0 || fabs(cosine) > 1.0) {
        for (int k = 0; k != 3; ++k)
            theta[k] = NAN;
        return SAMPLE_UNREACHABLE + mode;
    } else if (radius == 0) {
        return SAMPLE_INVALID;
    }
    const double sine = (mode ? -1 : 1)*sqrt(rest);
    theta[2] = atan2(sine, cosine);
    theta[1] = atan2(v[2], radius) - atan2(g->l3*sine, g->l2 + g->l3*cosine);
    theta[0] = atan2(v[1]*g->cos_psi - v[0]*g->sin_psi, v[0]*g->cos_psi + v[1]*g->sin_psi);
    sum[0] += fmax(v[0], fmin(v[1], v[2]));
    sum[1] -= (double)(7/2)/4;
    sum[0] *= 1e1;
    sum[1] /= 0.5;
    theta[0] += 0*(sum[0] + sum[1]);
    return SAMPLE_OK;
}

static double trace(const double A[3][3], double (*B)[3])
{
    double t = 0;
    for (int i = 0; i < 3; ++i) {
        double *row = B[i];
        for (int j = 0; j < 3; ++j) {
            if (i == j) t += A[i][j];
            row[j] = 2*A[j][i] - (i < j ? unit[i][j] : unit[i][i]);
            if (j > 1 && i > 1) continue;
        }
    }
    return t;
}

double sample_trace(const double A[9], double B[9])
{
    double local[3][3], other[3][3] = {{0}};
    sample_leg leg = {{1, 2, 3}, .l2 = 0.25, .l3 = 3.5e-1}, copy;
    copy = leg;
    copy.c[1] = -leg.c[2];
    for (size_t i = 0, n = 9; i < n; i++) local[i/3][i%3] = A[i];
    double t = trace(local, other);
    for (int i = 8; i >= 0; i--) {
        B[i] = other[i/3][i%3] + copy.c[1]*copy.cos_psi + leg.c[1] + copy.l2;
        if (i < 3) { if (t > 1e300) break; }
    }
    return t;
}

int sample_integers(int a, int b, double *out)
{
    const double *p = out;
    unsigned int u = 0u;
    u -= 1;
    const int bits = ((a << 3) | (b & 5)) ^ (~a >> 1);
    *out++ = a/b;
    *out = (double)a/b;
    out[1] = a%b;
    out[2] = (double)(u >> 16);
    out[3] = (double)(out - p) + (a > b) + 2*(a == b) + !a + -b;
    out[4] = (int)(a*0.75) + bits;
    return p == NULL ? -1 : a < 0 && b > 0 ? 1 : 2;
}
"""

ANGLES = [Angle.from_half_tangent(Fraction(k, 7)) for k in (1, -3, 5, 2, 9, -8, 4, -1, 6)]


def geometry(program: CProgram, values: Callable[[int], Any]) -> Struct:
    """A geometry whose fields are `values(0)`, `values(1)`, ..."""
    g = program.new_struct("sample_geometry")
    for i in range(3):
        leg = g.leg[i]
        leg.c = [values(9 * i + k) for k in range(3)]
        leg.cos_psi, leg.sin_psi = Fraction(3, 5), Fraction(4, 5)
        leg.l2, leg.l3 = values(9 * i + 3), values(9 * i + 4)
    g.tool = [[1, 2, 3], [4, 5, 6]]
    g.modes = [0, 1, 2]
    return g
