"""Retargeting of a motion capture to a robot or a rig."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from .. import progress as bars
from .._kinopt import MotionCapture, SceneFile, Trajectory, World
from .._kinopt.retargeting import Capture, FigureTarget, capture_retargeted
from .maps import MapLike, completed, guess_map, is_skeleton, naming, read_map
from .movement import LostContact, LimitMet, RetargetReport, Touching
from .score_report import score_of_json
from .sources import Source, read_capture
from .surroundings import HeldObjectLike, TerrainLike, held_object_json, terrain_json
from .targets import Target, TargetLike, read_target


@dataclass(frozen=True)
class RetargetRequest:
    """A capture, a target and the map between them."""

    capture: Capture
    target: Target
    map: dict[str, Any]
    notes: list[str]
    options: dict[str, Any]


def retarget_request(
    source: Source,
    target: TargetLike,
    map: MapLike,
    *,
    joints: Sequence[str] | None,
    fps: float | None,
    up: Literal["y", "z"] | None,
    clip: str | None,
    **options: Any,
) -> RetargetRequest:
    """Reads the capture, the target and the map."""
    skeleton = map if isinstance(map, str) and is_skeleton(map) else None
    parsed_map = read_map(map)
    if parsed_map is not None:
        joints = parsed_map.get("joints") or joints if joints is None else joints
        fps = parsed_map.get("fps") if fps is None else fps
        if up is not None:
            # The argument has priority over the map.
            parsed_map = {**parsed_map, "up": up}
        up = parsed_map.get("up")
    source_notes: list[str] = []
    if isinstance(source, (str, os.PathLike)) and os.fspath(source).lower().endswith(".npz"):
        source = MotionCapture.read_smpl(source)
        source_notes = source.notes
    capture = read_capture(source, joints=joints, skeleton=skeleton, fps=fps, up=up, clip=clip)
    target = read_target(target)
    notes: list[str] = []
    if parsed_map is None:
        guess = guess_map(capture, target, skeleton)
        parsed_map, notes = guess.map, guess.notes
    else:
        with naming(map):
            parsed_map, notes = completed(parsed_map, capture, target)
    return RetargetRequest(capture, target, parsed_map, [*source_notes, *notes], options)


def retarget(
    source: Source,
    target: TargetLike,
    map: MapLike = None,
    *,
    fps: float | None = None,
    whole: bool = False,
    world: World | None = None,
    margin: float | None = None,
    keep_clear: float | None = None,
    joints: Sequence[str] | None = None,
    up: Literal["y", "z"] | None = None,
    clip: str | None = None,
    contact_speed: float | None = None,
    contact_height: float | None = None,
    acceleration: float | None = None,
    terrain: TerrainLike | None = None,
    held_object: HeldObjectLike | None = None,
    progress: bool | Callable[[int, int], None] = False,
) -> Trajectory[RetargetReport]:
    """Retargets a motion capture to a robot or a rig, within its position and speed limits in every frame.

    Returns a trajectory whose ``q`` has shape (T, configuration_len): metres (else the model's unit) and radians.

    ``source`` is as in ``read_capture``: positions of shape (T, J, 3) in any unit, a ``MotionCapture``, a clip or a
    file; so are ``joints``, ``fps``, ``up`` and ``clip``. ``target``: a ``Robot``, a ``BallSkeleton``, or a skeleton. A
    robot that walks needs ``base_joint="free"``; on a fixed base it stays in place, with a note in the ``notes`` of the
    report. A skeleton is put on a free base (``q`` begins with x, y, z and w, x, y, z); it is a rig, a skeleton, a scene,
    a ``MotionCapture``, or a ``FigureTarget`` with the upward axis of its file. It may also be the path of a .urdf, MJCF
    .xml, .glb, .gltf, .bvh or rig's .json file. ``save`` of the result writes files,
    ``retargeting.to_clip`` converts the motion of a skeleton to a clip.

    ``map``: a dict or a .json file (which joint drives which frame), the name of the capture's skeleton ("cmu",
    "lafan1", "mixamo", "smpl"), or None, for a guess by ``guess_map``. The result contains the map. One file may hold
    the maps of several robots, by the names of their files; drives that it lacks for this robot are guessed.

    Limbs are scaled by their lengths, the ground is detected, feet are locked during contacts. By default frames are
    solved one by one, without knowledge of later frames. With ``whole`` all are solved as one problem: the motion is
    smoother, and contacts hold as well (``slip`` is the drift). ``contact_speed`` (m/s) and ``contact_height`` (metres
    over the ground) are the thresholds of foot contacts. ``acceleration`` is the cost of 1 rad/s² with ``whole``, as a
    position error in metres. ``keep_clear``: smallest distance between links of a ``Robot`` in every frame, metres, by
    the exact distances of its collision shapes. ``touching`` lists frames that violate it. ``world``: a ``World`` to
    avoid collisions with, and with itself, by ``margin``. It is in metres at the scale of the robot; obstacles of the
    subject scale by ``stride``. Feet are in contact with obstacles as with the ground.

    ``terrain`` moves the motion onto steps and slopes, in metres in the world of the target: a dict ``{"patches":
    [{"centre": [x, y, z], "size": [along, across], "heading": 0.0, "slope": 0.0}]}``, or its .json file. Feet tilt with
    the ground (angles in radians), and heights follow it. ``held_object`` is a box or a ball that the subject holds:
    ``{"shape": {"box": [x, y, z]}, "poses": (T, 7)}`` with x, y, z, quaternion w, x, y, z of its centre in each frame, in
    the unit and axes of the capture, or ``{"shape": {"ball": radius}, ...}``. Hands near it keep their places on the
    target's object, whose shape is ``model_shape`` (else scaled by ``stride``) and whose poses are ``object_poses``.

    ``progress``: True shows a tqdm bar; a function is called with the number of finished frames and of all frames.
    Ctrl-C interrupts the computation. The GIL is released.

    Raises ``UnknownNameError`` for names in the map that the capture or the target lacks, ``InvalidValueError`` for
    invalid arrays, names and options, ``FileError`` and ``InvalidFileError`` for files.
    """
    request = retarget_request(
        source,
        target,
        map,
        joints=joints,
        fps=fps,
        up=up,
        clip=clip,
        contact_speed=contact_speed,
        contact_height=contact_height,
        acceleration=acceleration,
        keep_clear=keep_clear,
        world=world,
        margin=margin,
        terrain=terrain_json(terrain),
        held_object=held_object_json(held_object),
    )
    with naming(map):
        parts = capture_retargeted(
            request.capture,
            request.target,
            json.dumps(request.map),
            whole,
            request.options,
            bars.bar() if progress is True else progress or None,
        )
    q, names, contacts, (contact_frames, contact_points), (angles, limbs), scalars, score, limits, touching, lost_contacts, base, object_poses = parts
    stands_along, has_fixed_base = base
    slip, ground_penetration, stride = scalars
    notes = list(request.notes)
    if stands_along is not None:
        notes.append("the target is upright along another axis than its upward axis")
    if has_fixed_base:
        notes.append('the target has legs but a fixed base, so it stays in place: read the robot with base_joint="free"')
    report = RetargetReport(
        fps=request.capture.fps,
        contacts=contacts,
        contact_frames=contact_frames,
        contact_points=contact_points,
        score=score_of_json(score),
        limb_angles=angles,
        limbs=limbs,
        slip=slip,
        ground_penetration=ground_penetration,
        stride=stride,
        limits=[LimitMet(*limit) for limit in limits],
        lost_contacts=[LostContact(*lost) for lost in lost_contacts],
        touching=[Touching(*pair) for pair in touching],
        map=request.map,
        notes=notes,
        object_poses=object_poses,
        capture=request.capture,
    )
    # A file cannot be pickled, its figure can.
    model = FigureTarget(request.target) if isinstance(request.target, SceneFile) else request.target
    return Trajectory(np.arange(len(q)) / request.capture.fps, q, names, report, model)


__all__ = ["retarget"]
