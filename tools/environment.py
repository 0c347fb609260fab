"""Make a virtual environment and install a lock and this project into it.

    python tools/environment.py VENV LOCK

It reads on any Python from 3.6 on, so that an old one is turned away with a sentence and not a traceback.
"""

import os
import subprocess
import sys

OLDEST = (3, 11)


def stop(*lines):
    """Say why nothing more can be done, and end."""
    print("\nkrhpr: " + "\n       ".join(lines) + "\n", file=sys.stderr)
    raise SystemExit(1)


def check_python():
    """Stop unless this Python can make the environment."""
    found = ".".join(map(str, sys.version_info[:3]))
    if sys.version_info < OLDEST:
        stop(
            "Python %d.%d or newer is needed; %s is %s." % (*OLDEST, sys.executable, found),
            "Name another one: make PYTHON=python3.12 ...",
        )
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError as missing:
        stop(
            "%s (%s) cannot make virtual environments: %s." % (sys.executable, found, missing),
            "On Debian and Ubuntu: apt install python3-venv (or python%d.%d-venv)" % sys.version_info[:2],
        )


def interpreter(folder):
    """The environment's Python, after making the environment where it is missing or its Python is gone."""
    python = os.path.abspath(os.path.join(folder, "bin", "python"))
    probe = "import sys, pip; raise SystemExit(sys.version_info < %r)" % (OLDEST,)

    def works():
        if not os.path.exists(python):
            return False
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.run([python, "-c", probe], check=False, **quiet).returncode == 0

    if not works():
        print("Making %s with %s" % (folder, sys.executable), flush=True)
        # A link to a Python that is gone stays in the way unless all is made anew.
        anew = ["--clear"] if os.path.islink(python) and not os.path.exists(python) else []
        subprocess.run([sys.executable, "-m", "venv", "--prompt", "krhpr", *anew, folder], check=False)
    if not works():
        stop(
            "%s has no usable Python of %d.%d or newer with pip in it." % (folder, *OLDEST),
            "Remove it and try again.",
        )
    return python


def install(python, lock, project=True):
    """Install the lock, then the project itself (if asked) so that its sources are used where they lie."""
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input"]
    print("Installing %s (the first time takes a minute or two)" % lock, flush=True)
    if subprocess.run([*pip, "--require-hashes", "-r", lock], check=False).returncode:
        stop(
            "pip could not install %s; its own message stands above." % lock,
            "Without a package index nothing can be installed: check the connection, or pip's settings.",
        )
    # Setuptools is in every lock: nothing is fetched to build this.
    editable = ["--no-deps", "--no-build-isolation", "--editable", "."]
    if project and subprocess.run([*pip, *editable], check=False).returncode:
        stop("pip could not install this project; its own message stands above.")


def main():
    folder, lock = sys.argv[1:]
    check_python()
    os.environ.setdefault("PIP_DEFAULT_TIMEOUT", "60")
    install(interpreter(folder), lock)


if __name__ == "__main__":
    main()
