"""Result of the last solve as text, and the error of a target drawn next to it."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np

from .dragging import Dragging

#: Colours of the bar next to the text, by result.
COLORS = {
    "": "#9aa5b1",
    "Reached": "#2f9e60",
    "Moving": "#d9a514",
    "Missed": "#d63a3a",
    "No solution": "#8d5bbd",
}


#: Height of the text: the controls below do not move during a drag.
HEIGHT = "7.5em"


class StatusPanel:
    """The text at the top of the panel, and a red line from each missed frame to its target."""

    def __init__(self, page: Dragging) -> None:
        self._page = page
        #: The text without formatting.
        self.text: str = ""
        self._shown = page.scene.server.gui.add_html("")
        self._lines: Any = None
        #: Labels of the distances at missed targets, by frame.
        self.marks: dict[str, Any] = {}
        self._labels: dict[str, Any] = {}
        self.show()

    def show(self) -> None:
        """Updates the text and the marks."""
        head, body, foot = self._words()
        text = "\n".join(part for part in (head, body, foot) if part)
        if text != self.text:
            self.text = text
            self._shown.content = _html(head, body, foot)
        self._draw_misses()

    def _words(self) -> tuple[str, str, str]:
        """Heading, text of the library, and duration."""
        answer = self._page.answer
        if self._page.problem:
            return "No solution", self._page.problem, ""
        if answer is None or answer.solution is None:
            return "", "Drag a gizmo, or move a joint.", ""
        solution = answer.solution
        head = "Reached" if solution.reached else "Moving" if answer.goes_on else "Missed"
        body = solution.explain()
        if answer.jump_text:
            body += f"\nJump: {answer.jump_text}."
        return head, body, f"solved in {duration(answer.seconds)}"

    def _draw_misses(self) -> None:
        """Draws lines and distances of missed targets."""
        page, scene = self._page, self._page.scene
        missed = {}
        answer = page.answer
        if answer is not None and answer.solution is not None and not answer.solution.reached:
            for goal in page.goals():
                reached_position, target = page.body.frame(goal.frame)[:3, 3], goal.placement[:3, 3]
                if np.linalg.norm(reached_position - target) * scene.drawn > 1e-3:
                    missed[goal.frame] = (reached_position, target)
        # Hidden instead of removed, because the page would report removed labels as unknown.
        for frame in [frame for frame in self.marks if frame not in missed]:
            self.marks.pop(frame).visible = False
        if self._lines is not None:
            self._lines.visible = bool(missed)
        if not missed:
            return
        points = (np.array(list(missed.values())) * scene.drawn).astype(np.float32)
        if self._lines is None:
            self._lines = scene.server.scene.add_line_segments(
                "/missed", points=points, colors=(214, 58, 58), thickness=3.0, thickness_units="screen"
            )
        else:
            self._lines.points = points
        unit = page.body.unit
        for frame, (reached_position, target) in missed.items():
            text = f"{length(float(np.linalg.norm(reached_position - target)), unit)} off"
            position = (reached_position + target) / 2 * scene.drawn
            if frame not in self._labels:
                self._labels[frame] = scene.server.scene.add_label(
                    f"/miss of {frame}", text, position=position, anchor="bottom-center"
                )
            label = self.marks[frame] = self._labels[frame]
            label.text, label.position, label.visible = text, position, True


def _html(head: str, body: str, foot: str) -> str:
    """The text with a bar of its colour next to it."""
    lines = [escape(line) for line in body.splitlines() if line.strip()]
    parts = [f'<div style="margin-top:3px">{line}</div>' for line in lines]
    if head:
        color = COLORS[head]
        parts.insert(0, f'<div style="color:{color};font-weight:700;font-size:1.05em">{head}</div>')
    if foot:
        parts.append(f'<div style="margin-top:4px;color:#8a94a0;font-size:0.85em">{escape(foot)}</div>')
    style = (
        f"border-left:4px solid {COLORS[head]};padding:2px 10px;margin:8px;line-height:1.35;font-size:0.9em;"
        f"height:{HEIGHT};overflow-y:auto"
    )
    return f'<div class="kinopt-status" style="{style}">{"".join(parts)}</div>'


def plain(text: str) -> str:
    """Escapes a text for Markdown."""
    for sign in "\\`*_{}[]<>#|~":
        text = text.replace(sign, "\\" + sign)
    return text


def duration(seconds: float) -> str:
    """A time in a suitable unit."""
    if seconds < 1e-3:
        return f"{seconds * 1e6:.0f} µs"
    return f"{seconds * 1e3:.1f} ms" if seconds < 1.0 else f"{seconds:.1f} s"


def length(value: float, unit: str) -> str:
    """A length in a suitable unit, or in the model's own."""
    if unit != "m":
        return f"{value:.3g}"
    if value < 1e-3:
        return f"{value * 1e6:.0f} µm"
    return f"{value * 1e3:.1f} mm" if value < 1.0 else f"{value:.2f} m"
