"""Reference kinematics: robots by Pinocchio, rigs by CasADi's expressions and their derivatives."""

import xml.etree.ElementTree as xml

import casadi as ca
import numpy as np
import pinocchio as pin

from expression import angular_velocity, axes_of
from models import REPOSITORY, read

SEED = 20261121
CONFIGURATIONS = 3
ROBOTS = [
    "models/adept_cobra_s600.urdf",
    "models/aldebaran_nao.urdf",
    "models/franka_panda.urdf",
    "models/kuka_iiwa14.urdf",
    "models/rethink_baxter.urdf",
    "models/universal_ur10e.urdf",
    "models/universal_ur5e.urdf",
    "tests/reference/oblique.urdf",
    "models/robotstudio_so101.urdf",
]
RIGS = ["humanoid", "robot-arm"]


def listed(array):
    return [float(v) for v in np.asarray(array).ravel()]


class Robot:
    """A URDF as read by Pinocchio, addressed by the names of its joints and links."""

    def __init__(self, file):
        self.file = file
        self.model = pin.buildModelFromUrdf(str(REPOSITORY / file), mimic=True)
        self.data = self.model.createData()
        joints = xml.parse(REPOSITORY / file).getroot().findall("joint")
        # Joints in the order of the file, as in the library's configurations.
        self.moving = [j.get("name") for j in joints if j.get("type") != "fixed"]
        self.mimics = {
            j.get("name"): (m.get("joint"), float(m.get("multiplier", 1)), float(m.get("offset", 0)))
            for j in joints
            if (m := j.find("mimic")) is not None
        }
        self.variables = [name for name in self.moving if name not in self.mimics]
        parents = {j.find("parent").get("link") for j in joints}
        self.tips = [j.find("child").get("link") for j in joints if j.find("child").get("link") not in parents]

    def joint(self, name):
        return self.model.joints[self.model.getJointId(name)]

    def sample(self, rng):
        """Random values by joint name within the limits; mimic joints are set explicitly."""
        values = {}
        for name in self.variables:
            joint = self.joint(name)
            if joint.nq == 2:  # continuous: cosine and sine
                values[name] = rng.uniform(-4.0, 4.0)
            else:
                low, high = (limit[joint.idx_q] for limit in (self.model.lowerPositionLimit, self.model.upperPositionLimit))
                values[name] = rng.uniform(low, high)
        for name, (leader, ratio, offset) in self.mimics.items():
            values[name] = ratio * values[leader] + offset
        return values

    def configuration(self, values):
        q = pin.neutral(self.model)
        for name in self.variables:
            joint, value = self.joint(name), values[name]
            q[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
        return q

    def links(self, values):
        """x, y, z and quaternion w, x, y, z of every link."""
        pin.framesForwardKinematics(self.model, self.data, self.configuration(values))
        links = {}
        for index, frame in enumerate(self.model.frames):
            if frame.type == pin.FrameType.BODY:
                at = self.data.oMf[index]
                x, y, z, w = pin.Quaternion(at.rotation).coeffs()
                links[frame.name] = [float(v) for v in (*at.translation, w, x, y, z)]
        return links

    def placement(self, link, values):
        pin.framesForwardKinematics(self.model, self.data, self.configuration(values))
        return self.data.oMf[self.model.getFrameId(link, pin.FrameType.BODY)].homogeneous

    def jacobian(self, link, values):
        """6 × variables: linear, then angular velocity, in world axes at the link's origin."""
        frame = self.model.getFrameId(link, pin.FrameType.BODY)
        q = self.configuration(values)
        columns = pin.computeFrameJacobian(self.model, self.data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        return columns[:, [self.joint(name).idx_v for name in self.variables]]


def robots():
    """Fixture entries: placements of all links, and Jacobians of the tips, at random configurations."""
    rng = np.random.default_rng(SEED)
    placements, jacobians = [], []
    for file in ROBOTS:
        robot = Robot(file)
        samples = [robot.sample(rng) for _ in range(CONFIGURATIONS)]
        q = [[values[name] for name in robot.moving] for values in samples]
        placements.append({"file": file, "joints": robot.moving, "cases": [
            {"q": q, "links": robot.links(values)} for q, values in zip(q, samples)]})
        jacobians.append({"file": file, "variables": robot.variables, "cases": [
            {"q": q, "jacobians": {tip: [listed(row) for row in robot.jacobian(tip, values)] for tip in robot.tips}}
            for q, values in zip(q, samples)]})
    return placements, jacobians


class RigDerivatives:
    """A rig's placements and Jacobians of its tips, and the cost, gradient and Hessian of reaching with them."""

    def __init__(self, name):
        self.rig = rig = read(name)
        self.tips = {"humanoid": ["head", "left_hand", "right_hand", "left_foot", "right_foot"]}.get(name, ["gripper"])
        self.tips = [f"{bone}/tip" for bone in self.tips]
        x, names = rig.x, list(rig.frames)
        self.placements = ca.Function("placements", [x], [rig.frames[frame] for frame in names], ["x"], names_of(names))
        self.names = names
        twists = [ca.vertcat(ca.jacobian(rig.frames[tip][:3, 3], x), angular_velocity(rig.frames[tip][:3, :3], x))
                  for tip in self.tips]
        self.jacobians = ca.Function("jacobians", [x], twists)
        targets = ca.SX.sym("targets", 3, len(self.tips))
        miss = ca.horzcat(*(rig.frames[tip][:3, 3] for tip in self.tips)) - targets
        cost = ca.sumsqr(miss) / 2
        hessian, gradient = ca.hessian(cost, x)
        self.reaching = ca.Function("reaching", [x, targets], [cost, gradient, hessian])

    def case(self, x, targets):
        placed = self.placements(x)
        jacobians = self.jacobians(x)
        cost, gradient, hessian = self.reaching(x, targets)
        return {
            "x": listed(x),
            "frames": {name: axes_of(np.array(at)) for name, at in zip(self.names, placed)},
            "jacobians": {tip: [listed(row) for row in np.array(J)] for tip, J in zip(self.tips, as_list(jacobians))},
            "targets": [listed(column) for column in np.array(targets).T],
            "cost": float(cost),
            "gradient": listed(gradient),
            "hessian": [listed(row) for row in np.array(hessian)],
        }


def names_of(frames):
    return [f"frame{k}" for k in range(len(frames))]


def as_list(value):
    return value if isinstance(value, (list, tuple)) else [value]


def rigs():
    """Fixture entries: the rest pose, which is singular, and random configurations."""
    entries = []
    for number, name in enumerate(RIGS):
        rng = np.random.default_rng([SEED, number])
        derivatives = RigDerivatives(name)
        rig = derivatives.rig
        configurations = [rig.rest()] + [rig.sample(rng) for _ in range(CONFIGURATIONS - 1)]
        cases = []
        for x in configurations:
            other = derivatives.placements(rig.sample(rng))
            at = dict(zip(derivatives.names, other))
            targets = np.array([np.array(at[tip])[:3, 3] for tip in derivatives.tips]).T
            cases.append(derivatives.case(x, targets))
        entries.append({"file": rig.file, "variables": rig.variables, "cases": cases})
    return entries
