/* What a rigid-body library leaves to its users for W1 and W2: J and K from the legs' end points and Jacobians,
   the end points that a pose asks for, and the step of Newton's method of each leg. */
#ifndef CLOSED_LOOP_H
#define CLOSED_LOOP_H

#include <math.h>

#define LEGS 3
#define ACCURATE 1e-8 /* a step of Newton's method, radians: the one after it is below rounding */
#define MOST_STEPS 30

static inline double closed_loop_dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void closed_loop_cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Q v for a v in the platform's plane. */
static inline void closed_loop_turn(const double *Q, double x, double y, double *v)
{
    for (int m = 0; m < 3; ++m) {
        v[m] = Q[3 * m] * x + Q[3 * m + 1] * y;
    }
}

/* The two rows of J and K of one leg, (1.31) and (1.32): s is S_i, column[k] the k-th column of M_i, corner B_i in
   the platform. The joint between the platform and the link to S_i is projected out by a and q_z. */
static inline void closed_loop_rows(const double *p, const double *Q, const double *corner, const double *s,
                                    const double *const column[3], double *J, double *K)
{
    const double q_z[3] = {Q[2], Q[5], Q[8]};
    double qb[3], a[3], arm[3];
    closed_loop_turn(Q, corner[0], corner[1], qb);
    for (int m = 0; m < 3; ++m) {
        arm[m] = s[m] - p[m];
        a[m] = qb[m] - arm[m];
        J[m] = a[m];
        J[6 + m] = q_z[m];
    }
    closed_loop_cross(qb, a, J + 3);
    closed_loop_cross(arm, q_z, J + 9);
    for (int k = 0; k < 3; ++k) {
        K[k] = closed_loop_dot(a, column[k]);
        K[3 + k] = closed_loop_dot(q_z, column[k]);
    }
}

/* S_i where the pose and the redundant angle put it; start is the direction from B_i to S_i at beta = 0, and
   beta turns against the platform's normal. */
static inline void closed_loop_end_point(const double *p, const double *Q, const double *corner,
                                         const double *start, double length, double beta, double *s)
{
    const double c = length * cos(beta), t = length * sin(beta);
    closed_loop_turn(Q, corner[0] + c * start[0] + t * start[1], corner[1] + c * start[1] - t * start[0], s);
    for (int m = 0; m < 3; ++m) {
        s[m] += p[m];
    }
}

/* beta from S_i, the inverse of the above. */
static inline double closed_loop_beta(const double *p, const double *Q, const double *corner, const double *start,
                                      const double *s)
{
    const double q_x[3] = {Q[0], Q[3], Q[6]}, q_y[3] = {Q[1], Q[4], Q[7]};
    const double arm[3] = {s[0] - p[0], s[1] - p[1], s[2] - p[2]};
    const double x = closed_loop_dot(q_x, arm) - corner[0], y = closed_loop_dot(q_y, arm) - corner[1];
    return atan2(start[1] * x - start[0] * y, start[0] * x + start[1] * y);
}

/* theta += M^-1 (wanted - s); the largest change. */
static inline double closed_loop_step(const double *wanted, const double *s, const double *const column[3],
                                      double *theta)
{
    const double miss[3] = {wanted[0] - s[0], wanted[1] - s[1], wanted[2] - s[2]};
    double row[3][3], largest = 0.0;
    closed_loop_cross(column[1], column[2], row[0]);
    closed_loop_cross(column[2], column[0], row[1]);
    closed_loop_cross(column[0], column[1], row[2]);
    const double inverse = 1.0 / closed_loop_dot(column[0], row[0]);
    for (int k = 0; k < 3; ++k) {
        const double change = inverse * closed_loop_dot(row[k], miss);
        theta[k] += change;
        largest = fmax(largest, fabs(change));
    }
    return largest;
}

#endif
