"""Shares of random unreachable poses that are decided within 10, 100 and 1 000 ms of processor time, and goal sets.

Run: python benches/reachability/shares.py
"""

import time

import numpy as np

import kinopt

POSES = 200
GOALS = 10_000
ARMS = {
    "Panda": (kinopt.models.panda, "base", "flange"),
    "UR5e": (kinopt.models.ur5e, "base", "flange"),
    "iiwa 14": (kinopt.models.iiwa14, "base", "flange"),
}


def random_poses(arm, rng):
    """Poses with uniform rotations and positions within a ball of the size of the arm's reach."""
    tools = arm.base_from_tool(rng.uniform(arm.lower, arm.upper, (2_000, len(arm.joints))))[:, :3, 3]
    centre = tools.mean(axis=0)
    radius = np.linalg.norm(tools - centre, axis=1).max()
    while True:
        quaternion, direction = rng.normal(size=4), rng.normal(size=3)
        quaternion /= np.linalg.norm(quaternion)
        direction /= np.linalg.norm(direction)
        yield kinopt.placement(centre + direction * radius * rng.uniform() ** (1 / 3), wxyz=quaternion)


def main():
    print("| arm | decided, 10 ms | 100 ms | 1 000 ms | median boxes |")
    print("|---|---:|---:|---:|---:|")
    for name, (robot, base, tip) in ARMS.items():
        arm = kinopt.Arm(robot(), base, tip)
        rng = np.random.default_rng(1)
        times, boxes = [], []
        for pose in random_poses(arm, rng):
            if arm.solve(pose).reached:
                continue
            search = time.process_time()
            arm.solve(pose)
            begin = time.process_time()
            answer = arm.reachability(pose, max_boxes=300_000)
            # Without the search for a solution that comes first.
            spent = time.process_time() - begin - (begin - search)
            times.append(spent if answer.reachable is False else np.inf)
            boxes.append(answer.boxes)
            if len(times) == POSES:
                break
        shares = [100 * np.mean(np.array(times) <= limit) for limit in (0.01, 0.1, 1.0)]
        print(f"| {name} | {shares[0]:.0f} % | {shares[1]:.0f} % | {shares[2]:.0f} % | {int(np.median(boxes))} |")

    arm = kinopt.Arm(kinopt.models.panda(), "base", "flange")
    rng = np.random.default_rng(2)
    goals = arm.base_from_tool(rng.uniform(arm.lower, arm.upper, (GOALS, len(arm.joints))))
    begin = time.process_time()
    found = arm.solve_goals(goals)
    print(f"\n{GOALS} goals of a Panda: {1e3 * (time.process_time() - begin):.0f} ms, {found.reached.mean():.2%} reached")


if __name__ == "__main__":
    main()
