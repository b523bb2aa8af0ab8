"""Viewer in the browser, with robots and characters that can be dragged: `python -m kinopt.view MODEL`.

`Scene` offers it to scripts, in a few lines. It needs viser: `pip install 'kinopt[view]'`.
"""

from importlib.util import find_spec

if find_spec("viser") is None:
    raise ImportError("kinopt.view needs viser: pip install 'kinopt[view]'")

from .balance import Balance
from .body import Body, Clip, Piece
from .movement import Movement
from .obstacles import Obstacles
from .play_bar import PlayBar
from .robot_body import RobotBody
from .scene import Scene
from .solids import Solid
from .target import Target

__all__ = ["Balance", "Body", "Clip", "Movement", "Obstacles", "Piece", "PlayBar", "RobotBody", "Scene", "Solid", "Target"]
