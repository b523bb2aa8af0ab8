"""Poses of the xArm6 and the xArm7 with self-collision checks on their meshes: kinopt compared with RoboPlan and pink.

Usage: ``python self_collisions.py XARM_DESCRIPTION [--poses N] [--slow N]``, on one core. The environment needs kinopt's
wheel and requirements-self-collisions.txt. XARM_DESCRIPTION is the folder of that name in a checkout of
xArm-Developer/xarm_ros2 (BSD-3-Clause).

Targets are poses of random collision-free configurations; starts are other random collision-free ones. All solvers check the
same pairs of links. kinopt solves to 1e-6 m and rad, the rivals to 1e-3, RoboPlan's default. RoboPlan has its own restarts and
checks. pink runs with full steps and restarts from random configurations until its result is collision-free by coal. Every
solver has at most one second a pose.

Pinocchio and coal, on the triangles of the meshes, judge all results. The best of three rounds counts for kinopt.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
import pinocchio
import pink
import xacro
from xacrodoc import packages as package_finder

import kinopt
from among_obstacles import Judge, roboplan_solver

TOLERANCE, LOOSE = 1e-6, 1e-3
TIME_LIMIT_S = 1.0
BASE, TIP = "link_base", "link_eef"


class NoObstacles:
    solids: list = []


def description(folder: Path, joints: int, to: Path) -> Path:
    """Expands the maker's xacro file to a URDF with plain paths of meshes."""
    package_finder.update_package_cache({name: str(folder) for name in ("xarm_description", "xarm_controller")})
    document = xacro.process_file(str(folder / "urdf/xarm_device.urdf.xacro"), mappings={"dof": str(joints)}, verbosity=0)
    urdf = to / f"xarm{joints}.urdf"
    urdf.write_text(document.toxml().replace("file://", ""))
    return urdf


def by_pink(judge: Judge, limits, random):
    """A loop of pink's steps with its configuration limit, restarted where it stalls or collides."""
    model, data, shapes = judge.model, judge.data, judge.shapes
    shape_data = shapes.createData()
    task = pink.tasks.FrameTask(TIP, position_cost=1.0, orientation_cost=1.0, lm_damping=1e-6)
    bounds = [pink.limits.ConfigurationLimit(model)]
    pinocchio.framesForwardKinematics(model, data, pinocchio.neutral(model))
    universe_from_base = data.oMf[judge.base].copy()

    def solve(target, start):
        begin, q = time.perf_counter(), start
        task.set_target(universe_from_base * pinocchio.SE3(target))
        while time.perf_counter() - begin < TIME_LIMIT_S:
            configuration = pink.Configuration(model, data, q)
            for _ in range(100):
                try:
                    velocity = pink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=bounds, safety_break=False)
                except pink.exceptions.NoSolutionFound:
                    break
                configuration.integrate_inplace(velocity, 1.0)
                error = task.compute_error(configuration)
                if max(np.linalg.norm(error[:3]), np.linalg.norm(error[3:])) < LOOSE:
                    if not pinocchio.computeCollisions(model, data, shapes, shape_data, configuration.q, True):
                        return configuration.q
                    break
                if np.linalg.norm(velocity) < 1e-6:
                    break
            q = random.uniform(*limits)
        return None

    return solve


def compare(urdf: Path, folder: Path, poses: int, slow: int) -> None:
    robot = kinopt.Robot.from_urdf(str(urdf), lenient=True)
    shapes = robot.collision_model().with_pairs_sampled()
    srdf = folder / "pairs.srdf"
    srdf.write_text(shapes.to_srdf())
    arm = kinopt.Arm(robot, BASE, TIP, world=kinopt.World(), collision_model=shapes)
    plain = kinopt.Arm(robot, BASE, TIP)
    judge = Judge(urdf, srdf, TIP, BASE)
    roboplan = roboplan_solver(urdf, srdf, arm.joint_names, TIP, BASE)(NoObstacles)

    random = np.random.default_rng(1)
    limits = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    free = []
    while len(free) < 2 * poses:
        q = random.uniform(*limits)
        if judge.is_free(q, []) and not arm.collisions(q):
            free.append(q)
    goals, starts = np.array(free[:poses]), np.array(free[poses:])
    targets = arm.base_from_tool(goals)

    def q_of(solution):
        return solution.q if solution.reached else None

    rows = {
        "kinopt, no checks": (lambda t, s: q_of(plain.solve(t, s)), 3, poses, TOLERANCE),
        "kinopt": (lambda t, s: q_of(arm.solve(t, s)), 3, poses, TOLERANCE),
        "RoboPlan, SimpleIk": (roboplan, 1, slow, LOOSE),
        "pink, DAQP, coal's check": (by_pink(judge, limits, random), 1, slow, LOOSE),
    }
    for name, (solve, rounds, count, tolerance) in rows.items():
        times, reached, collision_free = np.full(count, np.inf), 0, 0
        for turn in range(rounds):
            for k in range(count):
                begin = time.perf_counter()
                q = solve(targets[k], starts[k])
                times[k] = min(times[k], time.perf_counter() - begin)
                if turn > 0 or q is None:
                    continue
                tool = judge.tool(q)
                angle = np.linalg.norm(pinocchio.log3(tool[:3, :3].T @ targets[k][:3, :3]))
                if max(np.linalg.norm(tool[:3, 3] - targets[k][:3, 3]), angle) <= 1.001 * tolerance:
                    reached += 1
                    collision_free += judge.is_free(q, [])
        micros = 1e6 * times
        print(f"| {urdf.stem} | {name} | {count} | {reached / count:.1%} | {collision_free / count:.1%} | "
              f"{np.median(micros):.1f} | {np.percentile(micros, 99):.0f} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("description", type=Path)
    parser.add_argument("--poses", type=int, default=1000)
    parser.add_argument("--slow", type=int, default=100, help="poses for RoboPlan and pink")
    chosen = parser.parse_args()
    print("| arm | solver | poses | reached | reached and collision-free | median µs | p99 µs |\n|---|---|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        for joints in (6, 7):
            urdf = description(chosen.description.absolute(), joints, Path(folder))
            compare(urdf, Path(folder), chosen.poses, chosen.slow)


if __name__ == "__main__":
    main()
