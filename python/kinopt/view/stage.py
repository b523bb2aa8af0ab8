"""Stage of a scene: ground with a grid and soft shadows, light, and a camera that views the whole model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import viser

Array = NDArray[np.float64]
Up = Literal["+z", "+y"]

#: Approximate drawn size of a model, in viser's metres: shadows and gizmos are designed for it.
DRAWN = 1.6
#: Sizes in metres that are drawn without scaling.
USUAL_SIZES = (0.4, 4.0)
#: Direction from the model to the camera: right of the front, slightly above; for z up, x to the front.
LOOK_FROM = np.array([1.0, -0.72, 0.36])
#: Vertical field of view of the camera, radians.
FIELD_OF_VIEW = 0.6
#: Width of the picture for 1 of its height, next to the panel, and distance of the camera for 1 that just fits.
ASPECT, MARGIN = 1.15, 1.1


def drawn_scale(size: float) -> float:
    """Drawn length of 1 for a model of this size."""
    if not np.isfinite(size) or size <= 0.0 or USUAL_SIZES[0] <= size <= USUAL_SIZES[1]:
        return 1.0
    return DRAWN / size


def furnish(server: viser.ViserServer, up: Up) -> None:
    """Sets the light, and the theme of the panel."""
    server.gui.configure_theme(
        show_logo=False, show_share_button=False, control_width="medium", brand_color=(38, 106, 171)
    )
    server.gui.main_panel.dock_right()
    scene = server.scene
    scene.set_up_direction(up)
    scene.world_axes.visible = False
    scene.configure_environment_map("studio", environment_intensity=0.3)
    scene.configure_default_lights(enabled=True, cast_shadow=True)


def lay_ground(server: viser.ViserServer, up: Up, height: float, size: float) -> None:
    """Draws a ground below a model of this size as drawn, at `height` along the upward axis."""
    cell = 10.0 ** np.floor(np.log10(max(size, 1e-6))) / 10.0
    position = (0.0, 0.0, height) if up == "+z" else (0.0, height, 0.0)
    server.scene.add_grid(
        "/ground",
        plane="xy" if up == "+z" else "xz",
        infinite_grid=True,
        cell_size=cell,
        section_size=5.0 * cell,
        cell_color=(228, 231, 235),
        section_color=(205, 210, 217),
        fade_distance=6.0 * size,
        shadow_opacity=0.22,
        plane_color=(251, 252, 253),
        plane_opacity=0.0,
        position=position,
    )


def show_box(server: viser.ViserServer, up: Up, low: Array, high: Array) -> None:
    """Moves camera and ground so that the box from `low` to `high`, as drawn, is on it and fills the page."""
    axis = 2 if up == "+z" else 1
    size = float(np.linalg.norm(high - low))
    # The ground stays near the origin, but is below a model that hangs deeper.
    lay_ground(server, up, 0.0 if abs(low[axis]) < 0.05 * size else float(low[axis]), size)
    middle = (low + high) / 2
    direction = LOOK_FROM / np.linalg.norm(LOOK_FROM)
    upward = np.eye(3)[axis]
    if up == "+y":
        # A glTF character faces +z.
        direction = np.array([-direction[1], direction[2], direction[0]])
    right = np.cross(upward, direction)
    right /= np.linalg.norm(right)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (high - low) + low - middle
    wide = np.maximum(np.abs(corners @ right) / ASPECT, np.abs(corners @ np.cross(direction, right)))
    distance = float((wide / np.tan(FIELD_OF_VIEW / 2) + corners @ direction).max())
    eye = middle + direction * max(MARGIN * distance, 1e-3)
    camera = server.initial_camera
    camera.up = tuple(upward)
    camera.position = tuple(eye)
    camera.look_at = tuple(middle)
    camera.fov = FIELD_OF_VIEW
    for client in server.get_clients().values():
        client.camera.position = eye
        client.camera.look_at = middle
        client.camera.fov = FIELD_OF_VIEW
