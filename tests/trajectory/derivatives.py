"""Derivatives of a programme against central differences of its values and slopes."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from krhpr.trajectory.transcription import Programme

STEP = 1e-6


def check_derivatives(programme: Programme, x: Any, p: Any, source: np.random.Generator) -> None:
    """Gradient, Jacobian and Hessian along a random direction, the Hessian with random multipliers."""
    nlp, given = programme._nlp, programme._options[False]
    assert nlp["x"].numel() == len(x)
    plain = ca.Function("plain", [nlp["x"], nlp["p"]], [nlp["f"], nlp["g"]])
    direction = source.normal(size=len(x))

    def slope(of: Any) -> np.ndarray:
        ahead, behind = (of(x + sign * STEP * direction) for sign in (1, -1))
        return np.asarray((ahead - behind).full().ravel() / (2 * STEP))

    gradient = given["grad_f"](x, p)[1].full().ravel()
    np.testing.assert_allclose(gradient @ direction, slope(lambda at: plain(at, p)[0])[0], rtol=1e-6)
    jacobian = given["jac_g"](x, p)[1]
    slopes = slope(lambda at: plain(at, p)[1])
    np.testing.assert_allclose(
        (jacobian @ direction).full().ravel(), slopes, atol=1e-6 * np.abs(slopes).max()
    )
    multipliers = source.normal(size=jacobian.size1())
    upper = given["hess_lag"](x, p, 0.7, multipliers)
    hessian = upper + ca.triu(upper, False).T
    bends = slope(lambda at: 0.7 * given["grad_f"](at, p)[1] + given["jac_g"](at, p)[1].T @ multipliers)
    np.testing.assert_allclose((hessian @ direction).full().ravel(), bends, atol=1e-5 * np.abs(bends).max())
