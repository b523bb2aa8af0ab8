"""The page of `python -m kinopt.view`: a body, targets on its frames, and a panel."""

from __future__ import annotations

from collections.abc import Iterable

import kinopt

from .balance import Balance, feet as lowest
from .body import Body, Clip
from .dragging import Dragging
from .joints_panel import JointsPanel
from .play_bar import PlayBar
from .saving import SavePanel
from .scene import Scene
from .solver_panel import SolverPanel
from .status_panel import StatusPanel, plain
from .targets_panel import TargetsPanel

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
        self.play_bar: PlayBar | None = PlayBar(self.scene, clips) if clips else None
        self.solver_panel: SolverPanel = SolverPanel(self)
        self._show_balance()
        self.joints: JointsPanel = JointsPanel(self)
        self.saving: SavePanel = SavePanel(self)
        if self.notes:
            with self.scene.server.gui.add_folder("Notes", expand_by_default=False):
                self.scene.server.gui.add_markdown("\n".join(f"- {plain(note)}" for note in self.notes))
        self.on_targets.append(self.targets_panel.show)
        self.on_change.extend((self.status.show, self.joints.show))
        if self.play_bar is not None:
            self.play_bar.on_show.append(self.stands_elsewhere)
            self.on_grab.append(self.play_bar.pause)
        for frame in dict.fromkeys([*self._hold, *self.body.pinned_first]):
            self.add_target(frame, pinned=True)
        first = [] if self._played else self.apart(self.body.tips)[:MAX_TARGETS]
        for frame in first:
            self.add_target(frame)

    def _show_balance(self) -> None:
        """Shows the centre of mass over the held feet or those of a humanoid, with a checkbox."""
        found = getattr(self.body, "humanoid", None)
        feet = lowest(self.body.model, self._hold, self.body.q) or ([] if found is None else found.feet)
        if not (self.body.stands and self.body.can_hold and feet):
            return
        #: The drawn centre of mass and support polygon.
        self.balance: Balance = self.scene.add_balance(self.body, feet)
        shown = self.scene.server.gui.add_checkbox("Centre of mass", True, hint="with the support polygon of the feet")

        @shown.on_update
        def _(event: object) -> None:
            self.scene.loop.post(lambda: setattr(self.balance, "visible", bool(shown.value)))
