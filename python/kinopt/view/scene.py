"""A page with robots, characters, targets and whatever a script shows."""

from __future__ import annotations

import contextlib
import io
import itertools
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

import kinopt

from . import stage
from .animated import AnimatedBody
from .body import Body
from .character import CharacterBody
from .look import Color, extent, extent_of
from .loop import Loop
from .robot_body import RobotBody, Style
from .stage import Up
from .target import Target
from .transforms import placement_of, wxyz_of

Array = NDArray[np.float64]


class Scene:
    """A page in the browser that a script shows its robots, targets and results on.

    ```python
    import kinopt
    from kinopt.view import Scene

    robot = kinopt.Robot.from_urdf("models/franka_panda.urdf")
    arm = kinopt.Arm(robot, "base", "tool")
    scene = Scene()
    body = scene.add(robot)
    target = scene.target("goal", body.frame("tool"))
    @target.on_move
    def follow(placement):
        body.q = arm.configuration(arm.solve(placement, arm.joint_values(body.q)).q, body.q)
    scene.wait()
    ```

    Lengths are the model's own (metres for robots), placements 4 x 4 arrays, what has `homogeneous`,
    `as_matrix()` or `A`, or three numbers for a position. In a notebook the scene as a cell's last value
    is the page.
    """

    def __init__(
        self,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        up: Up = "+z",
        title: str | None = None,
    ) -> None:
        """Opens a page at `url`, on the next free port from `port` on; `up` is the way up, "+z" or "+y".

        Only this machine sees it unless `host` is "0.0.0.0".
        """
        with contextlib.redirect_stdout(io.StringIO()):
            #: viser's server, for whatever is not here: its `scene`, its `gui`.
            self.server = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        self.up: Up = up
        #: What a length of 1 is drawn as: very large and very small models are drawn about as large as a person.
        self.drawn = 1.0
        #: Where all that happens on the page is done, in order.
        self.loop = Loop(self.server.atomic)
        self._bodies: dict[str, Body] = {}
        self._targets: dict[str, Target] = {}
        self._empty = True
        self._closed = False
        stage.furnish(self.server, up)

    @property
    def url(self) -> str:
        """Where the page is."""
        host = self.server.get_host()
        shown = "localhost" if host in ("0.0.0.0", "127.0.0.1") else host
        return f"http://{shown}:{self.server.get_port()}"

    def add(
        self,
        thing: Any,
        name: str | None = None,
        *,
        at: object = None,
        style: Style = "auto",
        color: Color | None = None,
        opacity: float | None = None,
        beside: str | Path | None = None,
        packages: Mapping[str, str | Path] | Iterable[str | Path] = (),
    ) -> Body:
        """Shows a robot, rig, skeleton, model, glTF scene or motion capture: a `Body`, whose `q` moves it.

        `at` is world_from_model, 4 x 4 or three numbers, in the model's unit. With `style="file"` a robot is drawn
        with the shapes of its file; its meshes are looked for in the folder `beside` (and above it), in
        `packages` (folders by package, or folders that hold packages) and in `ROS_PACKAGE_PATH`; clean
        capsules stand in for those that are not at hand. With "capsules" there are no others; "auto" is
        "capsules" for files that have cylinders alone. `color` is red, green, blue up to 255, `opacity` from 0
        to 1. Of the same given `name` only the last is shown.
        """
        at = np.eye(4) if at is None else placement_of(at, "at")
        if not (hasattr(thing, "armature") or hasattr(thing, "model") or isinstance(thing, kinopt.Model)):
            raise kinopt.InvalidValueError(
                f"a scene shows a robot, rig, skeleton, model, glTF scene or capture, not {type(thing).__name__}"
            )
        name = self._free_name(name) if name else self._numbered(thing)
        self._measure(thing)
        body: Body
        if hasattr(thing, "armature"):
            body = AnimatedBody(self, thing, name, at, color=color, opacity=opacity)
        elif isinstance(thing, (kinopt.Rig, kinopt.Skeleton)):
            body = CharacterBody(self, thing, name, at, color=color, opacity=opacity)
        else:
            body = RobotBody(
                self,
                thing,
                name,
                at,
                style=style,
                color=color,
                opacity=opacity,
                beside=beside,
                packages=packages,
            )
        self._bodies[name] = body
        if self._empty:
            self._empty = False
            self.frame_all()
        return body

    def _measure(self, thing: Any) -> None:
        """The first thing shown says how large all is drawn."""
        if not self._empty:
            return
        if hasattr(thing, "armature"):
            placements = np.asarray(thing.armature.local_to_model(thing.armature.rest), dtype=float)
            self.drawn = stage.drawn_scale(extent(placements))
            return
        self.drawn = stage.drawn_scale(extent_of(getattr(thing, "model", thing)))

    def _free_name(self, name: str) -> str:
        name = name.strip("/")
        for known in (self._bodies, self._targets):
            if name in known:
                known[name].remove()
        return name

    def _numbered(self, thing: Any) -> str:
        """The thing's own name, with a number where that is taken: nothing is replaced unasked."""
        own = getattr(getattr(thing, "model", thing), "name", None)
        own = (own if isinstance(own, str) else "").strip("/") or "body"
        names = itertools.chain([own], (f"{own} {i}" for i in itertools.count(2)))
        return next(name for name in names if name not in self._bodies and name not in self._targets)

    def frame_all(self) -> None:
        """Lays the ground below all bodies and lets the camera see the whole of them."""
        boxes = [body.box() for body in self._bodies.values()]
        if not boxes:
            return
        low = np.min([low for low, _ in boxes], axis=0) * self.drawn
        high = np.max([high for _, high in boxes], axis=0) * self.drawn
        size = float(np.linalg.norm(high - low))
        axis = 2 if self.up == "+z" else 1
        # What stands on the ground stands there; what hangs below the origin is let down.
        ground = 0.0 if abs(low[axis]) < 0.05 * size else float(low[axis])
        stage.lay_ground(self.server, self.up, ground, size)
        stage.look_at(self.server, self.up, low, high)

    def target(
        self, name: str, placement: object, *, size: float | None = None, turns: bool = True
    ) -> Target:
        """A gizmo to drag: a `Target`, whose `on_move` says what follows it.

        `size` is its arrows' length in the model's unit; without `turns` it is moved but not turned.
        """
        name = self._free_name(name)
        size = 0.16 * stage.DRAWN / self.drawn if size is None else size
        target = Target(self, name, placement_of(placement), size, turns)
        self._targets[name] = target
        return target

    def frame(self, name: str, placement: object, *, size: float | None = None) -> viser.FrameHandle:
        """Shows a placement as three axes, red, green, blue; again with the same name moves it."""
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
        """Shows points, shape (N, 3); `colors` red, green, blue up to 255, shape (3,) or (N, 3)."""
        size = 0.006 * stage.DRAWN / self.drawn if size is None else size
        return self.server.scene.add_point_cloud(
            f"/{name}",
            points=(np.asarray(positions, dtype=float) * self.drawn).astype(np.float32),
            colors=np.asarray(colors, dtype=np.uint8),
            point_size=size * self.drawn,
            point_shape="circle",
        )

    def path(
        self, name: str, positions: ArrayLike, color: Color = (38, 106, 171), *, width: float = 2.5
    ) -> viser.LineSegmentsHandle:
        """Shows a line through positions, shape (N, 3), or through the places of (N, 4, 4); `width` in pixels."""
        places = np.asarray(positions, dtype=float)
        if places.ndim == 3:
            places = places[:, :3, 3]
        places = (places * self.drawn).astype(np.float32)
        segments = np.stack([places[:-1], places[1:]], axis=1)
        return self.server.scene.add_line_segments(
            f"/{name}", points=segments, colors=color, thickness=width, thickness_units="screen"
        )

    def label(self, name: str, text: str, position: ArrayLike) -> viser.LabelHandle:
        """Writes `text` beside a position, three numbers."""
        place = np.asarray(position, dtype=float) * self.drawn
        return self.server.scene.add_label(f"/{name}", text, position=place)

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

    def forget(self, thing: Body | Target) -> None:
        """What is removed from the scene is no longer known by its name."""
        for known in (self._bodies, self._targets):
            if known.get(thing.name) is thing:
                del known[thing.name]

    def show(self, height: int = 520) -> Any:
        """The live page as a notebook's output, `height` pixels high (needs IPython, which notebooks have)."""
        from IPython.display import IFrame

        return IFrame(self.url, width="100%", height=height)

    def snapshot(self) -> str:
        """The page as it stands, as one HTML document that needs no server, for notebooks that are saved."""
        html: str = self.server.scene.as_html()
        return html

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{self.url}" width="100%" height="520" style="border:0;border-radius:6px"></iframe>'
        )

    def __enter__(self) -> Scene:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        bodies = ", ".join(self._bodies) or "empty"
        return f"Scene({self.url}: {bodies})"
