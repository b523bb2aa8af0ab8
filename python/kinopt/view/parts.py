"""Moving what is drawn: only transforms travel to the page, and only of parts that moved."""

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

#: A part that moved or turned less than this, in metres as drawn and in quaternions' numbers, stays.
STILL = 1e-5


class Parts:
    """Nodes of a scene, or bones of a skinned mesh, that move together."""

    def __init__(
        self,
        server: viser.ViserServer,
        parts: Sequence[viser.SceneNodeHandle] | Sequence[viser.MeshSkinnedBoneHandle],
        scale: float = 1.0,
    ) -> None:
        """`scale` is what the page draws for a length of 1."""
        self._server = server
        self._scale = scale
        self._writes = [_write(part) for part in parts]
        self._sent = np.full((len(parts), 7), np.inf)

    def send(self, world_from_part: Array) -> int:
        """Moves the parts: placements of shape (parts, 4, 4); how many had to be sent."""
        now = np.empty_like(self._sent)
        now[:, :4] = wxyz_of(world_from_part[:, :3, :3])
        now[:, 4:] = world_from_part[:, :3, 3] * self._scale
        moved = np.nonzero(~(np.abs(now - self._sent).max(axis=1, initial=0.0) <= STILL))[0].tolist()
        self._sent[moved] = now[moved]
        with self._server.atomic():
            for part in moved:
                w, x, y, z, a, b, c = now[part].tolist()
                self._writes[part]((w, x, y, z), (a, b, c))
        return len(moved)


def _write(part: Any) -> Write:
    """What moves one part.

    viser's own setters compare each part with where it was, which takes longer than a solve; parts here are
    compared all at once, so the messages are queued as the setters would. A viser that has them no more is
    asked by its setters.
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
