"""Parts and robots of which something is known apart from the derivation, and can be compared with it."""

FIRST_PRINCIPLES = ("subleg_rrr", "subleg_r_fivebar", "subleg_planar_rr")
"""Sub-legs whose closure is written a second time from rotations of vectors, and whose thesis matrices
are copied.
"""

THESIS_ROWS = ("platform_spatial_a", "platform_spatial_c", "platform_planar_a")
"""Arrangements whose J is written as the thesis prints it."""

WITH_REFERENCE = ("spatial_rrr_a", "spatial_r_fivebar_a", "spatial_rrr_c", "planar_rr_a")
"""Robots with reference configurations."""
