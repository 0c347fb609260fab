/* Calls every function of a robot with sane and with hostile inputs and checks what the headers promise.
 * Compiled with sanitizers; arguments: the number of samples for each function, then the outputs (function.output) that may
 * be infinite or NaN with status OK. */
#include "table.h"

#include <float.h>

enum { FUNCTIONS = sizeof functions / sizeof functions[0], MANY = 19 /* two vectors of eight, and three left over */, LINE = 8 };

static int failures;
static char **unbounded;
static int unbounded_count;

#define CHECK(condition, ...)                                                                                          \
    do {                                                                                                               \
        if (!(condition) && ++failures <= 20) {                                                                        \
            fprintf(stderr, "%s: ", f->name);                                                                          \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fprintf(stderr, "\n");                                                                                     \
        }                                                                                                              \
    } while (0)

/* Buffers of exactly the stated size, so that one element too far is caught. */
struct buffers {
    double *in[PORTS], *out[PORTS], *again[PORTS];
};

static double *block(int size)
{
    double *const found = malloc((size_t)size * sizeof(double));
    if (found == NULL) {
        exit(2);
    }
    return found;
}

static void fill(double *x, int size, double value)
{
    for (int k = 0; k < size; ++k) {
        x[k] = value;
    }
}

static int all_nan(const double *x, int size)
{
    int nan = 1;
    for (int k = 0; k < size; ++k) {
        nan &= isnan(x[k]) != 0;
    }
    return nan;
}

static int any_nan(const double *x, int size)
{
    int nan = 0;
    for (int k = 0; k < size; ++k) {
        nan |= isnan(x[k]) != 0;
    }
    return nan;
}

static int same(const double *x, const double *y, int size)
{
    for (int k = 0; k < size; ++k) {
        if (memcmp(&x[k], &y[k], sizeof(double)) != 0 && !(isnan(x[k]) && isnan(y[k]))) {
            return 0;
        }
    }
    return 1;
}

/* Whether a batch gives what the function gives: bit by bit, or, where TOLERANCE is defined, up to so much of the largest
 * number, or of 1 where all are smaller (residuals vanish but for rounding).  Compilers then contract multiplications and additions in their own ways, and hostile inputs, where all digits
 * may cancel, are left out. */
#ifdef TOLERANCE
enum { EXACT = 0 };
#else
#define TOLERANCE 0.0
enum { EXACT = 1 };
#endif

static int alike(const double *x, const double *y, int size)
{
    double largest = 1.0;
    for (int k = 0; k < size; ++k) {
        largest = fmax(largest, fabs(x[k]));
    }
    for (int k = 0; k < size; ++k) {
        if (EXACT ? !same(&x[k], &y[k], 1) : isnan(x[k]) != isnan(y[k]) || fabs(x[k] - y[k]) > TOLERANCE * largest) {
            return 0;
        }
    }
    return 1;
}

/* Whether an output was named on the command line. */
static int is_unbounded(const struct function *f, const struct port *port)
{
    const size_t length = strlen(f->name);
    for (int k = 0; k < unbounded_count; ++k) {
        if (strncmp(unbounded[k], f->name, length) == 0 && unbounded[k][length] == '.'
            && strcmp(unbounded[k] + length + 1, port->name) == 0) {
            return 1;
        }
    }
    return 0;
}

/* Inputs below this overflow nowhere; beyond, an answer may be infinite, or NaN, as IEEE arithmetic has it. */
#define LARGEST_INPUT 1e30

static int check(const struct function *f, const geometry *g, struct buffers *b, const double *const in[])
{
    int finite = 1;
    double largest = 0.0;
    for (int k = 0; k < f->n_in; ++k) {
        for (int j = 0; in[k] != NULL && j < f->in[k].size; ++j) {
            finite &= isfinite(in[k][j]) != 0;
            largest = fmax(largest, fabs(in[k][j]));
        }
    }
    /* twice, over different rubbish: what differs was not written */
    for (int k = 0; k < f->n_out; ++k) {
        fill(b->out[k], f->out[k].size, 12345.678);
        fill(b->again[k], f->out[k].size, -0.75);
    }
    const int status = f->call(g, in, b->out);
    const int second = f->call(g, in, b->again);
    CHECK(status == second, "status %d, then %d", status, second);
    CHECK(status >= 0 && status <= LAST_STATUS, "status %d is none of the enumeration", status);
    CHECK((status == KRHPR_INVALID_INPUT) == !finite, "status %d for %sfinite input", status, finite ? "" : "in");
    int nan = 0;
    for (int k = 0; k < f->n_out; ++k) {
        const struct port *const port = &f->out[k];
        CHECK(same(b->out[k], b->again[k], port->size), "%s is not written whole", port->name);
        if (status == KRHPR_INVALID_INPUT) {
            CHECK(all_nan(b->out[k], port->size), "%s is not NaN for an invalid input", port->name);
        }
        nan |= any_nan(b->out[k], port->size);
        const int excess = strcmp(port->name, "excess") == 0;
        if (status >= KRHPR_UNREACHABLE_LEG_1 && status <= KRHPR_SINGULAR_LEG_3 && port->per_leg && !excess) {
            const int leg = (status - KRHPR_UNREACHABLE_LEG_1) % 3, size = port->size / LEGS;
            CHECK(all_nan(b->out[k] + leg * size, size), "%s of leg %d is not NaN", port->name, leg + 1);
        }
        if (status == KRHPR_OK && largest < LARGEST_INPUT && !is_unbounded(f, port)) {
            for (int j = 0; j < port->size; ++j) {
                CHECK(isfinite(b->out[k][j]), "%s[%d] = %g with status OK, inputs below %g", port->name, j,
                    b->out[k][j], largest);
            }
        }
    }
    if (status != KRHPR_OK && strcmp(f->name, "inverse_status") != 0) {
        CHECK(nan, "status %d without a NaN", status);
    }
    return status;
}

static const double hostile[] = {
    0.0, -0.0, DBL_TRUE_MIN, -DBL_TRUE_MIN, 1e-310, DBL_MIN, -DBL_MIN, DBL_EPSILON, 1e-160, -1e-160, 1.0, -1.0,
    1e16, -1e16, 1e5, 99999.999, 1.5707963267948966, 3.141592653589793, -3.141592653589793, 6.283185307179586,
    1e75, -1e75, 1e150, -1e155, 1e300, -1e300, DBL_MAX, -DBL_MAX, INFINITY, -INFINITY, NAN, -NAN,
};
enum { HOSTILE = sizeof hostile / sizeof hostile[0], NOT_FINITE = 4 };

static void sane(const struct function *f, const geometry *g, struct buffers *b)
{
    struct configuration c;
    configure(functions, FUNCTIONS, g, &c);
    for (int k = 0; k < f->n_in; ++k) {
        const double *const value = known(&c, f->in[k].name);
        for (int j = 0; j < f->in[k].size; ++j) {
            b->in[k][j] = value ? value[j] : uniform(-1.0, 1.0);
        }
    }
}

static void scalar_calls(const struct function *f, const geometry *g, struct buffers *b, long samples)
{
    const double *in[PORTS] = {0};
    for (int k = 0; k < f->n_in; ++k) {
        in[k] = b->in[k];
    }
    for (long sample = 0; sample < samples; ++sample) {
        const long kind = sample % 8;
        sane(f, g, b);
        const double scale = pow(10.0, uniform(-3.0, 3.0)), odds = uniform(0.0, 1.0);
        for (int k = 0; k < f->n_in; ++k) {
            for (int j = 0; j < f->in[k].size; ++j) {
                double *const x = &b->in[k][j];
                if (kind == 1) {
                    *x = scale * uniform(-1.0, 1.0);
                } else if (kind == 2 && uniform(0.0, 1.0) < odds) {
                    *x = hostile[chosen(HOSTILE - NOT_FINITE)];
                } else if (kind == 3 && uniform(0.0, 1.0) < 0.3 * odds) {
                    *x = hostile[chosen(HOSTILE)];
                } else if (kind == 4 && strcmp(f->in[k].name, "p") == 0) {
                    *x *= 10.0; /* out of reach */
                } else if (kind == 5 && uniform(0.0, 1.0) < 0.2) {
                    *x = 0.0; /* often singular */
                } else if (kind == 6) {
                    *x *= scale; /* no rotation, no unit signs */
                } else if (kind == 7 && sample < 8 * HOSTILE) {
                    *x = hostile[sample / 8]; /* all alike */
                }
            }
        }
        for (int k = 0; k < f->n_in; ++k) {
            in[k] = f->in[k].optional && chosen(4) == 0 ? NULL : b->in[k];
        }
        const int status = check(f, g, b, in);
        if (kind == 0) {
            /* joints may belong to another assembly mode, and redundant angles to another box */
            const int choice = strncmp(f->name, "subleg_forward", 14) == 0 || strcmp(f->name, "forward") == 0 ||
                               strcmp(f->name, "passive_joints_of_theta") == 0;
            const int expected = status == KRHPR_OK || choice;
            CHECK(expected || in[f->n_in - 1] == NULL, "status %d where it works", status);
        }
    }
    /* one value that is no number, in every place */
    sane(f, g, b);
    for (int k = 0; k < f->n_in; ++k) {
        in[k] = b->in[k];
    }
    for (int k = 0; k < f->n_in; ++k) {
        for (int j = 0; j < f->in[k].size; ++j) {
            const double before = b->in[k][j];
            for (int bad = HOSTILE - NOT_FINITE; bad < HOSTILE; ++bad) {
                b->in[k][j] = hostile[bad];
                check(f, g, b, in);
            }
            b->in[k][j] = before;
        }
    }
}

/* Iterations that one of two twins ended in its last step, and the other just not: where results need not be the same bit by
 * bit, rounding decides.  None or one was seen in all functions of a robot; more than MOST of them are a failure. */
static int undecided;
#define MOST 2

static int is_undecided(int expected, int no_status, int status, int first, const double *own, const double *twin)
{
    if (no_status) { /* what there is, or is not, in one of them only */
        const int same_kind = isnan(own[0]) == isnan(twin[0]);
        status = same_kind ? expected : !isnan(twin[0]) ? KRHPR_OK : first;
    }
    const int either = expected == KRHPR_NO_CONVERGENCE || status == KRHPR_NO_CONVERGENCE;
    const int other = expected == KRHPR_OK || status == KRHPR_OK;
    undecided += !EXACT && either && other;
    return !EXACT && either && other;
}

/* The batch twin against the function itself: steps that are tight, wide, zero and negative; NULL where it is allowed. */
static void batch_calls(const struct function *f, const geometry *g, struct buffers *b, long samples)
{
    for (long sample = 0; sample < samples; ++sample) {
        double *in_block[PORTS], *out_room[PORTS], *out_block[PORTS];
        const double *in[PORTS], *expected_in[PORTS];
        double *out[PORTS];
        ptrdiff_t in_step[PORTS], out_step[PORTS];
        const int before = chosen(LINE); /* where in a line of the cache outputs begin */
        const int back = chosen(2), wide = chosen(2), no_status = chosen(2);
        int status_block[2 * MANY], wild[MANY] = {0};
        for (int k = 0; k < f->n_in; ++k) {
            const int size = f->in[k].size, still = chosen(3) == 0;
            const int step = still ? 0 : size + 2 * wide, blocks = still ? 1 : MANY;
            const int length = size + (blocks - 1) * step;
            in_block[k] = block(length);
            fill(in_block[k], length, NAN);
            in_step[k] = back ? -step : step;
            in[k] = in_block[k] + (back ? (blocks - 1) * step : 0);
        }
        for (int n = 0; n < MANY; ++n) {
            sane(f, g, b);
            if (chosen(3) == 0) {
                const int k = chosen(f->n_in);
                b->in[k][chosen(f->in[k].size)] = hostile[chosen(HOSTILE)];
                for (int m = 0; m < MANY; ++m) {
                    wild[m] |= m == n || in_step[k] == 0; /* one element for all */
                }
            }
            for (int k = 0; k < f->n_in; ++k) {
                memcpy((double *)(uintptr_t)(in[k] + n * in_step[k]), b->in[k], (size_t)f->in[k].size * sizeof(double));
            }
        }
        for (int k = 0; k < f->n_out; ++k) {
            const int size = f->out[k].size, step = size + 3 * wide, length = size + (MANY - 1) * step;
            out_room[k] = block(before + length);
            fill(out_room[k], before + length, -0.75);
            out_block[k] = out_room[k] + before;
            out_step[k] = back ? -step : step;
            out[k] = out_block[k] + (back ? (MANY - 1) * step : 0);
        }
        const int drop = chosen(2);
        for (int k = 0; k < f->n_in; ++k) {
            in[k] = f->in[k].optional && drop ? NULL : in[k];
        }
        const ptrdiff_t status_step = back ? -1 : 1 + wide;
        int *const status = status_block + (back ? 2 * MANY - 1 : 0);
        memset(status_block, 0x55, sizeof status_block);
        const int first = f->batch(g, MANY, in, in_step, out, out_step, no_status ? NULL : status, status_step);
        int expected_first = KRHPR_OK, all_tame = 1;
        for (int n = 0; n < MANY; ++n) {
            for (int k = 0; k < f->n_in; ++k) {
                expected_in[k] = in[k] ? in[k] + n * in_step[k] : NULL;
            }
            const int expected = f->call(g, expected_in, b->out);
            expected_first = expected_first == KRHPR_OK ? expected : expected_first;
            all_tame &= !wild[n];
            if (!EXACT && wild[n]) {
                continue;
            }
            if (is_undecided(expected, no_status, status[n * status_step], first, b->out[0], out[0] + n * out_step[0])) {
                all_tame = 0;
                continue;
            }
            CHECK(no_status || status[n * status_step] == expected, "batch: status %d, not %d", status[n * status_step], expected);
            for (int k = 0; k < f->n_out; ++k) {
                CHECK(alike(b->out[k], out[k] + n * out_step[k], f->out[k].size), "batch: %s differs", f->out[k].name);
            }
        }
        CHECK(first == expected_first || !(EXACT || all_tame), "batch: returns %d, not %d", first, expected_first);
        for (int k = 0; k < f->n_out; ++k) {
            for (int j = 0; j < before; ++j) {
                CHECK(out_room[k][j] == -0.75, "batch: writes before %s", f->out[k].name);
            }
        }
        for (int k = 0; k < f->n_out && wide; ++k) {
            const double *const gap = out_block[k] + f->out[k].size;
            CHECK(gap[0] == -0.75 && gap[1] == -0.75 && gap[2] == -0.75, "batch: writes between elements of %s", f->out[k].name);
        }
        for (int k = 0; k < f->n_in; ++k) {
            free(in_block[k]);
        }
        for (int k = 0; k < f->n_out; ++k) {
            free(out_room[k]);
        }
    }
    /* no elements: nothing is read or written */
    const double *none_in[PORTS] = {0};
    double *none_out[PORTS] = {0};
    const ptrdiff_t steps[PORTS] = {0};
    CHECK(f->batch(g, 0, none_in, steps, none_out, steps, NULL, 0) == KRHPR_OK, "batch: an empty batch is not OK");
}

/* The same for structures of arrays: blocks of any length, the last one not full, the same block for all, NULL. */
static void soa_calls(const struct function *f, const geometry *g, struct buffers *b, long samples)
{
    static const int lengths[] = {0, 1, 2, 4, 5, 8, 16};
    for (long sample = 0; sample < samples; ++sample) {
        const int count = chosen(MANY + 1), block_length = lengths[chosen(7)], no_status = chosen(2), drop = chosen(2);
        const int row = block_length ? block_length : count ? count : 1, blocks = (count + row - 1) / row;
        double *in_block[PORTS], *out_block[PORTS];
        const double *in[PORTS], *expected_in[PORTS];
        ptrdiff_t in_step[PORTS], out_step[PORTS];
        int status[MANY + 1], wild[MANY] = {0}, all_tame = 1;
        for (int k = 0; k < f->n_in; ++k) {
            const int size = f->in[k].size * row, still = chosen(3) == 0;
            in_step[k] = still ? 0 : size + 2;
            in_block[k] = block(size + (still ? 0 : blocks * (size + 2)));
            in[k] = f->in[k].optional && drop ? NULL : in_block[k];
        }
        for (int n = 0; n < count; ++n) {
            sane(f, g, b);
            if (chosen(3) == 0) {
                const int k = chosen(f->n_in);
                b->in[k][chosen(f->in[k].size)] = hostile[chosen(HOSTILE)];
                for (int m = 0; m < MANY; ++m) {
                    wild[m] |= m == n || in_step[k] == 0;
                }
            }
            for (int k = 0; k < f->n_in; ++k) {
                for (int j = 0; j < f->in[k].size; ++j) {
                    in_block[k][n / row * in_step[k] + j * row + n % row] = b->in[k][j];
                }
            }
        }
        for (int k = 0; k < f->n_out; ++k) {
            const int size = f->out[k].size * row, length = size + blocks * (size + 3);
            out_step[k] = size + 3;
            out_block[k] = block(length);
            fill(out_block[k], length, -0.75);
        }
        memset(status, 0x55, sizeof status);
        const int last = status[MANY];
        const int first = f->soa(g, (size_t)count, (size_t)block_length, in, in_step, out_block, out_step,
            no_status ? NULL : status);
        int expected_first = KRHPR_OK;
        for (int n = 0; n < count; ++n) {
            for (int k = 0; k < f->n_in; ++k) {
                for (int j = 0; j < f->in[k].size; ++j) {
                    b->in[k][j] = in_block[k][n / row * in_step[k] + j * row + n % row];
                }
                expected_in[k] = in[k] ? b->in[k] : NULL;
            }
            const int expected = f->call(g, expected_in, b->out);
            expected_first = expected_first == KRHPR_OK ? expected : expected_first;
            const double *const result = out_block[0] + n / row * out_step[0] + n % row;
            const int tame = !wild[n] && !is_undecided(expected, no_status, status[n], first, b->out[0], result);
            const int compared = EXACT || tame;
            all_tame &= tame;
            CHECK(no_status || status[n] == expected || !compared, "soa: status %d, not %d", status[n], expected);
            for (int k = 0; k < f->n_out; ++k) {
                double *const place = out_block[k] + n / row * out_step[k] + n % row;
                for (int j = 0; j < f->out[k].size; ++j) {
                    b->again[k][j] = place[j * row];
                    place[j * row] = -0.75;
                }
                CHECK(alike(b->out[k], b->again[k], f->out[k].size) || !compared, "soa: %s differs", f->out[k].name);
            }
        }
        CHECK(first == expected_first || !(EXACT || all_tame), "soa: returns %d, not %d", first, expected_first);
        CHECK(status[MANY] == last, "soa: writes behind the statuses");
        for (int k = 0; k < f->n_out; ++k) {
            const int size = f->out[k].size * row, length = size + blocks * (size + 3);
            int untouched = 1;
            for (int j = 0; j < length; ++j) {
                untouched &= out_block[k][j] == -0.75;
            }
            CHECK(untouched, "soa: writes beside the poses of %s", f->out[k].name);
            free(out_block[k]);
        }
        for (int k = 0; k < f->n_in; ++k) {
            free(in_block[k]);
        }
    }
}

int main(int argc, char **argv)
{
    const long samples = argc > 1 ? strtol(argv[1], NULL, 10) : 1000;
    unbounded = argv + 2;
    unbounded_count = argc > 2 ? argc - 2 : 0;
    static geometry g;
    if (DEFAULT_GEOMETRY(&g) != KRHPR_OK) {
        return 2;
    }
    for (int n = 0; n < FUNCTIONS; ++n) {
        const struct function *const f = &functions[n];
        struct buffers b;
        for (int k = 0; k < f->n_in; ++k) {
            b.in[k] = block(f->in[k].size);
        }
        for (int k = 0; k < f->n_out; ++k) {
            b.out[k] = block(f->out[k].size);
            b.again[k] = block(f->out[k].size);
        }
        scalar_calls(f, &g, &b, samples);
        batch_calls(f, &g, &b, samples / 60 + 10);
        soa_calls(f, &g, &b, samples / 60 + 10);
        for (int k = 0; k < f->n_in; ++k) {
            free(b.in[k]);
        }
        for (int k = 0; k < f->n_out; ++k) {
            free(b.out[k]);
            free(b.again[k]);
        }
    }
    if (undecided > MOST) {
        fprintf(stderr, "%d iterations end in one twin only\n", undecided);
        ++failures;
    }
    if (failures) {
        fprintf(stderr, "%d failures\n", failures);
    }
    return failures != 0;
}
