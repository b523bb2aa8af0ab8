# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""First steps: a robot from its file, one pose, a thousand poses.

Run it as ``python first_solve.py [ROBOT.urdf BASE TIP]``.
"""

import sys

import numpy as np

import kinopt

path, base, tip = [*sys.argv[1:], *[kinopt.models.path("panda"), "base", "flange"][len(sys.argv) - 1 :]]
robot = kinopt.Robot.from_urdf(path)
arm = kinopt.Arm(robot, base, tip)

# A reachable target, and a solve from another start.
start = np.clip(0.5 * np.ones(arm.degrees_of_freedom), arm.lower, arm.upper)
q = np.random.default_rng(1).uniform(np.maximum(arm.lower, -3), np.minimum(arm.upper, 3))
target = arm.base_from_tool(q)
solution = arm.solve(target, start)
print(solution.explain())
print(dict(zip(arm.joint_names, solution.q.round(6).tolist())))
assert np.allclose(arm.base_from_tool(solution.q), target, atol=2e-6)

# A thousand targets, as arrays.
many = np.random.default_rng(2).uniform(np.maximum(arm.lower, -3), np.minimum(arm.upper, 3), (1000, len(q)))
batch = arm.solve_batch(arm.base_from_tool(many), start)
print(batch, "worst error:", f"{batch.position_error.max():.1e} m")

# Out of reach: the size of the miss and its reason.
far = target.copy()
far[:3, 3] += 10.0
print(arm.solve(far, start).explain())
