"""Inverse kinematics by optimisation for robot arms and skeletons, with hard limits.

Placements are 4 x 4 arrays (or objects with ``homogeneous``, ``as_matrix()`` or ``A``), metres and radians;
``world_from_tip`` maps tip coordinates to world coordinates. The batch axis comes first: ``(N, 4, 4)`` targets give
``(N, dof)`` configurations.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from . import animation, io, methods, models, retargeting, skinning, tasks
from ._kinopt import (
    ActiveLimit,
    ActiveMotionLimit,
    Arm,
    BallSkeleton,
    ArmDerivative,
    Batch,
    Bone,
    CollisionModel,
    Collision,
    Coordinates,
    Counts,
    Drag,
    Follower,
    ForwardKinematics,
    Frame,
    PoseBounds,
    Iteration,
    Jacobian,
    Joint,
    JointJump,
    JointPath,
    LoopClosure,
    Model,
    MissedFrame,
    MissedPoint,
    ModelBuilder,
    MotionCapture,
    MotionProblem,
    MotionReport,
    Obstacle,
    ParameterMap,
    PathReport,
    Problem,
    Rig,
    RigPosing,
    Robot,
    RowBlockReport,
    Scene,
    SceneFile,
    SceneMesh,
    ScenePosing,
    Separation,
    Servo,
    ServoStep,
    Shape,
    Skeleton,
    SkeletonBuilder,
    Skin,
    Solution,
    SolutionDerivative,
    Solutions,
    Solver,
    SphereModel,
    Srdf,
    TaskReport,
    TimedSpline,
    Trajectory,
    TrajectoryPoint,
    TriangleMesh,
    World,
    __version__,
    frame_jacobian,
    frame_placement,
    solve_path,
)
from ._robot_sources import from_description, from_xacro
from .errors import (
    FileError,
    InvalidFileError,
    InvalidValueError,
    KinoptError,
    UnknownNameError,
)

from .motion import Contact
from .placements import placement
from .retargeting import RetargetFollower, RetargetReport, guess_map, retarget

if TYPE_CHECKING:
    from types import ModuleType

# Their packages are optional and of Python, so the methods are not in the extension module.
for _method in (from_description, from_xacro):
    setattr(Robot, _method.__name__, classmethod(_method))
del _method, from_description, from_xacro


def __getattr__(name: str) -> ModuleType:
    # Imported on demand, because their optional dependencies may be missing.
    if name in ("jax", "lerobot", "ray", "rerun", "torch", "view"):
        return importlib.import_module(f"kinopt.{name}")
    raise AttributeError(f"module 'kinopt' has no attribute {name!r}")


__all__ = [
    "ActiveLimit",
    "ActiveMotionLimit",
    "Arm",
    "BallSkeleton",
    "ArmDerivative",
    "Batch",
    "Bone",
    "CollisionModel",
    "Collision",
    "Contact",
    "Coordinates",
    "Counts",
    "Drag",
    "FileError",
    "Follower",
    "ForwardKinematics",
    "Frame",
    "PoseBounds",
    "InvalidFileError",
    "InvalidValueError",
    "Iteration",
    "Jacobian",
    "Joint",
    "KinoptError",
    "JointJump",
    "JointPath",
    "LoopClosure",
    "Model",
    "MissedFrame",
    "MissedPoint",
    "ModelBuilder",
    "MotionCapture",
    "MotionProblem",
    "MotionReport",
    "Obstacle",
    "ParameterMap",
    "PathReport",
    "Problem",
    "RetargetFollower",
    "RetargetReport",
    "Rig",
    "RigPosing",
    "Robot",
    "RowBlockReport",
    "Scene",
    "SceneFile",
    "SceneMesh",
    "ScenePosing",
    "Separation",
    "Servo",
    "ServoStep",
    "Shape",
    "Skeleton",
    "SkeletonBuilder",
    "Skin",
    "Solution",
    "SolutionDerivative",
    "Solutions",
    "Solver",
    "SphereModel",
    "Srdf",
    "TaskReport",
    "TimedSpline",
    "Trajectory",
    "TrajectoryPoint",
    "TriangleMesh",
    "UnknownNameError",
    "World",
    "__version__",
    "animation",
    "frame_jacobian",
    "frame_placement",
    "guess_map",
    "retarget",
    "retargeting",
    "solve_path",
    "io",
    "methods",
    "models",
    "placement",
    "skinning",
    "tasks",
]
