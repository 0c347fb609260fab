/* Every function of a robot from several threads at once: the results are those of one thread, bit by bit. */
#include "table.h"

#include <pthread.h>

enum { FUNCTIONS = sizeof functions / sizeof functions[0], THREADS = 4, CASES = 50, ROOM = 192 };

static geometry shared;

/* Inputs of one case, and where one thread writes its answers. */
struct input {
    double value[PORTS][ROOM];
};
struct answer {
    double value[FUNCTIONS][CASES][PORTS][ROOM];
    int status[FUNCTIONS][CASES];
};

static struct input (*inputs)[CASES];

static void *work(void *place)
{
    struct answer *const answer = place;
    for (int n = 0; n < FUNCTIONS; ++n) {
        for (int k = 0; k < CASES; ++k) {
            const double *in[PORTS];
            double *out[PORTS];
            for (int j = 0; j < functions[n].n_in; ++j) {
                in[j] = functions[n].in[j].optional && k % 2 ? NULL : inputs[n][k].value[j];
            }
            for (int j = 0; j < functions[n].n_out; ++j) {
                out[j] = answer->value[n][k][j];
            }
            answer->status[n][k] = functions[n].call(&shared, in, out);
        }
    }
    return NULL;
}

int main(void)
{
    struct answer *const answers = calloc(THREADS + 1, sizeof *answers);
    inputs = calloc(FUNCTIONS, sizeof *inputs);
    if (answers == NULL || inputs == NULL || DEFAULT_GEOMETRY(&shared) != KRHPR_OK) {
        return 2;
    }
    for (int n = 0; n < FUNCTIONS; ++n) {
        for (int j = 0; j < functions[n].n_out; ++j) {
            if (functions[n].out[j].size > ROOM) {
                return 2;
            }
        }
        for (int k = 0; k < CASES; ++k) {
            struct configuration c;
            configure(functions, FUNCTIONS, &shared, &c);
            for (int j = 0; j < functions[n].n_in; ++j) {
                const double *const value = known(&c, functions[n].in[j].name);
                for (int i = 0; i < functions[n].in[j].size; ++i) {
                    inputs[n][k].value[j][i] = value ? value[i] : uniform(-1.0, 1.0);
                }
            }
        }
    }
    work(&answers[THREADS]);
    pthread_t threads[THREADS];
    for (int k = 0; k < THREADS; ++k) {
        if (pthread_create(&threads[k], NULL, work, &answers[k]) != 0) {
            return 2;
        }
    }
    int different = 0;
    for (int k = 0; k < THREADS; ++k) {
        pthread_join(threads[k], NULL);
        different += memcmp(&answers[k], &answers[THREADS], sizeof *answers) != 0;
    }
    printf("%d threads of %d differ\n", different, THREADS);
    free(answers);
    free(inputs);
    return different != 0;
}
