"""A glTF scene and a motion capture, built from the shipped rigs: y up and z ahead, as in such files."""

from __future__ import annotations

from pathlib import Path

import kinopt
import numpy as np

#: Rigs face along x, with z up.
SCENE_FROM_RIG = np.array(
    [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)


def keyframes(rig: kinopt.Rig, name: str) -> tuple[kinopt.animation.Armature, kinopt.animation.Clip]:
    """The bones of a rig in a scene, and its keyframes as a clip."""
    armature = kinopt.animation.Armature.of_skeleton(rig.skeleton.placed(SCENE_FROM_RIG))
    keys = kinopt.animation.Clip.builder(name, armature)
    keys.euler_clip(rig.clip)
    return armature, keys.build()


def write_scene(rig: kinopt.Rig, name: str, path: Path) -> None:
    """Writes a rig as a binary glTF file: its mesh, its skin, its keyframes."""
    armature, clip = keyframes(rig, "Keys")
    positions = np.asarray(rig.mesh.positions, dtype=float) @ SCENE_FROM_RIG[:3, :3].T
    mesh = kinopt.TriangleMesh(positions, rig.mesh.triangles)
    skin = kinopt.Skin(
        armature, "skin", list(armature.names), np.asarray(armature.rest_from_model), rig.weights
    )
    whole = kinopt.SceneMesh(armature, name, armature.names[0], mesh, skin=skin)
    kinopt.Scene(armature, [whole], [clip]).write(path)


def write_capture(rig: kinopt.Rig, path: Path) -> None:
    """Writes the keyframes of a rig as motion capture."""
    armature, clip = keyframes(rig, path.stem)
    kinopt.io.bvh_write(armature, clip, 60.0, path)
