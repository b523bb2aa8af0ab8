"""Poses among obstacles, one at a time on one core: kinopt with and without a world, rejection by VAMP's check,
OptIK and RoboPlan.

Usage: ``python among_obstacles.py FOLDER ROBOT [--per-kind N] [--slow N] [--kinds KIND...] [--no-rust]``, in the root of the
repository. The environment needs kinopt's wheel and requirements-obstacles.txt; VAMP takes part if it is installed. Rust's
rows need cargo.

FOLDER has VAMP's resources of one robot: its ``_spherized.urdf``, ``.urdf`` with meshes, ``.srdf``, and
MotionBenchMaker's problems in ``problems/``. A target is the pose of a problem's goal, so that a solution exists.
The start is the problem's. Pinocchio and coal judge every solution by the spheres and by the meshes.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import tempfile
import time
from pathlib import Path

import coal
import kinopt
import numpy as np
import optik
import pinocchio
import yaml

ROBOTS = {
    "panda": ("panda_link0", "panda_hand"),
    "ur5": ("base_link", "tool0"),
    "fetch": ("base_link", "gripper_link"),
    "baxter": ("base", "left_gripper_base"),  # Other arm: --tip right_gripper_base.
}
TOLERANCE = 1e-6
LOOSE = 1.1e-3  # RoboPlan's default tolerance, metres and radians
ATTEMPTS = 200


class Problem:
    """A scene of MoveIt and its goal."""

    def __init__(self, request: Path) -> None:
        asked = yaml.load(request.read_text(), yaml.CSafeLoader)
        self.scene = request.with_name(request.name.replace("request", "scene"))
        self.kind = request.parent.name
        goals = asked["goal_constraints"][0]["joint_constraints"]
        self.goal = {one["joint_name"]: one["position"] for one in goals}
        state = asked["start_state"]["joint_state"]
        self.start = dict(zip(state["name"], state["position"]))
        scene = yaml.load(self.scene.read_text(), yaml.CSafeLoader)
        self.solids = []
        for thing in scene["world"]["collision_objects"]:
            whole = placement(thing["pose"]) if "pose" in thing else np.eye(4)
            for shape, pose in zip(thing["primitives"], thing["primitive_poses"]):
                self.solids.append((shape["type"], shape["dimensions"], whole @ placement(pose)))


def placement(pose: dict) -> np.ndarray:
    x, y, z, w = pose["orientation"]
    quaternion = pinocchio.Quaternion(w, x, y, z).normalized()
    return pinocchio.SE3(quaternion, np.array(pose["position"])).homogeneous


class Judge:
    """Pinocchio and coal on one description of a robot."""

    def __init__(self, urdf: Path, srdf: Path, tip: str, base: str) -> None:
        self.model = pinocchio.buildModelFromUrdf(str(urdf))
        self.shapes = pinocchio.buildGeomFromUrdf(
            self.model, str(urdf), pinocchio.GeometryType.COLLISION, package_dirs=[str(urdf.parent)]
        )
        self.shapes.addAllCollisionPairs()
        pinocchio.removeCollisionPairs(self.model, self.shapes, str(srdf))
        # Adjacent links overlap by design, especially with spheres, and SRDF files do not list all such pairs.
        for pair in list(self.shapes.collisionPairs):
            a, b = (self.shapes.geometryObjects[index].parentJoint for index in (pair.first, pair.second))
            if a in (b, self.model.parents[b]) or b == self.model.parents[a]:
                self.shapes.removeCollisionPair(pair)
        self.own = len(self.shapes.geometryObjects)
        body = pinocchio.FrameType.BODY  # A joint can have the name of its link.
        self.data, self.tip = self.model.createData(), self.model.getFrameId(tip, body)
        self.base = self.model.getFrameId(base, body)

    def whole(self, *values: dict) -> np.ndarray:
        q = pinocchio.neutral(self.model)
        for told in values:
            for name, value in told.items():
                if self.model.existJointName(name):
                    joint = self.model.joints[self.model.getJointId(name)]
                    q[joint.idx_q:joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
        return q

    def tool(self, q: np.ndarray) -> np.ndarray:
        pinocchio.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.base].actInv(self.data.oMf[self.tip]).homogeneous

    def is_free(self, q: np.ndarray, solids: list) -> bool:
        shapes = self.shapes.copy()
        for index, (kind, size, pose) in enumerate(solids):
            shape = coal.Box(*size) if kind == "box" else (
                coal.Cylinder(size[1], size[0]) if kind == "cylinder" else coal.Sphere(size[0]))
            added = pinocchio.GeometryObject(f"solid {index}", 0, 0, pinocchio.SE3(pose), shape)
            number = shapes.addGeometryObject(added)
            for own in range(self.own):
                shapes.addCollisionPair(pinocchio.CollisionPair(own, number))
        return not pinocchio.computeCollisions(self.model, self.data, shapes, shapes.createData(), q, True)


def vamp_check(robot: str, problem: Problem):
    """VAMP's collision check in the scene of a problem."""
    import vamp
    from vamp.transformations import euler_from_matrix

    around = vamp.Environment()
    for kind, size, pose in problem.solids:
        at, turn = pose[:3, 3].tolist(), list(euler_from_matrix(pose))
        if kind == "box":
            around.add_cuboid(vamp.Cuboid(at, turn, [0.5 * length for length in size]))
        elif kind == "cylinder":
            around.add_capsule(vamp.Cylinder(at, turn, size[1], size[0]))
        else:
            around.add_sphere(vamp.Sphere(at, size[0]))
    module = getattr(vamp, robot)
    return lambda q: module.validate(q, around)


def rejection(solve, check, target, start, others):
    """Solves without obstacles from one start after another until the solution is collision-free."""
    q = solve(target, start)
    for other in others:
        if q is not None and check(q):
            return q
        q = solve(target, other)
    return q if q is not None and check(q) else None


def roboplan_solver(urdf: Path, srdf: Path, group: list, tip: str, base: str, **options):
    """RoboPlan's inverse kinematics among the solids of a problem, for 1 s and with 100 restarts unless `options` differ."""
    from roboplan.core import (Box, CartesianConfiguration, Cylinder, JointConfiguration, Scene, Sphere,
                               loadUrdfSceneDescription)
    from roboplan.simple_ik import SimpleIk, SimpleIkOptions

    options = {"max_restarts": 100, "max_time": 1.0} | options
    text = srdf.read_text()
    joints = "".join(f'<joint name="{name}"/>' for name in group)
    at = text.index(">", text.index("<robot")) + 1
    text = text[:at] + f'<group name="asked">{joints}</group>' + text[at:]

    def among(problem: Problem):
        scene = Scene("bench", loadUrdfSceneDescription(str(urdf), [str(urdf.parent)]))
        scene.importSrdf(text)
        for index, (kind, size, pose) in enumerate(problem.solids):
            name, pose, grey = f"solid {index}", np.asfortranarray(pose), np.ones(4)
            if kind == "box":
                scene.addBoxGeometry(name, "universe", Box(*size), pose, grey)
            elif kind == "cylinder":
                scene.addCylinderGeometry(name, "universe", Cylinder(size[1], size[0]), pose, grey)
            else:
                scene.addSphereGeometry(name, "universe", Sphere(size[0]), pose, grey)
        solids = [f"solid {index}" for index in range(len(problem.solids))]
        scene.setCollisions([(a, b) for a in solids for b in solids if a < b], False)
        solver = SimpleIk(scene, SimpleIkOptions(group_name="asked", **options))

        def solve(target, start):
            goal = CartesianConfiguration(base, tip, np.asfortranarray(target))
            found = JointConfiguration(group, np.array(start))
            try:
                reached = solver.solveIk(goal, JointConfiguration(group, np.array(start)), found)
            except RuntimeError:  # RoboPlan found no collision-free start.
                return None
            return found.positions if reached else None

        return solve

    return among


def rust(questions: dict) -> dict:
    build = ["cargo", "build", "--quiet", "--release", "-p", "kinopt-benches", "--bin", "among_obstacles"]
    subprocess.run(build, check=True)
    metadata = ["cargo", "metadata", "--format-version", "1", "--no-deps"]
    told = json.loads(subprocess.run(metadata, check=True, capture_output=True).stdout)
    run = [str(Path(told["target_directory"]) / "release/among_obstacles")]
    given = json.dumps(questions).encode()
    return json.loads(subprocess.run(run, input=given, check=True, capture_output=True).stdout)


class Row:
    """Statistics of one contender."""

    def __init__(self, name: str, tolerance: float = TOLERANCE) -> None:
        self.name, self.tolerance = name, tolerance
        self.times, self.reached, self.by_spheres, self.by_meshes = [], 0, 0, 0

    def take(self, nanoseconds, q, judges, wholes, problem, target) -> None:
        self.times.append(nanoseconds / 1e3)
        if q is None:
            return
        spheres, meshes = judges
        whole = [judge.whole(*wholes, q) for judge in judges]
        found = spheres.tool(whole[0])
        far = np.linalg.norm(found[:3, 3] - target[:3, 3])
        angle = np.linalg.norm(pinocchio.log3(found[:3, :3].T @ target[:3, :3]))
        if max(far, angle) > 1.001 * self.tolerance:
            return
        self.reached += 1
        self.by_spheres += spheres.is_free(whole[0], problem.solids)
        self.by_meshes += meshes.is_free(whole[1], problem.solids)

    def line(self, plain: float) -> str:
        count, times = len(self.times), np.array(self.times)
        share = [f"{100 * number / count:.2f}" for number in (self.reached, self.by_spheres, self.by_meshes)]
        median, late = np.median(times), np.percentile(times, 99)
        return (f"| {self.name} | {count} | {' | '.join(share)} | {median:.2f} | {late:.1f} "
                f"| {median / plain:.1f} | {late / plain:.0f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("robot", choices=ROBOTS)
    parser.add_argument("--per-kind", type=int, default=100)
    parser.add_argument("--slow", type=int, default=10, help="problems of each kind for slow solvers")
    parser.add_argument("--kinds", nargs="+", help="folders of problems, such as bookshelf_thin_panda; all by default")
    parser.add_argument("--no-rust", action="store_true", help="leave out the rows that a compiled Rust program measures")
    parser.add_argument("--tip")
    parser.add_argument("--rounds", type=int, default=5)
    wanted = parser.parse_args()
    base, tip = ROBOTS[wanted.robot]
    tip = wanted.tip or tip
    folder = wanted.folder
    urdf, original = folder / f"{wanted.robot}_spherized.urdf", folder / f"{wanted.robot}.urdf"
    srdf = folder / f"{wanted.robot}.srdf"
    robot = kinopt.Robot.from_urdf(str(urdf))
    # Removes pairs with links that are missing in the URDF, as in Fetch's file.
    lines = [line for line in srdf.read_text().splitlines()
             if all(name in robot.frame_names for name in re.findall(r'link[12]="([^"]*)"', line))]
    srdf = Path(tempfile.mkdtemp()) / srdf.name
    srdf.write_text("\n".join(lines))
    shapes = robot.collision_model().with_srdf(kinopt.Srdf.read(str(srdf), robot))
    plain = kinopt.Arm(robot, base, tip)
    names, limits = plain.joint_names, (np.maximum(plain.lower, -np.pi), np.minimum(plain.upper, np.pi))
    judges = (Judge(urdf, srdf, tip, base), Judge(original, folder / srdf.name, tip, base))
    tree = optik.Robot.from_urdf_file(str(urdf), base, tip)
    tree.set_parallelism(1)
    config = optik.SolverConfig("speed", max_time=0.05, tol_f=TOLERANCE**2)

    def by_optik(target, start):
        found = tree.ik(config, [list(map(float, row)) for row in target], start.tolist())
        return np.array(found[0]) if found else None

    try:
        among = roboplan_solver(original, srdf, names, tip, base)
    except ImportError:
        among = None
    try:
        import vamp
        has_vamp = hasattr(vamp, wanted.robot)
    except ImportError:
        has_vamp = False

    folders = [kind for kind in sorted((folder / "problems").iterdir()) if not wanted.kinds or kind.name in wanted.kinds]
    requests = [request for kind in folders for request in sorted(kind.glob("request*.yaml"))[:wanted.per_kind]]
    problems, targets, left_out = [], [], 0
    goals = [0, 0]
    for problem in map(Problem, requests):
        held = [problem.start, problem.goal]
        free = [judge.is_free(judge.whole(*held), problem.solids) for judge in judges]
        if not free[0]:
            left_out += 1
            continue
        goals[1] += free[1]
        problems.append(problem)
        targets.append(plain.base_from_tool([problem.goal[name] for name in names]))
    print(f"{wanted.robot}: {len(problems)} problems, {left_out} whose goal's spheres touch left out; of the goals "
          f"{goals[1]} are free by the meshes")

    random = np.random.default_rng(1)
    starts = [np.array([problem.start[name] for name in names]) for problem in problems]
    native = {"answers": [], "batches": []} if wanted.no_rust else rust({
        "robot": str(urdf), "srdf": str(srdf), "base": base, "tip": tip, "rounds": wanted.rounds,
        "questions": [
            {"world": str(problem.scene), "target": target.ravel().tolist(), "start": start.tolist(),
             "rest": {name: value for name, value in (problem.start | problem.goal).items()}}
            for problem, target, start in zip(problems, targets, starts)
        ],
    })
    rows = {} if wanted.no_rust else {name: Row(name) for name in ("Rust, no world", "Rust, its world")}
    for answer, problem, target in zip(native["answers"], problems, targets):
        for name, key, q in (("Rust, no world", "plain", "plain_q"), ("Rust, its world", "clear", "q")):
            told = answer[q] if answer["reached" if key == "clear" else "plain_reached"] else None
            value = dict(zip(names, told)) if told else None
            rows[name].take(answer[key], value, judges, (problem.start, problem.goal), problem, target)

    whole = kinopt.Robot.from_urdf(str(original), lenient=True)
    meshes = whole.collision_model().with_srdf(kinopt.Srdf.read(str(srdf), whole))

    def ask(name, call, index, rounds, tolerance=TOLERANCE):
        row = rows.setdefault(name, Row(name, tolerance))
        best, q = np.inf, None
        for _ in range(rounds):
            begun = time.perf_counter_ns()
            q = call()
            best = min(best, time.perf_counter_ns() - begun)
        problem = problems[index]
        told = None if q is None else dict(zip(names, q))
        row.take(best, told, judges, (problem.start, problem.goal), problem, targets[index])

    seen: dict = {}
    by_meshes, by_vamp = None, 0
    for index, (problem, target, start) in enumerate(zip(problems, targets, starts)):
        seen[problem.kind] = seen.get(problem.kind, 0) + 1
        values = problem.start | problem.goal
        world = kinopt.World.read(str(problem.scene))
        arm = kinopt.Arm(robot, base, tip, world=world, collision_model=shapes, only=names,
                         held=[values.get(name, 0.0) for name in robot.joint_names])
        others = random.uniform(*limits, (ATTEMPTS, len(names)))

        def q_of(solution):
            return solution.q if solution.reached else None

        def by_kinopt(t, s):
            return q_of(plain.solve(t, s))

        ask("kinopt, no world", lambda: by_kinopt(target, start), index, wanted.rounds)
        ask("kinopt, its world", lambda: q_of(arm.solve(target, start)), index, wanted.rounds)
        held = [values.get(name, 0.0) for name in whole.joint_names]
        by_meshes = by_meshes.with_world(world) if by_meshes else kinopt.Arm(
            whole, base, tip, world=world, collision_model=meshes, only=names, held=held)
        ask("kinopt, its world, the meshes", lambda: q_of(by_meshes.solve(target, start)), index, wanted.rounds)
        if has_vamp:
            check = vamp_check(wanted.robot, problem)
            by_vamp += check([problem.goal[name] for name in names])
            ask("kinopt, rejected by VAMP's check", lambda: rejection(by_kinopt, check, target, start, others), index,
                wanted.rounds)
        else:
            def check(q):
                return not arm.collisions(q)
        if seen[problem.kind] > wanted.slow:
            continue
        ask("OptIK, rejected by VAMP's check" if has_vamp else "OptIK, rejected by kinopt's check",
            lambda: rejection(by_optik, check, target, start, others), index, 1)
        if among:
            solve = among(problem)
            ask("RoboPlan, its own check, 1 mm", lambda: solve(target, start), index, 1, LOOSE)

    if has_vamp:
        print(f"{by_vamp} of the goals are free by VAMP's check")
    ours = np.nan if wanted.no_rust else np.median(rows["Rust, no world"].times)
    theirs = np.median(rows["kinopt, no world"].times)
    print("| solver | problems | reached % | free by spheres % | free by meshes % | median us | p99 us "
          "| median to plain | p99 to plain |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for row in rows.values():
        print(row.line(ours if row.name.startswith("Rust") else theirs))
    for batch in native["batches"]:
        print(f"batch of {batch['asked']}: {batch['plain']:.0f} ns a pose without a world, {batch['clear']:.0f} in it "
              f"({1e9 / batch['clear']:.0f} poses a second), {batch['reached']} reached")


if __name__ == "__main__":
    main()
