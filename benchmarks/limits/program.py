"""A program that calls the functions of one workload's library, for tools that count what it executes.

    program LIBRARY INPUTS WHAT...

WHAT is `SYMBOL:single:aos` or `SYMBOL:batch:LAYOUT`. Each function is called before it counts, so that models
are loaded and names resolved; what counts is called by `counted`, between the signals SIGUSR1 and SIGUSR2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.build import HARNESS_FLAGS, Tools, run
from benchmarks.layouts import LAYOUTS
from benchmarks.measure import Bench
from benchmarks.workloads import Workload

POSES = 8
"""How many calls count, one pose each; batches count whole."""
EMPTY = "nothing"
"""The harness' empty function: whatever its calls take is taken off."""

_SOURCE = """#include <dlfcn.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void (*single_t)(@POINTERS@);
typedef void (*batch_t)(long, @POINTERS@);

enum { POOL = @POOL@, POSES = @POSES@ };
static double @ARRAYS@;
@RESULTS@

static void ignore(int signal) { (void)signal; }

static inline __attribute__((always_inline)) void call(void *f, int batch, int layout, long poses) {
    if (batch) {
        ((batch_t)f)(POOL, @ALL@);
        return;
    }
    for (long i = 0; i < poses; ++i) {
        ((single_t)f)(@ONE@);
    }
}

static __attribute__((noinline, noclone)) void warm(void *f, int batch, int layout) {
    call(f, batch, layout, POOL);
}

static __attribute__((noinline, noclone)) void counted(void *f, int batch, int layout) {
    call(f, batch, layout, POSES);
}

int main(int argc, char **argv) {
    static const char *const layouts[] = {@LAYOUTS@};
    void *const library = dlopen(argv[1], RTLD_NOW);
    FILE *const file = fopen(argv[2], "rb");
    if (library == NULL || file == NULL) {
        fprintf(stderr, "%s\\n", library == NULL ? dlerror() : argv[2]);
        return 1;
    }
    if (@READ@) {
        fprintf(stderr, "%s is too short\\n", argv[2]);
        return 1;
    }
    signal(SIGUSR1, ignore);
    signal(SIGUSR2, ignore);
    for (int k = 3; k < argc; ++k) {
        const char *const symbol = strtok(argv[k], ":");
        const char *const mode = strtok(NULL, ":"), *const how = strtok(NULL, ":");
        void *const f = dlsym(library, symbol);
        int layout = 0;
        while (strcmp(layouts[layout], how) != 0) {
            ++layout;
        }
        if (f == NULL) {
            fprintf(stderr, "%s\\n", dlerror());
            return 1;
        }
        warm(f, mode[0] == 'b', layout);
        raise(SIGUSR1);
        counted(f, mode[0] == 'b', layout);
        raise(SIGUSR2);
    }
    return 0;
}
"""


@dataclass(frozen=True)
class Job:
    """A function of the library, called for single poses or for a batch."""

    symbol: str
    mode: str  # "throughput", the harness' word for single poses, or "batch"
    layout: str = "aos"

    def argument(self) -> str:
        """As the program takes it."""
        return f"{self.symbol}:{'batch' if self.mode == 'batch' else 'single'}:{self.layout}"


@dataclass(frozen=True)
class Program:
    """The compiled program, its library and its inputs."""

    path: Path
    library: Path
    inputs: Path
    pool: int

    def command(self, jobs: Sequence[Job]) -> list[str]:
        """To run it."""
        return [str(self.path), str(self.library), str(self.inputs), *(job.argument() for job in jobs)]

    def poses(self, job: Job) -> int:
        """How many poses are computed while it counts."""
        return self.pool if job.mode == "batch" else POSES


def build_program(workload: Workload, bench: Bench, library: Path, out: Path, tools: Tools) -> Program:
    """Writes source and inputs, compiles."""
    source, path, inputs = (out / f"counted_{workload.key}{ending}" for ending in (".c", "", ".bin"))
    source.write_text(_source(workload, bench.pool))
    with inputs.open("wb") as file:
        for layout in LAYOUTS:
            for packed in bench.packed[layout]:
                np.ascontiguousarray(packed).tofile(file)
    run([tools.cc, *HARNESS_FLAGS, str(source), "-o", str(path), "-ldl"])
    return Program(path, library, inputs, bench.pool)


def _source(workload: Workload, pool: int) -> str:
    inputs, outputs = workload.inputs, workload.outputs
    pointers = ["const double *"] * len(inputs) + ["double *"] * len(outputs)
    size = sum(pool * array.size for array in inputs)
    places: list[str] = []
    start = 0
    for array in inputs:
        places.append(f"given[layout] + {start}")
        start += pool * array.size
    names = [array.name for array in outputs]
    replacements = {
        "@POINTERS@": ", ".join(pointers),
        "@POOL@": str(pool),
        "@POSES@": str(POSES),
        "@ARRAYS@": f"given[{len(LAYOUTS)}][{size}]",
        "@RESULTS@": "\n".join(f"static double {a.name}[{pool * a.size}];" for a in outputs),
        "@ALL@": ", ".join([*places, *names]),
        "@ONE@": ", ".join([f"{at} + {a.size} * i" for at, a in zip(places, inputs, strict=True)] + names),
        "@LAYOUTS@": ", ".join(f'"{layout}"' for layout in LAYOUTS),
        "@READ@": "fread(given, sizeof given, 1, file) != 1",
    }
    text = _SOURCE
    for placeholder, value in replacements.items():
        text = text.replace(placeholder, value)
    return text
