"""Quality of retargeted movements by Pinocchio, equal for all contenders and without knowledge of their scales.

All errors are against the subject, not against targets of a contender.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio

# Foot contact: largest speed of the toe (m/s), window of the speed (s), and shortest duration (s).
STILL, OVER, SHORTEST = 0.1, 0.05, 0.2
# Limbs by the joints at their ends; then the lines across the hips and the shoulders.
LIMBS = {"thigh": ("UpLeg", "Leg"), "shin": ("Leg", "Foot"), "upper arm": ("Arm", "ForeArm"), "forearm": ("ForeArm", "Hand")}
LINES = {"hips": ("LeftUpLeg", "RightUpLeg"), "shoulders": ("LeftArm", "RightArm")}
# Ends of limbs, and the joints where these limbs begin and bend.
ENDS = {"Foot": ("UpLeg", "Leg"), "Hand": ("Arm", "ForeArm")}
SIDES = ("Left", "Right")
# Quantile of the angles of all limbs that is reported next to the mean.
MOST = 95
# The G1's axes of foot and hand links: x along foot and fingers, z up and to the thumb in the zero configuration.
FOOT_LINKS = {side: f"{side.lower()}_ankle_roll_link" for side in SIDES}
HAND_LINKS = {side: f"{side.lower()}_wrist_yaw_link" for side in SIDES}


@dataclass(frozen=True)
class Movement:
    """Result of a contender: x, y, z and quaternion w, x, y, z of the base, then joints by name; frames per second."""

    q: np.ndarray
    joints: list[str]
    fps: float


@dataclass(frozen=True)
class Subject:
    """Positions of a capture, (T, J, 3), metres with z up, and the names of its joints."""

    at: np.ndarray
    joints: list[str]

    def of(self, name: str) -> np.ndarray:
        return self.at[:, self.joints.index(name)]

    def __contains__(self, name: str) -> bool:
        return name in self.joints


class Judge:
    """A robot, with the links that are driven by the subject's joints."""

    def __init__(self, urdf: str, drives: dict[str, str]) -> None:
        self.model = pinocchio.buildModelFromUrdf(urdf, pinocchio.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.drives = drives
        links = list(drives.values()) + list(FOOT_LINKS.values()) + list(HAND_LINKS.values())
        self.ids = [self.model.getFrameId(link) for link in links]
        self.soles = sole_spheres(self.model, urdf, set(FOOT_LINKS.values()))

    def columns(self, joints: list[str]) -> list[int]:
        return [self.model.joints[self.model.getJointId(name)].idx_q for name in joints]

    def placements(self, movement: Movement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions (T, K, 3) and rotations (T, K, 3, 3) of the driven links and of feet and hands. The third array
        has the height of the lowest point of both soles (T), metres.
        """
        columns, whole = self.columns(movement.joints), pinocchio.neutral(self.model)
        at = np.empty((len(movement.q), len(self.ids), 3))
        turned = np.empty((len(movement.q), len(self.ids), 3, 3))
        lowest = np.empty(len(movement.q))
        for k, q in enumerate(movement.q):
            whole[:3], whole[3:6], whole[6] = q[:3], q[4:7], q[3]
            whole[columns] = q[7:7 + len(columns)]
            pinocchio.framesForwardKinematics(self.model, self.data, whole)
            at[k] = [self.data.oMf[frame].translation for frame in self.ids]
            turned[k] = [self.data.oMf[frame].rotation for frame in self.ids]
            lowest[k] = min(self.data.oMf[frame].act(centre)[2] - radius for frame, centre, radius in self.soles)
        return at, turned, lowest

    def measures(self, movement: Movement, subject: Subject, every: int) -> dict[str, float]:
        """Measures of a movement against the subject at its frames. Jerk is computed from every n-th frame
        (``every``), so that all movements have one rate.
        """
        at, turned, lowest = self.placements(movement)
        names, driven = list(self.drives), len(self.drives)
        robot = {name: at[:, k] for k, name in enumerate(names)}
        person = np.stack([subject.of(name) for name in names], axis=1)
        columns = self.columns(movement.joints)
        joints = movement.q[:, 7:7 + len(columns)]
        lower, upper = self.model.lowerPositionLimit[columns], self.model.upperPositionLimit[columns]
        velocity = [self.model.joints[self.model.getJointId(name)].idx_v for name in movement.joints]
        most = self.model.velocityLimit[velocity] / movement.fps
        angles = {f"{name} {side}": angle_between(robot[side + b] - robot[side + a], subject.of(side + b) - subject.of(side + a))
                  for name, (a, b) in LIMBS.items() for side in SIDES}
        angles |= {name: angle_between(robot[b] - robot[a], subject.of(b) - subject.of(a)) for name, (a, b) in LINES.items()}
        together = np.degrees(np.concatenate(list(angles.values())))
        feet = [turned[:, driven + k] for k in range(2)]
        hands = [turned[:, driven + 2 + k] for k in range(2)]
        slips = [slip for side in SIDES for slip in
                 slipped(robot[f"{side}ToeBase"], subject.of(f"{side}ToeBase"), movement.fps)]
        jerk = np.diff(joints[::every], 3, axis=0) * (movement.fps / every) ** 3
        found = {
            "off": 1e3 * fitted_apart(person, at[:, :driven]),
            "ends": 100 * float(np.mean([end_error(robot, subject, side, end) for side in SIDES for end in ENDS])),
            "limbs": float(together.mean()), "limbs most": float(np.percentile(together, MOST)),
            "feet": float(np.mean([foot_error(subject, side, foot) for side, foot in zip(SIDES, feet)])),
            "tilt": float(np.mean([contact_tilt(subject, side, foot, movement.fps) for side, foot in zip(SIDES, feet)])),
            "hands": float(np.mean([hand_error(subject, side, hand) for side, hand in zip(SIDES, hands)])),
            "slip": 1e3 * float(np.mean(slips)) if slips else 0.0, "worst slip": 1e3 * max(slips, default=0.0),
            "below": 1e3 * max(0.0, -float(lowest.min())), "below share": 100 * float((lowest < -0.01).mean()),
            "jerk": float(np.sqrt((jerk**2).mean())),
            "beyond": int(((joints < lower - 1e-9) | (joints > upper + 1e-9)).sum()),
            "fast": int((np.abs(np.diff(joints, axis=0)) > most * (1 + 1e-9)).sum()),
        }
        return found | {f"° {name}": float(np.degrees(angle.mean())) for name, angle in angles.items()}


def sole_spheres(model: pinocchio.Model, urdf: str, feet: set[str]) -> list[tuple[int, np.ndarray, float]]:
    """Collision spheres of the feet: frame, centre on the frame, radius, metres."""
    import xml.etree.ElementTree as ElementTree

    root = ElementTree.parse(urdf).getroot()
    parents = {joint.find("child").get("link"): joint.find("parent").get("link")
               for joint in root.iter("joint") if joint.get("type") == "fixed"}
    found = []
    for link in root.iter("link"):
        name = link.get("name")
        if name in feet or parents.get(name) in feet:
            for collision in link.iter("collision"):
                sphere = collision.find("geometry/sphere")
                if sphere is not None:
                    origin = collision.find("origin")
                    centre = [float(x) for x in origin.get("xyz", "0 0 0").split()] if origin is not None else [0.0] * 3
                    found.append((model.getFrameId(name), np.array(centre), float(sphere.get("radius"))))
    return found


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))


def fitted_apart(person: np.ndarray, robot: np.ndarray) -> float:
    """Mean distance after one scale and one shift of the whole movement."""
    p, r = person.reshape(-1, 3), robot.reshape(-1, 3)
    scale = ((p - p.mean(0)) * (r - r.mean(0))).sum() / ((p - p.mean(0)) ** 2).sum()
    return float(np.linalg.norm(r - r.mean(0) - scale * (p - p.mean(0)), axis=1).mean())


def end_error(robot: dict[str, np.ndarray], subject: Subject, side: str, end: str) -> float:
    """Mean distance of a hand or foot from the subject's, each relative to the start of its limb and its length."""
    start, middle = (side + name for name in ENDS[end])

    def relative(of) -> np.ndarray:
        lengths = [np.linalg.norm(of(b) - of(a), axis=1).mean() for a, b in ((start, middle), (middle, side + end))]
        return (of(side + end) - of(start)) / sum(lengths)

    return float(np.linalg.norm(relative(robot.__getitem__) - relative(subject.of), axis=1).mean())


def flat_slope(ankle: np.ndarray, toe: np.ndarray) -> float:
    """Slope in radians from ankle to toe while the foot is flat: the median over the slowest quarter of the frames."""
    moved = np.maximum(*[np.linalg.norm(np.diff(joint, axis=0), axis=1) for joint in (ankle, toe)])
    slowest = 1 + np.argsort(moved, kind="stable")[:max(1, int(np.ceil(0.25 * len(moved))))]
    return float(np.median(np.arcsin(np.clip(-unit(toe - ankle)[slowest, 2], -0.9, 0.9))))


def foot_error(subject: Subject, side: str, foot: np.ndarray) -> float:
    """Mean angle in degrees between the foot and the line from the subject's ankle to the toe, both parallel to the
    ground in contact.
    """
    ankle, toe = subject.of(f"{side}Foot"), subject.of(f"{side}ToeBase")
    slope = flat_slope(ankle, toe)
    along = unit(toe - ankle)
    across = unit(np.cross([0.0, 0.0, 1.0], along))
    level = np.cos(slope) * along + np.sin(slope) * np.cross(along, across)
    return float(np.degrees(angle_between(foot[..., 0], level).mean()))


def contact_tilt(subject: Subject, side: str, foot: np.ndarray, fps: float) -> float:
    """Mean angle in degrees of the sole from the horizontal while the subject's ankle and toe are both in contact."""
    spans = [contact_spans(subject.of(f"{side}{name}"), fps) for name in ("Foot", "ToeBase")]
    still = np.logical_and(*[np.isin(np.arange(len(foot)), np.concatenate([np.arange(s.start, s.stop) for s in each] or [[]]))
                             for each in spans])
    tilts = np.degrees(np.arccos(np.clip(foot[still, 2, 2], -1.0, 1.0)))
    return float(tilts.mean()) if len(tilts) else 0.0


def hand_error(subject: Subject, side: str, hand: np.ndarray) -> float:
    """Mean rotation in degrees between hand and subject's hand: fingers along x, thumb side along z."""
    if f"{side}HandMiddle1" not in subject:
        return 0.0
    along = unit(subject.of(f"{side}HandMiddle1") - subject.of(f"{side}Hand"))
    thumb = subject.of(f"{side}HandIndex1") - subject.of(f"{side}HandPinky1")
    thumb = unit(thumb - along * (along * thumb).sum(-1, keepdims=True))
    axes = np.stack([along, np.cross(thumb, along), thumb], axis=-1)
    trace = np.einsum("tij,tij->t", axes, hand)
    return float(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1.0, 1.0)).mean()))


def contact_spans(person: np.ndarray, fps: float) -> list[slice]:
    """Intervals in which a joint of the subject is at rest, without the window of the speed at both ends."""
    back = max(1, round(OVER * fps))
    speed = np.zeros(len(person))
    speed[back:] = np.linalg.norm(person[back:] - person[:-back], axis=1) * fps / back
    still = np.concatenate([[0], (speed < STILL).astype(int), [0]])
    edges = np.diff(still)
    spans = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1))
    return [slice(start + back, end - back) for start, end in spans if end - start >= SHORTEST * fps + 2 * back]


def slipped(toe: np.ndarray, person: np.ndarray, fps: float) -> list[float]:
    """Largest distance of a robot's toe from its mean position, in each contact interval of the subject's toe."""
    return [float(np.linalg.norm(toe[span] - toe[span].mean(0), axis=1).max()) for span in contact_spans(person, fps)]
