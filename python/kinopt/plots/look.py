"""Colours and figures of plots."""

from __future__ import annotations

from typing import Any

from ..extras import load

#: Colours of Okabe and Ito, which colour-blind readers can distinguish.
BLUE, ORANGE, GREEN, RED, BLACK = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#222222"
#: Ranges beyond limits.
FORBIDDEN: dict[str, Any] = {"facecolor": "#D55E00", "alpha": 0.16, "edgecolor": "none"}
#: Colour map of times, with monotone lightness.
TIMES = "viridis"


def blank_figure(figure: Any, size: tuple[float, float]) -> Any:
    """The given figure, or a new one of this size in inches.

    Raises ``ImportError`` without matplotlib.
    """
    plots = load("matplotlib.pyplot", "plot", "plot()")
    if figure is None:
        figure = plots.figure(figsize=size, layout="constrained")
        if "inline" in plots.get_backend():
            # A notebook shows the returned figure, and would show an open one again.
            plots.close(figure)
    return figure


def tidy(axes: Any) -> Any:
    """Axes without a box, with a faint grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8)
    return axes


__all__ = ["BLACK", "BLUE", "FORBIDDEN", "GREEN", "ORANGE", "RED", "TIMES", "blank_figure", "tidy"]
