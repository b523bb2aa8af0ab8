"""Python and Rust give bitwise equal results.

The Rust side is a small program of the repository, so these tests need cargo and a checkout.
"""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import kinopt

ROOT = Path(__file__).parents[2]
ARMS = [
    ("franka_panda", "base", "flange"),
    ("universal_ur5e", "base", "flange"),
    ("universal_ur10e", "base", "flange"),
    ("kuka_iiwa14", "base", "flange"),
    ("adept_cobra_s600", "base", "flange"),
    ("rethink_baxter", "torso", "left_tool"),
    ("aldebaran_nao", "torso", "left_hand"),
]

pytestmark = pytest.mark.skipif(
    shutil.which("cargo") is None or not (ROOT / "Cargo.toml").exists(),
    reason="SKIPPED: needs cargo and a checkout; Python's bits were not held against Rust's",
)


@pytest.fixture(scope="module")
def rust():
    """Runs the Rust program."""
    # Built with the packages of `cargo test`, to share its build of the library.
    packages = ["-p", "kinopt", "-p", "kinopt-cli", "-p", "kinopt-test-support"]
    build = ["cargo", "build", "--profile", "test", "--quiet", "--message-format=json", *packages, "--bin", "answers"]
    built = subprocess.run(build, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    messages = [json.loads(line) for line in built.splitlines()]
    (program,) = [one["executable"] for one in messages if one.get("executable")]

    def run_program(*arguments, numbers):
        input_bytes = np.ascontiguousarray(numbers, "<f8").tobytes()
        run = subprocess.run([program, *arguments], cwd=ROOT, check=True, input=input_bytes, capture_output=True)
        return np.frombuffer(run.stdout, "<f8")

    return run_program


@pytest.mark.parametrize(("name", "base", "tip"), ARMS)
def test_poses_of_shipped_robots_are_bitwise_equal(rust, name, base, tip):
    robot = kinopt.Robot.from_urdf(ROOT / "models" / f"{name}.urdf")
    arm = kinopt.Arm(robot, base, tip)
    rng = np.random.default_rng(11)
    lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    count, dof = 2000, arm.degrees_of_freedom
    targets = arm.base_from_tool(rng.uniform(lower, upper, (count, dof)))
    # Some are out of reach.
    targets[::50, :3, 3] *= 3
    starts = rng.uniform(lower, upper, (count, dof))
    numbers = np.hstack([targets.reshape(count, 16), starts])
    path = f"models/{name}.urdf"
    answers = rust("arm", path, base, tip, numbers=numbers).reshape(count, dof)
    batch = arm.solve_batch(targets, starts, threads=2)
    assert np.array_equal(batch.q, answers)
    assert batch.reached.sum() > 0.9 * count


@pytest.mark.parametrize("name", ["humanoid", "robot-arm"])
def test_problems_of_shipped_rigs_are_bitwise_equal(rust, name):
    path = f"models/{name}/{name}.json"
    skeleton = kinopt.Rig.read(ROOT / path).skeleton
    bones = [tip.removesuffix("/tip") for tip in skeleton.tips]
    rest, count = skeleton.model.neutral(), 100
    # Targets of the tips are a part of a random pose, ten of them slightly out of reach.
    poses = rest + 0.3 * (skeleton.model.random_configuration(count, seed=21) - rest)
    tips = [skeleton.tip(bone) for bone in bones]
    positions = [[kinopt.frame_placement(skeleton, tip, q)[:3, 3] for tip in tips] for q in poses]
    targets = np.array(positions)
    targets[::10, 0] *= 1.5
    answers = rust("rig", path, *bones, numbers=targets).reshape(count, len(rest))

    hands = [kinopt.tasks.Point(tip, position, name=bone) for tip, position, bone in zip(tips, positions[0], bones)]
    problem = kinopt.Problem(skeleton, hands)
    moved = {bone: targets[:, i] for i, bone in enumerate(bones)}
    solutions = kinopt.Solver().solve_batch(problem, rest, moved, threads=2)
    assert np.array_equal(solutions.q, answers)
    assert solutions.reached.sum() >= 0.8 * count
    single = kinopt.Solver().solve(problem, rest, {bone: targets[7, i] for i, bone in enumerate(bones)})
    assert np.array_equal(single.q, answers[7])
