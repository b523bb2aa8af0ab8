"""Folders of movements: what is done stays done where the same call is made again."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from .. import progress as bars
from .._kinopt import World
from .._kinopt.retargeting import folder_begun
from ..errors import InvalidValueError, KinoptError
from .maps import MapLike, is_skeleton, read_map
from .retarget import retarget
from .targets import TargetLike, read_target


@dataclass(frozen=True)
class ClipReport:
    """What came of one movement of a folder."""

    source: str
    """Its file."""
    out: str
    """Where it was written."""
    frames: int = 0
    """How many frames it has; 0 of one that was done before, or failed."""
    mean_error: float = 0.0
    """As of ``Retargeted``, metres."""
    slip: float = 0.0
    """As of ``Retargeted``, metres."""
    sunk: float = 0.0
    """As of ``Retargeted``, metres."""
    done_before: bool = False
    """Whether it was there already."""
    notes: list[str] = field(default_factory=list)
    """What a guessed map leaves to be looked at."""
    error: str | None = None
    """What is wrong with it; None where it was written."""


#: A movement's file, and where it goes.
Pair: TypeAlias = tuple[str, str]


class Begun:
    """A folder that was begun: what is left to do, and what came of the rest."""

    def __init__(self, movements: list[tuple[str, str, bool]]) -> None:
        self._pairs = [(source, out) for source, out, _ in movements]
        self._reports = {(source, out): ClipReport(source, out, done_before=True) for source, out, done in movements if done}
        self.left = [pair for pair in self._pairs if pair not in self._reports]

    def note(self, pair: Pair, report: ClipReport) -> None:
        """What came of one that was left."""
        self._reports[pair] = report

    @property
    def progress(self) -> tuple[int, int]:
        """How many are done, and how many there are."""
        return len(self._reports), len(self._pairs)

    @property
    def reports(self) -> list[ClipReport]:
        """Of all, in the order of their names."""
        return [self._reports[pair] for pair in self._pairs]


@dataclass(frozen=True)
class FolderJob:
    """A folder of movements, and what is done with each: a worker anywhere may hold it."""

    source: str
    out: str
    target: Any
    map: MapLike
    options: dict[str, Any]

    def begin(self, again: bool) -> Begun:
        """Makes the folder, or goes on with one that was begun by whomever to answer the same question."""
        skeleton = self.map if isinstance(self.map, str) and is_skeleton(self.map) else None
        given = read_map(self.map)
        text = None if given is None else json.dumps(given)
        folders = (self.source, self.out)
        # They read what is theirs.
        return Begun(folder_begun(folders, self.target, text, skeleton, self.options, self.options, again))

    def run(self, pair: Pair) -> ClipReport:
        """Brings one movement onto the target, and says what came of it."""
        source, out = pair
        try:
            found = retarget(source, self.target, self.map, **self.options)
            found.save(out)
        except KinoptError as error:
            named = str(error) if source in str(error) else f"{source}: {error}"
            return ClipReport(source, out, error=named)
        return ClipReport(source, out, len(found), found.mean_error, found.slip, found.sunk, notes=found.notes)


def retarget_folder(
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
    threads: int | None = None,
    again: bool = False,
    progress: bool | Callable[[int, int], None] = False,
) -> list[ClipReport]:
    """Brings every movement of a folder, and of those in it, onto a robot or a rig: a .npz each, as ``Retargeted.save`` writes it.

    So many ``threads`` (None: one a core) take a file at a time; the rest is as of ``retarget``. A file is there when it is whole:
    what was ended goes on where this is called again, or ``kinopt retarget`` is asked the same of both folders, and the other way
    round; what changed since is done anew, or with ``again`` all. What fails keeps no other from being done: its report says why.
    ``progress``: whether a bar shows how far it is (by tqdm), or what is called with (done, total).
    ``kinopt.ray.retarget_files`` does the same over many machines.

    Raises ``FileError`` for folders that cannot be read or written or hold no movement, ``InvalidValueError`` for one that answers
    another question and for two movements of one name, and what is wrong with the target.
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
    if threads is not None and threads < 1:
        raise InvalidValueError(f"threads is {threads}: at least 1, or None for all cores")
    begun = job.begin(again)
    report = bars.bar() if progress is True else progress or (lambda done, total: None)
    pool = ThreadPoolExecutor(threads or os.cpu_count() or 1)
    try:
        running = {pool.submit(job.run, pair): pair for pair in begun.left}
        for done in as_completed(running):
            begun.note(running[done], done.result())
            report(*begun.progress)
    finally:
        # Where it is interrupted, nothing more is begun.
        pool.shutdown(cancel_futures=True)
    return begun.reports


def folder_job(
    source: str | os.PathLike[str],
    target: TargetLike,
    out: str | os.PathLike[str],
    map: MapLike,
    **options: Any,
) -> FolderJob:
    """What is done with every movement."""
    joints = options.get("joints")
    options["joints"] = None if joints is None else list(joints)
    return FolderJob(os.fspath(source), os.fspath(out), read_target(target), map, options)


__all__ = ["ClipReport", "retarget_folder"]
