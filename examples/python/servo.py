# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A servo at 1 kHz: the tool follows a target that jumps, within velocity, acceleration and jerk limits."""

import numpy as np

import kinopt

arm = kinopt.Arm(kinopt.models.panda(), "base", "tool")
start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]
limits = {"acceleration_limits": np.full(7, 10.0), "jerk_limits": np.full(7, 500.0)}  # rad/s² and rad/s³
servo = arm.servo(start, 0.001, **limits)
target = arm.base_from_tool(start)
steps = []
for offset in ([0.0, 0.2, 0.1], [0.0, -0.4, 0.0]):
    target[:3, 3] += offset  # metres
    steps.append(servo.step(target))
    while not steps[-1].reached:
        steps.append(servo.step(target))
velocity = np.array([step.velocity for step in steps])
acceleration = np.array([step.acceleration for step in steps])
print(f"{len(steps)} cycles, {np.abs(velocity).max():.2f} rad/s, {np.abs(acceleration).max():.2f} rad/s²")
assert (np.abs(velocity) <= servo.velocity_limits).all() and (np.abs(acceleration) <= 10.0).all()
