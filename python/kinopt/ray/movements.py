"""Folders of motion captures on several machines."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal

import ray

from .._kinopt import World
from ..retargeting.folder import ClipReport, FolderJob, Pair, folder_job
from ..retargeting.maps import MapLike
from ..retargeting.targets import TargetLike
from .datasets import cores


def retarget_files(
    source: str | os.PathLike[str],
    target: TargetLike,
    out: str | os.PathLike[str],
    map: MapLike = None,
    *,
    joints: Sequence[str] | None = None,
    fps: float | None = None,
    up: Literal["y", "z"] | None = None,
    clip: str | None = None,
    whole: bool = False,
    contact_speed: float | None = None,
    contact_height: float | None = None,
    acceleration: float | None = None,
    keep_clear: float | None = None,
    world: World | None = None,
    margin: float | None = None,
    overwrite: bool = False,
    workers: int | None = None,
    **options: Any,
) -> list[ClipReport]:
    """Runs ``kinopt.retargeting.retarget_folder`` on Ray's ``workers`` (None: one for each core of the cluster), each
    with one file at a time.

    The folders are paths that all workers can access. Finished files stay and equal those of one machine exactly; a
    worker that dies is restarted, with its file. ``options`` go to Ray's ``remote``: ``num_cpus``, ``memory``,
    ``max_retries``, ...

    Raises as ``retarget_folder`` does.
    """
    job = folder_job(
        source,
        target,
        out,
        map,
        joints=joints,
        fps=fps,
        up=up,
        clip=clip,
        whole=whole,
        contact_speed=contact_speed,
        contact_height=contact_height,
        acceleration=acceleration,
        keep_clear=keep_clear,
        world=world,
        margin=margin,
    )
    begun = job.begin(overwrite)
    worker_count = workers or cores()
    options.setdefault("num_cpus", 1 if workers is None else min(1.0, cores() * 1000 // worker_count / 1000))
    run = ray.remote(_run).options(**options)
    job_reference = ray.put(job)
    running: dict[Any, Pair] = {}
    waiting = begun.left[::-1]
    while waiting or running:
        while waiting and len(running) < worker_count:
            pair = waiting.pop()
            running[run.remote(job_reference, pair)] = pair
        for done in ray.wait(list(running))[0]:
            begun.note(running.pop(done), ray.get(done))
    return begun.reports


def _run(job: FolderJob, pair: Pair) -> ClipReport:
    return job.run(pair)


__all__ = ["retarget_files"]
