/* The functions of krhpr_elementary.h over arrays, for test_elementary.py. */
#include "krhpr_elementary.h"

enum { BLOCK = 64 };

void sine_cosine(int n, const double *x, double *sine, double *cosine);
void arctangent(int n, const double *y, const double *x, double *angle);
void sine_cosine_blocks(int n, const double *x, double *sine, double *cosine);
void arctangent_blocks(int n, const double *y, const double *x, double *angle);
void one_of_both(int n, const double *x, double *sine, double *cosine);
void one_of_both_blocks(int n, const double *x, double *sine, double *cosine);
int lanes(void);
int leaves_angles_to_libm(void);

void sine_cosine(int n, const double *x, double *sine, double *cosine)
{
    for (int k = 0; k < n; ++k) {
        krhpr_sincos(x[k], &sine[k], &cosine[k]);
    }
}

void arctangent(int n, const double *y, const double *x, double *angle)
{
    for (int k = 0; k < n; ++k) {
        angle[k] = krhpr_atan2(y[k], x[k]);
    }
}

/* n is a multiple of BLOCK */
void sine_cosine_blocks(int n, const double *x, double *sine, double *cosine)
{
    for (int k = 0; k < n; k += BLOCK) {
        krhpr_sincos_array(BLOCK, x + k, sine + k, cosine + k);
    }
}

void arctangent_blocks(int n, const double *y, const double *x, double *angle)
{
    for (int k = 0; k < n; k += BLOCK) {
        krhpr_atan2_array(BLOCK, y + k, x + k, angle + k);
    }
}

void one_of_both(int n, const double *x, double *sine, double *cosine)
{
    for (int k = 0; k < n; ++k) {
        sine[k] = krhpr_sin(x[k]);
        cosine[k] = krhpr_cos(x[k]);
    }
}

void one_of_both_blocks(int n, const double *x, double *sine, double *cosine)
{
    for (int k = 0; k < n; k += KRHPR_LANES) {
        krhpr_store(sine + k, krhpr_lanes_sin(krhpr_load(x + k)));
        krhpr_store(cosine + k, krhpr_lanes_cos(krhpr_load(x + k)));
    }
}

int lanes(void)
{
    return KRHPR_LANES;
}

int leaves_angles_to_libm(void)
{
#ifdef KRHPR_LIBM
    return 1;
#else
    return 0;
#endif
}
