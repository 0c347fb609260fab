/* Batch kernels as small as they can be, for the tests of krhpr.native. */
#include <math.h>
#include <stddef.h>
#include <time.h>

#define ARGUMENTS                                                                                                      \
    const void *geometry, size_t count, const double *const in[], const ptrdiff_t in_step[], double *const out[],     \
        const ptrdiff_t out_step[], int *status, ptrdiff_t status_step

typedef struct {
    double scale, offset[3];
} geometry_type;

/* y = scale A x + offset. Writes all of y before it has read all of x: wrong if NumPy ever lets them overlap. */
int matvec(ARGUMENTS);
int matvec(ARGUMENTS)
{
    const geometry_type *g = geometry;
    for (ptrdiff_t n = 0; n < (ptrdiff_t)count; ++n) {
        const double *x = in[0] + n * in_step[0], *A = in[1] + n * in_step[1];
        double *y = out[0] + n * out_step[0];
        for (int i = 0; i < 3; ++i) {
            y[i] = g->offset[i];
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                y[i] += g->scale * A[3 * i + j] * x[j];
            }
        }
        status[n * status_step] = 0;
    }
    return 0;
}

/* The square root; status 7 and NaN (with the processor's flag for an invalid operation) where there is none. */
int root(ARGUMENTS);
int root(ARGUMENTS)
{
    (void)geometry;
    int first = 0;
    for (ptrdiff_t n = 0; n < (ptrdiff_t)count; ++n) {
        const double *x = in[0] + n * in_step[0];
        double *y = out[0] + n * out_step[0];
        *y = 100.0; /* before x is read: an input at the same place would be lost */
        const int bad = *x < 0.0;
        *y = sqrt(*x);
        status[n * status_step] = bad ? 7 : 0;
        first = first ? first : status[n * status_step];
    }
    return first;
}

/* The transpose and the sum. */
int split(ARGUMENTS);
int split(ARGUMENTS)
{
    (void)geometry;
    for (ptrdiff_t n = 0; n < (ptrdiff_t)count; ++n) {
        const double *x = in[0] + n * in_step[0];
        double *transposed = out[0] + n * out_step[0], *sum = out[1] + n * out_step[1];
        *sum = 0.0;
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 3; ++j) {
                transposed[2 * j + i] = x[3 * i + j];
                *sum += x[3 * i + j];
            }
        }
        status[n * status_step] = (int)n;
    }
    return 0;
}

/* What the kernel is called with: the size of the batch, the steps of input and output. */
int calls(ARGUMENTS);
int calls(ARGUMENTS)
{
    (void)geometry, (void)in;
    for (ptrdiff_t n = 0; n < (ptrdiff_t)count; ++n) {
        double *y = out[0] + n * out_step[0];
        y[0] = (double)count;
        y[1] = (double)in_step[0];
        y[2] = (double)out_step[0];
        status[n * status_step] = (int)status_step;
    }
    return 0;
}

/* Waits until two calls are under way at the same time; status 1 if that does not happen within ten seconds. */
int meet(ARGUMENTS);
int meet(ARGUMENTS)
{
    static int waiting = 0;
    (void)geometry, (void)in, (void)in_step;
    const time_t end = time(NULL) + 10;
    __atomic_add_fetch(&waiting, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&waiting, __ATOMIC_SEQ_CST) < 2 && time(NULL) < end) {
    }
    const int failed = __atomic_load_n(&waiting, __ATOMIC_SEQ_CST) < 2;
    for (ptrdiff_t n = 0; n < (ptrdiff_t)count; ++n) {
        out[0][n * out_step[0]] = 0.0;
        status[n * status_step] = failed;
    }
    return failed;
}
