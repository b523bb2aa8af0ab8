"""Motion capture retargeted to robots and rigs: ``kinopt.retarget``, and its parts.

A ``Capture`` holds joint positions. A map assigns its joints to frames of a robot or a rig. ``guess_map`` computes a
map if none is given; ``RetargetFollower`` retargets online.
"""

from __future__ import annotations

from .._kinopt.retargeting import Capture, FigureTarget
from .folder import ClipReport, retarget_folder
from .follower import RetargetFollower
from .maps import MapGuess, guess_map
from .movement import LostContact, LimitMet, RetargetReport, Touching, to_clip
from .retarget import retarget
from .score import score
from .score_report import FootMotion, LimitExcess, MotionScore, ScoreTerm, Spread
from .sources import read_capture

__all__ = [
    "Capture",
    "ClipReport",
    "FigureTarget",
    "FootMotion",
    "LimitExcess",
    "LostContact",
    "LimitMet",
    "MapGuess",
    "MotionScore",
    "RetargetFollower",
    "RetargetReport",
    "ScoreTerm",
    "Spread",
    "Touching",
    "guess_map",
    "read_capture",
    "retarget",
    "retarget_folder",
    "score",
    "to_clip",
]
