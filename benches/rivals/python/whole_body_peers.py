"""Whole-body solvers of other projects, each as ``solve(q, targets, deadline)`` on Pinocchio's configurations.

All run until every frame is within the tolerance and the centre of mass within the support polygon. A descent
that has not halved its error for PATIENCE steps restarts from sampled joints within the limits, until the
deadline. pink and mink have no support polygon: it is a limit on the step, written as their documentation shows.
"""

from __future__ import annotations

import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mink
import mujoco
import numpy as np
import pink
import pinocchio as pin
import placo

PATIENCE = 15
STEPS = 200


class Body:
    """The robot on a free base in Pinocchio, and its tasks."""

    def __init__(self, urdf: Path, document: dict, tolerance: float) -> None:
        self.model = pin.buildModelFromUrdf(str(urdf), pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.urdf, self.tolerance = urdf, tolerance
        self.places = [self.model.joints[self.model.getJointId(name)].idx_q for name in document["joints"]]
        self.joints = document["joints"]
        self.lower, self.upper = self.model.lowerPositionLimit[7:], self.model.upperPositionLimit[7:]
        self.frames = [name for name, _ in document["feet"]] + document["hands"]
        self.ids = [self.model.getFrameId(name) for name in self.frames]
        self.edges, self.reach, self.corners = half_planes(np.array(document["support"])[:, :2])
        self.feet = [np.array(at) for _, at in document["feet"]]

    def configuration(self, q: list[float]) -> np.ndarray:
        """Converts kinopt's order: the quaternion's w comes last, and joints are in Pinocchio's order."""
        own = np.zeros(self.model.nq)
        own[:3], own[3:6], own[6] = q[:3], q[4:7], q[3]
        own[self.places] = q[7:]
        return own

    def clipped(self, q: np.ndarray) -> np.ndarray:
        q[7:] = np.clip(q[7:], self.lower, self.upper)
        return q

    def drawn(self, start: np.ndarray, random: np.random.Generator) -> np.ndarray:
        return np.concatenate([start[:7], random.uniform(self.lower, self.upper)])

    def errors(self, q: np.ndarray, targets: list[np.ndarray]) -> tuple[float, float, float]:
        """Largest distance and angle of a frame, and distance of the centre of mass outside the support polygon."""
        pin.framesForwardKinematics(self.model, self.data, q)
        distance = angle = 0.0
        for frame, target in zip(self.ids, targets):
            found = self.data.oMf[frame]
            distance = max(distance, np.linalg.norm(found.translation - target[:3, 3]))
            angle = max(angle, np.linalg.norm(pin.log3(target[:3, :3].T @ found.rotation)))
        centre = pin.centerOfMass(self.model, self.data, q)[:2]
        return distance, angle, max(0.0, (self.edges @ centre - self.reach).max())


def half_planes(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Convex hull as A c <= b with unit rows, and its corners counter-clockwise."""
    points = points[np.lexsort((points[:, 1], points[:, 0]))]

    def chain(points):
        kept = []
        for p in points:
            while len(kept) > 1 and np.linalg.det([kept[-1] - kept[-2], p - kept[-2]]) <= 0.0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    corners = np.array(chain(points) + chain(points[::-1]))
    ways = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([ways[:, 1], -ways[:, 0]]) / np.linalg.norm(ways, axis=1)[:, None]
    return normals, (normals * corners).sum(axis=1), corners


def descend(body: Body, start, targets, deadline, begin, step, error):
    """Runs steps, the stall test and restarts, equally for all solvers. ``step`` raises if it has no result."""
    random = np.random.default_rng(7)
    q = body.clipped(start.copy())
    while True:
        begin(q, targets)
        halved, waited = np.inf, 0
        for _ in range(STEPS):
            worst = error()
            if worst <= body.tolerance:
                return True
            halved, waited = (worst, 0) if worst < 0.5 * halved else (halved, waited + 1)
            if waited > PATIENCE or time.process_time() > deadline:
                break
            try:
                step()
            except Exception:  # The quadratic programme has no solution.
                break
        if time.process_time() > deadline:
            return False
        q = body.drawn(start, random)


class Pink:
    """pink: differential steps by a quadratic programme (DAQP), with limits as inequalities."""

    def __init__(self, body: Body) -> None:
        outer = self.body = body
        self.tasks = [pink.tasks.FrameTask(name, 1.0, 0.5, lm_damping=1e-2) for name in body.frames]

        class Polygon(pink.limits.Limit):
            def compute_qp_inequalities(self, configuration, dt):
                jacobian = pin.jacobianCenterOfMass(outer.model, configuration.data, configuration.q)
                centre = configuration.data.com[0][:2]
                return outer.edges @ jacobian[:2], outer.reach - outer.edges @ centre

        self.limits = [pink.limits.ConfigurationLimit(body.model, config_limit_gain=1.0), Polygon()]

    def solve(self, start, targets, deadline):
        body = self.body

        def begin(q, targets):
            self.configuration = pink.Configuration(body.model, body.data, q)
            for task, target in zip(self.tasks, targets):
                task.set_target(pin.SE3(target))

        def error():
            # The quadratic programme keeps limits up to rounding.
            return max(body.errors(self.configuration.q, targets))

        def step():
            velocity = pink.solve_ik(
                self.configuration, self.tasks, 1.0, "daqp", 1e-9, self.limits, safety_break=False
            )
            q = self.configuration.integrate(velocity, 1.0)
            self.configuration = pink.Configuration(body.model, body.data, body.clipped(q))

        return self.configuration.q if descend(body, start, targets, deadline, begin, step, error) else None


class Mink:
    """mink: differential steps as in pink, on MuJoCo's kinematics."""

    def __init__(self, body: Body) -> None:
        outer = self.body = body
        root = ElementTree.parse(body.urdf).getroot()
        for link in root.iter("link"):
            for shape in link.findall("visual") + link.findall("collision"):
                link.remove(shape)
        compiler = ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler")
        compiler.attrib.update(fusestatic="false", balanceinertia="true", strippath="false")
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
        spec.worldbody.first_body().add_freejoint()
        self.model = spec.compile()
        names = body.model.names[2:]
        joint = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        self.places = [self.model.jnt_qposadr[k] for k in joint]
        self.tasks = [mink.FrameTask(name, "body", 1.0, 0.5, lm_damping=1e-2) for name in body.frames]

        class Polygon(mink.Limit):
            def compute_qp_inequalities(self, configuration, dt):
                jacobian = np.empty((3, configuration.nv))
                mujoco.mj_jacSubtreeCom(configuration.model, configuration.data, jacobian, 1)
                centre = configuration.data.subtree_com[1][:2]
                return mink.Constraint(outer.edges @ jacobian[:2], outer.reach - outer.edges @ centre)

        self.limits = [mink.ConfigurationLimit(self.model, gain=1.0), Polygon()]

    def solve(self, start, targets, deadline):
        body = self.body

        def begin(q, targets):
            own = np.zeros(self.model.nq)
            own[:3], own[3], own[4:7], own[self.places] = q[:3], q[6], q[3:6], q[7:]
            self.configuration = mink.Configuration(self.model, own)
            for task, target in zip(self.tasks, targets):
                task.set_target(mink.SE3.from_matrix(target))

        def here():
            own = self.configuration.q
            return np.concatenate([own[:3], own[4:7], own[3:4], own[self.places]])

        def error():
            return max(body.errors(here(), targets))

        def step():
            velocity = mink.solve_ik(self.configuration, self.tasks, 1.0, "daqp", 1e-9, limits=self.limits)
            own = self.configuration.integrate(velocity, 1.0)
            own[self.places] = np.clip(own[self.places], body.lower, body.upper)
            self.configuration.update(own)

        return here() if descend(body, start, targets, deadline, begin, step, error) else None


class Placo:
    """placo: quadratic programmes in C++ (eiquadprog), with joint limits and placo's support polygon."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self.robot = placo.RobotWrapper(str(body.urdf), placo.Flags.ignore_collisions)
        self.solver = placo.KinematicsSolver(self.robot)
        self.tasks = [self.solver.add_frame_task(name, np.eye(4)) for name in body.frames]
        for name, task in zip(body.frames, self.tasks):
            task.configure(name, "soft", 1.0, 0.5)
        # Clockwise, as placo's documentation requires.
        self.solver.add_com_polygon_constraint(list(body.corners[::-1]), 0.0).configure("balance", "hard")
        self.solver.enable_joint_limits(True)
        self.solver.add_regularization_task(1e-6)

    def solve(self, start, targets, deadline):
        def begin(q, targets):
            self.robot.state.q = q
            self.robot.update_kinematics()
            for task, target in zip(self.tasks, targets):
                task.T_world_frame = target

        def error():
            return max(self.body.errors(self.robot.state.q, targets))

        def step():
            self.solver.solve(True)
            self.robot.update_kinematics()

        solved = descend(self.body, start, targets, deadline, begin, step, error)
        return self.robot.state.q.copy() if solved else None


class Loop:
    """Loop over Pinocchio: damped least squares with a damping that falls with the error (Sugihara 2011).

    Joints are clamped to their limits. If the centre of mass is outside the polygon, its distance adds a row per
    edge.
    """

    def __init__(self, body: Body) -> None:
        self.body = body

    def solve(self, start, targets, deadline):
        body = self.body
        model, data = body.model, body.data
        goals = [pin.SE3(target) for target in targets]

        def begin(q, _):
            self.q = q

        def error():
            pin.computeJointJacobians(model, data, self.q)
            pin.updateFramePlacements(model, data)
            ways = [data.oMf[frame].actInv(goal) for frame, goal in zip(body.ids, goals)]
            self.rows = [pin.log6(way).vector for way in ways]
            self.slopes = [
                pin.Jlog6(way.inverse()) @ pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL)
                for way, frame in zip(ways, body.ids)
            ]
            slope = pin.jacobianCenterOfMass(model, data, self.q)[:2]
            outside = body.edges @ data.com[0][:2] - body.reach
            for edge in np.flatnonzero(outside > 0.0):
                self.rows.append(-outside[edge : edge + 1])
                self.slopes.append(body.edges[edge : edge + 1] @ slope)
            return max(max(np.linalg.norm(row[:3]), np.linalg.norm(row[3:])) for row in self.rows)

        def step():
            rows, slopes = np.concatenate(self.rows), np.vstack(self.slopes)
            damped = slopes @ slopes.T + (1e-2 * rows @ rows + 1e-12) * np.eye(len(rows))
            self.q = body.clipped(pin.integrate(model, self.q, slopes.T @ np.linalg.solve(damped, rows)))

        return self.q if descend(body, start, targets, deadline, begin, step, error) else None


PEERS = {"pink": Pink, "mink": Mink, "placo": Placo, "a loop over Pinocchio": Loop}
