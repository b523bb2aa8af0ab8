# /// script
# dependencies = ["kinopt[view]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A robot in the browser: the arm follows a gizmo, and the page shows what it reaches."""

import kinopt
from kinopt.view import Scene

robot = kinopt.models.panda()
arm = kinopt.Arm(robot, "base", "tool")
scene = Scene()
body = scene.add(robot)
body.q = arm.configuration(arm.default_start, body.q)
target = scene.target("goal", body.frame("tool"))
follower = arm.follower(arm.joint_values(body.q))


@target.on_move
def follow(placement):
    solution, jump = follower.advance(placement)
    body.q = arm.configuration(solution.q, body.q)


scene.wait()
