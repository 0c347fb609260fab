"""krhpr: kinematics and statics of kinematically redundant (hybrid) parallel robots.

    import krhpr

    robot = krhpr.load("spatial_rrr_a")
    theta = robot.inverse(p, Q, beta)

Using the generated functions needs NumPy alone; deriving and printing them needs the extra `generate`.
"""

__version__ = "0.1.0"
