"""Panel of solver options: method, tolerance, posture, holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .dragging import Dragging
from .posing import POSTURES


class SolverPanel:
    """Choices that apply from the next move."""

    def __init__(self, page: Dragging) -> None:
        self._page = page
        gui = page.scene.server.gui
        choices = page.posing.choices
        with gui.add_folder("Solver"):
            self.solver = gui.add_dropdown(
                "Method", tuple(page.posing.solvers()), initial_value=choices.solver
            )
            self.tolerance = gui.add_dropdown(
                "Tolerance",
                tuple(f"{10.0**-exponent:.0e}" for exponent in range(2, 10)),
                initial_value=f"{choices.tolerance:.0e}",
                hint="error within which a target counts as reached: the model's unit of length, and radians",
            )
            self.posture = gui.add_dropdown(
                "Posture",
                POSTURES,
                initial_value=choices.posture,
                hint="nominal posture in the null space of the targets",
            )
            self.holds = gui.add_checkbox(
                "Hold the rest",
                choices.holds,
                visible=page.body.can_hold,
                hint="keeps the trunk and the ends of all other limbs in place",
            )
        self._on(self.solver, lambda: {"solver": str(self.solver.value)})
        self._on(self.tolerance, lambda: {"tolerance": float(self.tolerance.value)})
        self._on(self.posture, lambda: {"posture": str(self.posture.value)})
        self._on(self.holds, lambda: {"holds": bool(self.holds.value)})

    def _on(self, handle: Any, choices: Callable[[], dict[str, Any]]) -> None:
        page = self._page

        def choose() -> None:
            page.posing.choose(**choices())
            page.pose()

        def chosen(event: Any) -> None:
            if event.client is not None:
                page.scene.loop.post(choose)

        handle.on_update(chosen)
