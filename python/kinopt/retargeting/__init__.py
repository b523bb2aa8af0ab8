"""People's movements on robots and rigs: ``kinopt.retarget``, and what it is made of.

A ``Capture`` is where joints are, a map which of them drives which frame of a robot or a rig. ``guess_map`` makes one
where none is given; ``RetargetFollower`` follows live.
"""

from __future__ import annotations

from .._kinopt.retargeting import Capture, FigureTarget
from .folder import ClipReport, retarget_folder
from .follower import RetargetFollower
from .maps import MapGuess, guess_map
from .movement import GivenUp, LimitMet, Retargeted, Touching
from .retarget import retarget
from .sources import read_capture

__all__ = [
    "Capture",
    "ClipReport",
    "FigureTarget",
    "GivenUp",
    "LimitMet",
    "MapGuess",
    "RetargetFollower",
    "Retargeted",
    "Touching",
    "guess_map",
    "read_capture",
    "retarget",
    "retarget_folder",
]
