"""Shares of random poses that `Arm.reachability` decides within 10, 100 and 1 000 ms of processor time.

Run: python benches/reachability/shares.py [--poses N]

The poses have uniform rotations, and positions in a ball of the arm's reach. The table has the poses that a search with 200
attempts does not reach: unreachable ones, and any that it missed. A time is that of the whole call, with the search that comes first.
"""

import argparse
import time

import numpy as np

import kinopt

LIMITS_S = (0.01, 0.1, 1.0)
ARMS = {
    "Panda": (kinopt.models.panda, "base", "flange"),
    "UR5e": (kinopt.models.ur5e, "base", "flange"),
    "iiwa 14": (kinopt.models.iiwa14, "base", "flange"),
}


def random_poses(arm, rng):
    """Poses with uniform rotations and positions within a ball of the size of the arm's reach."""
    tools = arm.base_from_tool(rng.uniform(arm.lower, arm.upper, (2_000, len(arm.joint_names))))[:, :3, 3]
    centre = tools.mean(axis=0)
    radius = np.linalg.norm(tools - centre, axis=1).max()
    while True:
        quaternion, direction = rng.normal(size=4), rng.normal(size=3)
        quaternion /= np.linalg.norm(quaternion)
        direction /= np.linalg.norm(direction)
        yield kinopt.placement(centre + direction * radius * rng.uniform() ** (1 / 3), wxyz=quaternion)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=200, help="poses of each arm that the search does not reach")
    chosen = parser.parse_args()
    print("| arm | poses | decided in 10 ms | 100 ms | 1 000 ms | of them reachable | undecided | search, median ms | boxes, median |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for name, (robot, base, tip) in ARMS.items():
        arm = kinopt.Arm(robot(), base, tip)
        timed = kinopt.Arm(robot(), base, tip, time_limit=1.05 * LIMITS_S[-1])
        rng = np.random.default_rng(1)
        times, searches, boxes, reachable = [], [], [], 0
        for pose in random_poses(arm, rng):
            begin = time.process_time()
            reached = arm.solve(pose).reached
            searched = time.process_time() - begin
            if reached:
                continue
            begin = time.process_time()
            answer = timed.reachability(pose, max_boxes=10_000_000)
            spent = time.process_time() - begin
            times.append(np.inf if answer.reachable is None else spent)
            searches.append(searched)
            reachable += answer.reachable is True
            boxes.append(answer.boxes)
            if len(times) == chosen.poses:
                break
        shares = " | ".join(f"{np.mean(np.array(times) <= limit):.1%}" for limit in LIMITS_S)
        undecided = sum(time_s > LIMITS_S[-1] for time_s in times)
        print(f"| {name} | {len(times)} | {shares} | {reachable} | {undecided} | {1e3 * np.median(searches):.1f} | "
              f"{int(np.median(boxes))} |", flush=True)


if __name__ == "__main__":
    main()
