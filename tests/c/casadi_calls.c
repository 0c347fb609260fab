/* Calls every function of a CasADi shim as CasADi does, with exactly the room that it asks for; run under sanitizers.
 * Functions and their Jacobians: all arguments and results, null pointers in their place, NaN and infinities. */
#include SHIM

#include <stdio.h>
#include <stdlib.h>

struct entry {
    const char *name;
    int (*call)(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem);
    casadi_int (*n_in)(void);
    casadi_int (*n_out)(void);
    const casadi_int *(*sparsity_in)(casadi_int i);
    const casadi_int *(*sparsity_out)(casadi_int i);
    int (*work)(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w);
};

#define ENTRY(f) {#f, f, f##_n_in, f##_n_out, f##_sparsity_in, f##_sparsity_out, f##_work}
static const struct entry entries[] = {
#include "entries.h"
};

static unsigned long long state = 88172645463325252u;

static double uniform(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 4503599627370496.0 - 1.0;
}

static casadi_int elements(const casadi_int *pattern)
{
    return pattern[2] == 1 ? pattern[0] * pattern[1] : pattern[2 + pattern[1]];
}

static double *room(casadi_int n)
{
    double *const found = malloc((size_t)(n ? n : 1) * sizeof(double));
    if (found == NULL) {
        exit(2);
    }
    return n ? found : (free(found), malloc(1));
}

static int try(const struct entry *e, int round)
{
    casadi_int sz_arg, sz_res, sz_iw, sz_w;
    int failures = e->work(&sz_arg, &sz_res, &sz_iw, &sz_w) != 0;
    const casadi_int n_in = e->n_in(), n_out = e->n_out();
    failures += sz_arg < n_in || sz_res < n_out;
    const double **arg = calloc((size_t)sz_arg, sizeof *arg);
    double **res = calloc((size_t)sz_res, sizeof *res);
    double *const w = room(sz_w);
    for (casadi_int i = 0; i < n_in; ++i) {
        double *const x = room(elements(e->sparsity_in(i)));
        for (casadi_int k = 0; k < elements(e->sparsity_in(i)); ++k) {
            x[k] = round == 3 ? NAN : round == 4 ? 1e300 * uniform() : round == 5 ? INFINITY : uniform();
        }
        arg[i] = x;
    }
    for (casadi_int o = 0; o < n_out; ++o) {
        const casadi_int n = elements(e->sparsity_out(o));
        res[o] = room(n);
        for (casadi_int k = 0; k < n; ++k) {
            res[o][k] = 12345.678;
        }
    }
    const double **given = calloc((size_t)sz_arg, sizeof *given);
    double **wanted = calloc((size_t)sz_res, sizeof *wanted);
    for (casadi_int i = 0; i < n_in; ++i) {
        given[i] = round == 1 || (round == 2 && i % 2) ? NULL : arg[i];
    }
    for (casadi_int o = 0; o < n_out; ++o) {
        wanted[o] = round == 2 && o % 2 ? NULL : res[o];
    }
    failures += e->call(given, wanted, NULL, w, 0) != 0;
    for (casadi_int o = 0; o < n_out; ++o) {
        for (casadi_int k = 0; k < elements(e->sparsity_out(o)); ++k) {
            failures += (res[o][k] == 12345.678) != (wanted[o] == NULL); /* all written, or none */
            failures += round == 3 && !isnan(res[o][k]);
        }
        free(res[o]);
    }
    for (casadi_int i = 0; i < n_in; ++i) {
        free((void *)(size_t)arg[i]);
    }
    free(arg);
    free(res);
    free(given);
    free(wanted);
    free(w);
    if (failures) {
        fprintf(stderr, "%s: %d failures in round %d\n", e->name, failures, round);
    }
    return failures;
}

int main(void)
{
    int failures = 0;
    for (size_t n = 0; n < sizeof entries / sizeof entries[0]; ++n) {
        for (int round = 0; round < 6; ++round) {
            failures += try(&entries[n], round);
        }
        failures += entries[n].sparsity_in(-1) != NULL || entries[n].sparsity_out(entries[n].n_out()) != NULL;
    }
    return failures != 0;
}
