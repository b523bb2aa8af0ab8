"""Plots of reach maps."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._kinopt import ReachMap
from ..errors import UnknownNameError
from ..reach import cube_centres
from .look import BLACK, blank_figure

#: Axes across, up and through a plane.
_PLANES = {"xz": (0, 2, 1), "xy": (0, 1, 2), "yz": (1, 2, 0)}


def plot_reach(reach_map: ReachMap, *, plane: str = "xz", at: float | None = None, figure: Any = None) -> Any:
    """Draws the share of reached orientations in a plane."""
    if plane not in _PLANES:
        raise UnknownNameError(f"there is no plane {plane!r} among {list(_PLANES)}")
    across, up, through = _PLANES[plane]
    centres = cube_centres(reach_map)
    at = float(reach_map.centre[through]) if at is None else at
    positions = np.empty((len(centres[up]), len(centres[across]), 3))
    positions[..., across] = centres[across]
    positions[..., up] = centres[up][:, None]
    positions[..., through] = at
    shares = reach_map.orientation_shares(positions.reshape(-1, 3)).reshape(*positions.shape[:2], 2)
    figure = blank_figure(figure, (5.6, 4.6))
    axes = figure.add_subplot()
    half = 0.5 * reach_map.position_step
    extent = (
        centres[across][0] - half,
        centres[across][-1] + half,
        centres[up][0] - half,
        centres[up][-1] + half,
    )
    # Masked cells show the grey of the axes.
    proven = shares[..., 1] >= 1.0
    axes.set_facecolor("#e6e6e6")
    reached = np.ma.masked_where(proven, 100 * shares[..., 0])
    image = axes.imshow(reached, origin="lower", extent=extent, cmap="viridis", vmin=0)
    axes.set_xlabel(f"{'xyz'[across]} (m)", fontsize=9)
    axes.set_ylabel(f"{'xyz'[up]} (m)", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.set_title(f"{'xyz'[through]} = {at:.3g} m; grey: proven unreachable", fontsize=9, color=BLACK)
    bar = figure.colorbar(image, ax=axes)
    bar.set_label("reached orientations (%)", fontsize=9)
    bar.ax.tick_params(labelsize=8)
    return figure


__all__ = ["plot_reach"]
