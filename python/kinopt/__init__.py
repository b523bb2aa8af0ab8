"""Inverse kinematics by optimisation: robot arms and skeletons, hard limits, honest results.

Placements are 4 x 4 arrays (or what has ``homogeneous``, ``as_matrix()`` or ``A``), metres and radians;
``world_from_tip`` maps tip coordinates to world coordinates. Many of anything come first:
``(N, 4, 4)`` targets give ``(N, dof)`` configurations.
"""

from ._kinopt import (
    ForwardKinematics,
    Frame,
    Jacobian,
    ActiveLimit,
    Counts,
    Frame,
    Goal,
    Joint,
    Model,
    ModelBuilder,
    Robot,
    Shape,
    __version__,
    frame_jacobian,
    frame_placement,
    RowsReport,
    Shape,
    Solution,
    TaskReport,
    __version__,
)
from .errors import (
    FileError,
    InvalidFileError,
    InvalidValueError,
    KinoptError,
    UnknownNameError,
)

__all__ = [
    "ActiveLimit",
    "Counts",
    "FileError",
    "ForwardKinematics",
    "Frame",
    "Goal",
    "InvalidFileError",
    "InvalidValueError",
    "Jacobian",
    "Joint",
    "KinoptError",
    "Model",
    "ModelBuilder",
    "Robot",
    "RowsReport",
    "Shape",
    "Solution",
    "TaskReport",
    "UnknownNameError",
    "__version__",
    "frame_jacobian",
    "frame_placement",
]
