"""The page of `python -m kinopt.view`: a body, targets on its frames, and a panel."""

from __future__ import annotations

from collections.abc import Iterable

import kinopt

from .body import Body, Clip
from .dragging import Dragging
from .joints_panel import JointsPanel
from .save_panel import SavePanel
from .scene import Scene
from .solver_panel import SolverPanel
from .status_panel import StatusPanel, plain
from .targets_panel import TargetsPanel
from .time_panel import TimePanel

#: Largest number of tips with a gizmo when the page opens; others are selected from the list.
MAX_TARGETS = 8


class Page(Dragging):
    """A body that is dragged by its frames, and a panel with its state and choices."""

    def __init__(
        self,
        scene: Scene,
        body: Body,
        *,
        turns: bool = True,
        tolerance: float = 1e-6,
        notes: Iterable[str] = (),
        hold: Iterable[str] = (),
        world: kinopt.World | None = None,
        margin: float = 0.0,
        clips: Iterable[Clip] = (),
    ) -> None:
        super().__init__(scene, body, turns=turns, tolerance=tolerance, world=world, margin=margin)
        #: Repairs, and parts that are not drawn, one line each.
        self.notes: list[str] = [*notes, *body.missing]
        self._hold = list(hold)
        #: Clips before the body's own clips; with any, gizmos are selected from the list.
        self._played = list(clips)
        scene.loop.call(self._furnish)

    def _furnish(self) -> None:
        """Creates the panel, and gizmos on the tips."""
        self.status: StatusPanel = StatusPanel(self)
        self.targets_panel: TargetsPanel = TargetsPanel(self)
        clips = [*self._played, *self.body.clips]
        self.time: TimePanel | None = TimePanel(self, clips) if clips else None
        self.solver_panel: SolverPanel = SolverPanel(self)
        self.joints: JointsPanel = JointsPanel(self)
        self.saving: SavePanel = SavePanel(self)
        if self.notes:
            with self.scene.server.gui.add_folder("Notes", expand_by_default=False):
                self.scene.server.gui.add_markdown("\n".join(f"- {plain(note)}" for note in self.notes))
        self.on_targets.append(self.targets_panel.show)
        self.on_change.extend((self.status.show, self.joints.show))
        if self.time is not None:
            self.on_change.append(self.time.follow)
            self.on_grab.append(self.time.pause)
        for frame in dict.fromkeys([*self._hold, *self.body.pinned_first]):
            self.add_target(frame, pinned=True)
        first = [] if self._played else self.apart(self.body.tips)[:MAX_TARGETS]
        for frame in first:
            self.add_target(frame)
