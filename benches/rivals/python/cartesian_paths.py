"""Whole Cartesian paths on one core: kinopt's path solver, IKLink, a dense graph like that of Descartes, OptIK
started at the previous point, and pink's differential steps.

Usage: ``python cartesian_paths.py URDF BASE TIP PATH... [--iklink FOLDER] [--samples N] [--jump RADIANS]``. The
environment needs kinopt's wheel and requirements-paths.txt.

A PATH is a table for `kinopt path`, or a problem of CppFlow (``robot__name.yaml`` next to ``name.csv``). Only
contenders with collision avoidance use its boxes. FOLDER is a built clone of uwgraphics/IKLink (``cargo build
--release``). IKLink solves a path only if its settings include the robot.

Pinocchio judges every solution. A point counts within 1e-4 m and rad (IKLink's own check is wider). A jump is a
step in which a joint moves by more than 0.2 rad, or exceeds its velocity limit if the path has times.
"""

from __future__ import annotations

import argparse
import csv
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import kinopt
import numpy as np
import optik
import pink
import pinocchio
import yaml
from pink.tasks import FrameTask

NEAR = 1e-4
MARGIN = 0.0


class Asked:
    """A path: placements of the tip in the base frame, times if there are any, and boxes as obstacles."""

    def __init__(self, file: Path, judge: Judge) -> None:
        self.name, self.boxes = file.stem, []
        base_from_path, turn = pinocchio.SE3.Identity(), np.eye(3)
        table = file
        if file.suffix == ".yaml":
            told = yaml.safe_load(file.read_text())
            table = file.with_name(told["path_name"] + ".csv")
            # Positions are relative to a frame's placement at rest; each orientation is rotated separately.
            world_from_path = judge.at_rest(told["path_offset_frame"])
            world_from_path.translation += np.array(told["path_xyz_offset"])
            base_from_path = judge.at_rest(judge.base).actInv(world_from_path)
            turn = np.array(told["path_R_offset"])
            for box in told.get("obstacles") or []:
                value = {key: number for part in box for key, number in part.items()}
                at = pinocchio.SE3(pinocchio.rpy.rpyToMatrix(value["roll"], value["pitch"], value["yaw"]),
                                   np.array([value["x"], value["y"], value["z"]])
                                   + np.array(told["obstacle_xyz_offset"]))
                self.boxes.append(([value[f"size_{axis}"] for axis in "xyz"], at.homogeneous))
        with table.open() as rows:
            header, *rows = list(csv.reader(rows))
        numbers = np.array([[float(cell) for cell in row] for row in rows])
        w_last = any(re.search("ROT_W$", name) for name in header[-1:])
        at, quaternion = numbers[:, 1:4], numbers[:, 4:8]
        quaternion = quaternion if w_last else np.roll(quaternion, -1, axis=1)
        self.times = numbers[:, 0] if "time" in header[0] else None
        self.points = np.zeros((len(at), 4, 4))
        for point, p, (x, y, z, w) in zip(self.points, at, quaternion):
            placed = pinocchio.SE3(pinocchio.Quaternion(w, x, y, z).normalized().matrix() @ turn, p)
            point[:] = (base_from_path * placed).homogeneous


class Judge:
    """Pinocchio's model of the same file, and the joints of the contenders' solutions."""

    def __init__(self, urdf: str, base: str, tip: str, names: list[str], jump: float) -> None:
        self.model = pinocchio.buildModelFromUrdf(urdf)
        self.data = self.model.createData()
        self.base, self.tip = base, tip
        self.base_id, self.tip_id = (self.model.getFrameId(frame) for frame in (base, tip))
        self.joints = [self.model.joints[self.model.getJointId(name)] for name in names]
        self.speeds = self.model.velocityLimit[[joint.idx_v for joint in self.joints]]
        self.slides = any("JointModelP" in joint.shortname() for joint in self.joints)
        self.jump = jump

    def at_rest(self, frame: str) -> pinocchio.SE3:
        """Placement of a frame in the world with every joint at zero."""
        if frame == "world":
            return pinocchio.SE3.Identity()
        pinocchio.framesForwardKinematics(self.model, self.data, pinocchio.neutral(self.model))
        return self.data.oMf[self.model.getFrameId(frame)].copy()

    def whole(self, q: np.ndarray) -> np.ndarray:
        """Pinocchio's configuration, in which an unbounded joint is a cosine and a sine."""
        whole = pinocchio.neutral(self.model)
        for value, joint in zip(q, self.joints):
            own = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
            whole[joint.idx_q:joint.idx_q + joint.nq] = own
        return whole

    def angles(self, whole: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Joint values of such a configuration. Unbounded joints get the nearest value up to full turns."""
        q = np.array(near)
        for index, joint in enumerate(self.joints):
            own = whole[joint.idx_q:joint.idx_q + joint.nq]
            if joint.nq == 2:
                by = np.arctan2(own[1], own[0]) - near[index]
                q[index] += by - 2 * np.pi * np.round(by / (2 * np.pi))
            else:
                q[index] = own[0]
        return q

    def tool(self, q: np.ndarray) -> np.ndarray:
        pinocchio.framesForwardKinematics(self.model, self.data, self.whole(q))
        return self.data.oMf[self.base_id].actInv(self.data.oMf[self.tip_id]).homogeneous

    def line(self, name: str, asked: Asked, q: np.ndarray, seconds: float) -> str:
        missed, worst = 0, 0.0
        for point, row in zip(asked.points, q):
            apart = pinocchio.log6(pinocchio.SE3(point).actInv(pinocchio.SE3(self.tool(row))))
            error = max(np.linalg.norm(apart.linear), np.linalg.norm(apart.angular))
            missed += error > NEAR
            worst = max(worst, error)
        steps = np.abs(np.diff(q, axis=0))
        jumps = int((steps > self.jump).any(axis=1).sum())
        quick = "-"
        if asked.times is not None:
            allowed = self.speeds * np.diff(asked.times)[:, None] * (1 + 1e-9)
            quick = int((steps > allowed).any(axis=1).sum())
        length = np.linalg.norm(np.diff(q, axis=0), axis=1).sum()
        return (f"| {asked.name} | {name} | {len(q)} | {missed} | {worst:.1e} | {jumps} | {quick} | {length:.2f} "
                f"| {1e3 * seconds:.1f} |")


def by_kinopt(arm: kinopt.Arm, asked: Asked, rounds: int, keep_times: bool = False) -> tuple[np.ndarray, float]:
    best, q = np.inf, None
    for _ in range(rounds):
        begun = time.process_time()
        q = kinopt.solve_path(arm, asked.points, times=asked.times, keep_times=keep_times).q
        best = min(best, time.process_time() - begun)
    return q, best


def by_dense_graph(arm: kinopt.Arm, asked: Asked, samples: int, jump: float) -> tuple[np.ndarray, float]:
    """Dense graph as in Descartes: n solutions per point, and all edges between neighbours. Dynamic programming
    finds the fewest jumps, then the shortest length. kinopt computes the solutions in batches from random starts.
    """
    begun = time.process_time()
    random = np.random.default_rng(1)
    lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    layers, before, cost = [], [], None
    for point in asked.points:
        starts = random.uniform(lower, upper, (samples, len(lower)))
        found = arm.solve_batch(np.repeat(point[None], samples, axis=0), starts)
        layer = found.q[found.reached]
        if len(layer) == 0:
            layer = layers[-1] if layers else starts
        if cost is None:
            cost = np.zeros((len(layer), 2))
        else:
            steps = np.abs(layer[:, None] - layers[-1][None])
            jumps = cost[None, :, 0] + (steps > jump).any(axis=2)
            lengths = cost[None, :, 1] + np.linalg.norm(steps, axis=2)
            # Jumps have priority: no path is a thousand radians long.
            chosen = (1e6 * jumps + lengths).argmin(axis=1)
            rows = np.arange(len(layer))
            cost = np.stack([jumps[rows, chosen], lengths[rows, chosen]], axis=1)
            before.append(chosen)
        layers.append(layer)
    at = int((1e6 * cost[:, 0] + cost[:, 1]).argmin())
    way = [layers[-1][at]]
    for layer, chosen in zip(reversed(layers[:-1]), reversed(before)):
        at = chosen[at]
        way.append(layer[at])
    return np.array(way[::-1]), time.process_time() - begun


def by_optik(urdf: str, base: str, tip: str, asked: Asked, start: np.ndarray) -> tuple[np.ndarray, float]:
    robot = optik.Robot.from_urdf_file(urdf, base, tip)
    robot.set_parallelism(1)
    config = optik.SolverConfig("speed", max_time=0.1, tol_f=1e-12)
    q, rows = start, []
    begun = time.perf_counter()
    for point in asked.points:
        found = robot.ik(config, [list(map(float, row)) for row in point], list(map(float, q)))
        q = np.array(found[0]) if found else q
        rows.append(q)
    return np.array(rows), time.perf_counter() - begun


def by_pink(judge: Judge, asked: Asked, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Differential steps at each point until it is reached or a step fails."""
    configuration = pink.Configuration(judge.model, judge.data, judge.whole(start))
    task = FrameTask(judge.tip, position_cost=1.0, orientation_cost=1.0)
    pinocchio.framesForwardKinematics(judge.model, judge.data, pinocchio.neutral(judge.model))
    world_from_base = judge.data.oMf[judge.base_id].copy()
    rows, q = [], start
    begun = time.process_time()
    for point in asked.points:
        task.set_target(world_from_base * pinocchio.SE3(point))
        for _ in range(50):
            error = task.compute_error(configuration)
            if max(np.linalg.norm(error[:3]), np.linalg.norm(error[3:])) < 1e-6:
                break
            try:
                velocity = pink.solve_ik(configuration, [task], 1.0, solver="daqp", safety_break=False)
            except pink.exceptions.PinkError:
                break
            configuration.integrate_inplace(velocity, 1.0)
        q = judge.angles(configuration.q, q)
        rows.append(q)
    return np.array(rows), time.process_time() - begun


def by_iklink(folder: Path, robot: str, asked: Asked, names: list[str]) -> tuple[np.ndarray, float]:
    """IKLink's program on this path alone, in a copy of its folders."""
    with tempfile.TemporaryDirectory() as place:
        shutil.copytree(folder / "configs", Path(place) / "configs")
        for own in ("input_trajectories", "output_motions"):
            (Path(place) / own).mkdir()
        table = Path(place) / "input_trajectories" / f"{robot}_asked.csv"
        with table.open("w", newline="") as rows:
            writer = csv.writer(rows)
            writer.writerow(["time", *(f"target-POS_{axis}" for axis in "XYZ"), *(f"target-ROT_{axis}" for axis in "XYZW")])
            for when, point in zip(asked.times, asked.points):
                quaternion = pinocchio.Quaternion(point[:3, :3]).coeffs()
                writer.writerow([when, *point[:3, 3], *quaternion])
        begun = time.perf_counter()
        subprocess.run([str(folder / "target/release/traj_tracing")], cwd=place, check=True, capture_output=True)
        took = time.perf_counter() - begun
        with (Path(place) / "output_motions" / table.name).open() as rows:
            header, *rows = list(csv.reader(rows))
        columns = [next(i for i, head in enumerate(header) if head.endswith(name)) for name in names]
        return np.array([[float(row[column]) for column in columns] for row in rows]), took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("urdf")
    parser.add_argument("base")
    parser.add_argument("tip")
    parser.add_argument("paths", type=Path, nargs="+")
    parser.add_argument("--iklink", type=Path)
    parser.add_argument("--iklink-robot", default="panda", help="robot name in IKLink's settings")
    parser.add_argument("--samples", type=int, default=200, help="solutions per point of the dense graph")
    parser.add_argument("--jump", type=float, default=0.2)
    parser.add_argument("--rounds", type=int, default=5)
    wanted = parser.parse_args()
    robot = kinopt.Robot.from_urdf(wanted.urdf)
    arm = kinopt.Arm(robot, wanted.base, wanted.tip)
    judge = Judge(wanted.urdf, wanted.base, wanted.tip, arm.joint_names, wanted.jump)
    print("| path | solver | points | missed | worst error | jumps | too fast | joint length | ms |\n"
          "|---|---|---:|---:|---:|---:|---:|---:|---:|")
    for asked in (Asked(path, judge) for path in wanted.paths):
        world = kinopt.World()
        for index, (size, pose) in enumerate(asked.boxes):
            world.add_box(f"box {index}", size, pose)
        q, seconds = by_kinopt(arm, asked, wanted.rounds)
        print(judge.line("kinopt", asked, q, seconds), flush=True)
        if asked.times is not None and np.isfinite(arm.velocity_limits).all():
            told = judge.line("kinopt, speeds kept", asked, *by_kinopt(arm, asked, wanted.rounds, True))
            print(told, flush=True)
        if asked.boxes:
            clear = kinopt.Arm(robot, wanted.base, wanted.tip, world=world, margin=MARGIN)
            told = judge.line("kinopt, its boxes", asked, *by_kinopt(clear, asked, wanted.rounds))
            print(told, flush=True)
        start = q[0]
        contenders = [
            ("dense graph", lambda: by_dense_graph(arm, asked, wanted.samples, wanted.jump)),
            ("pink, from where it stood", lambda: by_pink(judge, asked, start)),
        ]
        # OptIK does not support prismatic joints: it aborts the process.
        if not judge.slides:
            contenders.append(
                ("OptIK, from where it stood", lambda: by_optik(wanted.urdf, wanted.base, wanted.tip, asked, start)))
        if wanted.iklink and asked.times is not None:
            contenders.append(
                ("IKLink", lambda: by_iklink(wanted.iklink, wanted.iklink_robot, asked, arm.joint_names)))
        for name, solve in contenders:
            print(judge.line(name, asked, *solve()), flush=True)


if __name__ == "__main__":
    main()
