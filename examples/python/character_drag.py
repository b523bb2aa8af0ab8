# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A hand of a character follows a target while head, other hand and feet stay in place. The posed mesh is saved."""

import sys

import numpy as np

import kinopt
from kinopt import tasks

out = sys.argv[1] if len(sys.argv) > 1 else "reaching.obj"
rig = kinopt.models.humanoid()
skeleton = rig.skeleton
rest = skeleton.model.neutral()


def at(bone):
    return kinopt.frame_placement(rig, skeleton.tip(bone), rest)[:3, 3]


points = [tasks.Point(skeleton.tip(bone), at(bone), name=bone) for bone in rig.constrained]
drag = kinopt.Drag(kinopt.Problem(rig, points), rest)
for share in np.linspace(0.0, 1.0, 31):
    drag.advance({"left_hand": (1.0 - share) * at("left_hand") + share * np.array([0.35, 0.45, 1.5])})  # metres
solution = drag.settle()
print(solution.explain())
assert solution.reached
kinopt.io.obj_write(rig.posed_mesh(solution.q, "dqs"), out)
print(f"saved: {out}")
