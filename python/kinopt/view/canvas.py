"""A browser page with drawn objects, and its loop."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

import kinopt

from . import stage
from .look import Color
from .loop import Loop
from .stage import Up
from .transforms import placement_of, wxyz_of

Array = NDArray[np.float64]


class Removable(Protocol):
    """A named object on a page."""

    @property
    def name(self) -> str: ...

    def remove(self) -> None: ...


@dataclass(frozen=True)
class Embedded:
    """HTML for a notebook."""

    html: str

    def _repr_html_(self) -> str:
        return self.html


class Canvas:
    """A page with its objects by name, and its drawing scale."""

    def __init__(self, host: str, port: int, up: Up, title: str | None) -> None:
        with contextlib.redirect_stdout(io.StringIO()):
            #: viser's server, for functions that are missing here: its `scene`, its `gui`.
            self.server: viser.ViserServer = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        self.up: Up = up
        #: Drawn length of 1: very large and very small models are drawn at about the size of a person.
        self.drawn: float = 1.0
        #: Loop that runs all work of the page, in order.
        self.loop: Loop = Loop(self.server.atomic)
        self._things: dict[str, Removable] = {}
        self._closed = False
        stage.furnish(self.server, up)

    @property
    def url(self) -> str:
        """Address of the page."""
        host = self.server.get_host()
        shown = "localhost" if host in ("0.0.0.0", "127.0.0.1") else host
        return f"http://{shown}:{self.server.get_port()}"

    # Objects.

    def place(self, name: str, thing: Removable) -> None:
        """Registers an object by its name."""
        self._things[name] = thing

    def clear(self, name: str) -> str:
        """Removes the object of a name, and returns the name."""
        name = name.strip("/")
        if name in self._things:
            self._things[name].remove()
        return name

    def forget(self, thing: Removable) -> None:
        """Unregisters a removed object."""
        if self._things.get(thing.name) is thing:
            del self._things[thing.name]

    def frame(self, name: str, placement: object, *, size: float | None = None) -> viser.FrameHandle:
        """Shows a placement as three axes, red, green, blue; another call with the name moves it.

        Raises `InvalidValueError` for an invalid placement.
        """
        matrix = placement_of(placement)
        length = (0.07 * stage.DRAWN / self.drawn if size is None else size) * self.drawn
        return self.server.scene.add_frame(
            f"/{name}",
            axes_length=length,
            axes_radius=0.035 * length,
            origin_color=(120, 130, 140),
            position=matrix[:3, 3] * self.drawn,
            wxyz=wxyz_of(matrix[None, :3, :3])[0],
        )

    def points(
        self,
        name: str,
        positions: ArrayLike,
        colors: ArrayLike = (38, 106, 171),
        *,
        size: float | None = None,
    ) -> viser.PointCloudHandle:
        """Shows points, shape (N, 3); `colors` red, green, blue up to 255, shape (3,) or (N, 3).

        Raises `InvalidValueError` for other shapes and for positions that are not finite.
        """
        points = positions_of(positions)
        shades = np.asarray(colors)
        if shades.shape not in ((3,), (len(points), 3)):
            raise kinopt.InvalidValueError(
                f"colors has shape {shades.shape}, expected (3,) or ({len(points)}, 3)"
            )
        size = 0.006 * stage.DRAWN / self.drawn if size is None else size
        return self.server.scene.add_point_cloud(
            f"/{name}",
            points=(points * self.drawn).astype(np.float32),
            colors=shades.astype(np.uint8),
            point_size=size * self.drawn,
            point_shape="circle",
        )

    def path(
        self, name: str, positions: ArrayLike, color: Color = (38, 106, 171), *, width: float = 2.5
    ) -> viser.LineSegmentsHandle:
        """Shows a line through positions, shape (N, 3), or through those of placements (N, 4, 4); `width` in pixels.

        Raises `InvalidValueError` for other shapes and for positions that are not finite.
        """
        points = (positions_of(positions) * self.drawn).astype(np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return self.server.scene.add_line_segments(
            f"/{name}", points=segments, colors=color, thickness=width, thickness_units="screen"
        )

    def label(self, name: str, text: str, position: ArrayLike) -> viser.LabelHandle:
        """Writes `text` at a position, three numbers; other values raise `InvalidValueError`."""
        drawn_position = placement_of(position, "position")[:3, 3] * self.drawn
        return self.server.scene.add_label(f"/{name}", text, position=drawn_position)

    # Lifetime.

    def every_frame(self, ticker: Callable[[float], bool]) -> Callable[[float], bool]:
        """Calls `ticker` 60 times a second with the time in seconds, until it returns false."""
        self.loop.tick(ticker)
        return ticker

    def wait(self) -> None:
        """Serves the page until Ctrl-C."""
        with contextlib.suppress(KeyboardInterrupt):
            self.loop.thread.join()
        self.close()

    def close(self) -> None:
        """Closes the page."""
        if self._closed:
            return
        self._closed = True
        self.loop.stop()
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()

    def show(self, height: int = 520) -> Embedded:
        """The live page as a notebook's output, `height` pixels high."""
        style = "border:0;border-radius:6px"
        return Embedded(f'<iframe src="{self.url}" width="100%" height="{height}" style="{style}"></iframe>')

    def snapshot(self) -> str:
        """The current page as one HTML document that needs no server, for saved notebooks."""
        html: str = self.server.scene.as_html()
        return html

    def _repr_html_(self) -> str:
        return self.show().html


def positions_of(value: ArrayLike) -> Array:
    """Positions of shape (N, 3), or those of placements of shape (N, 4, 4)."""
    try:
        points = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise kinopt.InvalidValueError(f"positions holds no numbers: {error}") from None
    if points.ndim == 3 and points.shape[1:] == (4, 4):
        points = points[:, :3, 3]
    if points.ndim != 2 or points.shape[1] != 3:
        raise kinopt.InvalidValueError(
            f"positions has shape {points.shape}, expected (N, 3), or (N, 4, 4) for placements"
        )
    if not np.isfinite(points).all():
        raise kinopt.InvalidValueError("positions holds numbers that are not finite")
    return points
