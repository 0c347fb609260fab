"""Control of the grasping force, Section 5.5: a planar grasping robot with an object between its jaws as a
simulated plant, the three control schemes on the generated functions, and both in a closed loop.

    parameters     what the plant and the controllers are made of, with units; `parameter_file` reads it
    plant          motion of the robot and the object, as Lagrange's equations in CasADi
    controller     one step of schemes i, ii and iii in Python; `compiled_controller` runs the generated C
    simulation     the closed loop: a library's integrator between the controller's steps
    closed_forms   what comes out where nothing moves: the stiffness of (5.72) and the band of friction
"""
