"""The shipped rigs and robots, read from their files and expressed in CasADi.

A `Model` has the variables x, their bounds, and the placement of every frame as an expression of x. The variables
are all moving joints without mimic joints, in the order of the file.
"""

import json
import pathlib
import xml.etree.ElementTree as xml
from dataclasses import dataclass

import casadi as ca
import numpy as np

from expression import about, about_x, about_z, inverse, rigid

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
FILES = {
    "humanoid": "models/humanoid/humanoid.json",
    "robot-arm": "models/robot-arm/robot-arm.json",
    "panda": "models/franka_panda.urdf",
    "ur5e": "models/universal_ur5e.urdf",
    "iiwa14": "models/kuka_iiwa14.urdf",
    "nao": "models/aldebaran_nao.urdf",
    "baxter": "models/rethink_baxter.urdf",
    "oblique": "tests/reference/oblique.urdf",
}


@dataclass
class Model:
    name: str
    file: str
    x: ca.SX
    variables: list
    lower: np.ndarray
    upper: np.ndarray
    frames: dict
    is_rig: bool

    def sample(self, rng, share=1.0):
        """Uniform sample in the middle fraction `share` of the bounds; within ±π without bounds."""
        low = np.where(np.isfinite(self.lower), self.lower, -np.pi)
        high = np.where(np.isfinite(self.upper), self.upper, np.pi)
        middle, half = (low + high) / 2, (high - low) / 2
        return rng.uniform(middle - share * half, middle + share * half)

    def rest(self):
        return np.clip(np.zeros(len(self.variables)), self.lower, self.upper)

    def place(self, frame, x):
        function = ca.Function("place", [self.x], [self.frames[frame]])
        return np.array(function(x))


def read(name):
    file = FILES[name]
    return (read_rig if file.endswith(".json") else read_robot)(name, file)


def read_rig(name, file):
    """T_i = T_parent R_i Rx(t3) Rz(t2) Rx(t1) R_i^-1 with the rest placement R_i, angles (t1, t2, t3)."""
    bones = json.loads((REPOSITORY / file).read_text())["bones"]
    symbols, variables, lower, upper = [], [], [], []
    moved, frames = [], {}
    for bone in bones:
        angles = []
        for part, low, high in zip(("twist1", "bend", "twist2"), bone["xzx_min"], bone["xzx_max"]):
            low, high = low * (np.pi / 180), high * (np.pi / 180)
            if low == high:
                angles.append(low)
                continue
            variables.append(f"{bone['name']}/{part}")
            symbols.append(ca.SX.sym(variables[-1]))
            angles.append(symbols[-1])
            lower.append(low)
            upper.append(high)
        rest = ca.SX(np.array(bone["rest_T"]))
        first, bend, second = angles
        parent = moved[bone["parent_id"]] if bone["parent_id"] >= 0 else ca.SX.eye(4)
        turned = rest @ about_x(second) @ about_z(bend) @ about_x(first)
        moved.append(parent @ turned @ inverse(rest))
        posed = moved[-1] @ rest
        frames[bone["name"]] = posed
        frames[f"{bone['name']}/tip"] = posed @ rigid(ca.SX.eye(3), ca.SX([bone["length"], 0, 0]))
    x = ca.vertcat(*symbols)
    return Model(name, file, x, variables, np.array(lower), np.array(upper), frames, True)


def numbers(text, default):
    return np.array([float(v) for v in text.split()] if text else default)


def placement_of(element):
    if element is None:
        return ca.SX.eye(4)
    roll, pitch, yaw = numbers(element.get("rpy"), [0, 0, 0])
    turn = about([0, 0, 1], yaw) @ about([0, 1, 0], pitch) @ about([1, 0, 0], roll)
    return rigid(turn[:3, :3], ca.SX(numbers(element.get("xyz"), [0, 0, 0])))


def read_robot(name, file):
    """A URDF: each joint is its origin, then a rotation about or a translation along its normalised axis."""
    joints = xml.parse(REPOSITORY / file).getroot().findall("joint")
    values, symbols, variables, lower, upper = {}, [], [], [], []
    moving = [j for j in joints if j.get("type") != "fixed"]
    for joint in moving:
        if joint.find("mimic") is None:
            variables.append(joint.get("name"))
            values[variables[-1]] = ca.SX.sym(variables[-1])
            symbols.append(values[variables[-1]])
            limit = joint.find("limit")
            free = joint.get("type") == "continuous"
            lower.append(-np.inf if free else float(limit.get("lower", 0)))
            upper.append(np.inf if free else float(limit.get("upper", 0)))
    for joint in moving:
        if (mimic := joint.find("mimic")) is not None:
            ratio, offset = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
            values[joint.get("name")] = ratio * values[mimic.get("joint")] + offset
            # The limits of a mimic joint bound its source joint.
            if joint.get("type") != "continuous":
                limit, k = joint.find("limit"), variables.index(mimic.get("joint"))
                ends = [(float(limit.get(end, 0)) - offset) / ratio for end in ("lower", "upper")]
                lower[k], upper[k] = max(lower[k], min(ends)), min(upper[k], max(ends))

    into = {joint.find("child").get("link"): joint for joint in joints}
    frames = {}

    def place(link):
        if link not in frames:
            joint = into.get(link)
            frames[link] = ca.SX.eye(4) if joint is None else place(joint.find("parent").get("link")) @ step(joint)
        return frames[link]

    def step(joint):
        origin = placement_of(joint.find("origin"))
        if joint.get("type") == "fixed":
            return origin
        element = joint.find("axis")
        axis = numbers(element.get("xyz") if element is not None else None, [1, 0, 0])
        axis = axis / np.linalg.norm(axis)
        value = values[joint.get("name")]
        if joint.get("type") == "prismatic":
            return origin @ rigid(ca.SX.eye(3), ca.SX(axis) * value)
        return origin @ about(axis, value)

    for joint in joints:
        place(joint.find("child").get("link"))
    x = ca.vertcat(*symbols)
    return Model(name, file, x, variables, np.array(lower), np.array(upper), frames, False)
