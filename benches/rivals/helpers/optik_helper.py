"""Helper process of OptIK: optik_helper.py ROBOT.urdf BASE TIP SECONDS TOLERANCE.

Each request is a line of numbers: x y z qw qx qy qz, then the start. Each reply is a line: the nanoseconds of the
call, then the solution if there is one.
"""

import sys
import time

import optik


def matrix(x, y, z, w, i, j, k):
    return [
        [1 - 2 * (j * j + k * k), 2 * (i * j - w * k), 2 * (i * k + w * j), x],
        [2 * (i * j + w * k), 1 - 2 * (i * i + k * k), 2 * (j * k - w * i), y],
        [2 * (i * k - w * j), 2 * (j * k + w * i), 1 - 2 * (i * i + j * j), z],
        [0.0, 0.0, 0.0, 1.0],
    ]


def main():
    urdf, base, tip, seconds, tolerance = sys.argv[1:]
    robot = optik.Robot.from_urdf_file(urdf, base, tip)
    robot.set_parallelism(1)
    # tol_f bounds the sum of the squared errors, metres and radians, so both are within the tolerance.
    config = optik.SolverConfig("speed", max_time=float(seconds), tol_f=float(tolerance) ** 2)
    print("ready", flush=True)
    for line in sys.stdin:
        numbers = [float(word) for word in line.split()]
        target, start = matrix(*numbers[:7]), numbers[7:]
        begun = time.perf_counter_ns()
        found = robot.ik(config, target, start)
        took = time.perf_counter_ns() - begun
        print(took, *(repr(value) for value in (found[0] if found else [])), flush=True)


main()
