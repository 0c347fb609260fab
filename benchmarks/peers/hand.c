/* Hand-written reference: one leg's kernel, called in a loop over three legs, as a careful engineer would write it.
   Geometry is constant. Not generated, and not one of the peers: it shows what a person reaches in an afternoon. */
#include <math.h>

#define S60 0.86602540378443865
#define L2 0.3
#define L3 0.45
#define R_P 0.125
#define L_R 0.05
#define CX (-0.2165063509461096622) /* c . e_x, c . e_1: the same for all legs; c . e_t = 0 */
#define CY 0.175

/* Azimuths 0, 120, 240 deg. e_r = (cr, sr, 0), e_t = (-sr, cr, 0); alpha = 120 deg. */
static const double CR[3] = {1.0, -0.5, -0.5};
static const double SR[3] = {0.0, S60, -S60};

/* Components along e_r, e_t, z of a leg to base coordinates. */
static inline void to_base(double cr, double sr, double r, double t, double z, double *restrict v) {
    v[0] = cr * r - sr * t;
    v[1] = sr * r + cr * t;
    v[2] = z;
}

void hand_w1(const double *restrict p, const double *restrict Q, const double *restrict theta,
             double *restrict J, double *restrict K) {
    for (int i = 0; i < 3; ++i) {
        const double cr = CR[i], sr = SR[i];
        const double c1 = cos(theta[3 * i]), s1 = sin(theta[3 * i]);
        const double c2 = cos(theta[3 * i + 1]), s2 = sin(theta[3 * i + 1]);
        const double t23 = theta[3 * i + 1] + theta[3 * i + 2];
        const double x3 = L3 * cos(t23), y3 = L3 * sin(t23);
        const double x = L2 * c2 + x3, y = L2 * s2 + y3;
        double *restrict j = J + 12 * i, *restrict k = K + 6 * i;
        double u[3], b[3], a[3], s[3];

        /* e_x = (-S60, 0, 0.5), e_1 = (0.5, 0, S60) in (e_r, e_t, z); x = c1 e_x - s1 e_t */
        to_base(cr, sr, 0.275 - S60 * c1 * x + 0.5 * y, -s1 * x, 0.05 * S60 + 0.5 * c1 * x + S60 * y, s);
        for (int m = 0; m < 3; ++m) {
            b[m] = R_P * (cr * Q[3 * m] + sr * Q[3 * m + 1]);
            u[m] = s[m] - p[m];
            a[m] = b[m] - u[m];
        }
        const double qx = Q[2], qy = Q[5], qz = Q[8];
        j[0] = a[0];
        j[1] = a[1];
        j[2] = a[2];
        j[3] = b[1] * a[2] - b[2] * a[1];
        j[4] = b[2] * a[0] - b[0] * a[2];
        j[5] = b[0] * a[1] - b[1] * a[0];
        j[6] = qx;
        j[7] = qy;
        j[8] = qz;
        j[9] = u[1] * qz - u[2] * qy;
        j[10] = u[2] * qx - u[0] * qz;
        j[11] = u[0] * qy - u[1] * qx;
        const double rows[2][3] = {{a[0], a[1], a[2]}, {qx, qy, qz}};
        for (int m = 0; m < 2; ++m) {
            const double r = cr * rows[m][0] + sr * rows[m][1], t = cr * rows[m][1] - sr * rows[m][0];
            const double z = rows[m][2], w = 0.5 * z - S60 * r;
            const double along_x = c1 * w - s1 * t, along_1 = 0.5 * r + S60 * z, along_2 = c1 * t + s1 * w;
            k[3 * m] = -x * along_2;
            k[3 * m + 1] = x * along_1 - y * along_x;
            k[3 * m + 2] = x3 * along_1 - y3 * along_x;
        }
    }
}

void hand_w2(const double *restrict p, const double *restrict Q, const double *restrict beta,
             double *restrict theta) {
    for (int i = 0; i < 3; ++i) {
        const double cr = CR[i], sr = SR[i];
        const double in_r = R_P - L_R * cos(beta[i]), in_t = L_R * sin(beta[i]);
        const double in_x = cr * in_r - sr * in_t, in_y = sr * in_r + cr * in_t;
        const double sx = p[0] + Q[0] * in_x + Q[1] * in_y;
        const double sy = p[1] + Q[3] * in_x + Q[4] * in_y;
        const double sz = p[2] + Q[6] * in_x + Q[7] * in_y;
        const double r = cr * sx + sr * sy, t = cr * sy - sr * sx;
        const double dx = 0.5 * sz - S60 * r - CX, y = 0.5 * r + S60 * sz - CY;
        const double square = dx * dx + t * t, reach = sqrt(square);
        const double c3 = (square + y * y - (L2 * L2 + L3 * L3)) * (1.0 / (2.0 * L2 * L3));
        const double s3 = sqrt(1.0 - c3 * c3);
        const double k1 = L2 + L3 * c3, k2 = L3 * s3;
        theta[3 * i] = atan2(-t, dx);
        theta[3 * i + 1] = atan2(y * k1 - reach * k2, reach * k1 + y * k2);
        theta[3 * i + 2] = acos(c3);
    }
}

void hand_w5(const double *restrict s, const double *restrict theta, double *restrict M) {
    const double l4 = 0.3, l2 = 0.15, ratio = 1.5, k = 1.0 - ratio;
    for (int i = 0; i < 3; ++i) {
        const double cr = CR[i], sr = SR[i];
        const double c1 = cos(theta[3 * i]), s1 = sin(theta[3 * i]);
        const double u1x = l4 * cos(theta[3 * i + 1]), u1y = l4 * sin(theta[3 * i + 1]);
        const double u2x = l2 * cos(theta[3 * i + 2]), u2y = l2 * sin(theta[3 * i + 2]);
        const double r = cr * s[3 * i] + sr * s[3 * i + 1], t = cr * s[3 * i + 1] - sr * s[3 * i];
        const double z = s[3 * i + 2];
        const double x = c1 * (0.5 * z - S60 * r - CX) - s1 * t, y = 0.5 * r + S60 * z - CY;
        const double v1x = x - u1x, v1y = y - u1y;
        const double v2x = u1x + k * v1x - u2x, v2y = u1y + k * v1y - u2y;
        const double inv = 1.0 / (k * (v1x * v2y - v1y * v2x));
        const double g22 = inv * k * (v1y * u1x - v1x * u1y);
        const double g32 = inv * ratio * (v2x * u1y - v2y * u1x);
        const double g33 = inv * (v2y * u2x - v2x * u2y);
        /* columns 2 and 3 in (x, e_1) */
        const double in_x[2] = {g22 * v2y - g32 * v1y, -g33 * v1y};
        const double in_1[2] = {g32 * v1x - g22 * v2x, g33 * v1x};
        double column[3][3];
        /* e_2 = c1 e_t + s1 e_x */
        to_base(cr, sr, x * S60 * s1, -x * c1, -0.5 * x * s1, column[0]);
        for (int m = 0; m < 2; ++m) {
            to_base(cr, sr, 0.5 * in_1[m] - S60 * c1 * in_x[m], -s1 * in_x[m],
                    S60 * in_1[m] + 0.5 * c1 * in_x[m], column[m + 1]);
        }
        for (int row = 0; row < 3; ++row) {
            for (int m = 0; m < 3; ++m) {
                M[9 * i + 3 * row + m] = column[m][row];
            }
        }
    }
}
