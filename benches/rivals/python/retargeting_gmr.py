"""GMR's loop on mink and DAQP, frame by frame (Ze et al. 2025, "GMR: General Motion Retargeting", arXiv 2510.02252).

The tables are from one of its configurations: the link of each body in both stages, with weights, offsets and
scales.

GMR reads captures with rotations. Position arrays have none, so the body rotations are computed from the bones
and the planes in which knees and elbows bend. Their axes are those from which the configuration's offsets lead to
the robot's links.
"""

from __future__ import annotations

import json
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mink
import mujoco
import numpy as np
from retargeting_judge import flat_slope
from scipy.spatial.transform import Rotation

# Settings of GMR's program.
MOST_STEPS, LEAST_GAIN, DAMPING, TASK_DAMPING, HEIGHT = 10, 0.001, 0.5, 1.0, 1.75


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def frame(*, x: np.ndarray | None = None, z: np.ndarray | None = None, y: np.ndarray) -> np.ndarray:
    """Axes with x or z along a bone, and y as close to the given one as possible."""
    along = unit(x if z is None else z)
    y = unit(y - along * (along * y).sum(-1, keepdims=True))
    other = np.cross(y, along) if z is not None else np.cross(along, y)
    return np.stack([other, y, along] if z is not None else [along, y, other], axis=-1)


def least_turn(axis: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Rotates ``axis`` by the shortest arc from ``start`` to ``end``."""
    cross, cosine = np.cross(start, end), (start * end).sum(-1, keepdims=True)
    return axis + np.cross(cross, axis) + np.cross(cross, np.cross(cross, axis)) / np.maximum(1 + cosine, 1e-3)


def body_frames(joints: list[str], at: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Position and rotation of each body, frame by frame: (T, 3) and (T, 3, 3), in metres with z up."""
    place = {name: at[:, k] for k, name in enumerate(joints)}
    chest = next(place[name] for name in ("Spine2", "Spine1", "Spine") if name in place)
    left_hip = place["LeftUpLeg"] - place["RightUpLeg"]
    left_chest = place["LeftArm"] - place["RightArm"]
    middle = 0.5 * (place["LeftUpLeg"] + place["RightUpLeg"])
    torso = frame(z=0.5 * (place["LeftArm"] + place["RightArm"]) - chest, y=left_chest)
    found = {"Hips": (place["Hips"], frame(z=chest - middle, y=left_hip)), "Spine2": (chest, torso)}
    for side in ("Left", "Right"):
        hip, knee, ankle, toe = (place[side + name] for name in ("UpLeg", "Leg", "Foot", "ToeBase"))
        shoulder, elbow, hand = (place[side + name] for name in ("Arm", "ForeArm", "Hand"))
        # A straight leg bends about the hips' line; a straight arm bends as it does when it hangs from the chest.
        bend = np.cross(unit(knee - hip), unit(ankle - knee)) + 0.1 * unit(left_hip)
        thigh, shin = frame(z=hip - knee, y=bend), frame(z=knee - ankle, y=bend)
        slope = flat_slope(ankle, toe)
        raw = frame(x=toe - ankle, y=shin[..., 1])
        sole = np.cos(slope) * raw[..., 0] + np.sin(slope) * raw[..., 2]
        upper, lower = unit(elbow - shoulder), unit(hand - elbow)
        hangs = least_turn(torso[..., 1], -torso[..., 2], upper)
        flex = np.cross(lower, upper) + 0.1 * hangs
        forearm = frame(x=hand - elbow, y=flex)
        palm = forearm
        if f"{side}HandMiddle1" in place:
            # The axis from the thumb's side to the little finger's is that about which the forearm's y axis bends.
            along = place[f"{side}HandMiddle1"] - hand
            thumb = place[f"{side}HandIndex1"] - place[f"{side}HandPinky1"]
            palm = frame(x=along, y=np.cross(thumb, along))
        found |= {
            f"{side}UpLeg": (hip, thigh), f"{side}Leg": (knee, shin),
            f"{side}FootMod": (ankle, frame(x=sole, y=raw[..., 1])), f"{side}Arm": (shoulder, frame(z=-upper, y=flex)),
            f"{side}ForeArm": (elbow, forearm), f"{side}Hand": (hand, palm),
        }
    return found


def kinematics_of(file: Path) -> mujoco.MjModel:
    """A robot's MJCF without its shapes, which the loop does not use."""
    tree = ElementTree.parse(file)
    for parent in list(tree.iter()):
        for child in list(parent):
            if child.tag in ("asset", "sensor", "actuator", "contact", "geom", "light"):
                parent.remove(child)
    return mujoco.MjModel.from_xml_string(ElementTree.tostring(tree.getroot(), encoding="unicode"))


class Loop:
    """GMR's two stages for one robot and one configuration."""

    def __init__(self, model: Path, configuration: Path, height: float = HEIGHT) -> None:
        told = json.loads(configuration.read_text())
        ratio = height / told["human_height_assumption"]
        self.scales = {name: ratio * scale for name, scale in told["human_scale_table"].items()}
        self.root = told["human_root_name"]
        self.ground = told["ground_height"] * np.array([0.0, 0.0, 1.0])
        self.model = kinematics_of(model)
        self.robot = mink.Configuration(self.model)
        self.offsets: dict[str, tuple[np.ndarray, Rotation]] = {}
        self.stages = [self._tasks(told[f"ik_match_table{k}"]) for k in (1, 2) if told[f"use_ik_match_table{k}"]]
        self.steps = 0

    def _tasks(self, table: dict) -> list[tuple[str, mink.FrameTask]]:
        tasks = []
        for link, (body, position, rotation, offset, turn) in table.items():
            if position or rotation:
                task = mink.FrameTask(frame_name=link, frame_type="body", position_cost=position,
                                      orientation_cost=rotation, lm_damping=TASK_DAMPING)
                self.offsets.setdefault(body, (np.array(offset) - self.ground, Rotation.from_quat(turn, scalar_first=True)))
                tasks.append((body, task))
        return tasks

    def _error(self, stage: list) -> float:
        return float(np.linalg.norm(np.concatenate([task.compute_error(self.robot) for _, task in stage])))

    def _step(self, stage: list) -> float:
        dt = self.model.opt.timestep
        velocity = mink.solve_ik(self.robot, [task for _, task in stage], dt, "daqp", DAMPING)
        self.robot.integrate_inplace(velocity, dt)
        self.steps += 1
        return self._error(stage)

    def advance(self, bodies: dict[str, tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
        """Solves one frame: targets are scaled about the root, then both stages run until their gain is small."""
        root, placed = bodies[self.root][0], {}
        for body, (offset, turn) in self.offsets.items():
            at, quaternion = bodies[body]
            scaled = self.scales[self.root] * root + (self.scales[body] * (at - root) if body != self.root else 0.0)
            turned = Rotation.from_quat(quaternion, scalar_first=True) * turn
            quaternion = turned.as_quat(scalar_first=True)
            placed[body] = scaled + Rotation.from_quat(quaternion, scalar_first=True).apply(offset), quaternion
        for stage in self.stages:
            for body, task in stage:
                at, quaternion = placed[body]
                task.set_target(mink.SE3.from_rotation_and_translation(mink.SO3(quaternion), at))
        for stage in self.stages:
            before, now, steps = self._error(stage), self._step(stage), 0
            while before - now > LEAST_GAIN and steps < MOST_STEPS:
                before, now, steps = now, self._step(stage), steps + 1
        return self.robot.data.qpos.copy()

    def joints(self) -> list[str]:
        """Names of the hinges, in the order of the configuration after the seven values of the base."""
        hinges = range(1, self.model.njnt)
        return [mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_JOINT, k) for k in hinges]

    def retarget(self, joints: list[str], at: np.ndarray) -> tuple[np.ndarray, float]:
        """Configurations, and the processor time of the loop alone."""
        bodies = {}
        for body, (places, turns) in body_frames(joints, at).items():
            if body in self.offsets:
                captured = Rotation.from_matrix(turns) * self.offsets[body][1].inv()
                bodies[body] = places, captured.as_quat(scalar_first=True)
        frames = [{name: (p[k], r[k]) for name, (p, r) in bodies.items()} for k in range(len(at))]
        begun = time.process_time()
        q = np.array([self.advance(own) for own in frames])
        return q, time.process_time() - begun
