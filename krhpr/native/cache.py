"""Where compiled libraries are kept between runs.

A library's file name holds the key of what it was made from and a digest of its own bytes, so that a damaged
file is known before the loader maps it, and a file, once there, never changes: any number of processes can
look up, store and load at the same time.
"""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path

SUFFIX = ".so"
_DIGITS = 32  # of a key and of a digest: 128 bits

_temporary: Path | None = None
_temporary_lock = threading.Lock()


def cache_folder() -> Path:
    """The folder of compiled libraries, existing or not: $KRHPR_CACHE, else krhpr in the user's cache."""
    if chosen := os.environ.get("KRHPR_CACHE"):
        return Path(chosen).expanduser().absolute()
    base = os.environ.get("XDG_CACHE_HOME", "")
    # Relative paths there are to be ignored, says the XDG base directory specification.
    return (Path(base) if os.path.isabs(base) else Path("~/.cache").expanduser()) / "krhpr"


def digest(content: bytes) -> str:
    """What keys and file names are made of."""
    return hashlib.sha256(content).hexdigest()[:_DIGITS]


def find(name: str, key: str) -> Path | None:
    """The stored library, or None. Files whose content is not what was stored are removed on the way."""
    for folder in _folders():
        prefix = f"{name}-{key}-"
        try:
            entries = sorted(e for e in os.listdir(folder) if e.startswith(prefix) and e.endswith(SUFFIX))
        except OSError:
            continue
        for entry in entries:
            path = folder / entry
            with contextlib.suppress(OSError):
                if digest(path.read_bytes()) == entry[len(prefix) : -len(SUFFIX)]:
                    return path
                path.unlink()
    return None


@contextlib.contextmanager
def workshop(key: str) -> Iterator[Path]:
    """An empty folder to build in, from which `store` moves the result in one step.

    Who comes second with the same key waits, in this process or another, and does well to look again with
    `find`. Where the cache cannot be written, this is a temporary folder that goes with the process, and a
    warning says so.
    """
    try:
        folder = cache_folder()
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        _refuse_shared(folder)
        scratch = tempfile.mkdtemp(prefix="building-", dir=folder)
    except (OSError, RuntimeError) as error:  # RuntimeError: no home folder
        folder = _temporary_folder(error)
        scratch = tempfile.mkdtemp(prefix="building-", dir=folder)
    try:
        with _locked(folder / f"{key}.lock"):
            yield Path(scratch)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def store(built: Path, name: str, key: str) -> Path:
    """Move a library from a workshop into the cache; returns its place."""
    place = built.parent.parent / f"{name}-{key}-{digest(built.read_bytes())}{SUFFIX}"
    os.replace(built, place)
    return place


def _folders() -> list[Path]:
    folders = [] if _temporary is None else [_temporary]
    with contextlib.suppress(OSError, RuntimeError):
        folder = cache_folder()
        _refuse_shared(folder)
        folders.insert(0, folder)
    return folders


def _refuse_shared(folder: Path) -> None:
    """Code is loaded from the cache: nobody else may put any there."""
    if os.name == "posix" and folder.stat().st_mode & stat.S_IWOTH:
        raise PermissionError(f"every user may write to {folder}")


def _temporary_folder(reason: Exception) -> Path:
    """The folder that stands in for the cache in this process; made, with a warning, when first asked for."""
    global _temporary
    with _temporary_lock:
        if _temporary is None or not _temporary.is_dir():
            warnings.warn(
                f"compiled kernels cannot be kept: {reason}. They are compiled again in every process; "
                "set KRHPR_CACHE to a folder of your own that can be written",
                RuntimeWarning,
                stacklevel=2,
            )
            _temporary = Path(tempfile.mkdtemp(prefix="krhpr-"))
            atexit.register(_remove, _temporary, os.getpid())
        return _temporary


def _remove(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not in a fork of it
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold a lock among threads and processes, where the system has one; it saves double work, no more."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(ImportError, OSError):
            import fcntl

            file = stack.enter_context(open(path, "w"))
            fcntl.flock(file, fcntl.LOCK_EX)  # goes with the open file
            # Removed while held: who waits on it gets it in turn, who comes later makes a new one; both look
            # again.
            stack.callback(_unlink, path)
        yield


def _unlink(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.unlink()
