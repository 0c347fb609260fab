/* Executes a program one instruction at a time between its signals SIGUSR1 and SIGUSR2, and writes how often every
   instruction was executed: its bytes and a number on a line, an empty line behind every such region.

       tracer FILE PROGRAM ARGUMENT...

   The processor itself executes everything, so there is no instruction that this does not know. */
#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define PLACES (1u << 18) /* of a table of addresses, a power of two */
#define LONGEST 15        /* bytes of an instruction */

typedef struct {
    uint64_t address, times;
    unsigned char bytes[16];
} Place;

static Place table[PLACES];

static void fail(const char *what)
{
    fprintf(stderr, "tracer: %s: %s\n", what, strerror(errno));
    exit(1);
}

static void count(pid_t child)
{
    errno = 0;
    const long found = ptrace(PTRACE_PEEKUSER, child, (void *)offsetof(struct user_regs_struct, rip), NULL);
    if (errno != 0) {
        fail("reading the place");
    }
    const uint64_t address = (uint64_t)found;
    uint64_t at = address * UINT64_C(0x9e3779b97f4a7c15) >> 46;
    for (unsigned tries = 0; table[at].times != 0 && table[at].address != address; ++tries) {
        if (tries == PLACES) {
            errno = ENOMEM;
            fail("too many instructions");
        }
        at = (at + 1) % PLACES;
    }
    if (table[at].times == 0) {
        table[at].address = address;
        for (int k = 0; k < 2; ++k) { /* a page may end behind the instruction: what cannot be read stays zero */
            const long word = ptrace(PTRACE_PEEKTEXT, child, (void *)(address + 8 * (uint64_t)k), NULL);
            memcpy(table[at].bytes + 8 * k, &word, sizeof word);
        }
    }
    table[at].times += 1;
}

static void write_region(FILE *file)
{
    for (unsigned k = 0; k < PLACES; ++k) {
        if (table[k].times != 0) {
            for (int byte = 0; byte < LONGEST; ++byte) {
                fprintf(file, "%02x", table[k].bytes[byte]);
            }
            fprintf(file, " %" PRIu64 "\n", table[k].times);
        }
    }
    fprintf(file, "\n");
    memset(table, 0, sizeof table);
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        fprintf(stderr, "usage: tracer FILE PROGRAM ARGUMENT...\n");
        return 2;
    }
    FILE *const file = fopen(argv[1], "w");
    if (file == NULL) {
        fail(argv[1]);
    }
    const pid_t child = fork();
    if (child < 0) {
        fail("fork");
    }
    if (child == 0) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) {
            fail("ptrace");
        }
        execv(argv[2], argv + 2);
        fail(argv[2]);
    }
    int status, inside = 0;
    for (;;) {
        if (waitpid(child, &status, 0) < 0) {
            fail("waitpid");
        }
        if (!WIFSTOPPED(status)) {
            break;
        }
        long deliver = 0;
        switch (WSTOPSIG(status)) {
        case SIGUSR1:
            inside = 1;
            break;
        case SIGUSR2:
            inside = 0;
            write_region(file);
            break;
        case SIGTRAP:
            break;
        default:
            deliver = WSTOPSIG(status);
        }
        if (inside) {
            count(child);
        }
        if (ptrace(inside ? PTRACE_SINGLESTEP : PTRACE_CONT, child, NULL, (void *)deliver) != 0) {
            fail("going on");
        }
    }
    if (fclose(file) != 0) {
        fail(argv[1]);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
