"""Motion capture retargeted to robots and rigs: ``kinopt.retarget``, and its parts.

A ``Capture`` holds joint positions. A map assigns its joints to frames of a robot or a rig. ``guess_map`` computes a
map if none is given; ``RetargetFollower`` retargets online.
"""

from __future__ import annotations

from .._kinopt.retargeting import Capture, FigureTarget
from .folder import ClipReport, retarget_folder
from .follower import RetargetFollower
from .hand import HandReport, HandRetargetFollower, retarget_hand
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
    "HandReport",
    "HandRetargetFollower",
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
    "retarget_hand",
    "score",
    "to_clip",
]
