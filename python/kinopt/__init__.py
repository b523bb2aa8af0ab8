"""Inverse kinematics by optimisation: robot arms and skeletons, hard limits, honest results.

Placements are 4 x 4 arrays (or what has ``homogeneous``, ``as_matrix()`` or ``A``), metres and radians;
``world_from_tip`` maps tip coordinates to world coordinates. Many of anything come first:
``(N, 4, 4)`` targets give ``(N, dof)`` configurations.
"""

from ._kinopt import (
    ActiveLimit,
    Arm,
    Batch,
    Counts,
    Follower,
    ForwardKinematics,
    Frame,
    Goal,
    Jacobian,
    Joint,
    Jump,
    Model,
    ModelBuilder,
    Robot,
    RowsReport,
    Servo,
    ServoStep,
    Shape,
    Solution,
    TaskReport,
    Track,
    __version__,
    frame_jacobian,
    frame_placement,
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
    "Arm",
    "Batch",
    "Counts",
    "FileError",
    "Follower",
    "ForwardKinematics",
    "Frame",
    "Goal",
    "InvalidFileError",
    "InvalidValueError",
    "Jacobian",
    "Joint",
    "Jump",
    "KinoptError",
    "Model",
    "ModelBuilder",
    "Robot",
    "RowsReport",
    "Servo",
    "ServoStep",
    "Shape",
    "Solution",
    "TaskReport",
    "Track",
    "UnknownNameError",
    "__version__",
    "frame_jacobian",
    "frame_placement",
]
