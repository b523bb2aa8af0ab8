"""Common code of rigs, skeletons, scenes and captures: bones, limbs, and holds during a drag."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt
from kinopt import tasks

from .body import Body
from .canvas import Canvas
from .balance import Holding


Array = NDArray[np.float64]

#: Largest bend of a back while a limb is dragged, sum over its bones, radians.
MAX_BACK_BEND = 0.7
#: Posture weight of a back relative to limbs.
BACK_POSTURE_SCALE = 5.0


class Figure(Body):
    """A body of bones."""

    can_hold = True

    def __init__(self, scene: Canvas, thing: Any, name: str, at: Array) -> None:
        super().__init__(scene, thing, name, at)
        #: Skeleton of the bones.
        self.skeleton: Any = getattr(thing, "skeleton", thing)
        self._bone_of = {j: bone for bone in self.skeleton.bone_names for j in self.skeleton.joints(bone)}

    @property
    def tips(self) -> list[str]:
        """Tips of its limbs."""
        return list(self.skeleton.tips)

    def group(self, joint: str) -> str:
        """Bone of a joint."""
        return str(self._bone_of.get(joint, self.name))

    def short(self, joint: str) -> str:
        """Name of a joint's angle within its bone."""
        bone = self.group(joint)
        joints = self.skeleton.joints(bone) if joint in self._bone_of else []
        return ("twist", "bend", "second twist")[joints.index(joint)] if joint in joints else joint

    def holding(
        self, dragged: list[str], q: Array, reference: Array | None, pinned: Sequence[str] = ()
    ) -> Holding:
        """Locks the trunk, limits the bend of the back, and keeps the ends of other limbs in place.

        With a `reference` posture the back has a larger weight than limbs.
        """
        bones = [self.skeleton.bone_of_frame(frame)[0] for frame in dragged]
        holds = self.skeleton.holds(bones)
        values = dict(zip(self.model.joint_names, q.tolist(), strict=True))
        lock = {joint: values[joint] for bone in holds["trunk"] for joint in self.skeleton.joints(bone)}
        bend = MAX_BACK_BEND / max(len(holds["back"]), 1)
        narrow = {
            joint: (values[joint] - max_bend, values[joint] + max_bend)
            for bone in holds["back"]
            # Both twists rotate in one direction if a bone is straight.
            for joint, max_bend in zip(self.skeleton.joints(bone), (bend / 2, bend, bend / 2), strict=True)
        }
        ends = [self.skeleton.tip(bone) for bone in holds["ends"]]
        end_tasks = [
            tasks.Point(end, kinopt.frame_placement(self.model, end, q)[:3, 3], name=f"hold {end}")
            for end in ends
            if end not in dragged
        ]
        holding = Holding(end_tasks, kinopt.ParameterMap(self.thing, lock=lock, narrow=narrow))
        if reference is not None:
            back = {joint for bone in holds["back"] for joint in self.skeleton.joints(bone)}
            reference_values = dict(zip(self.model.joint_names, reference.tolist(), strict=True))
            stiff = {joint: value for joint, value in reference_values.items() if joint in back}
            loose = {joint: value for joint, value in reference_values.items() if joint not in back}
            for name, joint_values, scale in (
                ("posture", loose, 1.0),
                ("posture of the back", stiff, BACK_POSTURE_SCALE),
            ):
                if joint_values:
                    holding.tasks.append(tasks.Posture(joint_values, name=name, scale=scale))
            holding.has_posture = True
        return holding
