"""A page with robots, characters, targets and other objects of a script."""

from __future__ import annotations

import itertools
import sys
import webbrowser
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

import kinopt

from . import stage
from .animated import AnimatedBody
from .balance import Balance, has_masses
from .body import Body, Clip
from .canvas import Canvas
from .character import CharacterBody
from .look import Color, extent, extent_of
from .movement import Movement, show_movement
from .obstacles import Obstacles
from .play_bar import PlayBar, Together
from .recording import recorded
from .robot_body import RobotBody, Style
from .stage import Up
from .target import Target
from .transforms import placement_of


class Scene(Canvas):
    """A page in the browser for the robots, targets and results of a script.

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

    Lengths are in the unit of the model (metres for robots). Placements are 4 x 4 arrays, objects with `homogeneous`,
    `as_matrix()` or `A`, or three numbers for a position. In a notebook, the scene as the last value of a cell shows
    the page.
    """

    def __init__(
        self,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        up: Up = "+z",
        title: str | None = None,
        open: bool = True,
    ) -> None:
        """Serves a page at `url`, on the first free port from `port`; `up` is the upward axis, "+z" or "+y".

        Prints the address and opens a browser; without `open`, and in a notebook, it does neither. Only this machine
        can access the page unless `host` is "0.0.0.0".
        """
        super().__init__(host, port, up, title)
        self._empty = True
        self._bar: PlayBar | None = None
        if open and "ipykernel" not in sys.modules:
            self.announce()

    def announce(self, browser: bool = True) -> None:
        """Prints the address of the page, and opens it in a browser."""
        print(f"{self.url}  (Ctrl-C to stop)", flush=True)
        if browser:
            webbrowser.open(self.url)

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

        `at` is world_from_model, 4 x 4 or three numbers, in the model's unit. `style="file"` draws a robot with the
        shapes of its file. Its meshes are searched in the folder `beside` (and above it), in `packages` (folders by
        package, or folders that contain packages) and in `ROS_PACKAGE_PATH`. Collision shapes replace missing meshes,
        or capsules if there are none. "collision" draws the collision shapes, "capsules" capsules only; "auto" is
        "collision" for files without meshes. For a glTF scene, `beside` is its file, whose textures are drawn. `color` is red, green, blue up to 255, `opacity` from 0 to 1. An object replaces another one of
        an equal given `name`. Raises `InvalidValueError` for other objects and for an invalid `at`.
        """
        at = np.eye(4) if at is None else placement_of(at, "at")
        if not (hasattr(thing, "armature") or hasattr(thing, "model") or isinstance(thing, kinopt.Model)):
            raise kinopt.InvalidValueError(
                f"a scene shows a robot, rig, skeleton, model, glTF scene or capture, not {type(thing).__name__}"
            )
        name = self.clear(name) if name else self._numbered(thing)
        self._measure(thing)
        body: Body
        if hasattr(thing, "armature"):
            file = None if beside is None else Path(beside)
            body = AnimatedBody(self, thing, name, at, color=color, opacity=opacity, file=file)
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
        self.place(name, body)
        if self._empty:
            self._empty = False
            self.frame_all()
        return body

    def add_world(
        self, world: kinopt.World, name: str = "obstacles", *, on: Body | None = None
    ) -> Obstacles:
        """Shows a world of obstacles; `on` is the body whose model defines their coordinates and carries attached
        obstacles.

        `refresh` of the result draws later changes of the world. An object replaces another one of an equal given
        `name`.
        """
        name = self.clear(name)
        shown = Obstacles(self, world, name, on)
        self.place(name, shown)
        return shown

    def add_balance(self, body: Body, feet: Sequence[str] = (), name: str = "balance") -> Balance:
        """Shows a robot's centre of mass and the support polygon of its `feet`, by default those of a humanoid.

        Feet on the ground carry the body. Raises `InvalidValueError` for a body without masses or feet, and
        `UnknownNameError` for an unknown frame.
        """
        found = getattr(body, "humanoid", None)
        feet = list(feet) or ([] if found is None else found.feet)
        if not feet or not has_masses(body.thing, body.q):
            missing = "masses" if feet else "known feet"
            raise kinopt.InvalidValueError(f"{body.name}: a body without {missing} has no support polygon")
        shown = Balance(body, feet, self.clear(name))
        self.place(shown.name, shown)
        return shown

    def add_movement(
        self, movement: kinopt.Trajectory[Any], body: Body, *, beside: float | None = 0.9, name: str = "movement"
    ) -> Movement:
        """Adds a trajectory of a body or of some of its joints: a clip, which `play` plays.

        The subject of a retargeted motion is drawn next to the body, at a distance of `beside` times its size and with
        legs as long as the body's. None omits it. The camera views the whole path. Raises `InvalidValueError` for a
        trajectory of another body.
        """
        return show_movement(self, movement, body, beside, name)

    def play(self, *clips: Clip, speed: float = 1.0) -> PlayBar:
        """Plays clips together in a loop, at `speed` times their speed, with a bar to pause, scrub and record.

        Another call replaces the bar. Raises `InvalidValueError` without a clip and for a speed that is not positive.
        """
        if not clips or not 0.0 < speed < np.inf:
            raise kinopt.InvalidValueError(f"play expects a clip and a positive speed, not {len(clips)} clips at {speed}")

        def begin() -> PlayBar:
            if self._bar is not None:
                self._bar.remove()
            self._bar = PlayBar(self, clips if len(clips) == 1 else [Together(clips)], speed)
            self._bar.play()
            return self._bar

        bar: PlayBar = self.loop.call(begin)
        return bar

    def record(self, path: str | Path, clip: Clip, *, speed: float = 1.0, size: tuple[int, int] = (960, 540)) -> None:
        """Writes a clip as a page without a server (.html) or as a video (.gif, .mp4) of `size` pixels.

        A browser that shows the page renders videos. Raises `InvalidValueError` for another extension and for a video
        without a browser, `FileError` if the file cannot be written, `ImportError` for .mp4 without imageio-ffmpeg.
        """
        data = recorded(self, clip, Path(path).suffix.lower().lstrip("."), speed=speed, size=size)
        try:
            Path(path).write_bytes(data)
        except OSError as error:
            raise kinopt.FileError(f"{path}: cannot be written: {error}") from None

    def _measure(self, thing: Any) -> None:
        """Sets the drawing scale from the first object."""
        if not self._empty:
            return
        if hasattr(thing, "armature"):
            placements = np.asarray(thing.armature.local_to_model(thing.armature.rest), dtype=float)
            self.drawn: float = stage.drawn_scale(extent(placements))
            return
        self.drawn = stage.drawn_scale(extent_of(getattr(thing, "model", thing)))

    def _numbered(self, thing: Any) -> str:
        """The object's own name, with a number if the name exists, so that nothing is replaced."""
        base_name = getattr(getattr(thing, "model", thing), "name", None)
        base_name = (base_name if isinstance(base_name, str) else "").strip("/") or "body"
        names = itertools.chain([base_name], (f"{base_name} {i}" for i in itertools.count(2)))
        return next(name for name in names if name not in self._things)

    @property
    def bodies(self) -> list[Body]:
        """The robots and characters in the scene."""
        return [thing for thing in self._things.values() if isinstance(thing, Body)]

    def frame_all(self) -> None:
        """Draws the ground below all bodies and sets the camera to view all of them."""
        boxes = [body.region() for body in self.bodies]
        if not boxes:
            return
        low = np.min([low for low, _ in boxes], axis=0) * self.drawn
        high = np.max([high for _, high in boxes], axis=0) * self.drawn
        stage.show_box(self.server, self.up, low, high)

    def target(
        self, name: str, placement: object, *, size: float | None = None, turns: bool = True
    ) -> Target:
        """A gizmo to drag: a `Target`, whose `on_move` registers callbacks.

        `size` is the length of its arrows in the model's unit; without `turns` it has no rotation. Raises
        `InvalidValueError` for an invalid placement.
        """
        name = self.clear(name)
        size = 0.16 * stage.DRAWN / self.drawn if size is None else size
        target = Target(self, name, placement_of(placement), size, turns)
        self.place(name, target)
        return target

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
        bodies = ", ".join(body.name for body in self.bodies) or "empty"
        return f"Scene({self.url}: {bodies})"
