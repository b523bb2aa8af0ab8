"""All solutions of random poses by kinopt compared with EAIK and ssik.

Usage: ``python complete_sets.py [--poses N] [--plot FILE] [ARM...]``, in the root of the repository. The environment needs kinopt's
wheel and requirements-complete-sets.txt.

The arms are ssik's prebuilt ones, named as its modules. Their joint axes go to all solvers, without limits: joints of
six-joint arms have one turn from -pi to pi. Poses are those of uniformly random configurations. A solution is missing if
none of the other solver's differs by less than 1e-3 rad in every joint, up to whole turns. A rival's solution counts only
if it closes to 1e-6 m and rad by independent forward kinematics. For seven joints kinopt samples the self-motions, and a
rival's solution within the limits is missing if it is farther than 0.05 rad from every sample.

Times are medians of process time for single calls from Python, in microseconds; the solvers take turns on every pose.
"""

from __future__ import annotations

import argparse
import importlib
import math
import time

import numpy as np

import kinopt
from eaik.IK_HP import HPRobot

SIX = ["universal_robots.ur5_ik", "unimation.puma560_ik", "kuka.kr6_r900_ik", "kinova.jaco2_ik",
       "ufactory.xarm6_ik", "fanuc.crx10ia_ik"]
SEVEN = ["franka.panda_ik", "kuka.iiwa14_ik"]
# Arms that EAIK solves in closed form.
BY_EAIK = SIX[:3]
SAME, CLOSED, SPACING = 1e-3, 1e-6, 0.05


def rotation(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def rpy(matrix):
    """Roll, pitch and yaw of URDF."""
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    if abs(math.cos(pitch)) < 1e-9:
        return math.atan2(-matrix[1, 2], matrix[1, 1]), pitch, 0.0
    return math.atan2(matrix[2, 1], matrix[2, 2]), pitch, math.atan2(matrix[1, 0], matrix[0, 0])


class Chain:
    """Axes of one of ssik's prebuilt arms, and forward kinematics."""

    def __init__(self, name):
        self.ssik = importlib.import_module(f"ssik.prebuilt.{name}")
        arm, between = self.ssik, np.eye(4)
        self.placements, self.axes = [], []
        for axis, left, right in zip(arm._JOINT_AXES, arm._JOINT_T_LEFTS, arm._JOINT_T_RIGHTS):
            self.placements.append(between @ np.array(left))
            self.axes.append(np.array(axis) / np.linalg.norm(axis))
            between = np.array(right)
        self.tool = between
        turn = [(-math.pi, math.pi)] * len(self.axes)
        self.limits = turn if len(turn) == 6 else [tuple(limit) for limit in arm._JOINT_LIMITS]

    def pose(self, q):
        pose = np.eye(4)
        for placement, axis, value in zip(self.placements, self.axes, q):
            joint = np.eye(4)
            joint[:3, :3] = rotation(axis, value)
            pose = pose @ placement @ joint
        return pose @ self.tool

    def points(self, q):
        """Origins of the joints and of the tool."""
        pose, points = np.eye(4), []
        for placement, axis, value in zip(self.placements, self.axes, q):
            pose = pose @ placement
            points.append(pose[:3, 3].copy())
            pose[:3, :3] = pose[:3, :3] @ rotation(axis, value)
        return [*points, (pose @ self.tool)[:3, 3]]

    def closes(self, q, target):
        pose = self.pose(q)
        turned = np.linalg.norm(pose[:3, :3] - target[:3, :3]) / math.sqrt(2)
        return np.linalg.norm(pose[:3, 3] - target[:3, 3]) <= CLOSED and turned <= CLOSED

    def kinopt(self):
        def joint(name, kind, parent, child, placement, more=""):
            xyz = " ".join(map(repr, map(float, placement[:3, 3])))
            angles = " ".join(map(repr, rpy(placement)))
            return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
                    f'<origin xyz="{xyz}" rpy="{angles}"/>{more}</joint><link name="{child}"/>')

        parts = ['<robot name="arm"><link name="l0"/>']
        for i, (placement, axis, (lower, upper)) in enumerate(zip(self.placements, self.axes, self.limits)):
            more = f'<axis xyz="{" ".join(map(repr, map(float, axis)))}"/>'
            more += f'<limit lower="{lower!r}" upper="{upper!r}" effort="1" velocity="1"/>'
            parts.append(joint(f"j{i}", "revolute", f"l{i}", f"l{i + 1}", placement, more))
        parts.append(joint("end", "fixed", f"l{len(self.axes)}", "tool", self.tool))
        robot = kinopt.Robot.from_urdf_text("".join(parts) + "</robot>")
        return kinopt.Arm(robot, "l0", "tool", atlas=False)

    def eaik(self):
        """EAIK's robot by axes and offsets at zero joint values, and the constant rotation of its tool."""
        pose, axes, points = np.eye(4), [], [np.zeros(3)]
        for placement, axis in zip(self.placements, self.axes):
            pose = pose @ placement
            axes.append(pose[:3, :3] @ axis)
            points.append(pose[:3, 3].copy())
        end = pose @ self.tool
        points.append(end[:3, 3])
        return HPRobot(np.array(axes), np.diff(np.array(points), axis=0)), end[:3, :3]


def measured(solve):
    start = time.process_time_ns()
    result = solve()
    return result, (time.process_time_ns() - start) / 1e3


def distance(a, b):
    return np.abs((np.asarray(a) - np.asarray(b) + math.pi) % (2 * math.pi) - math.pi).max(axis=-1)


def six_joints(name, poses):
    chain = Chain(name)
    arm, rng = chain.kinopt(), np.random.default_rng(7)
    eaik = chain.eaik() if name in BY_EAIK else None
    times, missing, extra, complete, counts = {"kinopt": [], "EAIK": [], "ssik": []}, {"EAIK": 0, "ssik": 0}, 0, 0, []
    for _ in range(poses):
        target = chain.pose(rng.uniform(-math.pi, math.pi, 6))
        ours, spent = measured(lambda: arm.solve_all(target))
        q = ours.q
        times["kinopt"].append(spent)
        complete += ours.complete
        counts.append(len(q))
        found = {}
        options = {"respect_limits": False, "enumerate_windings": False}
        solutions, spent = measured(lambda: chain.ssik.solve(target, **options))
        times["ssik"].append(spent)
        found["ssik"] = [s.q for s in solutions]
        if eaik:
            robot, tool = eaik
            turned = target.copy()
            turned[:3, :3] = target[:3, :3] @ tool.T
            solution, spent = measured(lambda: robot.IK(turned))
            times["EAIK"].append(spent)
            found["EAIK"] = solution.Q
        for rival, rows in found.items():
            for row in rows:
                if chain.closes(row, target) and not (len(q) and distance(q, row).min() < SAME):
                    missing[rival] += 1
        rows = np.array(found["ssik"]).reshape(-1, 6)
        extra += sum(not (len(rows) and distance(rows, one).min() < SAME) for one in q)
    median = {solver: np.median(all) if all else math.nan for solver, all in times.items()}
    print(f"| {name.split('.')[1][:-3]} | {np.mean(counts):.2f} | {complete / poses:.2%} | {missing['EAIK'] if eaik else '–'} | "
          f"{missing['ssik']} | {extra} | {median['kinopt']:.1f} | {median['EAIK']:.1f} | {median['ssik']:.1f} |", flush=True)


def seven_joints(name, poses):
    chain = Chain(name)
    arm, rng = chain.kinopt(), np.random.default_rng(8)
    lower, upper = np.array(chain.limits).T
    times, missing, total, arcs = [], 0, 0, []
    for _ in range(poses):
        target = chain.pose(rng.uniform(lower, upper))
        motions, spent = measured(lambda: arm.self_motions(target))
        times.append(spent)
        arcs.append(len(motions))
        samples = np.concatenate([motion.q for motion in motions])
        for solution in chain.ssik.solve(target):
            if chain.closes(solution.q, target):
                total += 1
                missing += np.abs(samples - solution.q).max(axis=1).min() > SPACING
    print(f"| {name.split('.')[1][:-3]} | {np.mean(arcs):.1f} | {total} | {missing} | {np.median(times) / 1e3:.1f} |", flush=True)


def plot(path):
    """Draws the solutions of a UR5e for one pose, and the self-motions of an iiwa."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(10, 4.5), layout="constrained")
    chain = Chain("universal_robots.ur5e_ik")
    space = figure.add_subplot(1, 2, 1, projection="3d")
    for q in chain.kinopt().solve_all(chain.pose([0.5, -1.3, 1.2, -0.7, 1.0, 0.2])).q:
        space.plot(*np.array(chain.points(q)).T, marker="o", markersize=3)
    space.set(title="UR5e: all solutions of a pose", xlabel="x, m", ylabel="y, m", zlabel="z, m", aspect="equal")
    chain = Chain("kuka.iiwa14_ik")
    axes = figure.add_subplot(1, 2, 2)
    for motion in chain.kinopt().self_motions(chain.pose([0.3, 0.4, 0.2, -1.2, 0.1, 0.9, 0.5])):
        axes.plot(motion.q[:, 2], motion.q[:, 4])
    axes.set(title="iiwa 14: self-motions for a pose", xlabel="joint 3, rad", ylabel="joint 5, rad")
    figure.savefig(path, dpi=110)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--poses", type=int, default=2000)
    options.add_argument("--plot", help="file of the picture of docs/guide/complete-solutions.md; nothing is measured")
    options.add_argument("arms", nargs="*", default=SIX + SEVEN)
    chosen = options.parse_args()
    if chosen.plot:
        return plot(chosen.plot)
    print("| arm | solutions | complete | of EAIK's missing | of ssik's missing | not found by ssik | kinopt, µs | EAIK, µs | ssik, µs |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for name in chosen.arms:
        if name not in SEVEN:
            six_joints(name, chosen.poses)
    print("\n| arm | components | solutions of ssik | missing | kinopt, ms |\n|---|---:|---:|---:|---:|")
    for name in chosen.arms:
        if name in SEVEN:
            seven_joints(name, chosen.poses)


if __name__ == "__main__":
    main()
