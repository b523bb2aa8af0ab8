# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A motion capture on a humanoid robot: retargeted within its limits and saved."""

import sys

import kinopt

out = sys.argv[1] if len(sys.argv) > 1 else "steps.npz"
robot = kinopt.models.nao(base_joint="free")
motion = kinopt.retarget(kinopt.models.steps(), robot, fps=30)
report = motion.report
print(f"{motion.q.shape[0]} frames of {motion.q.shape[1]} numbers, contacts of {report.contact_frames}")
print(f"mean direction error {report.mean_angle:.0f}°, foot sliding {1000 * report.slip:.2f} mm")
assert all(robot.is_within_limits(q) for q in motion.q)
motion.save(out)  # or .csv, .json
print(f"saved: {out}")
