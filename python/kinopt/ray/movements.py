"""Folders of people's movements over many machines."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal

import ray

from .._kinopt import Model
from ..retargeting.folder import ClipReport, FolderJob, folder_job
from ..retargeting.maps import MapLike
from ..types import HasModel
from .datasets import cores


def retarget_files(
    source: str | os.PathLike[str],
    target: Model | HasModel | str | os.PathLike[str],
    out: str | os.PathLike[str],
    map: MapLike = None,
    *,
    joints: Sequence[str] | None = None,
    fps: float | None = None,
    up: Literal["y", "z"] | None = None,
    whole: bool = False,
    again: bool = False,
    workers: int | None = None,
    **options: Any,
) -> list[ClipReport]:
    """``kinopt.retargeting.retarget_folder`` by Ray's ``workers`` (None: one for each core of the cluster), each with a file at a time.

    The folders are paths that all workers see. What is done stays done, to the bit what one machine writes; a worker that
    dies is started again, and its file with it. ``options`` go to Ray's ``remote``: ``num_cpus``, ``memory``, ``max_retries``, ...

    Raises as ``retarget_folder`` does.
    """
    job = folder_job(source, target, out, map, joints=joints, fps=fps, up=up, whole=whole)
    pairs = job.begin(again)
    left = [pair for pair in pairs if again or not job.is_done(*pair)]
    many = workers or cores()
    options.setdefault("num_cpus", 1 if workers is None else min(1.0, cores() * 1000 // many / 1000))
    run = ray.remote(_run).options(**options)
    held = ray.put(job)
    reports = {pair: ClipReport(*pair, done_before=True) for pair in pairs if pair not in left}
    running: dict[Any, tuple[str, str]] = {}
    waiting = list(reversed(left))
    while waiting or running:
        while waiting and len(running) < many:
            pair = waiting.pop()
            running[run.remote(held, *pair)] = pair
        for done in ray.wait(list(running))[0]:
            reports[running.pop(done)] = ray.get(done)
    return [reports[pair] for pair in pairs]


def _run(job: FolderJob, source: str, out: str) -> ClipReport:
    return job.run(source, out)


__all__ = ["retarget_files"]
