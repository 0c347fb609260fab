"""Numbers that several tests draw."""

from __future__ import annotations

from hypothesis import strategies as st

rationals = st.fractions(min_value=-1000, max_value=1000, max_denominator=1000)
floats = st.floats(min_value=-1e6, max_value=1e6, allow_nan=False)
