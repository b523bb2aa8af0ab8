# /// script
# dependencies = ["kinopt[plot]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""Pick and place: straight lines through key positions, timed within limits and plotted."""

import sys

import numpy as np

import kinopt

out = sys.argv[1] if len(sys.argv) > 1 else "pick_and_place.png"
arm = kinopt.Arm(kinopt.models.panda(), "base", "tool")
home, over_pick, pick = [0.4, 0.0, 0.5], [0.5, -0.3, 0.3], [0.5, -0.3, 0.1]  # metres
over_place, place = [0.5, 0.3, 0.3], [0.5, 0.3, 0.1]
keys = [home, over_pick, pick, over_pick, over_place, place, over_place, home]

points = np.concatenate([np.linspace(start, end, 50) for start, end in zip(keys[:-1], keys[1:])])
targets = np.tile(np.diag([1.0, -1.0, -1.0, 1.0]), (len(points), 1, 1))  # the tool points down
targets[:, :3, 3] = points
path = kinopt.solve_path(arm, targets)
print(f"{len(path)} points, {len(path.jumps)} reconfigurations")
assert path.reached and not path.jumps
motion = path.trajectory(acceleration_limits=5.0, jerk_limits=100.0)  # rad/s² and rad/s³
print(f"{motion.duration:.2f} s")
motion.plot().savefig(out)
print(f"saved: {out}")
