"""Time until a solver reports that a pose is not reached, on one core: kinopt, OptIK, frankik, RoboPlan and pink.

Usage: ``python failures.py [--poses N] [--slow N]``, in the root of the repository. The environment needs kinopt's wheel and
requirements-failures.txt.

Unreachable poses are random ones with a proof of ``Arm.reachability``: uniform rotations, and positions in a ball of the arm's
reach. Poses in an obstacle are reachable, but a box of 0.3 m encloses the flange; only solvers that check collisions take part.
Starts are random configurations. Every solver has its defaults, RoboPlan without collision checks for unreachable poses. pink has no such loop: a
loop of at most 100 full steps ends at a step shorter than 1e-6 rad, or where DAQP fails.

Reported successes are results that a solver calls a solution. Nearest errors are those of the returned or last configurations
by Pinocchio: the median of the larger of distance (m) and angle (rad); solvers that return none have no entry.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import frankik
import numpy as np
import optik
import pink
import pinocchio

import kinopt
from among_obstacles import roboplan_solver

sys.path.append(str(Path(__file__).resolve().parents[2] / "reachability"))
from shares import random_poses  # noqa: E402

ARMS = {"Panda": "franka_panda", "UR5e": "universal_ur5e", "iiwa 14": "kuka_iiwa14"}
BASE, TIP = "base", "flange"
MAX_BOXES = 300_000


BOX_M = 0.3


class Scene:
    """Solids of a problem of among_obstacles.py."""

    def __init__(self, solids: list) -> None:
        self.solids = solids


class Judge:
    """Forward kinematics by Pinocchio."""

    def __init__(self, urdf: str, names: list) -> None:
        whole = pinocchio.buildModelFromUrdf(urdf)
        others = [index for index in range(1, whole.njoints) if whole.names[index] not in names]
        self.model = pinocchio.buildReducedModel(whole, others, pinocchio.neutral(whole))
        self.data = self.model.createData()
        self.tip, self.base = self.model.getFrameId(TIP), self.model.getFrameId(BASE)
        self.names = list(self.model.names[1:])

    def error(self, q, target) -> float:
        """Larger of distance (m) and angle (rad)."""
        pinocchio.framesForwardKinematics(self.model, self.data, np.asarray(q, float))
        tool = self.data.oMf[self.base].actInv(self.data.oMf[self.tip]).homogeneous
        angle = np.linalg.norm(pinocchio.log3(tool[:3, :3].T @ target[:3, :3]))
        return max(np.linalg.norm(tool[:3, 3] - target[:3, 3]), angle)


def by_pink(judge: Judge):
    model, data = judge.model, judge.data
    task = pink.tasks.FrameTask(TIP, position_cost=1.0, orientation_cost=1.0)
    bounds = [pink.limits.ConfigurationLimit(model)]
    pinocchio.framesForwardKinematics(model, data, pinocchio.neutral(model))
    universe_from_base = data.oMf[judge.base].copy()

    def solve(target, start):
        task.set_target(universe_from_base * pinocchio.SE3(target))
        configuration = pink.Configuration(model, data, start)
        for _ in range(100):
            try:
                velocity = pink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=bounds, safety_break=False)
            except pink.exceptions.NoSolutionFound:
                break
            configuration.integrate_inplace(velocity, 1.0)
            if np.linalg.norm(velocity) < 1e-6:
                break
        return configuration.q, np.linalg.norm(task.compute_error(configuration)) < 1e-3

    return solve


def contenders(urdf: str, arm, judge: Judge, folder: Path):
    """By name: whether it is slow, and a function of target and start that returns joint values or None, and success."""
    limited = kinopt.Arm(arm.robot, BASE, TIP, time_limit=1e-3)
    tree = optik.Robot.from_urdf_file(urdf, BASE, TIP)
    tree.set_parallelism(1)
    config = optik.SolverConfig()
    srdf = folder / "empty.srdf"
    srdf.write_text(f'<robot name="{arm.robot.name}"></robot>')
    defaults = {"max_restarts": 2, "max_time": 0.005, "check_collisions": False}
    roboplan = roboplan_solver(Path(urdf), srdf, arm.joint_names, TIP, BASE, **defaults)(Scene([]))

    def kinopt_call(with_limit):
        def solve(target, start):
            solution = with_limit.solve(target, start)
            return solution.q, solution.reached
        return solve

    def reachability(target, start):
        answer = arm.reachability(target, start, max_boxes=MAX_BOXES)
        return answer.solution.q, answer.reachable is not False

    def by_optik(target, start):
        found = tree.ik(config, [list(map(float, row)) for row in target], start.tolist())
        return (None, False) if found is None else (np.array(found[0]), True)

    def by_roboplan(target, start):
        found = roboplan(target, start)
        return found, found is not None

    rows = {
        "kinopt": (False, kinopt_call(arm)),
        "kinopt, `time_limit` 1 ms": (False, kinopt_call(limited)),
        "kinopt, `reachability`: with its proof": (False, reachability),
        "OptIK": (True, by_optik),
        "RoboPlan, SimpleIk": (True, by_roboplan),
        "pink, 100 steps": (True, by_pink(judge)),
    }
    if "panda" in urdf:
        closed = frankik.FrankaKinematics(frankik.RobotType.PANDA)
        # frankik's tip has a fixed rotation relative to the flange; its own matrix is rounded to 0.707.
        half = np.sqrt(0.5)
        hand = np.array([[half, half, 0, 0], [-half, half, 0, 0], [0, 0, 1, 0.1034], [0, 0, 0, 1]])
        zero = np.zeros(7)
        to_frankik = np.linalg.inv(arm.base_from_tool(zero)) @ closed.forward(zero) @ np.linalg.inv(hand)

        def by_frankik(target, start):
            found = closed.inverse(target @ to_frankik, start)
            return found, found is not None

        rows["frankik"] = (True, by_frankik)
    return rows


def in_obstacle(urdf: str, arm, targets, folder: Path):
    """Calls by name, one for each target: kinopt and RoboPlan with a box around the flange."""
    shapes = arm.robot.collision_model().with_pairs_sampled()
    srdf = folder / "pairs.srdf"
    srdf.write_text(shapes.to_srdf())
    defaults = {"max_restarts": 2, "max_time": 0.005}
    among = roboplan_solver(Path(urdf), srdf, arm.joint_names, TIP, BASE, **defaults)
    ours, theirs = [], []
    for target in targets:
        box = kinopt.placement(target[:3, 3])
        world = kinopt.World()
        world.add_box("box", [BOX_M] * 3, box)
        ours.append(kinopt.Arm(arm.robot, BASE, TIP, world=world, collision_model=shapes))
        theirs.append(among(Scene([("box", [BOX_M] * 3, np.asarray(box))])))
    return {
        "kinopt": [lambda t, s, arm=arm: arm.solve(t, s).reached for arm in ours],
        "RoboPlan, SimpleIk": [lambda t, s, solve=solve: solve(t, s) is not None for solve in theirs],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=200)
    parser.add_argument("--slow", type=int, default=30, help="poses for the rivals")
    chosen = parser.parse_args()
    print("| arm | poses | solver | number | reported successes | nearest error | median µs | p99 µs | largest µs |")
    print("|---|---|---|---:|---:|---:|---:|---:|---:|")
    for name, file in ARMS.items():
        urdf = f"models/{file}.urdf"
        arm = kinopt.Arm(kinopt.Robot.from_urdf(urdf), BASE, TIP)
        judge = Judge(urdf, arm.joint_names)
        assert judge.names == arm.joint_names
        rng = np.random.default_rng(3)
        poses = []
        for pose in random_poses(arm, rng):
            if arm.reachability(pose, max_boxes=MAX_BOXES).reachable is False:
                poses.append(np.asarray(pose))
            if len(poses) == chosen.poses:
                break
        starts = rng.uniform(arm.lower, arm.upper, (chosen.poses, len(arm.joint_names)))
        with tempfile.TemporaryDirectory() as folder:
            rows = contenders(urdf, arm, judge, Path(folder))
        for solver, (slow, solve) in rows.items():
            times, errors, successes = [], [], 0
            for target, start in list(zip(poses, starts))[:chosen.slow if slow else None]:
                begin = time.perf_counter()
                q, success = solve(target, start)
                times.append(1e6 * (time.perf_counter() - begin))
                successes += success
                if q is not None:
                    errors.append(judge.error(q, target))
            error = f"{np.median(errors):.3g}" if errors else "–"
            print(f"| {name} | unreachable | {solver} | {len(times)} | {successes} | {error} | {np.median(times):.0f} | "
                  f"{np.percentile(times, 99):.0f} | {np.max(times):.0f} |", flush=True)
        targets = arm.base_from_tool(rng.uniform(arm.lower, arm.upper, (chosen.slow, len(arm.joint_names))))
        with tempfile.TemporaryDirectory() as folder:
            calls = in_obstacle(urdf, arm, targets, Path(folder))
        for solver, solves in calls.items():
            times, successes = [], 0
            for solve, target, start in zip(solves, targets, starts):
                begin = time.perf_counter()
                successes += solve(target, start)
                times.append(1e6 * (time.perf_counter() - begin))
            print(f"| {name} | in an obstacle | {solver} | {len(times)} | {successes} | – | {np.median(times):.0f} | "
                  f"{np.percentile(times, 99):.0f} | {np.max(times):.0f} |", flush=True)


if __name__ == "__main__":
    main()
