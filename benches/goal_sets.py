"""Time of a goal set on one core: 10 000 random reachable poses, and as many of which half are beyond the reach.

Run: python benches/goal_sets.py [--goals N]

Process time of one call of `solve_goals`, the least of five rounds. Every reached configuration is judged by forward kinematics.
"""

import argparse
import time

import numpy as np

import kinopt

ARMS = {"Panda": kinopt.models.panda, "UR5e": kinopt.models.ur5e, "iiwa 14": kinopt.models.iiwa14}
ROUNDS = 5


def misses(arm, found, goals):
    """Number of reached goals whose configuration misses by more than 1.001e-6 m or rad."""
    reached = found.reached[0]
    away = arm.base_from_tool(found.q[0][reached]) - goals[reached]
    distance = np.linalg.norm(away[:, :3, 3], axis=1)
    angle = np.linalg.norm(away[:, :3, :3], axis=(1, 2)) / np.sqrt(2)
    return int((np.maximum(distance, angle) > 1.001e-6).sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--goals", type=int, default=10_000)
    count = parser.parse_args().goals
    print("| arm | goals | criterion | reached | status | ms | µs a goal | misses |\n|---|---:|---|---:|---|---:|---:|---:|")
    for name, robot in ARMS.items():
        arm = kinopt.Arm(robot(), "base", "flange")
        reachable = arm.base_from_tool(arm.random_configuration(count, seed=2))
        half = reachable.copy()
        half[::2, :3, 3] *= 4 / np.linalg.norm(half[::2, :3, 3], axis=1, keepdims=True)  # 4 m from the base
        for goals, criterion in ((reachable, "distance"), (reachable, "manipulability"), (half, "distance")):
            spent = []
            for _ in range(ROUNDS):
                begin = time.process_time()
                found = arm.solve_goals(goals, criterion=criterion)
                spent.append(time.process_time() - begin)
            states, numbers = np.unique(found.status[0], return_counts=True)
            status = ", ".join(f"{number} {state}" for state, number in zip(states, numbers))
            print(f"| {name} | {count} | {criterion} | {found.reached.mean():.2%} | {status} | {1e3 * min(spent):.1f} | "
                  f"{1e6 * min(spent) / count:.2f} | {misses(arm, found, goals)} |", flush=True)


if __name__ == "__main__":
    main()
