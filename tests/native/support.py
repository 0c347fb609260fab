"""What the tests of compiled kernels share."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).with_name("kernels.c")

SCALE, OFFSET = 1.5, (1.0, -2.0, 0.25)
GEOMETRY = struct.pack("4d", SCALE, *OFFSET)

# name: signature, inputs, outputs without the status
KERNELS = {
    "matvec": ("(3),(3,3)->(3),()", 2, 1),
    "root": ("()->(),()", 1, 1),
    "split": ("(2,3)->(3,2),(),()", 1, 2),
    "calls": ("(2)->(3),()", 1, 1),
    "meet": ("(1)->(1),()", 1, 1),
}


def run_python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run code in a Python of its own that finds the same packages."""
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
