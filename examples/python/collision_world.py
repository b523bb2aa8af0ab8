# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""An arm among boxes: poses at least 2 cm away from all obstacles, and a world that changes."""

import numpy as np

import kinopt

robot = kinopt.models.panda()
world = kinopt.World()
world.add_box("table", (0.8, 1.2, 0.04), pose=(0.65, 0.0, 0.1))
world.add_box("shelf", (0.2, 0.6, 0.02), pose=(0.75, 0.0, 0.5))
world.add_cylinder("pillar", 0.05, 0.8, pose=(0.4, 0.35, 0.5))
arm = kinopt.Arm(robot, "base", "tool", world=world, margin=0.02)  # metres
start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]
target = np.diag([1.0, -1.0, -1.0, 1.0])  # the tool points down
target[:3, 3] = [0.5, 0.1, 0.2]
solution = arm.solve(target, start)
print(solution.explain(), arm.collisions(solution.q))
assert solution.reached and not solution.collisions

world.add_sphere("ball", 0.1, pose=(0.5, 0.1, 0.2))
blocked = arm.with_world(world).solve(target, start)
print(blocked.explain())
assert not blocked.reached
