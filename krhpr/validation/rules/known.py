"""Parts and robots of which something is known apart from the derivation, and can be compared with it."""

FIRST_PRINCIPLES = ("subleg_rrr", "subleg_r_fivebar", "subleg_planar_rr")
"""Sub-legs whose closure is written a second time from rotations of vectors, and of which exact rational
configurations can be built.
"""

THESIS_VELOCITY = (*FIRST_PRINCIPLES, "subleg_prr", "subleg_p_fivebar", "subleg_rrrr", "subleg_cpr3")
"""Sub-legs whose matrices the thesis prints; they are copied."""

THESIS_ROWS = (
    "platform_spatial_a",
    "platform_spatial_b",
    "platform_spatial_c",
    "platform_planar_a",
    "platform_planar_b",
    "platform_planar_c",
)
"""Arrangements whose J is written as the thesis prints it."""

WITHOUT_REFERENCE = ("subleg_prr_parallel", "subleg_planar_prr2", "subleg_planar_rpr2")
"""Sub-legs without reference configurations."""
