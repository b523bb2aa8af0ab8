"""Colours of glTF meshes, from textures, vertex colours and materials.

The page gives a skinned mesh one colour. A mesh is therefore split into parts of one colour: the mean colour of each
triangle, in a palette.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .mesh_files import below

#: Largest number of colours of a mesh.
PALETTE = 16
#: Barycentric coordinates of the samples of a triangle.
SAMPLES = np.array([[1, 1, 1], [3, 1, 1], [1, 3, 1], [1, 1, 3]]) / np.array([[3], [5], [5], [5]])

Array = NDArray[np.float64]
Colors = NDArray[np.uint8]


def triangle_colors(path: Path, meshes: list[Any]) -> list[Colors | None]:
    """Colours of the triangles of each mesh of a glTF scene, shape (T, 3); None without material or file.

    Files other than `path` are opened only in its folder and below.
    """
    import trimesh

    try:
        with path.open("rb") as opened:
            loaded = trimesh.load_scene(
                opened, file_type=path.suffix.lower().lstrip("."), resolver=below(path.parent), process=False
            )
    except Exception:  # noqa: BLE001 - readers of images raise what they like
        return [None] * len(meshes)
    colored = list(loaded.geometry.values())
    result: list[Colors | None] = []
    for mesh in meshes:
        positions, triangles = np.asarray(mesh.mesh.positions), mesh.mesh.triangles
        same = (
            geometry
            for geometry in colored
            if geometry.vertices.shape == positions.shape
            and np.array_equal(geometry.faces, triangles)
            and np.allclose(geometry.vertices, positions)
        )
        found = next(same, None)
        result.append(None if found is None else _colors_of(found))
    return result


def _colors_of(geometry: Any) -> Colors | None:
    visual = geometry.visual
    if not getattr(visual, "defined", False):
        return None
    material: Any = getattr(visual, "material", None)
    uv = getattr(visual, "uv", None)
    if getattr(material, "baseColorTexture", None) is not None and uv is not None:
        points = np.einsum("sk,tkc->tsc", SAMPLES, uv[geometry.faces])
        sampled = np.asarray(material.to_color(points.reshape(-1, 2)), dtype=np.float64)
        colors: Array = sampled.reshape(len(points), len(SAMPLES), -1).mean(axis=1)
    elif material is not None:
        colors = np.tile(material.main_color, (len(geometry.faces), 1))
    else:
        colors = visual.vertex_colors[geometry.faces].mean(axis=1)
    return colors[:, :3].round().astype(np.uint8)


def palette(colors: Colors) -> tuple[Colors, NDArray[np.intp]]:
    """At most `PALETTE` colours, shape (P, 3), and the index of each given colour."""
    from PIL import Image

    quantised = Image.fromarray(colors[None]).quantize(PALETTE)
    used, labels = np.unique(np.asarray(quantised)[0], return_inverse=True)
    table = np.array(quantised.getpalette(), dtype=np.uint8).reshape(-1, 3)
    return table[used], labels.reshape(-1)
