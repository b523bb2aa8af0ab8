# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A circle with the tool: the joint path with the fewest reconfigurations, and its fastest trajectory."""

import numpy as np

import kinopt

arm = kinopt.Arm(kinopt.models.panda(), "base", "tool")
angle = np.linspace(0.0, 2.0 * np.pi, 181)
circle = np.tile(np.diag([1.0, -1.0, -1.0, 1.0]), (len(angle), 1, 1))  # the tool points down
circle[:, :3, 3] = np.stack([0.5 + 0.1 * np.cos(angle), 0.15 * np.sin(angle), np.full(len(angle), 0.3)], axis=1)
path = kinopt.solve_path(arm, circle, traversal="cyclic")
print(f"{len(path.q)} points, {len(path.jumps)} reconfigurations, {path.report.length:.2f} rad")
assert path.reached and not path.jumps

trajectory = path.trajectory(acceleration_limits=5.0, jerk_limits=100.0)  # rad/s² and rad/s³
points = trajectory.at(np.linspace(0.0, trajectory.duration, 500))
print(f"{trajectory.duration:.2f} s, at most {np.abs(points.velocity).max():.2f} rad/s")
