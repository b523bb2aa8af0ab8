# /// script
# dependencies = ["kinopt[plot]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""Reach map of an arm: picture, page, and a base from which it reaches a row of targets."""

import sys

import numpy as np

import kinopt

out = sys.argv[1] if len(sys.argv) > 1 else "reach-map.png"
step = float(sys.argv[2]) if len(sys.argv) > 2 else 0.25  # metres
angle = float(sys.argv[3]) if len(sys.argv) > 3 else 90.0  # degrees
arm = kinopt.Arm(kinopt.models.ur5e(), "base", "flange")
reach = kinopt.ReachMap.build(arm, position_step=step, orientation_step=np.radians(angle), threads=None)
print(reach)
reach.plot().savefig(out, dpi=100)
reach.page("reach-map.html")

# The flange points down, at targets along a table.
row = np.linspace(-0.4, 0.4, 9)
targets = kinopt.placement(np.stack([row + 1.0, 0 * row, 0 * row + 0.2], axis=1), rpy=[np.pi, 0, 0])
x, y = np.meshgrid(np.linspace(0.0, 2.0, 21), np.linspace(0.2, 1.0, 9))
bases = kinopt.placement(np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1))
best = reach.place_base(arm, targets, bases)[0]
print(f"base at {bases[best.candidate, :2, 3]}: {best.reached} of {len(targets)} targets")
assert best.reached == len(targets)
