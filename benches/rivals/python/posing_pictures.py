"""Pictures of the drags of `posing.py`, by kinopt and three.js, side by side.

    python benches/rivals/python/posing_pictures.py CHARACTER.glb --drags DRAGS.json --three THREE.json --out docs/posing.png

Needs kinopt, numpy and matplotlib. Each column is a drag, each row a program; a cross marks the target.
"""

import argparse
import json
from pathlib import Path

import kinopt
import matplotlib
import numpy as np
from kinopt.animation import Pose
from matplotlib.collections import PolyCollection

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

VIEW_ANGLE = np.radians(40)


def project(points):
    """Screen coordinates and depth of points with y up, seen from the front at an angle."""
    x, y, z = np.asarray(points, dtype=float).T
    c, s = np.cos(VIEW_ANGLE), np.sin(VIEW_ANGLE)
    return np.stack([c * x - s * z, y, s * x + c * z], axis=-1)


def draw(axes, vertices, triangles):
    at = project(vertices)
    corners = at[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    faces = (normals[:, 2] > 0) & (lengths > 0)
    corners, normals = corners[faces], normals[faces] / lengths[faces, None]
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    light = 0.35 + 0.6 * np.clip(normals @ [0.3, 0.5, 0.81], 0, 1)
    colours = light[order, None] * np.array([0.62, 0.70, 0.82])
    axes.add_collection(PolyCollection(corners[order, :, :2], facecolors=colours, edgecolors=colours, linewidths=0.1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("character", type=Path)
    parser.add_argument("--drags", type=Path, required=True)
    parser.add_argument("--three", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    report = json.loads(options.drags.read_text())[options.character.name]
    scene = kinopt.Scene.read(options.character)
    posing = scene.posing("lbs")
    triangles = np.concatenate(list(mesh_triangles(scene)))
    rows = report["rows"]
    ours, three = [], []
    rest, names = scene.armature.rest, scene.armature.names

    def posed(translations, rotations):
        pose = Pose(scene.armature, translations=translations, rotations_xyzw=rotations, scales=rest.scales)
        return posing.positions(pose), triangles

    for row, other in zip(rows, json.loads(options.three.read_text()), strict=True):
        ours.append(posed(*row["pose"]))
        rotations, translations = np.array(rest.rotations_xyzw), np.array(rest.translations)
        for bone, local in other["rotations"].items():
            rotations[names.index(bone)] = local["rotation"]
            translations[names.index(bone)] = local["translation"]
        three.append(posed(translations, rotations))
    programs = {"kinopt": ours, "three.js, CCDIKSolver": three}
    height = report["height"]
    figure, table = pyplot.subplots(len(programs), len(rows), figsize=(1.25 * len(rows), 1.45 * len(programs)))
    for line, (name, poses) in zip(table, programs.items(), strict=True):
        line[0].set_ylabel(name, fontsize=8)
        for axes, row, (vertices, faces) in zip(line, rows, poses, strict=True):
            draw(axes, np.asarray(vertices), faces)
            x, y, _ = project([row["target"]])[0]
            axes.plot([x], [y], "x", color="#c62828", markersize=4, markeredgewidth=1)
            axes.set(xlim=(-0.62 * height, 0.62 * height), ylim=(-0.08 * height, 1.25 * height), aspect="equal")
            axes.set_xticks([])
            axes.set_yticks([])
            for spine in axes.spines.values():
                spine.set_visible(False)
    for axes, row in zip(table[0], rows, strict=True):
        axes.set_title(row["bone"].split(":")[-1], fontsize=7)
    figure.tight_layout(pad=0.2)
    figure.savefig(options.out, dpi=110)


def mesh_triangles(scene):
    first = 0
    for mesh in scene.meshes:
        yield np.asarray(mesh.mesh.triangles) + first
        first += len(mesh.mesh.positions)


if __name__ == "__main__":
    main()
