"""Kinematics with the interface of LeRobot, for use in place of ``lerobot.model.kinematics.RobotKinematics``.

It needs neither LeRobot nor placo. Joint positions are in degrees, poses are 4 x 4 in metres.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._kinopt import Arm, PoseBounds, Robot
from .errors import InvalidValueError, UnknownNameError
from .types import Floats, PlacementLike


class RobotKinematics:
    """Forward and inverse kinematics of an arm, with the arguments of LeRobot 0.6.

    ``urdf_path``: file of the robot. ``target_frame_name``: frame of the poses. ``joint_names``: joints of the
    positions, in their order; default the joints from the base to the frame, then all others. Joints from the base to
    the frame that are not in ``joint_names`` stay at 0. ``attempts``: starts of one query, at least 1. The default of 1
    stays on the branch of the current position, so that successive targets do not jump. More find far poses.

    Raises ``FileError`` and ``InvalidFileError`` for the file, ``UnknownNameError`` for unknown names.
    """

    def __init__(
        self,
        urdf_path: str | os.PathLike[str],
        target_frame_name: str = "gripper_frame_link",
        joint_names: Sequence[str] | None = None,
        *,
        attempts: int = 1,
    ) -> None:
        robot = Robot.from_urdf(urdf_path)
        chain = Arm(robot, None, target_frame_name, atlas=False).joint_names
        if joint_names is None:
            joint_names = [*chain, *(name for name in robot.joint_names if name not in chain)]
        unknown = [name for name in joint_names if name not in robot.joint_names]
        if unknown:
            raise UnknownNameError(f"no joint named `{unknown[0]}`; joints: {', '.join(robot.joint_names)}")
        self.joint_names: list[str] = list(joint_names)
        self.target_frame_name = target_frame_name
        self._robot = robot
        self._options: dict[str, Any] = {
            "attempts": attempts,
            "atlas": attempts > 1,
            "only": [name for name in chain if name in self.joint_names],
            "held": np.clip(0.0, robot.lower, robot.upper),
        }
        self._weights = (1.0, 0.01)
        self._arm = self._weighted(*self._weights)
        # Places of the arm's joints in the positions.
        self._places = [self.joint_names.index(name) for name in self._arm.joint_names]

    def forward_kinematics(self, joint_pos_deg: ArrayLike) -> Floats:
        """Pose of the target frame in the frame of the robot's root, 4 x 4, at positions in degrees.

        Positions after those of ``joint_names`` are ignored. Raises ``InvalidValueError`` for fewer positions.
        """
        return self._arm.base_from_tool(self._radians(np.asarray(joint_pos_deg)))

    def inverse_kinematics(
        self,
        current_joint_pos: ArrayLike,
        desired_ee_pose: PlacementLike,
        position_weight: float = 1.0,
        orientation_weight: float = 0.01,
    ) -> NDArray[Any]:
        """Positions in degrees that bring the target frame to ``desired_ee_pose``, within the joint limits.

        If no position reaches the pose, the result minimises ``position_weight`` times the squared distance (m²) plus
        ``orientation_weight`` times the squared angle (rad²), locally. A weight of 0 leaves position or orientation
        free. Positions of other joints are those of ``current_joint_pos``, also after those of ``joint_names``.

        Raises ``InvalidValueError`` for fewer positions, NaN, a pose that is not rigid, and invalid weights.
        """
        weights = (float(position_weight), float(orientation_weight))
        if weights != self._weights:
            self._arm, self._weights = self._weighted(*weights), weights
        current = np.asarray(current_joint_pos)
        start = self._radians(current)
        result = np.array(current, dtype=current.dtype if len(current) > len(self.joint_names) else float)
        result[self._places] = np.rad2deg(self._arm.solve(desired_ee_pose, start).q)
        return result

    def _radians(self, positions: NDArray[Any]) -> Floats:
        """Positions of the arm's joints, in radians."""
        if positions.ndim != 1 or len(positions) < len(self.joint_names):
            raise InvalidValueError(
                f"joint positions must have shape ({len(self.joint_names)},) or longer, not {positions.shape}"
            )
        radians: Floats = np.deg2rad(positions[self._places].astype(float))
        return radians

    def _weighted(self, position: float, orientation: float) -> Arm:
        if not (0.0 <= position < np.inf and 0.0 <= orientation < np.inf and position + orientation > 0.0):
            raise InvalidValueError(
                f"position_weight {position} and orientation_weight {orientation} must be at least 0, and not both 0"
            )
        options = dict(self._options)
        if orientation == 0.0:
            options["goal"] = PoseBounds.position()
        elif position == 0.0:
            options["goal"] = PoseBounds.within([np.inf] * 3 + [0.0] * 3)
        else:
            options["metres_per_radian"] = np.sqrt(orientation / position)
        return Arm(self._robot, None, self.target_frame_name, **options)


__all__ = ["RobotKinematics"]
