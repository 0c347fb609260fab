/* What the C programs of the tests share: a robot's functions as a table, random numbers, configurations that close. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PORTS = 12 };

struct port {
    const char *name;
    int size;
    int per_leg;
    int optional;
};

struct function {
    const char *name;
    int n_in;
    const struct port *in;
    int n_out;
    const struct port *out;
    int (*call)(const geometry *g, const double *const in[], double *const out[]);
    int (*batch)(const geometry *g, size_t count, const double *const in[], const ptrdiff_t in_step[],
        double *const out[], const ptrdiff_t out_step[], int *status, ptrdiff_t status_step);
    int (*soa)(const geometry *g, size_t count, size_t block, const double *const in[], const ptrdiff_t in_step[],
        double *const out[], const ptrdiff_t out_step[], int *status);
};

/* xorshift64*: the same numbers everywhere */
static uint64_t random_state = 88172645463325252u;

static inline double uniform(double low, double high)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return low + (high - low) * ((double)((random_state * 2685821657736338717u) >> 11) / 9007199254740992.0);
}

static inline int chosen(int n)
{
    return (int)uniform(0.0, (double)n);
}

/* A configuration: what ports of these names are given. */
struct configuration {
    double p[3], Q[9], phi[1], redundant[3], mode[16], assembly[16], s[9], theta[32], theta_near[32];
    double swivel[3];
};

static inline const struct function *find(const struct function *all, size_t count, const char *name)
{
    for (size_t k = 0; k < count; ++k) {
        if (strcmp(all[k].name, name) == 0) {
            return &all[k];
        }
    }
    fprintf(stderr, "no function %s\n", name);
    exit(2);
}

static inline double *known(struct configuration *c, const char *name)
{
    static double positive = 1.0, sticky = 1e9, ones[3] = {1.0, 1.0, 1.0}, box[6] = {0.5, 2.6, 0.5, 2.6, 0.5, 2.6};
    static double zeros[3] = {0.0, 0.0, 0.0}, left[4] = {0.0, 0.0, 1.0, 0.0}, faces[2] = {3.0, 0.0};
    /* as two or three points in the plane, or three in space */
    static double apart[9] = {0.1, 0.0, -0.1, 0.0, 0.05, 0.1, -0.02, 0.1, 0.03};
    const struct { const char *name; double *value; } names[] = {
        {"p", c->p}, {"Q", c->Q}, {"phi", c->phi}, {"redundant", c->redundant}, {"mode", c->mode},
        {"assembly", c->assembly}, {"s", c->s}, {"theta", c->theta}, {"theta_near", c->theta_near},
        {"swivel", c->swivel}, {"s_near", c->s},
        {"turned", &positive}, {"side", &positive}, {"tolerance", &positive}, {"weights", ones},
        {"characteristic_length", &positive}, {"normal_forces", ones}, {"friction", &sticky},
        {"measured", c->redundant}, {"p_near", c->p}, {"Q_near", c->Q}, {"phi_near", c->phi}, {"box", box},
        /* of jaws that touch an object and do not press on it */
        {"pivot", c->p}, {"angles", c->redundant}, {"sensor", left}, {"faces", faces}, {"contacts", apart},
        {"measured_force", zeros}, {"weight", zeros},
    };
    for (size_t k = 0; k < sizeof names / sizeof names[0]; ++k) {
        if (strcmp(names[k].name, name) == 0) {
            return names[k].value;
        }
    }
    return NULL;
}

static inline void rotation(double Q[9])
{
    double q[4], n = 0.0;
    for (int k = 0; k < 4; ++k) {
        q[k] = k ? uniform(-0.4, 0.4) : 1.0;
        n += q[k] * q[k];
    }
    const double w = q[0], x = q[1], y = q[2], z = q[3], t = 2.0 / n;
    const double R[9] = {
        1.0 - t * (y * y + z * z), t * (x * y - z * w), t * (x * z + y * w),
        t * (x * y + z * w), 1.0 - t * (x * x + z * z), t * (y * z - x * w),
        t * (x * z - y * w), t * (y * z + x * w), 1.0 - t * (x * x + y * y),
    };
    memcpy(Q, R, sizeof R);
}

static inline int evaluate(const struct function *f, const geometry *g, struct configuration *c, double *out)
{
    const double *in[PORTS];
    for (int k = 0; k < f->n_in; ++k) {
        in[k] = known(c, f->in[k].name);
    }
    return f->call(g, in, &out);
}

/* A configuration in reach, found by trying; a few hundred are enough, so they are kept. */
static inline void configure(const struct function *all, size_t count, const geometry *g, struct configuration *c)
{
    enum { KEPT = 200 };
    static struct configuration kept[KEPT];
    static int ready = 0;
    if (ready == KEPT) {
        *c = kept[chosen(KEPT)];
        return;
    }
    const struct function *end_points = find(all, count, "end_points"), *inverse = find(all, count, "inverse");
    memset(c, 0, sizeof *c);
    for (int attempt = 0; attempt < 100000; ++attempt) {
        for (int k = 0; k < 3; ++k) {
            c->p[k] = uniform(-0.6, 0.6);
            c->redundant[k] = uniform(0.1, 2.2);
            c->swivel[k] = uniform(-1.0, 1.0);
        }
        rotation(c->Q);
        c->phi[0] = uniform(-0.6, 0.6);
        for (int k = 0; k < 16; ++k) {
            c->mode[k] = uniform(-1.0, 1.0) > 0.0 ? 1.0 : -1.0;
            c->assembly[k] = uniform(-1.0, 1.0) > 0.0 ? 1.0 : -1.0;
        }
        if (evaluate(end_points, g, c, c->s) == KRHPR_OK && evaluate(inverse, g, c, c->theta) == KRHPR_OK) {
            for (int k = 0; k < 32; ++k) {
                c->theta_near[k] = c->theta[k] + 0.1;
            }
            kept[ready++] = *c;
            return;
        }
    }
    fprintf(stderr, "no configuration in reach\n");
    exit(2);
}
