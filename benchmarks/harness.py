"""The measuring loops in C, for the prototype of one workload.

* ``throughput`` calls over the pool; nothing links one call to the next, so the processor overlaps them.
* ``latency`` makes the address of the next input depend on every word of the previous output, by a zero that
  the compiler does not know: each call waits for all of the one before, as in a control loop, and no value
  changes. (Adding a zero to the inputs would do the same, at the price of a copy.)
* ``batch`` calls the batch function on the whole pool.
* ``evaluate`` keeps all outputs, to compare them.

Times are of the thread's processor clock.
"""

from __future__ import annotations

from benchmarks.workloads import Workload

CLOCK = """static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}
"""
"""Nanoseconds of the thread's processor clock, in C."""

_TEMPLATE = """#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

typedef void (*single_t)(@POINTERS@);
typedef void (*batch_t)(long, @POINTERS@);

@CLOCK@
static inline uint64_t bits_of(const double *x) {
    uint64_t bits;
    memcpy(&bits, x, sizeof bits);
    return bits;
}

void nothing(@PARAMETERS@);
__attribute__((noinline)) void nothing(@PARAMETERS@) { __asm__ volatile("" ::@USES@ : "memory"); }

void evaluate(single_t f, long n, @PARAMETERS@) {
    for (long i = 0; i < n; ++i) {
        f(@AT_I_OUT@);
    }
}

double throughput(single_t f, long calls, long pool, @PARAMETERS@) {
    const double start = now_ns();
    long i = 0;
    for (long call = 0; call < calls; ++call) {
        f(@AT_I@);
        i = i + 1 == pool ? 0 : i + 1;
    }
    return (now_ns() - start) / (double)calls;
}

double latency(single_t f, long calls, long pool, @PARAMETERS@) {
    static volatile uint64_t zero_source = 0;
    const uint64_t zero = zero_source;
    const double start = now_ns();
    long next = 0, i = 0;
    for (long call = 0; call < calls; ++call) {
        f(@AT_I@);
        uint64_t chain[4] = {0, 0, 0, 0};
@CHAINS@
        next = next + 1 == pool ? 0 : next + 1;
        i = next + (long)((chain[0] | chain[1] | chain[2] | chain[3]) & zero);
    }
    return (now_ns() - start) / (double)calls;
}

double batch(batch_t f, long calls, long pool, @PARAMETERS@) {
    const double start = now_ns();
    for (long call = 0; call < calls; ++call) {
        f(pool, @NAMES@);
    }
    return (now_ns() - start) / ((double)calls * (double)pool);
}
"""


def harness_source(workload: Workload) -> str:
    """C source of the loops."""
    arrays = (*workload.inputs, *workload.outputs)
    parameters = [f"const double *{a.name}" for a in workload.inputs]
    parameters += [f"double *{a.name}" for a in workload.outputs]
    chains = "\n".join(
        f'        _Pragma("GCC unroll 64") for (int k = 0; k < {a.size}; ++k) '
        f"chain[k & 3] |= bits_of({a.name} + k);"
        for a in workload.outputs
    )
    in_i = [f"{a.name} + {a.size} * i" for a in workload.inputs]
    replacements = {
        "@POINTERS@": ", ".join(p.rsplit("*", 1)[0] + "*" for p in parameters),
        "@PARAMETERS@": ", ".join(parameters),
        "@USES@": ", ".join(f'"r"({a.name})' for a in arrays),
        "@AT_I_OUT@": ", ".join([*in_i, *(f"{a.name} + {a.size} * i" for a in workload.outputs)]),
        "@AT_I@": ", ".join([*in_i, *(a.name for a in workload.outputs)]),
        "@NAMES@": ", ".join(a.name for a in arrays),
        "@CHAINS@": chains,
        "@CLOCK@": CLOCK,
    }
    source = _TEMPLATE
    for placeholder, text in replacements.items():
        source = source.replace(placeholder, text)
    return source
