"""Saved poses: JSON for programs, OBJ and GLB for mesh viewers, HTML for browsers; and their buttons."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from .transforms import wxyz_of

if TYPE_CHECKING:
    from .body import Body
    from .dragging import Dragging

#: Formats of a saved pose.
FORMATS = ("json", "obj", "glb", "html")


def pose_json(body: Body) -> str:
    """The configuration by joint, and the poses of the tips (metres or the model's unit, w x y z) as JSON.

    The numbers read back exactly.
    """
    frames = {}
    for name in body.tips:
        placement = body.frame(name)
        wxyz = wxyz_of(placement[None, :3, :3])[0]
        frames[name] = {"position": placement[:3, 3].tolist(), "quaternion": wxyz.tolist()}
    document = {
        "model": body.model.name,
        "q": body.q.tolist(),
        "joints": dict(zip(body.model.coordinate_names, body.q.tolist(), strict=True)),
        "frames": frames,
    }
    return json.dumps(document, indent=1)


def pose_obj(body: Body) -> str:
    """The meshes in the current pose, in the world, as Wavefront OBJ with a group for each part."""
    lines = [f"# {body.model.name}, posed by kinopt"]
    first = 1
    for i, piece in enumerate(body.pieces()):
        lines.append(f"o {piece.name.replace(' ', '_')}_{i}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in piece.solid.vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (piece.solid.triangles.astype(int) + first).tolist()]
        first += len(piece.solid.vertices)
    return "\n".join(lines) + "\n"


def pose_glb(body: Body) -> bytes:
    """The meshes in the current pose as binary glTF, with their colours; y is upward, as in glTF."""
    import trimesh as meshes

    trimesh: Any = meshes

    scene = trimesh.Scene()
    for i, piece in enumerate(body.pieces()):
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=[*piece.color, 255], metallicFactor=0.0, roughnessFactor=0.7
        )
        mesh = trimesh.Trimesh(
            vertices=piece.solid.vertices,
            faces=piece.solid.triangles.astype(int),
            visual=trimesh.visual.TextureVisuals(material=material),
            process=False,
        )
        scene.add_geometry(mesh, node_name=f"{piece.name}_{i}", geom_name=f"{piece.name}_{i}")
    if body.scene.up == "+z":
        turned = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
        scene.apply_transform(turned)
    data: bytes = scene.export(file_type="glb")
    return data


def saved(body: Body, kind: str) -> bytes:
    """The pose in one of `FORMATS`."""
    if kind == "glb":
        return pose_glb(body)
    if kind == "html":
        return body.scene.snapshot().encode()
    return (pose_json(body) if kind == "json" else pose_obj(body)).encode()


class SavePanel:
    """Buttons that save the pose to a download of the browser."""

    def __init__(self, page: Dragging) -> None:
        gui = page.scene.server.gui
        with gui.add_folder("Save the pose"):
            self._kind = gui.add_button_group("", tuple(kind.upper() for kind in FORMATS))

        @self._kind.on_click
        def _(event: Any) -> None:
            kind = str(self._kind.value).lower()
            data = page.call(lambda: saved(page.body, kind))
            to = event.client or page.scene.server
            to.send_file_download(f"{page.body.name}.{kind}", data, save_immediately=True)
