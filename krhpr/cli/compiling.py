"""Compiling robots and the extension that makes NumPy functions of them, side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from functools import partial
from pathlib import Path

from krhpr.backend import compile_extension, compile_robot
from krhpr.cli.common import Step
from krhpr.native import find_compiler

JOBS = 2


def compile_all(identifiers: Sequence[str], step: Step) -> dict[str, Path]:
    """Compile the extension and every robot; returns the library of each robot.

    Raises NoCompiler where nothing can be compiled, CompilationError where the compiler refuses a robot.
    """
    find_compiler()
    libraries: dict[str, Path] = {}

    def compiled(identifier: str) -> None:
        step(f"compile {identifier}")
        libraries[identifier] = compile_robot(identifier)

    def extension() -> None:
        step("compile the NumPy extension")
        compile_extension()

    jobs: list[Callable[[], None]] = [extension]
    jobs += [partial(compiled, identifier) for identifier in identifiers]
    with ThreadPoolExecutor(JOBS) as pool:
        futures = [pool.submit(job) for job in jobs]
        try:
            wait(futures, return_when=FIRST_EXCEPTION)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
    for future in futures:
        if not future.cancelled():
            future.result()
    return {identifier: libraries[identifier] for identifier in identifiers}
