"""Folders of motion captures: an equal call continues after an interruption."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from .. import progress as bars
from .._kinopt import SceneFile, World
from .._kinopt.retargeting import folder_begun
from ..errors import InvalidValueError, KinoptError
from .maps import MapLike, is_skeleton, read_map
from .retarget import retarget
from .targets import TargetLike, read_target


@dataclass(frozen=True)
class ClipReport:
    """Report of one motion capture of a folder."""

    source: str
    """Input file."""
    out: str
    """Output file."""
    frames: int = 0
    """Number of frames; 0 for a file that was done before, or failed."""
    mean_angle: float = 0.0
    """Mean direction error as in ``RetargetReport``, degrees."""
    slip: float = 0.0
    """Largest drift as in ``RetargetReport``, metres."""
    ground_penetration: float = 0.0
    """Largest ground penetration as in ``RetargetReport``, metres."""
    done_before: bool = False
    """True if the output existed."""
    notes: list[str] = field(default_factory=list)
    """Notes on a guessed map, for review."""
    error: str | None = None
    """Error text; None if the output was written."""


#: Input file and output file.
Pair: TypeAlias = tuple[str, str]


class Begun:
    """A folder in progress: the remaining files, and the reports of the others."""

    def __init__(self, movements: list[tuple[str, str, bool]]) -> None:
        self._pairs = [(source, out) for source, out, _ in movements]
        self._reports = {(source, out): ClipReport(source, out, done_before=True) for source, out, done in movements if done}
        self.left: list[tuple[str, str]] = [pair for pair in self._pairs if pair not in self._reports]

    def note(self, pair: Pair, report: ClipReport) -> None:
        """Records the report of a remaining file."""
        self._reports[pair] = report

    @property
    def progress(self) -> tuple[int, int]:
        """Number of finished files, and of all files."""
        return len(self._reports), len(self._pairs)

    @property
    def reports(self) -> list[ClipReport]:
        """Reports of all files, in the order of their names."""
        return [self._reports[pair] for pair in self._pairs]


@dataclass(frozen=True)
class FolderJob:
    """A folder of motion captures with the options of retargeting; can be sent to a worker."""

    source: str
    out: str
    target: Any
    map: MapLike
    options: dict[str, Any]

    def begin(self, overwrite: bool) -> Begun:
        """Creates the output folder, or continues one of an equal job."""
        skeleton = self.map if isinstance(self.map, str) and is_skeleton(self.map) else None
        parsed_map = read_map(self.map)
        text = None if parsed_map is None else json.dumps(parsed_map)
        folders = (self.source, self.out)
        # Each option struct reads its own fields.
        return Begun(folder_begun(folders, self.target, text, skeleton, self.options, self.options, overwrite))

    def run(self, pair: Pair) -> ClipReport:
        """Retargets one motion capture, and returns its report."""
        source, out = pair
        try:
            retargeted = retarget(source, self.target, self.map, **self.options)
            retargeted.save(out)
        except KinoptError as error:
            named = str(error) if source in str(error) else f"{source}: {error}"
            return ClipReport(source, out, error=named)
        return ClipReport(
            source,
            out,
            len(retargeted),
            retargeted.report.mean_angle,
            retargeted.report.slip,
            retargeted.report.ground_penetration,
            notes=retargeted.report.notes,
        )


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
    overwrite: bool = False,
    progress: bool | Callable[[int, int], None] = False,
) -> list[ClipReport]:
    """Retargets every motion capture of a folder and its subfolders to a robot or a rig: a .npz each, as
    ``Trajectory.save`` writes it.

    Each of ``threads`` (None: one for each core) processes one file at a time; other arguments are as in ``retarget``.
    A file appears when it is complete. After an interruption, an equal call, or ``kinopt retarget`` with equal
    arguments, continues the job. Changed inputs are processed again, or with ``again`` all of them. A failure does not
    affect other files: its report has the error. ``progress`` shows a tqdm bar if True, or is called with (done,
    total). ``kinopt.ray.retarget_files`` runs on several machines.

    Raises ``FileError`` for folders that cannot be read or written or contain no motion capture. Raises
    ``InvalidValueError`` for an output folder of another job and for two inputs of one name, and the errors of the
    target.
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
        raise InvalidValueError(f"threads is {threads}, expected at least 1, or None for all cores")
    begun = job.begin(overwrite)
    report = bars.bar() if progress is True else progress or (lambda done, total: None)
    pool = ThreadPoolExecutor(threads or os.cpu_count() or 1)
    try:
        running = {pool.submit(job.run, pair): pair for pair in begun.left}
        for done in as_completed(running):
            begun.note(running[done], done.result())
            report(*begun.progress)
    finally:
        # After an interruption, no further file starts.
        pool.shutdown(cancel_futures=True)
    return begun.reports


def folder_job(
    source: str | os.PathLike[str],
    target: TargetLike,
    out: str | os.PathLike[str],
    map: MapLike,
    **options: Any,
) -> FolderJob:
    """Creates the job of a folder."""
    joints = options.get("joints")
    options["joints"] = None if joints is None else list(joints)
    target = read_target(target)
    # A file cannot be sent to a worker, and a .npz has no use of its materials.
    target = target.scene if isinstance(target, SceneFile) else target
    return FolderJob(os.fspath(source), os.fspath(out), target, map, options)


__all__ = ["ClipReport", "retarget_folder"]
