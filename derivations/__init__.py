"""What is true of each robot: sub-legs, platform arrangements and their composition, as SymPy formulas."""
