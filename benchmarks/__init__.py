"""Measured speed of generated kernels against peers: ``python -m benchmarks`` from the root."""
