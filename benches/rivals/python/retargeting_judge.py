"""Quality of retargeted movements by Pinocchio, equal for all contenders and without knowledge of their scales."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio

# Foot contact: largest speed of the toe (m/s), window of the speed (s), and shortest duration (s).
STILL, OVER, SHORTEST = 0.1, 0.05, 0.2
# Bones by the joints at their ends; then the lines across the hips and the shoulders.
BONES = [(side + a, side + b) for side in ("Left", "Right") for a, b in
         (("UpLeg", "Leg"), ("Leg", "Foot"), ("Arm", "ForeArm"), ("ForeArm", "Hand"))]
BONES += [("LeftUpLeg", "RightUpLeg"), ("LeftArm", "RightArm")]


@dataclass(frozen=True)
class Movement:
    """Result of a contender: x, y, z and quaternion w, x, y, z of the base, then joints by name; frames per second."""

    q: np.ndarray
    joints: list[str]
    fps: float


class Judge:
    """A robot, with the links that are driven by the subject's joints."""

    def __init__(self, urdf: str, drives: dict[str, str]) -> None:
        self.model = pinocchio.buildModelFromUrdf(urdf, pinocchio.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.drives = drives
        self.ids = [self.model.getFrameId(link) for link in drives.values()]
        self.feet = [name for name in ("LeftToeBase", "RightToeBase") if name in drives]

    def columns(self, joints: list[str]) -> list[int]:
        return [self.model.joints[self.model.getJointId(name)].idx_q for name in joints]

    def places(self, movement: Movement) -> np.ndarray:
        """Positions of the driven links, shape (T, K, 3), metres."""
        columns, whole = self.columns(movement.joints), pinocchio.neutral(self.model)
        placed = np.empty((len(movement.q), len(self.ids), 3))
        for row, q in zip(placed, movement.q):
            whole[:3], whole[3:6], whole[6] = q[:3], q[4:7], q[3]
            whole[columns] = q[7:7 + len(columns)]
            pinocchio.framesForwardKinematics(self.model, self.data, whole)
            row[:] = [self.data.oMf[frame].translation for frame in self.ids]
        return placed

    def measures(self, movement: Movement, person: np.ndarray, every: int) -> dict[str, float]:
        """Measures of a movement. ``person`` has the positions of the driven joints, (T, K, 3), at its frames. Jerk
        is computed from every n-th frame (``every``), so that all movements have one rate.
        """
        at = self.places(movement)
        names = list(self.drives)
        columns = self.columns(movement.joints)
        joints = movement.q[:, 7:7 + len(columns)]
        lower, upper = self.model.lowerPositionLimit[columns], self.model.upperPositionLimit[columns]
        velocity = [self.model.joints[self.model.getJointId(name)].idx_v for name in movement.joints]
        most = self.model.velocityLimit[velocity] / movement.fps
        angles = [angle_between(at[:, names.index(a)] - at[:, names.index(b)],
                                person[:, names.index(a)] - person[:, names.index(b)])
                  for a, b in BONES if a in names and b in names]
        slips = [slip for foot in self.feet for slip in
                 slipped(at[:, names.index(foot)], person[:, names.index(foot)], movement.fps)]
        jerk = np.diff(joints[::every], 3, axis=0) * (movement.fps / every) ** 3
        return {
            "off": 1e3 * fitted_apart(person, at), "bones": float(np.degrees(np.mean(angles))),
            "slip": 1e3 * float(np.mean(slips)) if slips else 0.0, "worst slip": 1e3 * max(slips, default=0.0),
            "jerk": float(np.sqrt((jerk**2).mean())),
            "beyond": int(((joints < lower - 1e-9) | (joints > upper + 1e-9)).sum()),
            "fast": int((np.abs(np.diff(joints, axis=0)) > most * (1 + 1e-9)).sum()),
        }


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))


def fitted_apart(person: np.ndarray, robot: np.ndarray) -> float:
    """Mean distance after one scale and one shift of the whole movement."""
    p, r = person.reshape(-1, 3), robot.reshape(-1, 3)
    scale = ((p - p.mean(0)) * (r - r.mean(0))).sum() / ((p - p.mean(0)) ** 2).sum()
    return float(np.linalg.norm(r - r.mean(0) - scale * (p - p.mean(0)), axis=1).mean())


def slipped(toe: np.ndarray, person: np.ndarray, fps: float) -> list[float]:
    """Largest distance of a robot's toe from its mean position, in each contact interval of the subject's toe."""
    back = max(1, round(OVER * fps))
    speed = np.zeros(len(person))
    speed[back:] = np.linalg.norm(person[back:] - person[:-back], axis=1) * fps / back
    still = np.concatenate([[0], (speed < STILL).astype(int), [0]])
    edges = np.diff(still)
    spans = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1))
    # The window is removed at both ends, so that the foot has come to rest.
    inside = [slice(start + back, end - back) for start, end in spans if end - start >= SHORTEST * fps + 2 * back]
    return [float(np.linalg.norm(toe[span] - toe[span].mean(0), axis=1).max()) for span in inside]
