"""First steps with a robot: position, working modes, velocity, singularities, passive joints.

    python examples/first_steps.py

Needs NumPy.  Where there is a C compiler the functions run on compiled kernels (the first call compiles
them), else on NumPy; the numbers are the same to rounding.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np

import krhpr


def tilt(angle: np.ndarray) -> np.ndarray:
    """Q for a tilt about y', (1.46)."""
    Q = np.zeros((*np.shape(angle), 3, 3))
    Q[..., 0, 0], Q[..., 0, 2] = np.cos(angle), np.sin(angle)
    Q[..., 2, 0], Q[..., 2, 2] = -np.sin(angle), np.cos(angle)
    Q[..., 1, 1] = 1.0
    return Q


def main() -> None:
    robot = krhpr.load("spatial_r_fivebar_a")
    print(f"1. A robot of {len(krhpr.catalogue())}: {robot.identifier}, {robot.notation}, {robot.title}")
    print(f"   its functions run on the {robot.backend} backend")
    print(f"   crank u_1 is l_4 = {robot.geometry.l_4[0]} m, redundant link l_r = {robot.geometry.l_r[0]} m")

    # 10,000 poses at once: the platform tilts about y' from 0 to 80 degrees
    Q = tilt(np.linspace(0.0, np.radians(80.0), 10_000))
    p = np.array([0.0, 0.0, 0.35])
    beta = np.radians([97.0, 97.0, 97.0])
    robot.inverse(p, Q[:1], beta)  # the first call compiles
    begin = perf_counter()
    theta = robot.inverse(p, Q, beta)
    milliseconds = 1e3 * (perf_counter() - begin)
    print(
        f"\n2. Inverse kinematics of {len(Q):,} poses in {milliseconds:.1f} ms: theta has shape {theta.shape}"
    )
    print(
        f"   leg 1 at the first pose: {np.degrees(theta[0, 0]).round(3)} degrees, in the default working mode"
    )
    print(f"   ({robot.default_mode}: the upper crank outside, the linkage a parallelogram)")

    every = robot.inverse_all(p, Q[0], beta)
    print(f"\n3. All {len(robot.modes)} working modes of leg 1 at the first pose, in degrees:")
    for label, angles in zip(robot.modes, every[0], strict=True):
        print(f"   {label:20}" + "".join(f"{angle:10.3f}" for angle in np.degrees(angles)))

    s = robot.end_points(p, Q, beta)
    J, K = robot.jacobians(p, Q, s, theta)
    print(f"\n4. J {J.shape} and K {K.shape} of J t = K theta_dot at every pose, (1.30)")

    twist = np.array([0.05, -0.02, 0.1, 0.3, -0.2, 0.1])
    rates = robot.joint_rates(p, Q, s, theta, twist)
    back = robot.twist(p, Q, s, theta, rates)
    print("\n5. From a twist to joint rates and back")
    print(f"   largest joint rate: {np.abs(rates).max():.3f} rad/s")
    print(f"   largest error of the twist: {np.abs(back - twist).max():.1e}")
    residual = np.einsum("kij,j->ki", J, twist) - np.einsum("kij,kj->ki", K, rates.reshape(-1, 9))
    print(f"   largest |J t - K theta_dot|: {np.abs(residual).max():.1e}")

    found = robot.singularity(p, Q, s, theta)
    print("\n6. Distance to singularities along the path (margins are positive inside the working box)")
    for column, (name, text) in enumerate(robot.documentation["singular factors"]):
        print(f"   leg, {name:8} |factor| >= {np.abs(found.factors[..., column]).min():.3f}   ({text})")
    print(f"   platform, det J_a and det J_n: margins >= {found.margins.min(axis=0).round(3)}")

    passive = robot.passive_joints(p, Q, s, theta)
    print("\n7. Passive joints of leg 1 at the first pose")
    for (name, text), angle in zip(robot.documentation["passive"], passive.passive[0, 0], strict=True):
        print(f"   {name:8} {np.degrees(angle):8.3f} degrees   ({text})")
    print(f"   beta     {np.degrees(passive.platform_joint[0, 0]):8.3f} degrees")

    far = np.array([0.0, 0.0, 0.75])
    theta, status = robot.inverse(far, Q[0], beta, status=True)
    print(f"\n8. A pose out of reach gives NaN ({theta[0]}) and a status ({krhpr.Status(status).name});")
    try:
        robot.inverse(far, Q[0], beta, check=True)
    except krhpr.Unreachable as error:
        print(f"   with check=True it raises Unreachable: leg {error.leg} misses by {error.distance:.3f} m")


if __name__ == "__main__":
    main()
