"""Proof by running: the printed texts (C, NumPy, CasADi) are evaluated in exact arithmetic and compared."""
