# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A humanoid robot crouches and reaches down, its feet in place and its centre of mass over them."""

import numpy as np

import kinopt
from kinopt import tasks

robot = kinopt.models.nao(base_joint="free")
feet = ["left_sole", "right_sole"]
stance = robot.crouched_configuration(feet, robot.neutral())


def at(frame):
    return kinopt.frame_placement(robot, frame, stance)


hand = at("left_hand")[:3, 3]
problem = kinopt.Problem(robot, [
    tasks.Point("left_hand", hand, name="hand"),
    *(tasks.Pose(foot, at(foot), scale=10.0) for foot in feet),
    tasks.SupportPolygon(on={foot: robot.sole(foot) for foot in feet}, margin=0.02, scale=10.0),
    tasks.Posture(stance, joint_weights="upright"),
])
drag = kinopt.Drag(problem, stance)  # each frame continues from the last one, without jumps
for share in np.linspace(0.0, 1.0, 31):
    drag.advance({"hand": hand + share * np.array([0.1, 0.0, -0.2])})
solution = drag.settle()
print(solution.explain())
print("centre of mass", robot.center_of_mass(solution.q).round(3), "m; the soles end at 0.1 m")
assert solution.reached
