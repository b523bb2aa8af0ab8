"""One pose at a time from Python: kinopt compared with common packages, and with its own Rust call.

Usage: ``python single_poses.py [--poses N] [--slow N]``, in the root of the repository. The environment needs
kinopt's wheel and requirements.txt; Rust's time is that of ``cargo build --release -p kinopt-benches``.

The targets are random reachable poses of the shipped Panda, from random starts to 1e-6 m and rad, equal for all.
Each call is timed on one core; the best of three rounds counts (one for ``--slow``). Pinocchio judges every
solution.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import time
from pathlib import Path

import frankik
import numpy as np
import optik
import pinocchio
import roboticstoolbox

import kinopt

URDF = str(Path("models/franka_panda.urdf"))
BASE, TIP = "base", "flange"
TOLERANCE = 1e-6
BATCH = 1_000_000


def judge_of(names):
    """Function of the distance and angle between the flange at q and a target, by Pinocchio."""
    model = pinocchio.buildModelFromUrdf(URDF)
    data, tip, base = model.createData(), model.getFrameId(TIP), model.getFrameId(BASE)
    places = [model.joints[model.getJointId(name)].idx_q for name in names]

    def judge(q, target):
        whole = pinocchio.neutral(model)
        whole[places] = q
        pinocchio.framesForwardKinematics(model, data, whole)
        found = data.oMf[base].actInv(data.oMf[tip]).homogeneous
        turn = found[:3, :3].T @ target[:3, :3]
        return np.linalg.norm(found[:3, 3] - target[:3, 3]), np.linalg.norm(pinocchio.log3(turn))

    return judge


def pinocchio_loop(limits):
    """The loop of Pinocchio's example (damped pseudo-inverse of the error's logarithm), clamped to the limits and
    restarted if it stalls. It represents a simple user-written solver.
    """
    model = pinocchio.buildModelFromUrdf(URDF)
    fingers = [model.getJointId(name) for name in model.names if "finger" in name]
    model = pinocchio.buildReducedModel(model, fingers, pinocchio.neutral(model))
    data, tip = model.createData(), model.getFrameId(TIP)
    random = np.random.default_rng(3)
    lower, upper = limits

    def solve(target, start):
        goal, q = pinocchio.SE3(target), start
        for _ in range(20):
            for _ in range(100):
                pinocchio.framesForwardKinematics(model, data, q)
                away = data.oMf[tip].actInv(goal)
                error = pinocchio.log6(away).vector
                if np.linalg.norm(error) < TOLERANCE:
                    return q
                jacobian = pinocchio.computeFrameJacobian(model, data, q, tip)
                jacobian = -pinocchio.Jlog6(away.inverse()) @ jacobian
                step = -jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-12 * np.eye(6), error)
                q = np.clip(pinocchio.integrate(model, q, step), lower, upper)
            q = random.uniform(lower, upper)
        return None

    return solve


def contenders(arm):
    first = kinopt.Arm(kinopt.Robot.from_urdf(URDF), BASE, TIP, search="first")
    closed = frankik.FrankaKinematics(frankik.RobotType.PANDA)
    # frankik's tip has a fixed rotation relative to the flange; its own matrix is rounded to 0.707.
    half = np.sqrt(0.5)
    hand = np.array([[half, half, 0, 0], [-half, half, 0, 0], [0, 0, 1, 0.1034], [0, 0, 0, 1]])
    flange = arm.base_from_tool(np.zeros(7))
    to_frankik = np.linalg.inv(flange) @ closed.forward(np.zeros(7)) @ np.linalg.inv(hand)
    tree = optik.Robot.from_urdf_file(URDF, BASE, TIP)
    tree.set_parallelism(1)
    config = optik.SolverConfig("speed", max_time=0.05, tol_f=TOLERANCE**2)
    toolbox = roboticstoolbox.Robot.URDF(str(Path(URDF).absolute()))
    chain = toolbox.ets(start=BASE, end=TIP)
    loop = pinocchio_loop((arm.lower, arm.upper))

    def lists(target):
        return [list(map(float, row)) for row in target]

    def by_optik(target, start):
        found = tree.ik(config, target, start)
        return np.array(found[0]) if found else None

    def by_toolbox(target, start):
        found = chain.ik_LM(target, q0=start, tol=0.5 * TOLERANCE**2)
        return found.q if found.success else None

    return {
        "kinopt": (arm.solve, lambda t, s, q: (t, s), lambda found: found.q),
        "kinopt, first": (first.solve, lambda t, s, q: (t, s), lambda found: found.q),
        "frankik, the seventh joint given": (
            closed.inverse,
            lambda t, s, q: (t @ to_frankik, s, None, q[6]),
            lambda found: found,
        ),
        "frankik, the seventh joint sampled": (
            closed.inverse,
            lambda t, s, q: (t @ to_frankik, s),
            lambda found: found,
        ),
        "OptIK": (by_optik, lambda t, s, q: (lists(t), s.tolist()), lambda found: found),
        "roboticstoolbox, ik_LM": (by_toolbox, lambda t, s, q: (t, s), lambda found: found),
        "a loop over Pinocchio": (loop, lambda t, s, q: (t, s), lambda found: found),
    }


def rust(arm, targets, starts, search):
    build = ["cargo", "build", "--quiet", "--release", "-p", "kinopt-benches", "--bin", "single_questions"]
    subprocess.run(build, check=True)
    numbers = np.hstack([targets.reshape(len(targets), 16), starts]).astype("<f8").tobytes()
    run = ["target/release/single_questions", URDF, BASE, TIP, search, "3"]
    return json.loads(subprocess.run(run, input=numbers, check=True, capture_output=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=2000)
    parser.add_argument("--slow", type=int, default=500, help="poses for slow solvers")
    parser.add_argument("--batch", type=int, default=BATCH)
    wanted = parser.parse_args()

    arm = kinopt.Arm(kinopt.Robot.from_urdf(URDF), BASE, TIP)
    random = np.random.default_rng(1)
    truth = random.uniform(arm.lower, arm.upper, (wanted.poses, 7))
    starts = random.uniform(arm.lower, arm.upper, (wanted.poses, 7))
    targets = arm.base_from_tool(truth)
    judge = judge_of(arm.joint_names)

    native = {search: rust(arm, targets, starts, search) for search in ("start", "first")}
    print("| call | solved % | median us | p99 us | to kinopt |\n|---|---:|---:|---:|---:|")
    for search, told in native.items():
        single = np.array(told["single"]) / 1e3
        print(f"| Rust, {search} | {100 * told['reached'] / len(targets):.2f} "
              f"| {np.median(single):.2f} | {np.percentile(single, 99):.1f} | |")
    ours = None
    for name, (call, prepare, q_of) in contenders(arm).items():
        quick = "kinopt" in name or "given" in name
        count, rounds = (wanted.poses, 3) if quick else (min(wanted.slow, wanted.poses), 1)
        asked = [prepare(targets[i], starts[i], truth[i]) for i in range(count)]
        best, solved = np.full(count, np.inf), 0
        for turn in range(rounds):
            for i, question in enumerate(asked):
                begun = time.perf_counter_ns()
                q = q_of(call(*question))
                best[i] = min(best[i], time.perf_counter_ns() - begun)
                if turn == 0 and q is not None:
                    distance, angle = judge(q, targets[i])
                    inside = (q >= arm.lower - 1e-9).all() and (q <= arm.upper + 1e-9).all()
                    solved += distance <= 1.001 * TOLERANCE and angle <= 1.001 * TOLERANCE and inside
        median = np.median(best) / 1e3
        ours = ours or median
        print(f"| {name} | {100 * solved / count:.2f} | {median:.2f} "
              f"| {np.percentile(best, 99) / 1e3:.1f} | {median / ours:.1f} |")

    many = arm.base_from_tool(random.uniform(arm.lower, arm.upper, (wanted.batch, 7)))
    some = random.uniform(arm.lower, arm.upper, (wanted.batch, 7))
    told = rust(arm, many[:100_000], some[:100_000], "start")
    took = min(timed(arm, many, some) for _ in range(3))
    print(f"\nbatch of {wanted.batch}: {1e9 * took / wanted.batch:.0f} ns a pose from Python, "
          f"{told['batch']:.0f} in Rust (100 000): {100 * told['batch'] * wanted.batch / 1e9 / took:.1f} % of its rate")


def timed(arm, targets, starts):
    begun = time.perf_counter()
    assert arm.solve_batch(targets, starts).reached.all()
    return time.perf_counter() - begun


if __name__ == "__main__":
    main()
