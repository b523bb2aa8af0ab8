"""Batches of poses on a GPU compared with kinopt on the processor: PyRoki and cuRobo, with and without obstacles, in
one run.

Usage: ``python gpu_batches.py CUROBO [--steps ask,kinopt,pyroki,curobo,judge] [--to FOLDER]``, in the root of the
repository. The environment needs kinopt's wheel and requirements-gpu.txt. CUROBO is a checkout of cuRobo, whose
Panda and spheres define the queries. Each step is a separate process that leaves its files in FOLDER, so steps
can run on different machines.

Targets are poses of random configurations within the limits. Among obstacles the configurations are
collision-free by the judge, by kinopt, by cuRobo's padded spheres and by PyRoki's capsules. Each rival has a
world of shapes that it supports exactly: 30 boxes for cuRobo, 15 spheres and 15 capsules for PyRoki. The judge is
Pinocchio in double precision, with distances of spheres in closed form.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from gpu_answers import BASE, BATCHES, TIP, Answers

FINGER = 0.04  # Position at which cuRobo locks the fingers, metres
POOL = 10_000
CLEAR_POOL = 1_000
TOLERANCES = {"5 mm, 0.05 rad": (5e-3, 0.05), "1e-3 m, 1e-2 rad": (1e-3, 1e-2), "1e-6": (1.001e-6, 1.001e-6)}


def configuration(curobo: Path) -> dict:
    import yaml

    told = yaml.safe_load((curobo / "curobo/content/configs/robot/franka.yml").read_text())
    return told["robot_cfg"]["kinematics"]


def write_robots(curobo: Path, folder: Path) -> None:
    """Writes cuRobo's Panda with fixed fingers: once with its meshes, and once with cuRobo's spheres as shapes."""
    content = curobo / "curobo/content/assets/robot/franka_description"
    spheres = configuration(curobo)["collision_spheres"]
    for name, with_spheres in (("panda.urdf", False), ("panda_spheres.urdf", True)):
        tree = ET.parse(content / "franka_panda.urdf")
        for joint in tree.getroot().findall("joint[@type='prismatic']"):
            along = np.array(joint.find("axis").get("xyz").split(), float)
            origin = joint.find("origin")
            at = np.array((origin.get("xyz") or "0 0 0").split(), float) + FINGER * along
            origin.set("xyz", " ".join(map(repr, map(float, at))))
            joint.set("type", "fixed")
            for tag in ("axis", "limit", "dynamics", "mimic"):
                for child in joint.findall(tag):
                    joint.remove(child)
        for link in tree.getroot().findall("link"):
            if with_spheres:
                for tag in ("visual", "collision"):
                    for child in link.findall(tag):
                        link.remove(child)
                for one in spheres.get(link.get("name"), []):
                    shape = ET.SubElement(link, "collision")
                    ET.SubElement(shape, "origin", xyz=" ".join(map(str, one["center"])), rpy="0 0 0")
                    ET.SubElement(ET.SubElement(shape, "geometry"), "sphere", radius=str(one["radius"]))
            else:
                for mesh in link.iter("mesh"):
                    mesh.set("filename", mesh.get("filename").split("franka_description/")[-1])
        tree.write(folder / name)


def turned(random: np.random.Generator, count: int) -> np.ndarray:
    """Random quaternions w, x, y, z, shape (count, 4)."""
    drawn = random.normal(size=(count, 4))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def matrices(quaternions: np.ndarray) -> np.ndarray:
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


def draw_worlds(random: np.random.Generator) -> dict:
    """Random worlds around the arm, at least 0.3 m from its axis: 30 boxes; 15 spheres and 15 capsules. Lengths are
    in metres.
    """
    around = random.uniform(-np.pi, np.pi, 60)
    far, high = random.uniform(0.45, 0.85, 60), random.uniform(0.05, 1.0, 60)
    at = np.stack([far * np.cos(around), far * np.sin(around), high], axis=1)
    turns = turned(random, 60)
    return {
        "boxes_at": at[:30], "boxes_turn": turns[:30], "boxes_size": random.uniform(0.05, 0.16, (30, 3)),
        "spheres_at": at[30:45], "spheres_radius": random.uniform(0.03, 0.1, 15),
        "capsules_at": at[45:], "capsules_turn": turns[45:],
        "capsules_size": np.stack([random.uniform(0.02, 0.06, 15), random.uniform(0.1, 0.3, 15)], axis=1),
    }


class Judge:
    """Forward kinematics by Pinocchio, and sphere distances in closed form."""

    def __init__(self, folder: Path, worlds: dict) -> None:
        import pinocchio

        self.pinocchio, self.worlds = pinocchio, worlds
        self.model = pinocchio.buildModelFromUrdf(str(folder / "panda_spheres.urdf"))
        self.data = self.model.createData()
        body = pinocchio.FrameType.BODY
        self.base, self.tip = (self.model.getFrameId(name, body) for name in (BASE, TIP))
        told = json.loads((folder / "spheres.json").read_text())
        self.links = list(told["spheres"])
        self.frames = [self.model.getFrameId(name, body) for name in self.links]
        self.centres = [np.array([one["center"] for one in told["spheres"][name]]) for name in self.links]
        self.radii = np.concatenate([[one["radius"] for one in told["spheres"][name]] for name in self.links])
        of = np.concatenate([[index] * len(told["spheres"][name]) for index, name in enumerate(self.links)])
        kept = {frozenset((a, b)) for a in self.links for b in self.links if a != b}
        kept -= {frozenset((a, b)) for a, others in told["ignored"].items() for b in others}
        self.first, self.second = np.triu_indices(len(of), 1)
        checked = [frozenset((self.links[of[a]], self.links[of[b]])) in kept for a, b in zip(self.first, self.second)]
        self.first, self.second = self.first[checked], self.second[checked]
        self.padding = np.array([told["padding"].get(self.links[index], 0.0) for index in of])

    def place(self, q: np.ndarray) -> tuple:
        self.pinocchio.framesForwardKinematics(self.model, self.data, q)
        base = self.data.oMf[self.base]
        tool = base.actInv(self.data.oMf[self.tip]).homogeneous
        placed = [base.actInv(self.data.oMf[frame]) for frame in self.frames]
        return tool, np.concatenate([own @ frame.rotation.T + frame.translation for own, frame in zip(self.centres, placed)])

    def clear_of_itself(self, centres: np.ndarray, padded: bool = False) -> bool:
        radii = self.radii + self.padding if padded else self.radii
        apart = np.linalg.norm(centres[self.first] - centres[self.second], axis=1)
        return bool((apart >= radii[self.first] + radii[self.second]).all())

    def clear_of(self, world: str, centres: np.ndarray) -> float:
        """Smallest distance of the spheres to a world, metres."""
        if world == "plain":
            return np.inf
        w = self.worlds
        if world == "boxes":
            local = np.einsum("bji,bsj->bsi", matrices(w["boxes_turn"]), centres[None] - w["boxes_at"][:, None])
            over = np.abs(local) - 0.5 * w["boxes_size"][:, None]
            far = np.linalg.norm(np.maximum(over, 0), axis=2) + np.minimum(over.max(axis=2), 0)
            return float((far - self.radii).min())
        balls = np.linalg.norm(centres[None] - w["spheres_at"][:, None], axis=2) - w["spheres_radius"][:, None]
        along = matrices(w["capsules_turn"])[:, :, 2]
        relative = centres[None] - w["capsules_at"][:, None]
        radius, length = w["capsules_size"].T[:, :, None]
        on = np.clip(np.einsum("bsi,bi->bs", relative, along), -0.5 * length, 0.5 * length)
        capsules = np.linalg.norm(relative - on[..., None] * along[:, None], axis=2) - radius
        return float(min((balls - self.radii).min(), (capsules - self.radii).min()))


def world_of(kind: str, worlds: dict):
    """kinopt's world of this kind."""
    import kinopt

    def placed(at, turn=(1.0, 0.0, 0.0, 0.0)):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = matrices(np.array([turn]))[0], at
        return pose

    world, w = kinopt.World(), worlds
    if kind == "boxes":
        for index in range(len(w["boxes_at"])):
            world.add_box(f"box {index}", w["boxes_size"][index], placed(w["boxes_at"][index], w["boxes_turn"][index]))
        return world
    for index in range(len(w["spheres_at"])):
        world.add_sphere(f"sphere {index}", w["spheres_radius"][index], placed(w["spheres_at"][index]))
    for index in range(len(w["capsules_at"])):
        radius, length = w["capsules_size"][index]
        world.add_capsule(f"capsule {index}", radius, length, placed(w["capsules_at"][index], w["capsules_turn"][index]))
    return world


def arm_of(folder: Path, kind: str, worlds: dict):
    import kinopt

    robot = kinopt.Robot.from_urdf(str(folder / "panda_spheres.urdf"))
    if kind == "plain":
        return kinopt.Arm(robot, BASE, TIP)
    model = robot.collision_model()
    ignored = json.loads((folder / "spheres.json").read_text())["ignored"]
    for first, others in ignored.items():
        for second in others:
            if first in model.links and second in model.links and model.is_checked(first, second):
                model = model.with_ignored(first, second)
    return kinopt.Arm(robot, BASE, TIP, world=world_of(kind, worlds), collision_model=model)


def ask(curobo: Path, folder: Path) -> None:
    write_robots(curobo, folder)
    told = configuration(curobo)
    spheres = told["collision_spheres"]
    ignored = {name: [other for other in others if other in spheres]
               for name, others in told["self_collision_ignore"].items() if name in spheres}
    (folder / "spheres.json").write_text(json.dumps(
        {"spheres": spheres, "ignored": ignored, "padding": told["self_collision_buffer"]}))
    random = np.random.default_rng(1)
    worlds = draw_worlds(random)
    judge = Judge(folder, worlds)
    lower, upper = judge.model.lowerPositionLimit, judge.model.upperPositionLimit
    try:
        from gpu_solvers import capsules_touch
    except ImportError:
        capsules_touch = None
        print("PyRoki is not here: its capsules are not asked whether goals are free")
    kept = dict(worlds)
    for kind, count in (("plain", POOL), ("boxes", CLEAR_POOL), ("rounds", CLEAR_POOL)):
        arm = arm_of(folder, kind, worlds)
        told, drawn, goals = [0, 0], 0, []
        while len(goals) < count:
            configurations = random.uniform(lower, upper, (count, len(lower)))
            touching = np.zeros(count, bool)
            if kind == "rounds" and capsules_touch:
                touching = capsules_touch(curobo, folder, worlds, configurations)
            for q, touches in zip(configurations, touching):
                if len(goals) == count:
                    break
                drawn += 1
                if kind != "plain":
                    centres = judge.place(q)[1]
                    if judge.clear_of(kind, centres) <= 0 or not judge.clear_of_itself(centres, padded=True):
                        continue
                    told[0] += 1
                    if touches or arm.collisions(q):
                        continue
                goals.append(q)
        goals = np.array(goals)
        print(f"{kind}: {count} goals of {drawn} configurations" + (f", {told[0]} free by the judge" if told[0] else ""))
        kept[f"{kind}_goals"] = goals
        kept[f"{kind}_targets"] = np.array([judge.place(q)[0] for q in goals])
        assert np.abs(arm.base_from_tool(goals) - kept[f"{kind}_targets"]).max() < 1e-12
    np.savez_compressed(folder / "questions.npz", **kept)


def processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def by_kinopt(folder: Path, questions: dict) -> None:
    import kinopt

    cores = sorted(os.sched_getaffinity(0))
    about = {"kinopt": kinopt.__version__ if hasattr(kinopt, "__version__") else "", "processor": processor(), "cores": len(cores)}
    answers = Answers(folder, "kinopt", about)
    for threads in dict.fromkeys((1, len(cores))):
        os.sched_setaffinity(0, cores[:1] if threads == 1 else cores)
        for kind, batches in BATCHES.items():
            begun = time.perf_counter()
            arm = arm_of(folder, kind, questions)
            targets = questions[f"{kind}_targets"]
            prepared = time.perf_counter() - begun

            def call(given, preparing):
                return targets[given] if preparing else arm.solve_batch(given, threads=threads)

            for batch in batches:
                name = f"kinopt, {threads} core{'s' if threads > 1 else ''}"
                answers.take(name, kind, batch, len(targets), prepared, call,
                             lambda solved: np.where(solved.reached[:, None], solved.q, np.nan))


def judged(folder: Path, questions: dict) -> None:
    judge = Judge(folder, questions)
    lower, upper = judge.model.lowerPositionLimit, judge.model.upperPositionLimit
    single = 1e-6 * (upper - lower)  # Rounding of a limit in single precision
    rows = {}
    for who in ("kinopt", "pyroki", "curobo"):
        if not (folder / f"{who}.json").exists():
            continue
        told, answers = json.loads((folder / f"{who}.json").read_text()), np.load(folder / f"{who}.npz")
        print(f"{who}: {told['about']}")
        for row in told["rows"]:
            found, kind = answers[row["key"]].astype(float), row["kind"]
            targets, goals = questions[f"{kind}_targets"], []
            for q, target in zip(found, targets):
                if not np.isfinite(q).all():
                    goals.append([np.inf, np.inf, False, False, False])
                    continue
                tool, centres = judge.place(q)
                turn = judge.pinocchio.log3(tool[:3, :3].T @ target[:3, :3])
                goals.append([np.linalg.norm(tool[:3, 3] - target[:3, 3]), np.linalg.norm(turn),
                              ((q >= lower - single) & (q <= upper + single)).all(),
                              judge.clear_of(kind, centres) > -1e-6, judge.clear_of_itself(centres)])
            far, angle, within, apart, own = np.array(goals, float).T
            free = (apart * own).astype(bool) if kind != "plain" else np.ones(len(far), bool)
            row |= {"asked": len(far), "within limits %": 100 * within.mean(), "median far m": float(np.median(far))}
            given = np.isfinite(far)
            row |= {"answers %": 100 * given.mean(), "free %": 100 * free[given].mean()}
            row["solved %"] = {name: 100 * float(((far <= p) & (angle <= r) & (within > 0) & free).mean())
                               for name, (p, r) in TOLERANCES.items()}
            rows.setdefault(kind, []).append(row)
    for kind, told in rows.items():
        print(f"\n{kind}\n| solver | batch | ms a batch | poses a second | {' | '.join(f'solved % at {name}' for name in TOLERANCES)} "
              f"| of answers free % | ready after s |\n|---|---:|---:|---:|{'---:|' * len(TOLERANCES)}---:|---:|")
        for row in sorted(told, key=lambda one: one["batch"]):
            middle = float(np.median(row["times_s"]))
            shares = " | ".join(f"{share:.2f}" for share in row["solved %"].values())
            free = "" if kind == "plain" else f"{row['free %']:.1f}"
            print(f"| {row['solver']} | {row['batch']} | {1e3 * middle:.3f} | {row['batch'] / middle:.0f} | {shares} | {free} "
                  f"| {row['prepared_s']:.1f} |")
    (folder / "judged.json").write_text(json.dumps(rows, default=float))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("curobo", type=Path, help="a checkout of cuRobo")
    parser.add_argument("--steps", default="ask,kinopt,pyroki,curobo,judge")
    parser.add_argument("--to", type=Path, default=Path("target/rivals/gpu-batches"))
    parser.add_argument("--kinds", default="plain,boxes,rounds", help="plain poses, among boxes, among spheres and capsules")
    wanted = parser.parse_args()
    for kind in set(BATCHES) - set(wanted.kinds.split(",")):
        del BATCHES[kind]
    steps, folder = wanted.steps.split(","), wanted.to
    folder.mkdir(parents=True, exist_ok=True)
    if len(steps) > 1:
        for step in steps:  # Separate processes: a GPU fault of one rival does not affect the next.
            subprocess.run([sys.executable, __file__, str(wanted.curobo), "--steps", step, "--to", str(folder),
                            "--kinds", wanted.kinds])
        return
    if steps == ["ask"]:
        return ask(wanted.curobo, folder)
    questions = dict(np.load(folder / "questions.npz"))
    if steps == ["kinopt"]:
        return by_kinopt(folder, questions)
    if steps == ["judge"]:
        return judged(folder, questions)
    import gpu_solvers

    solve = {"pyroki": gpu_solvers.by_pyroki, "curobo": gpu_solvers.by_curobo}[steps[0]]
    solve(wanted.curobo, folder, questions)


if __name__ == "__main__":
    main()
