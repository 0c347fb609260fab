"""Stores and clusters: what is interrupted goes on, and results are the same wherever they are made."""

from __future__ import annotations

import json
import os
import shutil
import signal
from collections import namedtuple
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import krhpr
from krhpr import workspace as W
from krhpr.errors import WorkspaceError
from krhpr.workspace import execute, maps

xarray = pytest.importorskip("xarray")
pytest.importorskip("zarr")

BETA = np.radians(97.0)


def job(**changes: Any) -> W.Job:
    """A grid in several chunks."""
    robot = krhpr.load("spatial_rrr_a")
    family = W.Layers()
    axes = family.axes(np.linspace(0.2, 0.5, 7), W.directions(12), W.steps(0.0, 0.6, 0.03))
    return replace(
        W.GridMap(robot, W.section_1_7(robot), W.constant(BETA), family, axes, chunk=300), **changes
    )


def same(one: W.Workspace, other: W.Workspace) -> bool:
    return set(one.arrays) == set(other.arrays) and all(
        np.array_equal(one[name], other[name], equal_nan=one[name].dtype.kind == "f") for name in one.arrays
    )


def test_a_store_says_what_it_holds(tmp_path: Path) -> None:
    made = W.run(job(with_indices=True), store=tmp_path / "map")
    assert made.job.chunks == 7
    with W.open_store(tmp_path / "map") as found:
        assert found.stops.dims == ("h", "theta_c", "d_p")
        assert found.eta.dims == ("h", "theta_c", "d_p", "index")
        assert found.d_p.attrs["units"] == "m"
        assert found.theta_c.attrs["units"] == "rad"
        assert found.attrs["version"] == krhpr.__version__
        settings = json.loads(found.attrs["krhpr_settings"])
        assert settings["robot"] == "spatial_rrr_a"
        assert settings["limits"]["cone"] == pytest.approx(np.radians(150))
        assert settings["geometry"]["l_2"] == [0.3, 0.3, 0.3]
        assert np.array_equal(found.stops.values, made["stops"])
        assert np.array_equal(found.d_p.values, made.axis("d_p"))
    in_memory = W.run(job(with_indices=True))
    assert same(made, in_memory)
    data = in_memory.dataset()
    assert data.stops.dims == ("h", "theta_c", "d_p")
    assert data.attrs["fingerprint"] == made.job.fingerprint


def test_boundaries_are_kept_too(tmp_path: Path) -> None:
    robot = krhpr.load("spatial_rrr_a")
    arguments: dict[str, Any] = {"redundancy": BETA, "rays": 8, "step": 0.02, "farthest": 0.7}
    here = W.translational(robot, [0.2, 0.3, 0.9], **arguments)
    there = W.translational(robot, [0.2, 0.3, 0.9], store=tmp_path / "map", **arguments)
    assert same(here, there)
    assert np.isnan(here["boundary"][2]).all()


def test_an_interrupted_run_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(done: int, of: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        W.run(job(), store=tmp_path / "map", progress=interrupt)
    made: list[int] = []
    make = maps.GridMap.make

    def counted(self: maps.GridMap, number: int) -> Any:
        made.append(number)
        return make(self, number)

    monkeypatch.setattr(maps.GridMap, "make", counted)
    seen: list[tuple[int, int]] = []
    found = W.run(job(), store=tmp_path / "map", progress=lambda *at: seen.append(at))
    assert made == [3, 4, 5, 6]
    assert seen[0] == (3, 7)
    assert seen[-1] == (7, 7)
    assert same(found, W.run(job()))


def test_a_chunk_without_its_mark_is_made_again(tmp_path: Path) -> None:
    """As where a run was killed between writing and marking, or while writing."""
    import zarr

    W.run(job(), store=tmp_path / "map")
    root: Any = zarr.open_group(tmp_path / "map", mode="r+")
    root["stops"][2] = 77
    root["done"][2] = 0
    assert same(W.run(job(), store=tmp_path / "map"), W.run(job()))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"robot": "spatial_rrr_b"}, 'identifier "spatial_rrr_a" there, "spatial_rrr_b" here'),
        ({"limits": W.WorkspaceLimits(radius=0.01)}, "limits"),
        ({"redundancy": W.constant(1.6)}, "redundant"),
        ({"geometry": 0.31}, "geometry"),
        ({"version": "9.9"}, f'version "{krhpr.__version__}" there, "9.9" here'),
    ],
)
def test_a_store_of_something_else(
    tmp_path: Path, changes: dict[str, Any], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    W.run(job(), store=tmp_path / "map")
    if "version" in changes:
        monkeypatch.setattr(krhpr, "__version__", changes["version"])
        changes = {}
    if "geometry" in changes:
        changes = {"robot": krhpr.load("spatial_rrr_a").with_geometry(l_2=changes["geometry"])}
    elif "robot" in changes:
        robot = krhpr.load(changes["robot"])
        changes = {"robot": robot, "redundancy": W.constant(robot.home.redundant)}
    with pytest.raises(WorkspaceError) as caught:
        W.run(job(**changes), store=tmp_path / "map")
    assert "the store is of something else" in str(caught.value)
    assert words in str(caught.value)


def test_what_is_no_store(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no zarr\n", "utf-8")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "other").write_text("", "utf-8")
    for path in (tmp_path / "file", tmp_path / "folder"):
        with pytest.raises(WorkspaceError, match="no store of a workspace"):
            W.run(job(), store=path)
    assert (tmp_path / "file").read_text("utf-8") == "no zarr\n"
    with pytest.raises(WorkspaceError, match="no store of a workspace"):
        W.open_store(tmp_path / "nothing")


def test_a_grid_that_does_not_fit_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = namedtuple("usage", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: usage(10**6, 9 * 10**5, 10**4 + 5 * 10**4))
    monkeypatch.setattr(maps.GridMap, "make", lambda *_: pytest.fail("begun all the same"))
    with pytest.raises(WorkspaceError) as caught:
        W.run(job(with_indices=True), store=tmp_path / "map")
    assert "takes up to 0.0 GB; the disk has room for 0.0 GB: take larger steps" in str(caught.value)
    assert not (tmp_path / "map").exists()


def test_a_map_that_memory_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(execute, "MEMORY", 1000)
    with pytest.raises(WorkspaceError, match="give a store"):
        W.run(job())


def test_chunks_do_not_matter() -> None:
    whole = job(chunk=10**6)
    assert (whole.chunks, job().chunks) == (1, 7)
    assert same(W.run(job()), W.run(whole))


def test_a_cluster_gives_the_same_and_a_dead_worker_loses_nothing(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        first, _ = (worker.pid for worker in cluster.workers.values())
        killed: list[int] = []

        def kill(done: int, of: int) -> None:
            if done == 2 and not killed:
                os.kill(first, signal.SIGKILL)
                killed.append(first)

        found = W.run(
            job(with_indices=True), workers=cluster.scheduler_address, store=tmp_path / "map", progress=kill
        )
        assert killed
        again = W.run(job(with_indices=True), workers=cluster.scheduler_address)
    here = W.run(job(with_indices=True))
    assert same(found, here)
    assert same(again, here)
    shutil.rmtree(tmp_path / "map")


def test_a_scheduler_that_does_not_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(execute, "WAIT", "300ms")
    for address in ("tcp://127.0.0.1:9", "nowhere"):
        with pytest.raises(WorkspaceError, match="no Dask scheduler answers at"):
            W.run(job(), workers=address)
    with pytest.raises(WorkspaceError, match="0 processes; expected 1 or more"):
        W.run(job(), workers=0)
