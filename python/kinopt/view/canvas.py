"""A page in the browser that things are drawn on, and the loop that moves them."""

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
    """Something on a page that is known by its name."""

    @property
    def name(self) -> str: ...

    def remove(self) -> None: ...


@dataclass(frozen=True)
class Embedded:
    """HTML that a notebook shows."""

    html: str

    def _repr_html_(self) -> str:
        return self.html


class Canvas:
    """A page, what is drawn on it by name, and how large a length of 1 is drawn."""

    def __init__(self, host: str, port: int, up: Up, title: str | None) -> None:
        with contextlib.redirect_stdout(io.StringIO()):
            #: viser's server, for whatever is not here: its `scene`, its `gui`.
            self.server = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        self.up: Up = up
        #: What a length of 1 is drawn as: very large and very small models are drawn about as large as a person.
        self.drawn = 1.0
        #: Where all that happens on the page is done, in order.
        self.loop = Loop(self.server.atomic)
        self._things: dict[str, Removable] = {}
        self._closed = False
        stage.furnish(self.server, up)

    @property
    def url(self) -> str:
        """Where the page is."""
        host = self.server.get_host()
        shown = "localhost" if host in ("0.0.0.0", "127.0.0.1") else host
        return f"http://{shown}:{self.server.get_port()}"

    # What is on it.

    def place(self, name: str, thing: Removable) -> None:
        """Knows a thing by its name from now on."""
        self._things[name] = thing

    def clear(self, name: str) -> str:
        """The name, which nothing has any more."""
        name = name.strip("/")
        if name in self._things:
            self._things[name].remove()
        return name

    def forget(self, thing: Removable) -> None:
        """What is removed is no longer known by its name."""
        if self._things.get(thing.name) is thing:
            del self._things[thing.name]

    def frame(self, name: str, placement: object, *, size: float | None = None) -> viser.FrameHandle:
        """Shows a placement as three axes, red, green, blue; again with the same name moves it.

        Raises `InvalidValueError` for what is no placement.
        """
        place = placement_of(placement)
        length = (0.07 * stage.DRAWN / self.drawn if size is None else size) * self.drawn
        return self.server.scene.add_frame(
            f"/{name}",
            axes_length=length,
            axes_radius=0.035 * length,
            origin_color=(120, 130, 140),
            position=place[:3, 3] * self.drawn,
            wxyz=wxyz_of(place[None, :3, :3])[0],
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

        Raises `InvalidValueError` for other shapes and for places that are not finite.
        """
        places = positions_of(positions)
        shades = np.asarray(colors)
        if shades.shape not in ((3,), (len(places), 3)):
            raise kinopt.InvalidValueError(
                f"colors has shape {shades.shape}, expected (3,) or ({len(places)}, 3)"
            )
        size = 0.006 * stage.DRAWN / self.drawn if size is None else size
        return self.server.scene.add_point_cloud(
            f"/{name}",
            points=(places * self.drawn).astype(np.float32),
            colors=shades.astype(np.uint8),
            point_size=size * self.drawn,
            point_shape="circle",
        )

    def path(
        self, name: str, positions: ArrayLike, color: Color = (38, 106, 171), *, width: float = 2.5
    ) -> viser.LineSegmentsHandle:
        """Shows a line through positions, shape (N, 3), or through the places of (N, 4, 4); `width` in pixels.

        Raises `InvalidValueError` for other shapes and for places that are not finite.
        """
        places = (positions_of(positions) * self.drawn).astype(np.float32)
        segments = np.stack([places[:-1], places[1:]], axis=1)
        return self.server.scene.add_line_segments(
            f"/{name}", points=segments, colors=color, thickness=width, thickness_units="screen"
        )

    def label(self, name: str, text: str, position: ArrayLike) -> viser.LabelHandle:
        """Writes `text` beside a position, three numbers; others raise `InvalidValueError`."""
        place = placement_of(position, "position")[:3, 3] * self.drawn
        return self.server.scene.add_label(f"/{name}", text, position=place)

    # Its life.

    def every_frame(self, ticker: Callable[[float], bool]) -> Callable[[float], bool]:
        """Has `ticker` called 60 times a second with the time in seconds, until it returns false."""
        self.loop.tick(ticker)
        return ticker

    def wait(self) -> None:
        """Serves the page until Ctrl-C."""
        with contextlib.suppress(KeyboardInterrupt):
            self.loop.thread.join()
        self.close()

    def close(self) -> None:
        """Ends the page."""
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
        """The page as it stands, as one HTML document that needs no server, for notebooks that are saved."""
        html: str = self.server.scene.as_html()
        return html

    def _repr_html_(self) -> str:
        return self.show().html


def positions_of(value: ArrayLike) -> Array:
    """Positions of shape (N, 3), or those of placements of shape (N, 4, 4)."""
    try:
        places = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise kinopt.InvalidValueError(f"positions holds no numbers: {error}") from None
    if places.ndim == 3 and places.shape[1:] == (4, 4):
        places = places[:, :3, 3]
    if places.ndim != 2 or places.shape[1] != 3:
        raise kinopt.InvalidValueError(
            f"positions has shape {places.shape}, expected (N, 3), or (N, 4, 4) for placements"
        )
    if not np.isfinite(places).all():
        raise kinopt.InvalidValueError("positions holds numbers that are not finite")
    return places
