"""Writes tests/reference/loops.json: least squares with unreachable targets, on mechanisms with closed loops.

Every mechanism is defined here by its geometry: rods as distances, pins as equal points, two hands as equal
placements. IPOPT minimises with these equality constraints from random starts. A result counts if the first- and
second-order conditions hold. `notebooks-ref/run` runs this script.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
import scipy.linalg
from scipy.spatial.transform import Rotation

import fixtures
from expression import about, inverse, rigid, rotation_vector
from minima import NO_COST, SAME_COST
from models import read
from tools import IPOPT

SEED = 20261122
STARTS = 16
# Tolerances of the first-order conditions, of the constraints, and of the curvature in the directions that they leave
# free.
STATIONARY, CLOSED, CURVED = 1e-8, 1e-11, -1e-8
# Distance at which a constraint or variable counts as on its bound.
ACTIVE = 1e-7


@dataclass
class Mechanism:
    name: str
    x: ca.SX
    lower: np.ndarray
    upper: np.ndarray
    cost: ca.SX
    constraints: ca.SX
    above: np.ndarray  # of the constraints; 0 for what is equal
    target: ca.SX
    draw: object  # a target for a random generator

    def __post_init__(self):
        problem = {"x": self.x, "p": self.target, "f": self.cost, "g": self.constraints}
        self.solver = ca.nlpsol("loops", "ipopt", problem, {**IPOPT, "ipopt.max_iter": 500})
        force = ca.SX.sym("force", self.constraints.numel())
        lagrangian = self.cost + ca.dot(force, self.constraints)
        hessian, gradient = ca.hessian(lagrangian, self.x)
        slope = ca.jacobian(self.constraints, self.x)
        self.conditions = ca.Function("conditions", [self.x, self.target, force],
                                      [self.constraints, gradient, hessian, slope])

    def minima(self, target, rng):
        """Costs of local minima in ascending order, each with the number of starts that ended there; and variables
        of the best one.
        """
        low, high = np.maximum(self.lower, -np.pi), np.minimum(self.upper, np.pi)
        ends = []
        for _ in range(STARTS):
            start = rng.uniform(low, high)
            found = self.solver(x0=start, p=target, lbx=self.lower, ubx=self.upper, lbg=0.0, ubg=self.above)
            if self.is_minimum(found, target):
                ends.append((float(found["f"]), np.array(found["x"]).ravel()))
        groups = []
        for cost, _ in sorted(ends, key=lambda end: end[0]):
            if groups and cost <= max(NO_COST, groups[-1]["cost"] * (1 + SAME_COST)):
                groups[-1]["starts"] += 1
            else:
                groups.append({"cost": cost, "starts": 1})
        near = min(ends, key=lambda end: end[0])[1] if ends else np.array([])
        return groups, np.round(near, 3).tolist()

    def is_minimum(self, found, target):
        x, force, held = (np.array(found[key]).ravel() for key in ("x", "lam_g", "lam_x"))
        values, gradient, hessian, slope = (np.array(v) for v in self.conditions(x, target, force))
        values = values.ravel()
        off = np.maximum(values - self.above, -values).max()
        if off > CLOSED or np.abs(gradient.ravel() + held).max() > STATIONARY:
            return False
        bound = (x - self.lower < ACTIVE) | (self.upper - x < ACTIVE)
        tight = (values < ACTIVE) | (self.above - values < ACTIVE)
        free = scipy.linalg.null_space(np.vstack([slope[tight], np.eye(len(x))[bound]]), rcond=1e-9)
        curvature = np.linalg.eigvalsh(free.T @ hessian @ free)
        return curvature.min(initial=0.0) >= CURVED


def half(vector):
    return ca.dot(vector, vector) / 2


def along(angle):
    return ca.vertcat(ca.cos(angle), ca.sin(angle))


def turned(angle, vector):
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(c * vector[0] - s * vector[1], s * vector[0] + c * vector[1])


def equal(*parts):
    constraints = ca.vertcat(*parts)
    return constraints, np.zeros(constraints.numel())


def four_bar():
    ground, crank, coupler, rocker = 0.4, 0.12, 0.35, 0.3
    x, target = ca.SX.sym("x", 3), ca.SX.sym("target", 2)
    end = crank * along(x[0])
    pen = end + turned(x[0] + x[1], [coupler / 2, 0.1])
    pin = end + coupler * along(x[0] + x[1]) - ca.vertcat(ground, 0) - rocker * along(x[2])
    draw = lambda rng: rng.uniform([-0.3, -0.5], [0.7, 0.6])
    return Mechanism("four-bar", x, np.full(3, -4.0), np.full(3, 4.0), half(pen - target), *equal(pin), target, draw)


def stewart():
    """The platform alone: legs are lengths between bounds. A metre counts as 0.4 rad."""
    x, target = ca.SX.sym("x", 6), ca.SX.sym("target", 6)
    of_vector = lambda v: about(v / ca.sqrt(ca.dot(v, v) + 1e-300), ca.sqrt(ca.dot(v, v) + 1e-300))[:3, :3]
    turn = of_vector(x[3:])
    circle = lambda radius, degrees: radius * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])
    legs = []
    for leg in range(6):
        pair, side = 120.0 * (leg // 2), -1 if leg % 2 == 0 else 1
        below, above = circle(0.5, pair + side * 15), circle(0.3, pair + side * 45)
        foot = x[:3] + turn @ above - below
        legs.append(ca.sqrt(ca.dot(foot, foot)) - 0.2)
    miss = rotation_vector(turn @ of_vector(target[3:]).T)
    draw = lambda rng: np.concatenate([rng.uniform([-0.5, -0.5, 1.5], [0.5, 0.5, 2.0]), rng.uniform(-0.6, 0.6, 3)])
    bounds = np.array([2.0, 2.0, 2.0, 2.0, 2.0, 2.0])
    lower = -bounds
    lower[2] = 0.1  # above the ground; the legs' hinges do not go below
    return Mechanism("stewart", x, lower, bounds, half(x[:3] - target[:3]) + half(0.4 * miss),
                     ca.vertcat(*legs), np.full(6, 1.3), target, draw)


def gripper():
    """Each side in mirrored coordinates: crank, second, finger, rod; the slide is last."""
    out, arm, between, hole, rod = 0.03, 0.06, 0.02, 0.025, 0.055
    x, target = ca.SX.sym("x", 9), ca.SX.sym("target", 4)
    cost, pins = 0, []
    for side in range(2):
        crank, second, finger, link = (x[4 * side + k] for k in range(4))
        end = ca.vertcat(out, 0) + arm * along(crank)
        tip = end + turned(crank + finger, [0, 0.08])
        pins.append(end + turned(crank + finger, [0, between]) - ca.vertcat(out, between) - arm * along(second))
        pins.append(ca.vertcat(0, x[8]) + rod * along(link) - ca.vertcat(out, 0) - hole * along(crank))
        cost += half(tip - target[2 * side:2 * side + 2])
    limits = np.array([1.4, 1.4, 1.4, 3.0] * 2)
    draw = lambda rng: np.concatenate([rng.uniform([0.03, 0.1], [0.15, 0.2]) for _ in range(2)])
    return Mechanism("gripper", x, np.append(-limits, -0.1), np.append(limits, 0.06), cost, *equal(*pins), target, draw)


def knee():
    """tests/solver/loops/files/knee.xml with a fixed pelvis: hip, knee's motor, knee, ankle's motor, ankle; x and z."""
    x, target = ca.SX.sym("x", 5), ca.SX.sym("target", 4)
    about_y = lambda angle, v: ca.vertcat(ca.cos(angle) * v[0] + ca.sin(angle) * v[1],
                                          -ca.sin(angle) * v[0] + ca.cos(angle) * v[1])
    hip, knee_motor, knee, ankle_motor, ankle = (x[k] for k in range(5))
    lever = ca.vertcat(0, -0.4) + about_y(knee, [-0.05, 0])
    rod = lever - about_y(knee_motor, [-0.06, 0])
    heel_lever = ca.vertcat(0, -0.38) + about_y(ankle, [0.045, 0])
    second = heel_lever - about_y(ankle_motor, [0.04, 0])
    rods = [(ca.dot(rod, rod) - 0.01**2 - 0.4**2) / 0.8, (ca.dot(second, second) - 0.005**2 - 0.38**2) / 0.76]
    on_leg = lambda v: ca.vertcat(0, -0.05) + about_y(
        hip, ca.vertcat(0, -0.4) + about_y(knee, ca.vertcat(0, -0.38) + about_y(ankle, v)))
    cost = half(on_leg([0.15, -0.05]) - target[:2]) + half(on_leg([-0.06, -0.05]) - target[2:])
    limits = np.radians([[-120, 60], [-100, 100], [-10, 140], [-80, 80], [-60, 60]])

    def draw(rng):
        middle, tilt = rng.uniform([-0.6, -1.2], [0.8, -0.5]), rng.uniform(-0.8, 0.8)
        toe = np.array([np.cos(tilt), np.sin(tilt)]) * 0.105
        return np.concatenate([middle + toe, middle - toe])

    return Mechanism("knee", x, limits[:, 0], limits[:, 1], cost, *equal(*rods), target, draw)


def hands():
    """Baxter with a box 0.4 m wide between its tools. A metre counts as 0.3 rad."""
    model, target = read("baxter"), ca.SX.sym("target", 12)
    grips = [rigid(about([1, 0, 0], side * np.pi / 2)[:3, :3], ca.SX([0, 0, 0.2])) for side in (1, -1)]
    left, right = model.frames["left_tool"] @ grips[0], model.frames["right_tool"] @ grips[1]
    between = inverse(left) @ right
    wanted = ca.reshape(target[3:], 3, 3)
    miss = rotation_vector(left[:3, :3] @ wanted.T)
    cost = half(left[:3, 3] - target[:3]) + half(0.3 * miss)

    def draw(rng):
        turn = Rotation.from_rotvec(rng.uniform(-0.8, 0.8, 3)).as_matrix()
        return np.concatenate([rng.uniform([0.9, -0.8, -0.2], [1.6, 0.8, 1.2]), turn.ravel(order="F")])

    return Mechanism("hands", model.x, model.lower, model.upper, cost,
                     *equal(between[:3, 3], rotation_vector(between[:3, :3])), target, draw)


def main():
    problems = []
    for number, (mechanism, count) in enumerate([(four_bar, 12), (stewart, 10), (gripper, 8), (knee, 12), (hands, 8)]):
        own = mechanism()
        kept = 0
        for k in range(2 * count):
            rng = np.random.default_rng([SEED, number, k])
            target = own.draw(rng)
            minima, near = own.minima(target, rng)
            # The target is reachable, or IPOPT failed from every start: there is no minimum to compare.
            if not minima or minima[0]["cost"] < 1e-6:
                continue
            problems.append({"mechanism": own.name, "target": target.tolist(), "minima": minima, "near": near})
            kept += 1
            if kept == count:
                break
        print(f"{own.name}: {kept} problems")
    fixtures.write("loops.json", "CasADi + IPOPT", ca.__version__, SEED, "loops.py",
                   "metres, radians; rotations by columns; costs are half the sum of squares; near: the least one's variables to three decimals", problems=problems)


if __name__ == "__main__":
    main()
