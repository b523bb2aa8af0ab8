"""Batches of 100 problems of a dual UR10e and a Unitree G1 over a table, as in cuRobo's own benchmark, by kinopt on the processor.

Usage: ``python many_joints.py CUROBO [--threads N] [--batches N]``. The environment needs kinopt's wheel and
requirements-many-joints.txt. CUROBO is a checkout of cuRobo (NVlabs/curobo, Apache-2.0), of which two URDF files and two
configurations are read.

Problems are those of ``benchmark/ik_benchmark.py``: poses of all tool frames of random configurations. The dual UR10e has two
tools, the G1 on a free base two fingers and two ankles. With collisions the world is ``collision_table.yml``, and the
configurations are free by kinopt and by the judge, with cuRobo's spheres and its list of ignored pairs. kinopt has the same
spheres, starts at the zero configuration, and reaches 1e-6 m and rad. cuRobo counts 5 mm and 0.05 rad as solved.

The judge is Pinocchio, with the distances of spheres in closed form. Times are wall-clock times of a whole batch: the mean of the
batches, each the best of two rounds. The solver has at most 1 000 attempts a problem; its default of 32 misses some.
"""

from __future__ import annotations

import argparse
import os
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio
import yaml

import kinopt
from kinopt import tasks

BATCH, TOLERANCE, ROUNDS, ATTEMPTS = 100, 1e-6, 2, 1_000
ROBOTS = {"dual UR10e": "dual_ur10e.yml", "Unitree G1": "unitree_g1.yml"}
#: Ranges of the G1's base in cuRobo's configuration, metres.
BASE_BOUNDS_M = (-10.0, 10.0)


class Body:
    """A robot of cuRobo: its URDF with spheres as collision shapes, its pairs and its world."""

    def __init__(self, curobo: Path, file: str) -> None:
        content = curobo / "curobo/content"
        told = yaml.safe_load((content / "configs/robot" / file).read_text())
        told = told.get("robot_cfg", told)["kinematics"]
        self.tips, self.spheres = told["tool_frames"], told["collision_spheres"]
        self.free = "base_j_x" in told["cspace"]["joint_names"]
        tree = ET.parse(content / "assets" / told["urdf_path"])
        for link in tree.getroot().findall("link"):
            for tag in ("visual", "collision"):
                for child in link.findall(tag):
                    link.remove(child)
            for one in self.spheres.get(link.get("name"), []):
                shape = ET.SubElement(link, "collision")
                ET.SubElement(shape, "origin", xyz=" ".join(map(str, one["center"])), rpy="0 0 0")
                ET.SubElement(ET.SubElement(shape, "geometry"), "sphere", radius=str(one["radius"]))
        self.urdf = ET.tostring(tree.getroot(), encoding="unicode")
        ignored = {frozenset((a, b)) for a, others in told["self_collision_ignore"].items() for b in others}
        names = list(self.spheres)
        self.pairs = {frozenset((a, b)) for i, a in enumerate(names) for b in names[:i]} - ignored

        bounds = {name: BASE_BOUNDS_M for name in "xyz"} if self.free else None
        self.robot = kinopt.Robot.from_urdf_text(self.urdf, base_joint="free" if self.free else None, base_bounds=bounds)
        shapes = self.robot.collision_model()
        for i, a in enumerate(names):
            for b in names[:i]:
                wanted = frozenset((a, b)) in self.pairs
                if wanted != shapes.is_checked(a, b):
                    shapes = shapes.with_checked(a, b) if wanted else shapes.with_ignored(a, b)
        self.shapes = shapes
        scene = yaml.safe_load((content / "configs/scene/collision_table.yml").read_text())["cuboid"]
        self.boxes = [(np.array(box["dims"]), np.array(box["pose"][:3])) for box in scene.values()]
        self.world = kinopt.World()
        for index, (size, at) in enumerate(self.boxes):
            self.world.add_box(f"box {index}", size, kinopt.placement(at))


class Judge:
    """Forward kinematics by Pinocchio, and sphere distances in closed form."""

    def __init__(self, body: Body) -> None:
        base = [pinocchio.JointModelFreeFlyer()] if body.free else []
        self.body, self.model = body, pinocchio.buildModelFromXML(body.urdf, *base)
        self.data = self.model.createData()
        frame = pinocchio.FrameType.BODY
        self.tips = [self.model.getFrameId(name, frame) for name in body.tips]
        names = list(body.spheres)
        self.links = [self.model.getFrameId(name, frame) for name in names]
        self.centres = [np.array([one["center"] for one in body.spheres[name]]) for name in names]
        self.radii = np.concatenate([[one["radius"] for one in body.spheres[name]] for name in names])
        of = np.concatenate([[index] * len(body.spheres[name]) for index, name in enumerate(names)])
        first, second = np.triu_indices(len(of), 1)
        checked = np.array([[frozenset((a, b)) in body.pairs for b in names] for a in names])[of[first], of[second]]
        self.first, self.second = first[checked], second[checked]

    def place(self, q: np.ndarray) -> tuple:
        """Poses of the tool frames and centres of the spheres, for a configuration of kinopt."""
        pinocchio.framesForwardKinematics(self.model, self.data, self.body.robot.to_pinocchio(q))
        at = [self.data.oMf[link] for link in self.links]
        centres = [own @ frame.rotation.T + frame.translation for own, frame in zip(self.centres, at)]
        return np.array([self.data.oMf[tip].homogeneous for tip in self.tips]), np.concatenate(centres)

    def is_free(self, centres: np.ndarray) -> bool:
        apart = np.linalg.norm(centres[self.first] - centres[self.second], axis=1)
        if (apart < self.radii[self.first] + self.radii[self.second] - TOLERANCE).any():
            return False
        for size, at in self.body.boxes:  # The boxes have no rotation.
            over = np.abs(centres - at) - 0.5 * size
            far = np.linalg.norm(np.maximum(over, 0), axis=1) + np.minimum(over.max(axis=1), 0)
            if (far < self.radii - TOLERANCE).any():
                return False
        return True


def problems(body: Body, judge: Judge, count: int, collision_free: bool) -> np.ndarray:
    """Poses of all tool frames, shape (count, tips, 4, 4). kinopt's check comes first, since it is faster than the judge's."""
    checks = kinopt.Problem(body.robot, [], world=body.world, collision_model=body.shapes)
    targets, seed = [], 0
    while len(targets) < count:
        for q in body.robot.random_configuration(100, seed=seed):
            if collision_free and checks.collisions(q):
                continue
            poses, centres = judge.place(q)
            if not collision_free or judge.is_free(centres):
                targets.append(poses)
        seed += 1
    return np.array(targets[:count])


def judged(judge: Judge, solved, targets: np.ndarray, collision_free: bool) -> int:
    """Number of solutions within the tolerance and, if asked, collision-free."""
    right = 0
    for q, wanted in zip(solved.q, targets):
        poses, centres = judge.place(q)
        errors = [max(np.linalg.norm(pose[:3, 3] - target[:3, 3]), np.linalg.norm(pinocchio.log3(pose[:3, :3].T @ target[:3, :3])))
                  for pose, target in zip(poses, wanted)]
        right += max(errors) <= 1.001 * TOLERANCE and (not collision_free or judge.is_free(centres))
    return right


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("curobo", type=Path)
    parser.add_argument("--threads", type=int, help="cores of the second row; all by default")
    parser.add_argument("--batches", type=int, default=5)
    chosen = parser.parse_args()
    cores = sorted(os.sched_getaffinity(0))
    print("| robot | problems | cores | solved | ms a batch of 100 |\n|---|---|---:|---:|---:|")
    for name, file in ROBOTS.items():
        body = Body(chosen.curobo, file)
        judge = Judge(body)
        start = body.robot.neutral()
        for collision_free in (False, True):
            targets = problems(body, judge, BATCH * chosen.batches, collision_free)
            settings = {"world": body.world, "collision_model": body.shapes} if collision_free else {}
            poses = [tasks.Pose(tip, np.eye(4), name=tip) for tip in body.tips]
            problem, solver = kinopt.Problem(body.robot, poses, tolerance=TOLERANCE, **settings), kinopt.Solver(attempts=ATTEMPTS)
            for threads in dict.fromkeys((1, chosen.threads or len(cores))):
                spent, right = [], 0
                for batch in np.split(targets, chosen.batches):
                    given = {tip: batch[:, index] for index, tip in enumerate(body.tips)}
                    times = []
                    for _ in range(ROUNDS):
                        begin = time.perf_counter()
                        solved = solver.solve_batch(problem, np.tile(start, (BATCH, 1)), given, threads=threads)
                        times.append(time.perf_counter() - begin)
                    spent.append(min(times))
                    right += judged(judge, solved, batch, collision_free)
                world = "table and itself" if collision_free else "no collisions"
                print(f"| {name} | {world} | {threads} | {right / len(targets):.1%} | {1e3 * np.mean(spent):.1f} |", flush=True)


if __name__ == "__main__":
    main()
