"""Dragging of a body by its frames."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .body import Body, moved_by
from .obstacles import Obstacles
from .posing import Answer, Goal, Posing
from .scene import Scene
from .target import Target

Array = NDArray[np.float64]

#: Tips closer than this share a gizmo when the page opens, relative to the size of the body.
MIN_TARGET_DISTANCE = 0.06
#: Seconds between two updates of text, sliders and free gizmos, which need no screen rate.
TEXT_UPDATE_INTERVAL = 0.08


class Dragging:
    """A body that is dragged by its frames.

    Goals are the pinned frames and the last dragged one; other gizmos follow their frames. Everything here runs on the
    scene's loop.
    """

    def __init__(
        self,
        scene: Scene,
        body: Body,
        *,
        turns: bool = True,
        tolerance: float = 1e-6,
        world: kinopt.World | None = None,
        margin: float = 0.0,
    ) -> None:
        self.scene = scene
        self.body = body
        self.posing: Posing = Posing(body, world, margin)
        #: Drawn obstacles of collision avoidance.
        self.obstacles: Obstacles | None = None if world is None else scene.add_world(world, on=body)
        self.posing.choose(tolerance=tolerance)
        #: True if targets have an orientation too.
        self.turns: bool = turns
        self.targets: dict[str, Target] = {}
        self.pinned: set[str] = set()
        #: The last dragged frame.
        self.dragged: str | None = None
        #: Result of the last frame.
        self.answer: Answer | None = None
        #: Reason why the selected solver has no result; empty if it has one.
        self.problem: str = ""
        #: Seconds from a mouse position to the transforms sent to the page, of the last moves.
        self.times: deque[float] = deque(maxlen=10_000)
        #: Callbacks: soon after a change; when targets are added, removed or pinned; and when one is grabbed.
        self.on_change: list[Callable[[], Any]] = []
        self.on_targets: list[Callable[[], Any]] = []
        self.on_grab: list[Callable[[], Any]] = []
        self._last_slow = 0.0

    # Targets.

    def add_target(self, frame: str, *, pinned: bool = False) -> Target:
        """Adds a gizmo on a frame, unless there is one."""
        if frame in self.targets:
            return self.targets[frame]
        if pinned:
            self.pinned.add(frame)
        turns = self._asks_turn(frame)
        size = (0.15 if turns else 0.11) * self._size()
        target = self.scene.target(f"target/{frame}", self._place(frame), size=size, turns=turns)
        self.targets[frame] = target
        target.on_grab(lambda place: self._grab(frame))
        target.on_move(lambda place: self._drag(frame))
        target.on_release(lambda place: self.refresh())
        _tell(self.on_targets)
        return target

    def remove_target(self, frame: str) -> None:
        """Removes the gizmo of a frame."""
        self.targets.pop(frame).remove()
        self.pinned.discard(frame)
        if self.dragged == frame:
            self.dragged = None
        self.posing.state_anew()
        _tell(self.on_targets)
        self.pose()

    def pin(self, frame: str, pinned: bool) -> None:
        """Pins a frame at its target while others are dragged, or releases it."""
        if pinned:
            self.pinned.add(frame)
            if frame != self.dragged:
                self.targets[frame].placement = self._place(frame)
        else:
            self.pinned.discard(frame)
        self.posing.state_anew()
        self.pose()

    def set_turns(self, turns: bool) -> None:
        """Sets whether targets have an orientation too."""
        self.turns = turns
        for frame, target in self.targets.items():
            target.turns = turns
            turned = target.placement
            turned[:3, :3] = self._place(frame)[:3, :3]
            target.placement = turned
        self.posing.state_anew()
        self.pose()

    def _place(self, frame: str) -> Array:
        """Pose of the gizmo of a frame; a gizmo without rotation has the world's axes."""
        placement = self.body.frame(frame)
        if not self._asks_turn(frame):
            placement[:3, :3] = np.eye(3)
        return placement

    def apart(self, frames: list[str]) -> list[str]:
        """The frames that are not fixed to another one or to a target, and not close to a target."""
        min_distance = MIN_TARGET_DISTANCE * self.body.size()
        positions = [self.body.frame(frame)[:3, 3] for frame in self.targets]
        carriers = moved_by(self.body.model)
        taken = {carriers[frame] for frame in self.targets}
        chosen = []
        for frame in frames:
            position = self.body.frame(frame)[:3, 3]
            is_near_target = any(np.linalg.norm(position - other) <= min_distance for other in positions)
            if not is_near_target and carriers[frame] not in {None, *taken}:
                positions.append(position)
                taken.add(carriers[frame])
                chosen.append(frame)
        return chosen

    def goals(self) -> list[Goal]:
        """Current goals of the body."""
        frames = [frame for frame in self.targets if frame in self.pinned or frame == self.dragged]
        return [
            Goal(frame, self.targets[frame].placement, self._asks_turn(frame), frame in self.pinned)
            for frame in frames
        ]

    def _asks_turn(self, frame: str) -> bool:
        """True if the goal of a frame includes its orientation; that of feet does."""
        return self.turns or (self.body.stands and frame in self.pinned)

    # Motion.

    def pose(self) -> None:
        """Solves once, and continues while the body moves."""
        answer = self._solved()
        if answer is not None:
            self.show(answer)
            if answer.goes_on:
                self.scene.loop.tick(self._go_on)
        self.refresh()

    def _solved(self) -> Answer | None:
        """One frame of the solver; the page shows the error of an unsupported problem."""
        try:
            answer = self.posing.solve(self.goals())
        except kinopt.KinoptError as error:
            self.problem = str(error)
            self.refresh()
            return None
        self.problem = ""
        return answer

    def show(self, answer: Answer) -> None:
        """Moves the body to the result of a solve."""
        self.answer = answer
        self.body.q = answer.q
        if self.obstacles is not None:
            touched = getattr(answer.solution, "collisions", [])
            self.obstacles.refresh()
            bodies = [body for pair in touched for body in ((pair.first, pair.first_kind), (pair.second, pair.second_kind))]
            # A link may have the name of an obstacle.
            self.obstacles.mark(name for name, kind in bodies if kind == "obstacle")

    def set_configuration(self, q: Array) -> None:
        """Sets the configuration of the body; pinned targets follow."""
        self.body.q = q
        self.stands_elsewhere()

    def stands_elsewhere(self) -> None:
        """Called when the body was moved otherwise, by a clip for example: pinned targets follow, and goals end."""
        self.dragged = None
        self.answer = None
        for frame in self.pinned:
            self.targets[frame].placement = self._place(frame)
        self.posing.state_anew()
        self.refresh()

    def set_joint(self, joint: str, value: float) -> None:
        """Moves one joint; the others keep pinned frames in place, as far as possible."""
        self.dragged = None
        self.show(self.posing.with_joint(joint, value, self.goals()))
        self.refresh()

    def let_go(self) -> None:
        """Releases all pinned and dragged frames."""
        self.pinned.clear()
        self.dragged = None
        self.answer = None
        self.posing.state_anew()
        _tell(self.on_targets)
        self.refresh()

    def _grab(self, frame: str) -> None:
        _tell(self.on_grab)
        self.dragged = frame
        self.posing.state_anew()

    def _drag(self, frame: str) -> None:
        if self.dragged != frame:
            self._grab(frame)
        self.pose()
        self.times.append(time.perf_counter() - self.targets[frame].asked)

    def _go_on(self, now: float) -> bool:
        """One more frame of a body that has not reached a constant target."""
        answer = self._solved()
        if answer is None:
            return False
        self.show(answer)
        self.refresh()
        return answer.goes_on

    # Display.

    def refresh(self) -> None:
        """Updates text, sliders and free gizmos, soon."""
        self.scene.loop.tick(self._slow)

    def _slow(self, now: float) -> bool:
        if now - self._last_slow < TEXT_UPDATE_INTERVAL:
            return True
        self._last_slow = now
        for frame, target in self.targets.items():
            if frame not in self.pinned and frame != self.dragged:
                target.placement = self._place(frame)
        _tell(self.on_change)
        return False

    def _size(self) -> float:
        low, high = self.body.box()
        return float(np.linalg.norm(high - low))

    def call(self, work: Callable[[], Any]) -> Any:
        """Runs `work` between two frames and waits for it: for scripts that control a page."""
        return self.scene.loop.call(work)


def _tell(listeners: list[Callable[[], Any]]) -> None:
    for listener in listeners:
        listener()
