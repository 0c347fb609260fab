/* Inverse kinematics of the 3-[R(RR-RRR)SR] robot as a filter: poses in, joint angles, status and J out.
 *
 * Uses nothing but generated/c.  Build it with CMake (see CMakeLists.txt beside this file), or at once:
 *
 *   cc -O2 -I generated/c examples/c/inverse.c generated/c/krhpr_spatial_r_fivebar_a.c -o inverse -lm
 *   echo "0 0 0.35   0 0 0.2   1.7 1.7 1.7" | ./inverse
 *
 * What a program of yours does is in `solve`: end points, joint angles, J and K, each with a status.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "krhpr_spatial_r_fivebar_a.h"

enum { SIGNS = 3, LEGS = 3, LONGEST_LINE = 1000, FEWEST = 9, MOST = 15 };

/* Exit statuses. */
enum { ALL_ANSWERED = 0, SOME_WITHOUT_ANSWER = 1, MALFORMED = 2 };

/* A rotation matrix whose Q^T Q differs from I by more than this is taken for a mistake. */
static const double ROTATION_TOLERANCE = 1e-6;

static const char HELP[] =
    "Usage: inverse [options] < poses\n"
    "\n"
    "Inverse kinematics of the 3-[R(RR-RRR)SR] robot with its default sizes.  Each line of standard input is a pose:\n"
    "\n"
    "  px py pz   rx ry rz          b1 b2 b3     9 numbers: the orientation as a rotation vector (axis times angle)\n"
    "  px py pz   Q11 Q12 ... Q33   b1 b2 b3    15 numbers: the orientation as a matrix, row by row\n"
    "\n"
    "with the position p of the platform (metres) and the redundant angles beta of the three legs (radians).  Numbers are\n"
    "separated by blanks, tabs or commas.  Empty lines, and what follows a #, are left out.\n"
    "\n"
    "For each pose: the status, the joint angles leg by leg, and J (rows as in J t = K theta_dot).\n"
    "\n"
    "  -d, --degrees      angles are in degrees, read and printed\n"
    "  -m, --mode SIGNS   working mode of all legs: signs of shoulder, elbow and rod, such as ++- (default +--)\n"
    "  -n, --no-jacobian  do not print J\n"
    "  -h, --help         print this text\n"
    "\n"
    "The exit status is 0 where every pose has an answer, 1 where one has none, 2 where input or options are malformed.\n";

typedef struct {
    double per_radian; /* one radian in the unit of angles */
    int jacobian;
    const double *mode; /* signs, leg by leg; NULL for the default */
} options;

static const char *status_text(int status)
{
    switch (status) {
    case KRHPR_OK:
        return "ok";
    case KRHPR_UNREACHABLE_LEG_1:
        return "out of reach of leg 1";
    case KRHPR_UNREACHABLE_LEG_2:
        return "out of reach of leg 2";
    case KRHPR_UNREACHABLE_LEG_3:
        return "out of reach of leg 3";
    case KRHPR_SINGULAR_LEG_1:
        return "leg 1 is singular";
    case KRHPR_SINGULAR_LEG_2:
        return "leg 2 is singular";
    case KRHPR_SINGULAR_LEG_3:
        return "leg 3 is singular";
    case KRHPR_SINGULAR_IN_PLANE:
    case KRHPR_SINGULAR_NORMAL:
        return "the platform is singular";
    case KRHPR_INVALID_INPUT:
        return "a number is infinite or NaN";
    default:
        return "no answer";
    }
}

/* Q of a rotation vector (Rodrigues' formula; the series where the angle is small). */
static void rotation(const double v[3], double Q[9])
{
    const double angle2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double angle = sqrt(angle2);
    const double a = angle > 1e-4 ? sin(angle) / angle : 1.0 - angle2 / 6.0;
    const double half = angle > 1e-4 ? sin(0.5 * angle) / (0.5 * angle) : 1.0 - angle2 / 24.0;
    const double b = 0.5 * half * half; /* (1 - cos angle) / angle^2 without cancellation */
    Q[0] = 1.0 - b * (v[1] * v[1] + v[2] * v[2]);
    Q[1] = b * v[0] * v[1] - a * v[2];
    Q[2] = b * v[0] * v[2] + a * v[1];
    Q[3] = b * v[0] * v[1] + a * v[2];
    Q[4] = 1.0 - b * (v[0] * v[0] + v[2] * v[2]);
    Q[5] = b * v[1] * v[2] - a * v[0];
    Q[6] = b * v[0] * v[2] - a * v[1];
    Q[7] = b * v[1] * v[2] + a * v[0];
    Q[8] = 1.0 - b * (v[0] * v[0] + v[1] * v[1]);
}

static void print_row(const char *label, const double *row, int n, double factor)
{
    printf("  %-8s", label);
    for (int k = 0; k < n; ++k) {
        printf(" %16.12f", factor * row[k]);
    }
    printf("\n");
}

/* One pose: what a program that uses krhpr does. */
static int solve(const krhpr_spatial_r_fivebar_a_geometry *g, const options *wanted, long line, const double p[3],
    const double Q[9], const double beta[3])
{
    double s[9], theta[9], J[36], K[54];
    char label[16];

    int status = krhpr_spatial_r_fivebar_a_inverse(g, p, Q, beta, wanted->mode, theta);
    printf("line %ld: %s\n", line, status_text(status));
    for (int leg = 0; leg < LEGS; ++leg) {
        snprintf(label, sizeof label, "theta %d", leg + 1);
        print_row(label, theta + 3 * leg, 3, wanted->per_radian);
    }
    if (status == KRHPR_OK && wanted->jacobian) {
        krhpr_spatial_r_fivebar_a_end_points(g, p, Q, beta, s);
        status = krhpr_spatial_r_fivebar_a_jacobians(g, p, Q, s, theta, J, K);
        if (status != KRHPR_OK) {
            printf("  no J: %s\n", status_text(status));
        }
        for (int row = 0; status == KRHPR_OK && row < 6; ++row) {
            snprintf(label, sizeof label, "J %d", row + 1);
            print_row(label, J + 6 * row, 6, 1.0);
        }
    }
    return status;
}

/* Reads the numbers of a line; their count, or -1 after a message. */
static int read_numbers(char *text, long line, double *numbers)
{
    int count = 0;
    text[strcspn(text, "#")] = '\0';
    for (char *word = strtok(text, " \t\r\n,"); word != NULL; word = strtok(NULL, " \t\r\n,")) {
        char *end;
        errno = 0;
        const double number = strtod(word, &end);
        if (end == word || *end != '\0') {
            fprintf(stderr, "inverse: line %ld: '%s' is not a number\n", line, word);
            return -1;
        }
        if (!isfinite(number) || (errno == ERANGE && fabs(number) > 1.0)) {
            fprintf(stderr, "inverse: line %ld: %s is not a finite number\n", line, word);
            return -1;
        }
        if (count == MOST) {
            fprintf(stderr, "inverse: line %ld: more than %d numbers\n", line, MOST);
            return -1;
        }
        numbers[count++] = number;
    }
    if (count != 0 && count != FEWEST && count != MOST) {
        fprintf(stderr, "inverse: line %ld: %d numbers; there should be %d (p, rotation vector, beta) or %d (p, Q, beta)\n",
            line, count, FEWEST, MOST);
        return -1;
    }
    return count;
}

/* Reads the orientation; 0 after a message where it is none. */
static int read_rotation(const krhpr_spatial_r_fivebar_a_geometry *g, const options *wanted, long line, int count,
    const double *numbers, double Q[9])
{
    double error;
    if (count == FEWEST) {
        const double v[3] = {
            numbers[3] / wanted->per_radian, numbers[4] / wanted->per_radian, numbers[5] / wanted->per_radian};
        rotation(v, Q);
        return 1;
    }
    memcpy(Q, numbers + 3, 9 * sizeof(double));
    krhpr_spatial_r_fivebar_a_rotation_error(g, Q, &error);
    if (!(error <= ROTATION_TOLERANCE)) {
        fprintf(stderr, "inverse: line %ld: Q is not a rotation matrix (Q^T Q differs from I by %.2g)\n", line, error);
        return 0;
    }
    return 1;
}

static int read_options(int argc, char **argv, options *wanted)
{
    static double mode[LEGS * SIGNS];
    for (int k = 1; k < argc; ++k) {
        if (strcmp(argv[k], "-h") == 0 || strcmp(argv[k], "--help") == 0) {
            fputs(HELP, stdout);
            exit(ALL_ANSWERED);
        } else if (strcmp(argv[k], "-d") == 0 || strcmp(argv[k], "--degrees") == 0) {
            wanted->per_radian = 57.295779513082323;
        } else if (strcmp(argv[k], "-n") == 0 || strcmp(argv[k], "--no-jacobian") == 0) {
            wanted->jacobian = 0;
        } else if (strcmp(argv[k], "-m") == 0 || strcmp(argv[k], "--mode") == 0) {
            const char *const signs = k + 1 < argc ? argv[++k] : "";
            if (strlen(signs) != SIGNS || strspn(signs, "+-") != SIGNS) {
                fprintf(stderr, "inverse: --mode takes %d signs, such as ++-, not '%s'\n", SIGNS, signs);
                return 0;
            }
            for (int j = 0; j < LEGS * SIGNS; ++j) {
                mode[j] = signs[j % SIGNS] == '+' ? 1.0 : -1.0;
            }
            wanted->mode = mode;
        } else {
            fprintf(stderr, "inverse: unknown option '%s'; --help tells what there is\n", argv[k]);
            return 0;
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    static krhpr_spatial_r_fivebar_a_geometry g;
    options wanted = {1.0, 1, NULL};
    char text[LONGEST_LINE + 2];
    double numbers[MOST], Q[9], beta[3];
    int result = ALL_ANSWERED;

    if (!read_options(argc, argv, &wanted)) {
        return MALFORMED;
    }
    if (krhpr_spatial_r_fivebar_a_default_geometry(&g) != KRHPR_OK) {
        fprintf(stderr, "inverse: the geometry is not valid\n");
        return MALFORMED;
    }
    for (long line = 1; fgets(text, sizeof text, stdin) != NULL; ++line) {
        if (strlen(text) > LONGEST_LINE) {
            fprintf(stderr, "inverse: line %ld: longer than %d characters\n", line, LONGEST_LINE);
            return MALFORMED;
        }
        const int count = read_numbers(text, line, numbers);
        if (count == 0) {
            continue;
        }
        if (count < 0 || !read_rotation(&g, &wanted, line, count, numbers, Q)) {
            return MALFORMED;
        }
        for (int leg = 0; leg < LEGS; ++leg) {
            beta[leg] = numbers[count - LEGS + leg] / wanted.per_radian;
        }
        if (solve(&g, &wanted, line, numbers, Q, beta) != KRHPR_OK) {
            result = SOME_WITHOUT_ANSWER;
        }
    }
    if (ferror(stdin)) {
        perror("inverse: standard input");
        return MALFORMED;
    }
    if (fflush(stdout) != 0) {
        perror("inverse: standard output");
        return MALFORMED;
    }
    return result;
}
