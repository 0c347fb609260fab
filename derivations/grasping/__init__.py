"""Planar grasping robots (Figs. 5.1 and 5.2): two sub-legs with two actuators each, and two jaws on a pivot.

Legs 1 and 2 of the thesis meet in P and are the right sub-leg here, its legs 3 and 4 meet in S and are the
left one.  The platform is two jaws, the links PB and SB, that share the pivot B.
"""
