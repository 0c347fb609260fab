"""Write requirements/*.txt from requirements/*.in: exact versions with hashes, for every Python and platform.

    python tools/lock.py VENV [--upgrade]

The resolver is itself installed from a lock, into an environment of its own.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import environment

REQUIREMENTS = Path(__file__).resolve().parent.parent / "requirements"

# In this order: each takes its versions from those before it, so that one lock never contradicts another.
LOCKS = ("lock", "generate", "test", "bench")


def main() -> None:
    folder, *options = sys.argv[1:]
    environment.check_python()
    python = environment.interpreter(folder)
    environment.install(python, str(REQUIREMENTS / "lock.txt"), project=False)
    for name in LOCKS:
        print(f"Resolving requirements/{name}.in", flush=True)
        command = [python, "-m", "uv", "pip", "compile", "--quiet", "--no-config"]
        command += [f"{name}.in", "-o", f"{name}.txt"]
        # One version for all Pythons from 3.11 on: what is generated must not depend on who generates it.
        command += ["--universal", "--python-version", "3.11", "--fork-strategy", "fewest"]
        command += ["--generate-hashes", "--no-emit-index-url", "--no-emit-find-links"]
        command += ["--default-index", "https://pypi.org/simple", "--custom-compile-command", "make lock"]
        subprocess.run([*command, *options], cwd=REQUIREMENTS, check=True)


if __name__ == "__main__":
    main()
