"""Opening a page for a model file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import kinopt

from ..types import BaseJoint
from .humanoid import humanoid
from .look import extent
from .page import Page
from .scene import Scene
from .stage import Up

#: Ranges from this size on have no meaningful middle, radians.
MAX_LIMITED_RANGE = 5.9
#: Ratio of smallest to largest singular value below which an arm counts as stretched.
MIN_DEXTERITY = 0.03
#: Largest bend of joints away from a stretched pose, radians.
MAX_BEND = 1.2
#: Notes of the reader about parts of a glTF scene that a page draws.
DRAWN_PARTS = ("images:", "materials:", "textures:", "meshes: TEXCOORD_0:")
#: Supported file types.
SUPPORTED = ".urdf and .xml (a robot), .json (a rig), .glb and .gltf (a scene), .bvh (motion capture)"


@dataclass
class Opened:
    """A model, with the options of its page."""

    thing: Any
    up: Up = "+z"
    #: True if targets initially have an orientation.
    turns: bool = False
    #: Initial tolerance of targets for lengths and angles.
    tolerance: float = 1e-6
    #: Omissions and repairs of the reader, one line each.
    notes: list[str] = field(default_factory=list)


def open_model(path: str | Path, base_joint: BaseJoint | None = None) -> Opened:
    """Reads a model by its file extension; `base_joint` connects a robot's root to the world.

    A malformed URDF is repaired if the repair is unique, with notes. Raises `FileError` if the file cannot be read,
    `InvalidFileError` if its content is invalid, `InvalidValueError` for other file types.
    """
    path = Path(path)
    if base_joint is not None and path.suffix.lower() not in (".urdf", ".xml", ".mjcf"):
        raise kinopt.InvalidValueError(f"{path}: a base joint applies to robots only (.urdf, .xml)")
    match path.suffix.lower():
        case ".urdf":
            try:
                robot = kinopt.Robot.from_urdf(path, base_joint=base_joint)
            except kinopt.InvalidFileError:
                robot = kinopt.Robot.from_urdf(path, base_joint=base_joint, lenient=True)
            return _robot(robot)
        case ".xml" | ".mjcf":
            return _robot(kinopt.Robot.from_mjcf(path, base_joint=base_joint))
        case ".json":
            rig = kinopt.Rig.read(path)
            return Opened(rig, tolerance=_below(rig.skeleton.size), notes=list(rig.notes))
        case ".glb" | ".gltf":
            scene = kinopt.Scene.read(path)
            notes = [note for note in scene.notes if not note.startswith(DRAWN_PARTS)]
            return Opened(scene, "+y", tolerance=_below(_extent(scene.armature)), notes=notes)
        case ".bvh":
            capture = kinopt.MotionCapture.read(path)
            return Opened(
                capture, "+y", tolerance=_below(_extent(capture.armature)), notes=list(capture.notes)
            )
    raise kinopt.InvalidValueError(f"{path}: unsupported file, expected {SUPPORTED}")


def opening_pose(robot: Any, hold: Sequence[str] = ()) -> Any:
    """Initial pose: an arm in the middle of its ranges, bent if it would be stretched. Others are at rest, a body on a
    free base with its knees slightly bent over the held frames.

    At full stretch, where many files have all zeros, an arm cannot be pushed back.
    """
    model, tips = robot.model, robot.tips
    rest = model.neutral()
    if model.configuration_len > model.degrees_of_freedom:
        # A quaternion has no middle.
        return robot.crouched_configuration(list(hold), rest)
    arms = [robot.chain(robot.frame_names[0], tip) for tip in tips[:1]]
    followed = set(robot.mimics) | {joint for tip in tips for joint in robot.chain(robot.frame_names[0], tip)}
    if not arms or len(arms[0]) < 3 or len(followed - set(arms[0])) > 2:
        return rest
    ranges = model.upper - model.lower
    narrow = np.isfinite(ranges) & (ranges < MAX_LIMITED_RANGE)
    middle = np.where(narrow, (np.nan_to_num(model.lower) + np.nan_to_num(model.upper)) / 2, rest)
    jacobian = kinopt.Jacobian(robot, [tips[0]])

    def dexterity(q: Any) -> float:
        values = np.linalg.svd(jacobian.at(q), compute_uv=False)
        return float(values[-1] / values[0])

    if dexterity(middle) > MIN_DEXTERITY:
        return middle
    half_range = np.where(np.isfinite(ranges), np.minimum(ranges / 2, MAX_BEND), MAX_BEND)
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (200, len(middle)))
    bent = np.clip(middle + random * half_range, model.lower, model.upper)
    return max(bent, key=dexterity)


def _extent(armature: Any) -> float:
    return extent(np.asarray(armature.local_to_model(armature.rest), dtype=float))


def _robot(robot: kinopt.Robot) -> Opened:
    # Targets of a body's hands are positions.
    turns = not robot.model.free_joints and humanoid(robot) is None
    return Opened(robot, turns=turns, notes=list(robot.repairs))


def _below(size: float) -> float:
    """A millionth of a size as a power of ten, from 1e-9 to 1e-2."""
    import math

    return 10.0 ** min(max(math.floor(math.log10(max(size, 1e-12))) - 6, -9), -2)


def open_page(
    path: str | Path,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    packages: Iterable[str | Path] = (),
    capsules: bool = False,
    up: Up | None = None,
    base_joint: BaseJoint | None = None,
    hold: Sequence[str] = (),
    world: kinopt.World | str | Path | None = None,
    margin: float = 0.0,
    retarget: str | Path | None = None,
    map: str | Path | None = None,
    fps: float | None = None,
    whole: bool = False,
    keep_clear: float | None = None,
) -> Page:
    """Opens the page of a model: see `python -m kinopt.view --help`. Raises as `open_model` and `World.read`. Raises
    `UnknownNameError` for an unknown frame to hold, `InvalidValueError` for a world with a model without shapes, and as
    `kinopt.retarget` for a motion."""
    path = Path(path)
    if world is not None and not isinstance(world, kinopt.World):
        world = kinopt.World.read(world)
    movement = None
    if retarget is not None:
        base_joint = base_joint or ("free" if path.suffix.lower() != ".json" else None)
    opened = open_model(path, base_joint)
    if retarget is not None:
        retarget_world = world if isinstance(opened.thing, kinopt.Robot) else None
        movement = kinopt.retarget(
            retarget,
            opened.thing,
            None if map is None else str(map),
            fps=fps,
            whole=whole,
            keep_clear=keep_clear,
            # The motion of a skeleton avoids no collisions.
            world=retarget_world,
            margin=None if retarget_world is None or keep_clear is not None else margin,
        )
        opened.notes += movement.report.notes
        if movement.report.touching:
            opened.notes.append(f"collisions in {len(movement.report.touching)} of {len(movement)} frames")
    if world is not None:
        # Checks the world with the model before a page opens.
        kinopt.Problem(opened.thing, world=world, margin=margin)
    scene = Scene(host=host, port=port, up=up or opened.up, title=path.name, open=False)
    body = scene.add(
        opened.thing,
        style="capsules" if capsules else "auto",
        beside=path if isinstance(opened.thing, kinopt.Scene) else path.resolve().parent,
        packages=packages,
    )
    found = getattr(body, "humanoid", None)
    if found is not None and body.stands and movement is None:
        hold = hold or found.feet
    for frame in hold:
        # Raises an error with the valid names for an unknown frame.
        body.frame(frame)
    if isinstance(opened.thing, kinopt.Robot):
        body.q = opening_pose(opened.thing, hold)
        scene.frame_all()
    clips = [] if movement is None else [scene.add_movement(movement, body, name=Path(str(retarget)).stem)]
    return Page(
        scene,
        body,
        turns=opened.turns,
        tolerance=opened.tolerance,
        notes=opened.notes,
        hold=hold,
        world=world,
        margin=margin,
        clips=clips,
    )
