"""The drags of `posing.py` by Blender's bone constraints: IK of two bones with pole targets, hips keyed by the drag.

    python -m pip install bpy==4.5.*
    python benches/rivals/python/posing_blender.py CHARACTER.glb --drags DRAGS.json --out BLENDER.json

DRAGS.json is written by `posing.py --json`. A rigger's usual set-up: every hand and foot has an IK constraint over two
bones, with a pole in front of each knee and behind each elbow. A drag moves the target of one of them, or the hips.
OUT.json has the positions of all bones, and the vertices of all meshes, for each drag.
"""

import argparse
import json
from math import pi
from pathlib import Path

import bpy
from mathutils import Matrix, Vector


def to_blender(p):
    """glTF has y up, Blender z."""
    return Vector((p[0], -p[2], p[1]))


def to_gltf(v):
    return [v.x, v.z, -v.y]


def empty(name, at):
    thing = bpy.data.objects.new(name, None)
    thing.location = at
    bpy.context.collection.objects.link(thing)
    return thing


def pole_angle(armature, upper, lower, pole):
    """Angle for which the constraint leaves the rest pose as it is."""
    def head(bone):
        return armature.matrix_world @ bone.head

    base, tip = head(upper), armature.matrix_world @ lower.tail
    axis = (armature.matrix_world.to_3x3() @ upper.matrix.to_3x3()).col[0]
    normal = (tip - base).cross(pole - base)
    projected = normal.cross(head(lower) - base if (head(lower) - base).length else tip - base)
    angle = axis.angle(projected)
    return -angle if axis.cross(projected).angle(head(lower) - base) < pi / 2 else angle


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("character", type=Path)
    parser.add_argument("--drags", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    report = json.loads(options.drags.read_text())[options.character.name]

    bpy.ops.wm.read_factory_settings(use_empty=True)
    # The rest pose of the bones is that of the nodes, not the bind pose of the skin.
    bpy.ops.import_scene.gltf(filepath=str(options.character), guess_original_bind_pose=False)
    armature = next(thing for thing in bpy.context.scene.objects if thing.type == "ARMATURE")
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.matrix_basis = Matrix()
    bpy.context.view_layer.update()
    bones = armature.pose.bones
    forward = to_blender(report["forward"])
    height = report["height"]
    goals = {}
    for kind, limbs in (("leg", report["legs"]), ("arm", report["arms"])):
        for upper, lower, end in limbs:
            middle = armature.matrix_world @ bones[lower].head
            side = forward if kind == "leg" else -forward
            pole = empty(f"{lower} pole", middle + side * 0.5 * height)
            goal = empty(f"{end} goal", armature.matrix_world @ bones[end].head)
            constraint = bones[lower].constraints.new("IK")
            constraint.target, constraint.pole_target, constraint.chain_count = goal, pole, 2
            constraint.pole_angle = pole_angle(armature, bones[upper], bones[lower], pole.location)
            # The end keeps its orientation, as a foot on the ground does.
            copy = bones[end].constraints.new("COPY_ROTATION")
            goal.rotation_euler = (armature.matrix_world @ bones[end].matrix).to_euler()
            copy.target = goal
            goals[end] = goal
    hips = bones[report["hips"]]
    hips_rest = hips.matrix.copy()

    results = []
    for row in report["rows"]:
        target = to_blender(row["target"])
        before = {name: goal.location.copy() for name, goal in goals.items()}
        hips.matrix = hips_rest
        bpy.context.view_layer.update()
        if row["bone"] in goals:
            goals[row["bone"]].location = target
        elif row["bone"] == report["hips"]:
            moved = hips_rest.copy()
            moved.translation = armature.matrix_world.inverted() @ target
            hips.matrix = moved
        bpy.context.view_layer.update()
        graph = bpy.context.evaluated_depsgraph_get()
        positions = {bone.name: to_gltf(armature.matrix_world @ bone.head) for bone in armature.evaluated_get(graph).pose.bones}
        vertices, triangles = [], []
        for thing in bpy.context.scene.objects:
            if thing.type != "MESH" or thing.find_armature() is None:
                continue
            evaluated = thing.evaluated_get(graph)
            mesh = evaluated.to_mesh()
            mesh.calc_loop_triangles()
            first = len(vertices)
            vertices += [to_gltf(evaluated.matrix_world @ vertex.co) for vertex in mesh.vertices]
            triangles += [[first + k for k in triangle.vertices] for triangle in mesh.loop_triangles]
            evaluated.to_mesh_clear()
        results.append({"bone": row["bone"], "positions": positions, "vertices": vertices, "triangles": triangles})
        for name, location in before.items():
            goals[name].location = location
    options.out.write_text(json.dumps(results))


if __name__ == "__main__":
    main()
