"""Models that the package contains: eight robots, a character and a motion capture.

```python
import kinopt

arm = kinopt.Arm(kinopt.models.panda(), "base", "tool")
nao = kinopt.models.nao(base_joint="free")
```

The robots have makers' kinematics and simple shapes without meshes. ``path`` returns the file of a model, for readers
with other options. Sources and licences:
https://github.com/kinopt/kinopt/blob/main/models/README.md
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .._kinopt import MotionCapture, Rig, Robot
from ..errors import UnknownNameError
from ..types import BaseJoint

_FILES = {
    "baxter": "rethink_baxter.urdf",
    "cobra_s600": "adept_cobra_s600.urdf",
    "humanoid": "humanoid.json",
    "iiwa14": "kuka_iiwa14.urdf",
    "nao": "aldebaran_nao.urdf",
    "panda": "franka_panda.urdf",
    "so101": "robotstudio_so101.urdf",
    "steps": "steps.bvh",
    "ur10e": "universal_ur10e.urdf",
    "ur5e": "universal_ur5e.urdf",
}


def names() -> list[str]:
    """Names of the models, in alphabetical order."""
    return list(_FILES)


def path(name: str) -> Path:
    """File of the model ``name``: URDF for robots, JSON for the character, BVH for the capture.

    Raises ``UnknownNameError`` for other names.
    """
    try:
        # A checkout has links to the files of the repository.
        return (Path(__file__).parent / _FILES[name]).resolve()
    except KeyError:
        raise UnknownNameError(f"no model named `{name}`; models: {', '.join(_FILES)}") from None


def _robot(name: str, base_joint: BaseJoint | None) -> Robot:
    return Robot.from_urdf(path(name), base_joint=base_joint)


def baxter(*, base_joint: BaseJoint | None = None) -> Robot:
    """Rethink Baxter: two arms of seven joints, ``torso`` to ``left_tool`` and ``right_tool``."""
    return _robot("baxter", base_joint)


def cobra_s600(*, base_joint: BaseJoint | None = None) -> Robot:
    """Adept Cobra s600: a SCARA arm of four joints, ``base`` to ``flange``."""
    return _robot("cobra_s600", base_joint)


def humanoid() -> Rig:
    """A character of 22 bones with mesh and skin weights; its tips are head, hands and feet. ``nao`` is a humanoid robot."""
    return Rig.read(path("humanoid"))


def iiwa14(*, base_joint: BaseJoint | None = None) -> Robot:
    """KUKA LBR iiwa 14: an arm of seven joints, ``base`` to ``flange``."""
    return _robot("iiwa14", base_joint)


def nao(*, base_joint: BaseJoint | None = None) -> Robot:
    """Aldebaran NAO: a humanoid robot of 24 joints with masses, ``torso`` to ``head``, ``left_hand``, ``right_hand``,
    ``left_sole`` and ``right_sole``.

    With ``base_joint="free"`` the torso can move."""
    return _robot("nao", base_joint)


def panda(*, base_joint: BaseJoint | None = None) -> Robot:
    """Franka Panda: an arm of seven joints with two fingers, ``base`` to ``flange``, ``hand`` and ``tool``."""
    return _robot("panda", base_joint)


def so101(*, base_joint: BaseJoint | None = None) -> Robot:
    """SO-101: an arm of five joints and a gripper, ``base_link`` to ``gripper_frame_link``."""
    return _robot("so101", base_joint)


def steps() -> MotionCapture:
    """A motion capture of six seconds: steps aside, a crouch, a wave."""
    return MotionCapture.read(path("steps"))


def ur10e(*, base_joint: BaseJoint | None = None) -> Robot:
    """Universal Robots UR10e: an arm of six joints, ``base`` to ``flange``."""
    return _robot("ur10e", base_joint)


def ur5e(*, base_joint: BaseJoint | None = None) -> Robot:
    """Universal Robots UR5e: an arm of six joints, ``base`` to ``flange``."""
    return _robot("ur5e", base_joint)


__all__ = [
    "baxter",
    "cobra_s600",
    "humanoid",
    "iiwa14",
    "names",
    "nao",
    "panda",
    "path",
    "so101",
    "steps",
    "ur10e",
    "ur5e",
]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        # Type checkers find unknown names themselves.
        raise AttributeError(f"no model named `{name}`; models: {', '.join(_FILES)}")
