"""Time-optimal path timing against toppra (PyPI), in one run.

    pip install kinopt toppra numpy scipy
    python benches/path_timing/compare_toppra.py

1. 100 smooth Cartesian paths of shipped arms, solved by `solve_path`. toppra interpolates the same configurations by its cubic spline,
   over row number and over joint length, under the same limits, with 1 000 grid points.
2. One pick and place in rows of 5, 1 and 0.1 cm.
3. Time for 1 000 rows.
"""

import logging
import time
from pathlib import Path

import kinopt
import numpy as np
import toppra
from toppra import algorithm, constraint

logging.disable(logging.CRITICAL)
MODELS = Path(__file__).resolve().parents[2] / "models"
ARMS = [
    ("franka_panda.urdf", "base", "flange", [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]),
    ("universal_ur5e.urdf", "base", "flange", [0.3, -1.2, 1.4, -1.6, -1.5, 0.0]),
    ("kuka_iiwa14.urdf", "base", "flange", [0.2, 0.6, 0.1, -1.4, 0.0, 1.0, 0.3]),
]
GRID_POINTS = 1000


def arms():
    """Arms of the models that exist, with start configurations."""
    for file, base, tip, start in ARMS:
        if (MODELS / file).exists():
            robot = kinopt.Robot.from_urdf(str(MODELS / file))
            yield file, kinopt.Arm(robot, base, tip), np.array(start)


def toppra_duration(q, velocity, acceleration, parameter):
    """Duration by toppra over a spline through the rows of q, seconds."""
    if parameter == "row number":
        s = np.linspace(0.0, 1.0, len(q))
    else:
        s = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))]
    path = toppra.SplineInterpolator(s, q)
    limits = [
        constraint.JointVelocityConstraint(np.c_[-velocity, velocity]),
        constraint.JointAccelerationConstraint(np.c_[-acceleration, acceleration]),
    ]
    grid = np.linspace(s[0], s[-1], GRID_POINTS + 1)
    solver = algorithm.TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeConstAccel", solver_wrapper="seidel")
    trajectory = solver.compute_trajectory(0, 0)
    return np.nan if trajectory is None else trajectory.duration


def smooth_path(begin, random, rows):
    """Placements on a smooth curve of two harmonics within 20 cm of a placement, with a slow rotation."""
    share = np.linspace(0.0, 1.0, rows)[:, None]
    offsets = np.zeros((rows, 3))
    angles = np.zeros((rows, 1))
    for harmonic in (1, 2):
        phase = random.uniform(0.0, 2.0 * np.pi, 4)
        size = random.normal(scale=0.06 / harmonic, size=4)
        waves = np.sin(2.0 * np.pi * harmonic * share * random.uniform(0.4, 1.0) + phase) - np.sin(phase)
        offsets += size[:3] * waves[:, :3]
        angles += 3.0 * size[3:] * waves[:, 3:]
    path = np.tile(begin, (rows, 1, 1))
    path[:, :3, 3] += offsets
    cos, sin = np.cos(angles[:, 0]), np.sin(angles[:, 0])
    about_z = np.tile(np.eye(3), (rows, 1, 1))
    about_z[:, 0, 0], about_z[:, 0, 1], about_z[:, 1, 0], about_z[:, 1, 1] = cos, -sin, sin, cos
    path[:, :3, :3] = path[:, :3, :3] @ about_z
    return path


def compare_smooth_paths(count=100):
    random = np.random.default_rng(1)
    known = list(arms())
    ratios = {"row number": [], "joint length": []}
    tried = 0
    while len(ratios["row number"]) < count:
        _, arm, start = known[tried % len(known)]
        tried += 1
        begin = np.asarray(arm.base_from_tool(start))
        solved = kinopt.solve_path(arm, smooth_path(begin, random, int(random.integers(60, 400))), start=start)
        if not solved.reached:
            continue
        velocity = np.minimum(np.asarray(arm.velocity_limits), 10.0)
        acceleration = random.uniform(2.0, 15.0, len(start))
        duration = solved.trajectory(acceleration_limits=acceleration, velocity_limits=velocity).duration
        for parameter, values in ratios.items():
            values.append(duration / toppra_duration(solved.q, velocity, acceleration, parameter))
    print(f"{count} smooth paths ({tried} tried), duration over toppra's:")
    for parameter, values in ratios.items():
        values = np.array(values)
        failed = int(np.isnan(values).sum())
        print(
            f"  over {parameter}: least {np.nanmin(values):.4f}, median {np.nanmedian(values):.4f}, "
            f"largest {np.nanmax(values):.4f}, toppra failed {failed} times"
        )


def pick_and_place(begin, row_distance):
    """Down, up, aside, down and up in straight segments."""
    stops = np.array([[0, 0, 0], [0, 0, -0.15], [0, 0, 0], [0, 0.3, 0], [0, 0.3, -0.15], [0, 0.3, 0]], dtype=float)
    offsets = [stops[:1]]
    for a, b in zip(stops, stops[1:]):
        steps = round(np.linalg.norm(b - a) / row_distance)
        offsets.append(a + (b - a) * np.linspace(0.0, 1.0, steps + 1)[1:, None])
    offsets = np.concatenate(offsets)
    path = np.tile(begin, (len(offsets), 1, 1))
    path[:, :3, 3] += offsets
    return path


def compare_row_distances():
    print("pick and place, duration in s for rows of 5, 1 and 0.1 cm:")
    for file, arm, start in arms():
        begin = np.asarray(arm.base_from_tool(start))
        acceleration = np.full(len(start), 5.0)
        for tolerance in (0.0, 1e-3):
            solutions = [kinopt.solve_path(arm, pick_and_place(begin, distance), start=start) for distance in (0.05, 0.01, 0.001)]
            durations = [solved.trajectory(acceleration_limits=acceleration, corner_tolerance=tolerance).duration for solved in solutions]
            velocity = np.asarray(arm.velocity_limits)
            theirs = [toppra_duration(solved.q, velocity, acceleration, "joint length") for solved in solutions]
            text = ", ".join(f"{duration:.4f}" for duration in durations)
            spread = max(durations) / min(durations) - 1.0
            theirs = ", ".join(f"{duration:.4f}" for duration in theirs)
            print(f"  {file}, corner tolerance {tolerance}: {text} (spread {100 * spread:.2f} %); toppra {theirs}")


def time_of_1000_rows(repeats=200):
    share = np.linspace(0.0, 1.0, 1000)[:, None]
    for file, arm, start in arms():
        begin = np.asarray(arm.base_from_tool(start))
        random = np.random.default_rng(3)
        solved = kinopt.solve_path(arm, smooth_path(begin, random, len(share)), start=start)
        velocity = np.asarray(arm.velocity_limits)
        acceleration = np.full(len(start), 5.0)

        def timed(call, count):
            times = []
            for _ in range(count):
                started = time.perf_counter()
                call()
                times.append(1e3 * (time.perf_counter() - started))
            return np.median(times)

        ours = timed(lambda: solved.trajectory(acceleration_limits=acceleration, velocity_limits=velocity), repeats)
        with_jerk = timed(lambda: solved.trajectory(acceleration, velocity, jerk_limits=50.0), 3)
        theirs = timed(lambda: toppra_duration(solved.q, velocity, acceleration, "row number"), 5)
        plain = solved.trajectory(acceleration_limits=acceleration, velocity_limits=velocity).duration
        bounded = solved.trajectory(acceleration, velocity, jerk_limits=50.0).duration
        print(
            f"{file}, 1 000 rows, median ms: {ours:.3f}, with jerk limits {with_jerk:.0f}, toppra {theirs:.1f}; "
            f"duration with jerk limits of 50 over without: {bounded / plain:.3f}"
        )


if __name__ == "__main__":
    compare_smooth_paths()
    compare_row_distances()
    time_of_1000_rows()
