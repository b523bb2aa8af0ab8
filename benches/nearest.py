"""Time and result of the search `nearest` of six-joint arms, next to the nearest solution of the complete set.

Run: python benches/nearest.py [--poses N]

Poses of uniformly random configurations within the limits, from random starts. Times are medians of process time of single calls from
Python. A result is farther if its weighted joint distance from the start exceeds that of the nearest solution of `solve_all` by 1e-6.
"""

import argparse
import time

import numpy as np

import kinopt

ARMS = {"UR5e": kinopt.models.ur5e, "UR10e": kinopt.models.ur10e}


def measured(call):
    begin = time.process_time_ns()
    result = call()
    return result, (time.process_time_ns() - begin) / 1e3


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=2_000)
    count = parser.parse_args().poses
    print("| arm | poses | reached | farther than the nearest of `solve_all` | nearest, µs | p99 | `solve_all`, µs | p99 |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for name, robot in ARMS.items():
        nearest = kinopt.Arm(robot(), "base", "flange", search="nearest")
        arm = kinopt.Arm(robot(), "base", "flange")
        targets = arm.base_from_tool(arm.random_configuration(count, seed=1))
        starts = arm.random_configuration(count, seed=2)
        times, all_times, reached, farther = [], [], 0, 0
        for target, start in zip(targets, starts):
            solution, spent = measured(lambda: nearest.solve(target, start))
            times.append(spent)
            solutions, spent = measured(lambda: arm.solve_all(target, start))
            all_times.append(spent)
            reached += solution.reached
            if solution.reached and len(solutions):
                least = np.linalg.norm(solutions.q - start, axis=1).min()
                farther += np.linalg.norm(solution.q - start) > least + 1e-6
        print(f"| {name} | {count} | {reached / count:.2%} | {farther} | {np.median(times):.1f} | {np.percentile(times, 99):.0f} | "
              f"{np.median(all_times):.1f} | {np.percentile(all_times, 99):.0f} |", flush=True)


if __name__ == "__main__":
    main()
