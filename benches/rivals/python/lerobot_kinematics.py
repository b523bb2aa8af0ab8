"""Poses and paths of the SO-101 by kinopt.lerobot compared with placo, called as LeRobot 0.6.1 calls it.

Usage: ``python lerobot_kinematics.py [--poses N]``, in the root of the repository. The environment needs kinopt's
wheel and requirements-lerobot.txt.

Reachable poses have a start near the solution (at most 10 degrees a joint) or a random start. Turned poses are poses
of the start, turned by 0.2 rad about a random axis: five joints do not reach them. Paths have 300 poses at 30 Hz; each
call starts from the result before. All calls have LeRobot's weights, 1 and 0.01. The fastest of three equal calls
counts. Pinocchio judges: a pose is solved within 1 mm and 1 degree, with all joints in their limits. The cost is the
weighted sum of squared errors (m², rad²); a turned pose is solved within 1 % of the lowest cost of all solvers.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import pinocchio
import placo

from kinopt.lerobot import RobotKinematics

URDF = str(Path("models/robotstudio_so101.urdf"))
FRAME = "gripper_frame_link"
JOINTS = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll"]
WEIGHTS = (1.0, 0.01)
NEAR, TURN = 10.0, 0.2
FRAMES, RATE = 300, 30.0
ROUNDS = 3
# Largest joint displacement in a step that is no jump: 0.2 rad, in degrees.
JUMP = np.rad2deg(0.2)


class Judge:
    """Forward kinematics and limits by Pinocchio, in degrees."""

    def __init__(self):
        self.model = pinocchio.buildModelFromUrdf(URDF)
        self.data = self.model.createData()
        self.frame = self.model.getFrameId(FRAME)
        self.places = [self.model.joints[self.model.getJointId(name)].idx_q for name in JOINTS]
        self.lower, self.upper = (
            np.rad2deg(limit[self.places]) for limit in (self.model.lowerPositionLimit, self.model.upperPositionLimit)
        )

    def pose(self, degrees):
        q = pinocchio.neutral(self.model)
        q[self.places] = np.deg2rad(degrees)
        pinocchio.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.frame].homogeneous

    def errors(self, degrees, target):
        """Distance in metres and angle in radians."""
        pose = self.pose(degrees)
        angle = np.linalg.norm(pinocchio.log3(pose[:3, :3].T @ target[:3, :3]))
        return np.linalg.norm(pose[:3, 3] - target[:3, 3]), angle

    def allows(self, degrees):
        return (degrees >= self.lower - 1e-6).all() and (degrees <= self.upper + 1e-6).all()


class Placo:
    """placo's solver of quadratic programmes. LeRobot makes one step a call; `steps` repeats it until it stops.

    The kinematics are updated before the first step, as by the forward kinematics of LeRobot's teleoperation.
    """

    def __init__(self, steps):
        self.steps = steps
        self.robot = placo.RobotWrapper(URDF, placo.Flags.ignore_collisions)
        self.solver = placo.KinematicsSolver(self.robot)
        self.solver.mask_fbase(True)
        self.task = self.solver.add_frame_task(FRAME, np.eye(4))

    def inverse_kinematics(self, current, target):
        for name, value in zip(JOINTS, np.deg2rad(current)):
            self.robot.set_joint(name, value)
        self.robot.update_kinematics()
        self.task.T_world_frame = target
        self.task.configure(FRAME, "soft", *WEIGHTS)
        before = np.deg2rad(current)
        for _ in range(self.steps):
            self.solver.solve(True)
            self.robot.update_kinematics()
            found = np.array([self.robot.get_joint(name) for name in JOINTS])
            if abs(found - before).max() < 1e-7:
                break
            before = found
        return np.rad2deg(found)


def solvers():
    return {
        "placo, one step (LeRobot)": Placo(1),
        "placo, up to 100 steps": Placo(100),
        "kinopt.lerobot": RobotKinematics(URDF, FRAME, JOINTS),
        "kinopt.lerobot, 200 attempts": RobotKinematics(URDF, FRAME, JOINTS, attempts=200),
    }


def timed(solver, start, target):
    """Result of a call and its time in microseconds. A solver that raises an error returns its start."""
    found, times = start, []
    for _ in range(ROUNDS):
        begun = time.perf_counter_ns()
        try:
            found = solver.inverse_kinematics(start, target)
        except RuntimeError:
            pass
        times.append(time.perf_counter_ns() - begun)
    return found, min(times) / 1e3


def turned(pose, axis, angle):
    result = pose.copy()
    result[:3, :3] = pinocchio.exp3(angle * axis / np.linalg.norm(axis)) @ pose[:3, :3]
    return result


def poses(judge, random, count):
    """Starts and targets by name."""
    there = random.uniform(judge.lower, judge.upper, (count, 5))
    near = np.clip(there + random.uniform(-NEAR, NEAR, (count, 5)), judge.lower, judge.upper)
    far = random.uniform(judge.lower, judge.upper, (count, 5))
    reachable = [judge.pose(q) for q in there]
    rotated = [turned(pose, random.normal(size=3), TURN) for pose in reachable]
    return {"near": (near, reachable), "random start": (far, reachable), "turned": (there, rotated)}


def report_poses(judge, name, starts, targets):
    measured = {}
    for solver_name, solver in solvers().items():
        if name == "turned" and "attempts" in solver_name:
            continue
        found, times = zip(*(timed(solver, start, target) for start, target in zip(starts, targets)))
        errors = np.array([judge.errors(q, target) for q, target in zip(found, targets)])
        cost = (np.array(WEIGHTS) * errors**2).sum(1)
        allowed = np.array([judge.allows(q) for q in found])
        measured[solver_name] = errors, cost, allowed, times
    lowest = np.min([np.where(allowed, cost, np.inf) for _, cost, allowed, _ in measured.values()], axis=0)
    for solver_name, (errors, cost, allowed, times) in measured.items():
        reached = (errors <= [1e-3, np.deg2rad(1)]).all(1) if name != "turned" else cost <= 1.01 * lowest
        distance, angle = np.median(errors, axis=0)
        print(f"| {name} | {solver_name} | {100 * (reached & allowed).mean():.1f} | {1e3 * distance:.3g} "
              f"| {np.rad2deg(angle):.3g} | {np.median(times):.0f} | {np.mean(times):.0f} |")


def paths(judge, random):
    """Lists of targets by name, and a start."""
    middle, half = (judge.upper + judge.lower) / 2, (judge.upper - judge.lower) / 2
    t = np.arange(FRAMES) / RATE
    sway = sum(np.sin(rate * t[:, None] + random.uniform(0, 6, 5)) for rate in (0.5, 0.9, 1.3)) / 3
    joints = middle + 0.8 * half * sway
    ready = np.array([0.0, -30.0, 40.0, 50.0, 0.0])
    line = np.repeat(judge.pose(ready)[None], FRAMES, axis=0)
    line[:, 1, 3] += np.linspace(-0.25, 0.25, FRAMES)
    reach = np.repeat(judge.pose(ready)[None], FRAMES, axis=0)
    reach[:, 0, 3] += 0.3 * np.sin(np.pi * np.arange(FRAMES) / (FRAMES - 1))
    over = np.repeat(judge.pose(ready)[None], FRAMES, axis=0)
    over[:, 0, 3] += np.linspace(0, -0.35, FRAMES)
    return {
        "moving joints": ([judge.pose(q) for q in joints], joints[0]),
        "line across, one orientation": (line, ready),
        "out of reach and back": (reach, ready),
        "line over the base": (over, ready),
    }


def report_path(judge, name, targets, start):
    for solver_name, solver in solvers().items():
        if "attempts" in solver_name:
            continue
        q, results, times = np.array(start, dtype=float), [], []
        for target in targets:
            q, took = timed(solver, q, target)
            results.append(q)
            times.append(took)
        errors = np.array([judge.errors(q, target) for q, target in zip(results, targets)])
        steps = abs(np.diff(results, axis=0)).max(1)
        print(f"| {name} | {solver_name} | {1e3 * np.median(errors[:, 0]):.3g} | {1e3 * errors[:, 0].max():.3g} "
              f"| {np.rad2deg(np.median(errors[:, 1])):.3g} | {steps.max():.1f} | {(steps > JUMP).sum()} "
              f"| {np.median(times):.0f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=1000)
    wanted = parser.parse_args()
    judge, random = Judge(), np.random.default_rng(1)
    print("| poses | solver | solved, % | median error, mm | median error, degrees | µs median | µs mean |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for name, (starts, targets) in poses(judge, random, wanted.poses).items():
        report_poses(judge, name, starts, targets)
    print("\n| path | solver | median error, mm | largest error, mm | median error, degrees "
          "| largest step, degrees | jumps | µs median |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for name, (targets, start) in paths(judge, random).items():
        report_path(judge, name, targets, start)


if __name__ == "__main__":
    main()
