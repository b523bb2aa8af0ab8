"""Poses with the settings of HJCD-IK's tables I and III, by kinopt on one core, judged by Pinocchio.

Usage: ``python hjcd_poses.py FOLDER [--rounds N]``. The environment needs kinopt's wheel and requirements-hjcd.txt. FOLDER has
the robots of a checkout of A2R-Lab/HJCD-IK (``include/test_urdf``): Panda, Fetch, and Pandas of 12 and 24 joints. That of 18 joints
is not well-formed XML.

As in the tables of Yasutake, Liu, Kingston and Plancher (arXiv 2510.07514, IROS 2026): 100 targets of configurations from a Halton
sequence within the limits, one target a call, mean times and mean errors of the returned configurations. kinopt's counterpart of
a batch of start configurations is its own sequence of attempts from the default start. Times are the best of all rounds for each target.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import pinocchio

import kinopt

POSES = 100
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89)
#: Base link, and link of the tool.
ROBOTS = {
    "panda": ("panda_link0", "panda_grasptarget"),
    "fetch": ("arm_mount_link", "ee_link"),
    "panda_ext_12dof": ("panda_link0", "panda_hand"),
    "panda_ext_24dof": ("panda_link0", "panda_grasptarget"),
}
TOLERANCES = (1e-6, 1e-9)


def halton(count: int, dimensions: int) -> np.ndarray:
    """Halton sequence without its first point, shape (count, dimensions), in [0, 1)."""
    points = np.zeros((count, dimensions))
    for axis, prime in enumerate(PRIMES[:dimensions]):
        for row in range(count):
            index, scale = row + 1, 1.0
            while index:
                scale /= prime
                points[row, axis] += scale * (index % prime)
                index //= prime
    return points


class Judge:
    """Forward kinematics by Pinocchio."""

    def __init__(self, urdf: Path, base: str, tip: str, names: list) -> None:
        self.model = pinocchio.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        body = pinocchio.FrameType.BODY
        self.base, self.tip = self.model.getFrameId(base, body), self.model.getFrameId(tip, body)
        self.joints = [self.model.joints[self.model.getJointId(name)] for name in names]

    def tool(self, q: np.ndarray) -> np.ndarray:
        whole = pinocchio.neutral(self.model)
        for joint, value in zip(self.joints, q):
            whole[joint.idx_q:joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
        pinocchio.framesForwardKinematics(self.model, self.data, whole)
        return self.data.oMf[self.base].actInv(self.data.oMf[self.tip]).homogeneous


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    print("| robot | joints | tolerance | reached | mean ms | largest ms | mean error, mm | mean error, rad |\n|---|---:|---:|---:|---:|---:|---:|---:|")
    for name, (base, tip) in ROBOTS.items():
        urdf = chosen.folder / f"{name}.urdf"
        robot = kinopt.Robot.from_urdf(str(urdf), lenient=True)
        for tolerance in TOLERANCES:
            arm = kinopt.Arm(robot, base, tip, position_tolerance=tolerance, orientation_tolerance=tolerance)
            judge = Judge(urdf, base, tip, arm.joint_names)
            lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
            targets = [judge.tool(q) for q in lower + (upper - lower) * halton(POSES, len(lower))]
            times, errors, reached = np.full(POSES, np.inf), np.zeros((POSES, 2)), 0
            for turn in range(chosen.rounds):
                for k, target in enumerate(targets):
                    begin = time.perf_counter()
                    solution = arm.solve(target)
                    times[k] = min(times[k], time.perf_counter() - begin)
                    if turn == 0:
                        tool = judge.tool(solution.q)
                        angle = np.linalg.norm(pinocchio.log3(tool[:3, :3].T @ target[:3, :3]))
                        errors[k] = 1e3 * np.linalg.norm(tool[:3, 3] - target[:3, 3]), angle
                        reached += solution.reached
            print(f"| {name} | {len(lower)} | {tolerance:.0e} | {reached} of {POSES} | {1e3 * times.mean():.4f} | {1e3 * times.max():.3f} | "
                  f"{errors[:, 0].mean():.2e} | {errors[:, 1].mean():.2e} |", flush=True)


if __name__ == "__main__":
    main()
