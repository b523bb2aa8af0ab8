"""Folders of movements: what is done stays done where the same call is made again."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from .. import progress as bars
from .._kinopt import Model, MotionCapture, Scene, __version__
from .._kinopt.retargeting import FigureTarget
from ..errors import FileError, InvalidValueError, KinoptError
from .maps import MapLike
from .movement import UNFINISHED
from .retarget import retarget
from .targets import TargetLike, read_target

#: Files of movements, by their endings.
KINDS = (".npy", ".bvh", ".glb", ".gltf")
#: Beside the movements: what was asked, so that a folder has the answers to one question.
QUESTION = "retarget.json"


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


@dataclass(frozen=True)
class FolderJob:
    """A folder of movements, and what is done with each: a worker anywhere may hold it."""

    source: str
    out: str
    target: Any
    map: MapLike
    options: dict[str, Any]

    def begin(self, again: bool) -> tuple[list[tuple[str, str]], dict[tuple[str, str], ClipReport]]:
        """Makes the folder, sweeps out what a call that was ended was writing, and says what goes where, and what was done before."""
        pairs = self._pairs()
        question = {"kinopt": __version__, "asked": self._asked()}
        noted = Path(self.out, QUESTION)
        try:
            for _, out in pairs:
                Path(out).parent.mkdir(parents=True, exist_ok=True)
            for left in Path(self.out).rglob(f"{UNFINISHED}*"):
                left.unlink()
            if noted.exists() and not again:
                if json.loads(noted.read_text(encoding="utf-8")) != question:
                    raise InvalidValueError(
                        f"{self.out} answers another question, as {QUESTION} in it says: give another folder, or again=True"
                    )
            else:
                noted.write_text(json.dumps(question, indent=2) + "\n", encoding="utf-8")
        except (OSError, ValueError) as error:
            if isinstance(error, KinoptError):
                raise
            raise FileError(f"{self.out} cannot be written: {error}") from None
        done = [pair for pair in pairs if not again and _is_newer(*pair)]
        return pairs, {pair: ClipReport(*pair, done_before=True) for pair in done}

    def _pairs(self) -> list[tuple[str, str]]:
        source, out = Path(self.source), Path(self.out)
        if not source.is_dir():
            raise FileError(f"{source} is no folder")
        found = sorted(path for path in source.rglob("*") if path.suffix.lower() in KINDS and path.name[0] != ".")
        if not found:
            raise FileError(f"there is no {', '.join(KINDS)} in {source}")
        pairs: dict[Path, Path] = {}
        for path in found:
            into = out / path.relative_to(source).with_suffix(".npz")
            if into in pairs:
                raise InvalidValueError(f"{pairs[into]} and {path} would both be written to {into}")
            pairs[into] = path
        return [(str(path), str(into)) for into, path in pairs.items()]

    def _asked(self) -> dict[str, Any]:
        target = FigureTarget(self.target) if isinstance(self.target, (MotionCapture, Scene)) else self.target
        model = target if isinstance(target, Model) else target.model
        given = str(self.map) if isinstance(self.map, os.PathLike) else self.map
        # As it is read again.
        asked: dict[str, Any] = json.loads(json.dumps({"target": [model.name, *model.joint_names], "map": given, **self.options}))
        return asked

    def run(self, source: str, out: str) -> ClipReport:
        """Brings one movement onto the target, and says what came of it."""
        try:
            found = retarget(source, self.target, self.map, **self.options)
            found.save(out)
        except KinoptError as error:
            named = str(error) if source in str(error) else f"{source}: {error}"
            return ClipReport(source, out, error=named)
        return ClipReport(source, out, len(found), found.mean_error, found.slip, found.sunk, notes=found.notes)


def _is_newer(source: str, out: str) -> bool:
    """Whether a movement was written after its source."""
    try:
        return os.stat(out).st_mtime_ns >= os.stat(source).st_mtime_ns
    except OSError:
        return False


def retarget_folder(
    source: str | os.PathLike[str],
    target: TargetLike,
    out: str | os.PathLike[str],
    map: MapLike = None,
    *,
    joints: Sequence[str] | None = None,
    fps: float | None = None,
    up: Literal["y", "z"] | None = None,
    whole: bool = False,
    contact_speed: float | None = None,
    contact_height: float | None = None,
    acceleration: float | None = None,
    keep_clear: float | None = None,
    threads: int | None = None,
    again: bool = False,
    progress: bool | Callable[[int, int], None] = False,
) -> list[ClipReport]:
    """Brings every movement of a folder, and of those in it, onto a robot or a rig: a .npz each, as ``Retargeted.save`` writes it.

    So many ``threads`` (None: one a core) take a file at a time; the rest is as of ``retarget``. A file is there when it is whole:
    a call that was ended goes on where it is made again, and does anew what changed since, or with ``again`` all. What
    fails keeps no other from being done: its report says why. ``progress``: whether a bar shows how far it is (by tqdm), or what is
    called with (done, total). ``kinopt.ray.retarget_files`` does the same over many machines.

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
        whole=whole,
        contact_speed=contact_speed,
        contact_height=contact_height,
        acceleration=acceleration,
        keep_clear=keep_clear,
    )
    pairs, reports = job.begin(again)
    report = bars.bar() if progress is True else progress or (lambda done, total: None)
    if threads is not None and threads < 1:
        raise InvalidValueError(f"threads is {threads}: at least 1, or None for all cores")
    left = [pair for pair in pairs if pair not in reports]
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        running = {pool.submit(job.run, *pair): pair for pair in left}
        for done in as_completed(running):
            reports[running[done]] = done.result()
            report(len(reports), len(pairs))
    return [reports[pair] for pair in pairs]


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
