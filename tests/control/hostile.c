/* Steps of a generated controller with any numbers: finite torques within the limit, or NaN and a status.
 * MODE is the argument of the working mode and a comma, or nothing where there are none. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include HEADER

static uint64_t seed = 88172645463325252ULL;

static uint64_t next(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static double about(double x, double width)
{
    static const double special[] = {0.0, -0.0, 1e300, -1e300, 5e-324, INFINITY, -INFINITY, NAN};
    const uint64_t k = next();
    if (k % 40 == 0) {
        return special[(k >> 8) % 8];
    }
    return x + width * ((double)(next() >> 11) / 4503599627370496.0 - 1.0);
}

int main(void)
{
    ROBOT(geometry) g;
    krhpr_control_settings c = {KRHPR_CONTROL_POSITION, 0.002, 1.5e-4, 0.012, 5e3, 600.0, 0.004, 0.8, 30.0, 0.015, 0.004,
        0.05, 10.0, {0.045, -0.015, 0.015, 0.045}, {2.356, -2.356}, {0.03, 0.03}, {0.0, -0.3}, {1.0, 1.0}, 1.0};
    krhpr_control_state state;
    long answered = 0, refused = 0;
    double pivot[2] = {0.0, 0.09}, angles[2] = {0.785, 2.356}, home[4], theta[4], torques[4];

    if (ROBOT(default_geometry)(&g) != KRHPR_OK || ROBOT(inverse)(&g, pivot, angles, MODE home) != KRHPR_OK) {
        return 1;
    }
    krhpr_control_reset(&state);
    for (long k = 0; k < 6000; ++k) {
        const double goal[2] = {about(pivot[0], 0.01), about(pivot[1], 0.01)};
        const double turned[2] = {about(angles[0], 0.1), about(angles[1], 0.1)};
        for (int i = 0; i < 4; ++i) {
            theta[i] = about(home[i], 0.005);
        }
        c.scheme = (krhpr_control_scheme)(next() % 4);
        c.period = about(0.002, 0.0019);
        const int status =
            ROBOT(control_step)(&g, &c, &state, goal, turned, about(2.0, 2.0), theta, about(2.0, 3.0), torques);
        for (int i = 0; i < 4; ++i) {
            if (status == KRHPR_OK ? !(fabs(torques[i]) <= c.torque_limit) : torques[i] == torques[i]) {
                fprintf(stderr, "step %ld: status %d, torque %g\n", k, status, torques[i]);
                return 1;
            }
        }
        answered += status == KRHPR_OK;
        refused += status != KRHPR_OK;
    }
    printf("%ld %ld\n", answered, refused);
    return 0;
}
