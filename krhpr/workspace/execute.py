"""Making maps: here, in processes of this machine, or on a cluster; the results are the same."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any

from krhpr.errors import WorkspaceError
from krhpr.workspace.maps import Arrays, Job, Workspace
from krhpr.workspace.store import Store, missing

Progress = Callable[[int, int], None]
"""Called with the chunks that are there and those that there will be."""

MEMORY = 2_000_000_000
"""Bytes of a map that is kept in memory; larger ones need a store."""
AHEAD = 4
"""Chunks for each worker that are handed out before their results are taken."""
WAIT = "10s"
"""How long a scheduler may take to answer."""
RETRIES = 5
"""How often a chunk is tried again after a worker has died."""


def run(
    job: Job,
    *,
    store: str | Path | None = None,
    workers: int | str = 1,
    progress: Progress | None = None,
) -> Workspace:
    """Make a map.

    Args:
        job: what is to be made.
        store: where it is kept (a zarr group); an interrupted run goes on there.  In memory unless given.
        workers: how many processes of this machine share the work, or the address of a Dask scheduler; this
            process alone unless given.
        progress: called after each chunk.

    Returns:
        The map; it does not depend on where it was made.

    Raises:
        WorkspaceError: a job that cannot be made, a store of something else, or a scheduler that does not
            answer.
    """
    job.check()
    if store is None and job.size > MEMORY:
        raise WorkspaceError(
            f"the map takes {job.size / 1e9:.1f} GB, more than the {MEMORY / 1e9:g} GB that are kept in "
            "memory; give a store"
        )
    kept = Store(Path(store), job) if store is not None else None
    arrays = None if kept is not None else job.empty()
    left = list(missing(kept, job))
    there = job.chunks - len(left)
    report = progress or (lambda done, of: None)
    report(there, job.chunks)
    with _made(job, left, workers) as results:
        for number, made in results:
            if kept is not None:
                kept.put(number, made)
            elif arrays is not None:
                for name, array in made.items():
                    arrays[name][job.part(number)] = array
            there += 1
            report(there, job.chunks)
    return kept.workspace() if kept is not None else Workspace(job, arrays or {})


@contextmanager
def _made(job: Job, left: list[int], workers: int | str) -> Iterator[Iterable[tuple[int, Arrays]]]:
    if workers == 1 or not left:
        yield ((number, job.make(number)) for number in left)
        return
    with connected(workers) as client:
        yield _by_workers(client, job, left)


def _distributed() -> Any:
    try:
        return import_module("distributed")
    except ImportError as lacking:
        raise WorkspaceError("clusters need Dask: pip install 'krhpr[workspace]'") from lacking


@contextmanager
def connected(workers: int | str) -> Iterator[Any]:
    """A Dask client: of the scheduler at an address, or of so many processes of this machine.

    Raises:
        WorkspaceError: no scheduler answers, or Dask is not there.
    """
    dask = _distributed()
    if isinstance(workers, int):
        if workers < 1:
            raise WorkspaceError(f"{workers} processes; expected 1 or more")
        with (
            dask.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as local,
            dask.Client(local) as client,
        ):
            yield client
        return
    try:
        client = dask.Client(workers, timeout=WAIT)
    except (OSError, ValueError) as problem:
        raise WorkspaceError(
            f"no Dask scheduler answers at {workers!r} ({problem}); start one with `dask scheduler`, and "
            "workers with `dask worker ADDRESS`, or leave the address out"
        ) from problem
    with client:
        yield client


@lru_cache(maxsize=4)
def _job(pickled: bytes) -> Job:
    """A job that came to a worker, with what it has prepared."""
    found: Job = pickle.loads(pickled)
    return found


def _make(pickled: bytes, number: int) -> Arrays:
    return _job(pickled).make(number)


def _by_workers(client: Any, job: Job, left: list[int]) -> Iterator[tuple[int, Arrays]]:
    """Chunks in the order in which workers finish them; few are under way, so that memory stays bounded."""
    # with every chunk, for what lies on one worker is lost with it
    pickled, waiting = pickle.dumps(job), iter(left)

    def submit(count: int) -> list[Any]:
        return [
            client.submit(
                _make, pickled, number, key=f"{job.fingerprint}-{number}", retries=RETRIES, pure=False
            )
            for number in islice(waiting, count)
        ]

    workers = max(1, len(client.scheduler_info()["workers"]))
    under_way = _distributed().as_completed(submit(AHEAD * workers), with_results=True)
    for future, made in under_way:
        number = int(future.key.rpartition("-")[2])
        yield number, made
        future.release()
        for other in submit(1):
            under_way.add(other)
