# /// script
# dependencies = ["kinopt", "scipy"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A residual of your own: the tool stays on a sphere. SciPy solves the same problem for comparison."""

import time

import numpy as np
from scipy.optimize import least_squares

import kinopt
from kinopt import tasks

robot = kinopt.models.panda()
kinematics = kinopt.ForwardKinematics(robot, ["tool"])
centre, radius = np.array([0.3, 0.0, 0.5]), 0.3  # metres


def distance(placements):
    return [np.linalg.norm(placements[0, :3, 3] - centre) - radius]


problem = kinopt.Problem(robot, [tasks.Residual(distance, frames=["tool"], rows={"metres": 1})])
starts = robot.random_configuration(1, 100)

begun = time.perf_counter()
solutions = kinopt.Solver().solve_batch(problem, starts)
between = time.perf_counter()
by_scipy = [
    least_squares(lambda q: distance(kinematics.place(q)), q, bounds=(robot.lower, robot.upper), xtol=1e-12) for q in starts
]
ended = time.perf_counter()
print(f"kinopt: {solutions.reached.sum()} of {len(starts)} reached in {between - begun:.2f} s")
print(f"SciPy:  {sum(abs(result.fun[0]) < 1e-6 for result in by_scipy)} of {len(starts)} in {ended - between:.2f} s")
assert solutions.reached.all()
