"""What a sub-leg states whose assembly modes are the real roots of a polynomial."""

from __future__ import annotations

from dataclasses import dataclass

from krhpr.codegen.kernel import Kernel, Port


@dataclass(frozen=True)
class ForwardRoots:
    """Kernels of one leg: `polynomial` from the joints to coefficients, `at_root` from a root to the end
    point.

    The only output of `polynomial` has the coefficients, the constant one first. `at_root` reads a root (port
    `root`) and its last output, `miss`, says whether it is a solution (`derivations/roots.py`); what its
    other outputs give is collected in the function's `outputs`, sorted by the one called `order`.
    """

    polynomial: Kernel
    at_root: Kernel
    degree: int
    order: str
    outputs: tuple[Port, ...]
    equations: str
    doc: str
