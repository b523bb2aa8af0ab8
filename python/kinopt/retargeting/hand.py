"""Retargeting of a captured hand to a robot hand."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike

from .._kinopt import Trajectory
from .._kinopt.retargeting import LiveHand, hand_map_guessed, hand_retargeted
from ..types import Floats
from .sources import Source, read_capture
from .targets import TargetLike, read_target

HandMapLike = Union[dict[str, Any], str, "os.PathLike[str]", None]


@dataclass(frozen=True)
class HandReport:
    """Errors of a retargeted hand."""

    fps: float
    """Frame rate, in frames a second."""
    tip_error: float
    """Mean distance of fingertips from the scaled ones of the subject, metres."""
    pinch_distance: float
    """Mean distance of a fingertip from the thumb's while the subject pinches, metres; 0 without a pinch."""
    scales: list[float]
    """Ratio of each finger's length to the subject's, from the thumb outward."""
    map: dict[str, Any]
    """The map in use."""


def retarget_hand(
    source: Source,
    target: TargetLike,
    map: HandMapLike = None,
    *,
    joints: Sequence[str] | None = None,
    fps: float | None = None,
    side: str | None = None,
    up: Literal["y", "z"] | None = None,
    clip: str | None = None,
) -> Trajectory[HandReport]:
    """Retargets a captured hand to a robot hand on a fixed base, within its position and speed limits.

    Fingertips follow the vectors from the bases of the subject's fingers to their tips, and those from the thumb to the
    other tips. A finger at the thumb closes on it. Scales and palm axes of both hands are measured. Joints above all
    fingers stay at neutral.

    ``source``, ``joints``, ``fps``, ``up`` and ``clip`` are as in ``retarget``: positions of shape (T, J, 3) in any unit
    and axes, for example the 21 points of a hand tracker. ``map``: a dict or a .json file, ``{"wrist": joint, "fingers":
    {"thumb": {"base": joint, "tip": joint, "frame": frame of the target}}}``, with ``thumb`` and at least two of
    ``index``, ``middle``, ``ring`` and ``little``; or None, for a guess by names. ``side``, such as "right", selects the
    joints of one hand of a body for the guess.

    Raises ``UnknownNameError`` for names that the capture or the target lacks, and ``InvalidValueError`` for a map
    without thumb or fingers.
    """
    capture, model, text = _read(source, target, map, joints, fps, side, up, clip)
    q, names, (tip_error, pinch_distance, scales) = hand_retargeted(capture, model, text)
    report = HandReport(capture.fps, tip_error, pinch_distance, scales, json.loads(text))
    return Trajectory(np.arange(len(q)) / capture.fps, q, names, report, model)


class HandRetargetFollower:
    """Retargets a live hand: from one frame's joint positions to its configuration. Arguments are as in
    ``retarget_hand``; ``measured`` is a capture of the subject's hand that opens and closes.

    Raises the errors of ``retarget_hand``.
    """

    def __init__(
        self,
        measured: Source,
        target: TargetLike,
        map: HandMapLike = None,
        *,
        joints: Sequence[str] | None = None,
        fps: float | None = None,
        side: str | None = None,
        up: Literal["y", "z"] | None = None,
        clip: str | None = None,
    ) -> None:
        capture, model, text = _read(measured, target, map, joints, fps, side, up, clip)
        self._live = LiveHand(capture, model, text)
        self._map: dict[str, Any] = json.loads(text)

    @property
    def q(self) -> Floats:
        """Current configuration, shape (nq,)."""
        return self._live.q

    @property
    def names(self) -> list[str]:
        """Names of the numbers of a configuration."""
        return self._live.names

    @property
    def map(self) -> dict[str, Any]:
        """The map in use."""
        return self._map

    def step(self, positions: ArrayLike) -> Floats:
        """Processes the next frame: ``positions`` of shape (J, 3); returns the configuration of shape (nq,).

        Raises ``InvalidValueError`` for another number of joints.
        """
        return self._live.step(positions)


def _read(
    source: Source,
    target: TargetLike,
    map: HandMapLike,
    joints: Sequence[str] | None,
    fps: float | None,
    side: str | None,
    up: Literal["y", "z"] | None,
    clip: str | None,
) -> tuple[Any, Any, str]:
    capture = read_capture(source, joints=joints, skeleton=None, fps=fps, up=up, clip=clip)
    model = read_target(target)
    if map is None:
        return capture, model, hand_map_guessed(capture, model, side)
    text = json.dumps(map) if isinstance(map, dict) else Path(map).read_text(encoding="utf-8")
    return capture, model, text


__all__ = ["HandReport", "HandRetargetFollower", "retarget_hand"]
