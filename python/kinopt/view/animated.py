"""Characters from animation files: glTF scenes and motion capture, played and dragged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import look
from .body import Clip, Piece
from .canvas import Canvas
from .curves import MAX_SAMPLES, Curves, curves_in
from .figure import Figure
from .look import Color
from .mesh_on_bones import MeshOnBones
from .skin import bone_skin
from .textures import triangle_colors

Array = NDArray[np.float64]

#: Number of times of each clip that are checked for scaling bones.
CLIP_SAMPLES = 24
#: Colours of the meshes of a scene, in order.
COLORS: tuple[Color, ...] = (look.SKIN, (150, 160, 172), (120, 140, 160), (190, 150, 120))


class AnimatedBody(Figure):
    """A glTF scene or a motion capture. It plays its clips, and can be dragged from any pose of a clip.

    Its angles are relative to the pose of a clip, where all are zero. The bones of a capture with channels rotate, or
    the joints of a scene's skins; without any, all bones rotate.
    """

    def __init__(
        self,
        scene: Canvas,
        thing: Any,
        name: str,
        at: Array,
        *,
        color: Color | None = None,
        opacity: float | None = None,
        file: Path | None = None,
    ) -> None:
        """Arguments are as in `Scene.add`; `thing` is a `kinopt.Scene` or a `kinopt.MotionCapture`, `file` its file."""
        #: Bones of the file.
        self.armature: Any = thing.armature
        self._turning = turning_bones(thing)
        self._limits = np.zeros((self.armature.bones, 3, 2))
        self._limits[sorted(self._turning)] = [-np.inf, np.inf]
        clips = clips_of(thing)
        self._pose = clips[0].sample(clips[0].span[0]) if clips else self.armature.rest
        super().__init__(scene, self._skeleton_in(self._pose, name), name, at)
        bones = self.armature.names
        self._bone_of_frame = {
            frame: bones.index(self.skeleton.bone_of_frame(frame)[0]) for frame in self.frame_names
        }
        self._clips: list[Clip] = [Played(self, clip) for clip in clips]
        self._moments = self._sampled(clips)
        self._meshes = self._build_meshes(thing, color, opacity, file)
        self.missing.extend(note for mesh in self._meshes for note in mesh.notes)
        self.show_pose(self._pose)

    def _skeleton_in(self, pose: Any, name: str) -> Any:
        return self.armature.at_rest_in(pose).skeleton(name, self._limits)

    def _sampled(self, clips: list[Any]) -> list[Array]:
        """model_from_bone of the first pose, and at several times of each clip, (N, bones, 4, 4)."""
        times = [np.linspace(clip.span[0], clip.span[1], CLIP_SAMPLES) for clip in clips]
        moving = [self.armature.local_to_model(clip.sample(moments)) for clip, moments in zip(clips, times, strict=True)]
        return [np.asarray(pose, dtype=float) for pose in [self.armature.local_to_model(self._pose)[None], *moving]]

    def _build_meshes(
        self, thing: Any, color: Color | None, opacity: float | None, file: Path | None
    ) -> list[MeshOnBones]:
        samples = np.concatenate(self._moments)
        meshes = list(getattr(thing, "meshes", []))
        bone_meshes = []
        textured = [None] * len(meshes) if file is None or color else triangle_colors(file, meshes)
        for i, (mesh, colors) in enumerate(zip(meshes, textured, strict=True)):
            mesh_color = color or COLORS[i % len(COLORS)]
            bone_meshes.append(MeshOnBones.of_scene(self, f"{self.name}/{i}", mesh, samples, mesh_color, opacity, colors))
        if not meshes:
            bones = np.arange(self.armature.bones)
            rest_placements = np.linalg.inv(samples[0])
            skin = bone_skin(self.skeleton)
            mesh_color = color or look.BONE
            bone_meshes.append(
                MeshOnBones(self, f"{self.name}/bones", skin, bones, rest_placements, samples, mesh_color, opacity)
            )
        return bone_meshes

    # Pose.

    def show_pose(self, pose: Any) -> None:
        """Sets the pose of its armature, which becomes the zero of the angles."""
        self._pose = pose
        self._from_here = np.asarray(self.armature.local_to_model(pose), dtype=float)
        self._model_from_bone = self._from_here
        self._q = np.zeros(len(self._q))
        self._stale = True
        self._show()

    def standing(self) -> None:
        """Sets the rest pose of the skeleton to the current pose."""
        if self._stale:
            self.skeleton: Any = self._skeleton_in(self._pose, self.name)
            self.thing: Any = self.skeleton
            self.model: Any = self.skeleton.model
            self._stale = False

    def _place(self, q: Array) -> None:
        self.standing()
        moved: Array = self.skeleton.skinning_transforms(q)
        self._q = q
        self._model_from_bone = moved @ self._from_here
        self._show()

    def _draw(self, q: Array, world_from_frames: Array) -> None:
        self._show()

    def _show(self) -> None:
        world_from_bone = self.at @ self._model_from_bone
        for mesh in self._meshes:
            mesh.move(world_from_bone, self._pose)
        self._tell_moved()

    def frame(self, name: str) -> Array:
        """Current pose of a frame: world_from_frame, shape (4, 4). Raises `UnknownNameError` for an unknown name."""
        if name not in self._bone_of_frame:
            return super().frame(name)
        placement: Array = self.at @ self._model_from_bone[self._bone_of_frame[name]]
        placement[:3, :3] /= np.linalg.norm(placement[:3, :3], axis=0)
        return placement

    def size(self) -> float:
        """Extent of its bones in the current pose, in the model's unit."""
        return look.extent(self._model_from_bone)

    def region(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the box about its first clip, in the model's unit."""
        low, high = self.box()
        here = self.at @ self._model_from_bone
        path = self.at @ np.concatenate(self._moments[:2])
        first, last = here[:, :3, 3].min(axis=0), here[:, :3, 3].max(axis=0)
        return path[..., :3, 3].min(axis=(0, 1)) - (first - low), path[..., :3, 3].max(axis=(0, 1)) + (high - last)

    # Parts.

    def pieces(self) -> list[Piece]:
        """Its meshes in the current pose, in the world, with all influences of each vertex."""
        world_from_bone = self.at @ self._model_from_bone
        return [piece for mesh in self._meshes for piece in mesh.pieces(world_from_bone, self._pose)]

    def remove(self) -> None:
        """Removes it from the scene."""
        for mesh in self._meshes:
            mesh.remove()
        self.scene.forget(self)

    @property
    def tips(self) -> list[str]:
        """Ends of its limbs: the children of the last rotating bones, or those bones themselves."""
        parents, names = self.armature.parents.tolist(), self.armature.names
        leads_on = {parents[bone] for bone in self._turning}
        ends = []
        for bone in sorted(self._turning - leads_on):
            carried = [other for other, parent in enumerate(parents) if parent == bone]
            ends.append(self.skeleton.tail(names[carried[0] if carried else bone]))
        return ends

    @property
    def limbs(self) -> dict[str, dict[str, int]]:
        """Rotating bones from the root to each tip, by their indices in the armature; each is in one limb."""
        names, parents = self.armature.names, self.armature.parents.tolist()
        limbs: dict[str, dict[str, int]] = {}
        taken: set[int] = set()
        for tip in self.tips:
            bone, chain = self._bone_of_frame[tip], []
            while bone >= 0 and bone not in taken:
                chain.append(bone)
                bone = parents[bone]
            taken.update(chain)
            limbs[tip] = {names[bone]: bone for bone in reversed(chain) if bone in self._turning}
        return {tip: limb for tip, limb in limbs.items() if limb}

    @property
    def clips(self) -> list[Clip]:
        """Clips of the file."""
        return self._clips


class Played:
    """A clip on a time line."""

    def __init__(self, body: AnimatedBody, clip: Any) -> None:
        self._body, self._clip = body, clip
        self.name: str = clip.name or "clip"
        start, end = clip.span
        self.span: tuple[float, float] = (float(start), float(end))

    def show(self, seconds: float) -> None:
        """Sets the pose of the clip at that time."""
        self._body.show_pose(self._clip.sample(seconds))

    @property
    def curves(self) -> Curves:
        """Rotation of each bone from its first orientation over time, radians, by limb."""
        times = np.linspace(self.span[0], self.span[1], MAX_SAMPLES)
        wxyz = np.asarray(self._clip.sample(times).rotations_wxyz, dtype=float)
        angles = 2.0 * np.arccos(np.abs(np.einsum("tbi,bi->tb", wxyz, wxyz[0])).clip(0.0, 1.0))
        return curves_in({tip: {name: angles[:, bone] for name, bone in limb.items()} for tip, limb in self._body.limbs.items()}, times)


def clips_of(thing: Any) -> list[Any]:
    """The clips of a scene, or the motion of a capture."""
    return list(thing.clips) if hasattr(thing, "clips") else [thing.clip]


def turning_bones(thing: Any) -> set[int]:
    """Bones that can rotate, by their indices in the armature."""
    names = thing.armature.names
    turning: set[int] = set()
    for mesh in getattr(thing, "meshes", []):
        if mesh.skin is not None:
            turning.update(names.index(joint) for joint in mesh.skin.joints)
    for bone, channels in enumerate(getattr(thing, "channels", [])):
        if any("rotation" in channel for channel in channels):
            turning.add(bone)
    return turning or set(range(len(names)))
