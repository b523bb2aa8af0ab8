"""A movement on a robot or a rig, and the truth about it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._kinopt.animation import Clip
from .._kinopt.retargeting import Capture, FigureTarget, unfinished
from ..errors import FileError, InvalidValueError
from ..types import Floats
from .targets import TargetLike, read_target


@dataclass(frozen=True)
class LimitMet:
    """A limit that a joint is at over a span of frames."""

    joint: str
    """The joint's name."""
    bound: str
    """"lower" or "upper", "speed down" or "speed up"."""
    first: int
    """The first of the frames."""
    end: int
    """The frame after the last."""


@dataclass(frozen=True)
class Touching:
    """Two links that touch in a frame, where they were to be kept apart."""

    frame: int
    """The frame."""
    first: str
    """One link."""
    second: str
    """The other."""
    distance: float
    """How far they are apart, metres; negative where one is in the other."""


@dataclass(frozen=True)
class GivenUp:
    """What stood, and could be held no longer, as limits win."""

    frame: int
    """The first frame in which it has slipped by more than a millimetre; from there on it stands no more."""
    standing: str
    """The frame of the target, as in ``standing``."""


@dataclass(frozen=True, eq=False, repr=False)
class Retargeted:
    """A movement on a robot or a rig: configurations within all limits of position and speed, to the bit."""

    q: Floats
    """Configurations, shape (T, nq)."""
    fps: float
    """Frames a second."""
    names: list[str]
    """Names of the numbers of a configuration."""
    contacts: NDArray[np.bool_]
    """What stands, shape (T, S)."""
    standing: list[str]
    """The S frames of the target that stand at times."""
    standing_at: Floats
    """The point of each that stands, in its coordinates, shape (S, 3), metres."""
    errors: Floats
    """How far each driven place is from where it should be, shape (T, K), metres."""
    driven: list[str]
    """The K captured joints that drive them, the columns of ``errors``."""
    mean_error: float
    """Their mean over all frames, metres."""
    slip: float
    """How far what stands is from where it came to stand, at most, metres."""
    sunk: float
    """How deep the lowest point of a foot with a shape is in the ground, at most, metres; 0 where none is."""
    stride: float
    """How many times as large as the person's its steps are."""
    limits: list[LimitMet]
    """The limits that are met, by joint and then by frame."""
    given_up: list[GivenUp]
    """What could be held no longer before the person let go of it."""
    touching: list[Touching]
    """The frames in which something touches all the same with ``keep_clear``, each with its nearest pair."""
    map: dict[str, Any]
    """The map that it went by."""
    notes: list[str]
    """What a guessed map leaves to be looked at, and whether the target stands along another axis than z."""
    capture: Capture
    """What was brought there."""

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return (
            f"Retargeted({len(self.q)} frames at {self.fps:g} fps, {self.q.shape[1]} numbers a frame, "
            f"mean_error={self.mean_error:.4g} m, slip={self.slip:.2g} m, {len(self.notes)} notes)"
        )

    def missed(self, tolerance: float = 0.05) -> dict[str, NDArray[np.intp]]:
        """The frames in which a driven place is further off than a ``tolerance`` (metres), by the joint that drives it."""
        far = self.errors > tolerance
        return {name: np.flatnonzero(far[:, k]) for k, name in enumerate(self.driven) if far[:, k].any()}

    def clip(self, target: TargetLike, name: str = "retargeted") -> Clip:
        """The movement of a figure as a clip of ``target``'s armature, in the axes of its file: of the rig, skeleton, scene, motion capture or
        ``FigureTarget`` that it was brought onto, or of its file.

        ``SceneFile.add_clip`` puts it into the scene's own file.

        Raises ``InvalidValueError`` for what is no figure, or another one.
        """
        figure = read_target(target)
        if not isinstance(figure, FigureTarget):
            figure = FigureTarget(figure)
        return figure.clip(self.q, self.fps, name)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes ``q``, ``fps``, ``names``, ``contacts``, ``standing`` and ``standing_at`` as a .npz; it appears when it is whole.

        Raises ``InvalidValueError`` for another ending, ``FileError`` where it cannot be written.
        """
        path = Path(path)
        if path.suffix != ".npz":
            raise InvalidValueError(f"{path}: a .npz is written")
        # Beside the file that a link leads to.
        real = Path(os.path.realpath(path))
        part = unfinished(real)
        try:
            with part.open("wb") as file:
                np.savez(
                    file,
                    q=self.q,
                    fps=self.fps,
                    names=np.array(self.names),
                    contacts=self.contacts,
                    standing=np.array(self.standing, dtype=str),
                    standing_at=self.standing_at,
                )
            part.replace(real)
        except OSError as error:
            raise FileError(f"{path}: cannot be written: {error}") from None


__all__ = ["GivenUp", "LimitMet", "Retargeted", "Touching"]
