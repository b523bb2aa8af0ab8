# /// script
# dependencies = ["kinopt"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A clip added to a glTF file: a character reaches up. Materials and other content of the file stay."""

import sys

import kinopt
from kinopt import tasks
from kinopt.animation import Clip, EulerPoseMap

out = sys.argv[1] if len(sys.argv) > 1 else "reaching.glb"
rig = kinopt.models.humanoid()
glb = kinopt.Scene.of_skeleton(rig.skeleton, rig.mesh, rig.weights).to_bytes()
file = kinopt.SceneFile.from_bytes(glb, "character.glb")  # yours: SceneFile.read("character.glb")
armature = file.scene.armature
skeleton = armature.skeleton()
rest = skeleton.model.neutral()


def at(bone):
    return kinopt.frame_placement(skeleton, skeleton.tail(bone), rest)[:3, 3]


bones = ["left_hand", "right_hand", "left_foot", "right_foot"]
problem = kinopt.Problem(skeleton, [tasks.Point(skeleton.tail(bone), at(bone), name=bone) for bone in bones])
solution = kinopt.Drag(problem, rest).settle({"left_hand": at("left_hand") + [-0.1, 0.1, 0.2]})
assert solution.reached
pose = EulerPoseMap(skeleton, armature).pose_of(solution.q)
file.add_clip(Clip.through_poses("reach", armature, [0.0, 1.0], [armature.rest, pose]))
file.write(out)
print([clip.name for clip in kinopt.Scene.read(out).clips], f"saved: {out}")
