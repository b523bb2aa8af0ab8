"""Motion of drawn parts: only transforms of parts that moved are sent to the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .transforms import wxyz_of

if TYPE_CHECKING:
    import viser

Array = NDArray[np.float64]
Four = tuple[float, float, float, float]
Three = tuple[float, float, float]
Write = Callable[[Four, Three], None]

#: Smallest change of a transform that is sent, in metres as drawn and in components of quaternions.
MOTION_TOLERANCE = 1e-5


class Parts:
    """Nodes of a scene, or bones of a skinned mesh, that move together."""

    def __init__(
        self,
        server: viser.ViserServer,
        parts: Sequence[viser.SceneNodeHandle] | Sequence[viser.MeshSkinnedBoneHandle],
        scale: float = 1.0,
    ) -> None:
        """`scale` is the drawn length of 1."""
        self._server = server
        self._scale = scale
        self._writes = [_write(part) for part in parts]
        self._sent = np.full((len(parts), 7), np.inf)

    def send(self, world_from_part: Array) -> int:
        """Moves the parts to placements of shape (parts, 4, 4); returns the number of sent parts."""
        now = np.empty_like(self._sent)
        now[:, :4] = wxyz_of(world_from_part[:, :3, :3])
        now[:, 4:] = world_from_part[:, :3, 3] * self._scale
        moved = np.nonzero(~(np.abs(now - self._sent).max(axis=1, initial=0.0) <= MOTION_TOLERANCE))[0].tolist()
        self._sent[moved] = now[moved]
        with self._server.atomic():
            for part in moved:
                w, x, y, z, a, b, c = now[part].tolist()
                self._writes[part]((w, x, y, z), (a, b, c))
        return len(moved)


def _write(part: Any) -> Write:
    """Function that moves one part.

    The setters of viser compare each part with its last transform, which takes longer than a solve. Parts here are
    compared all at once, so messages are queued as the setters would do. The setters are used if a version of viser
    lacks these messages.
    """
    try:
        from viser import _messages as messages

        impl = part._impl
        if hasattr(impl, "bone_index"):
            queue = impl.mesh_impl.api._queue_scene_message
            turn: Any = messages.SetBoneOrientationMessage
            move: Any = messages.SetBonePositionMessage
            named: tuple[Any, ...] = (impl.name, impl.bone_index)
        else:
            queue = impl.api._queue_scene_message
            turn, move = messages.SetOrientationMessage, messages.SetPositionMessage
            named = (impl.name,)
    except (AttributeError, ImportError):

        def by_setters(wxyz: Four, position: Three) -> None:
            part.wxyz = wxyz
            part.position = position

        return by_setters

    def by_messages(wxyz: Four, position: Three) -> None:
        queue(turn(*named, wxyz))
        queue(move(*named, position))
        impl.wxyz[:] = wxyz
        impl.position[:] = position

    return by_messages
