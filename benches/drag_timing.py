"""Latency of the viewer from a mouse position to transforms sent to the page.

    python benches/drag_timing.py [MODEL] [MOVES]

A hand of the model is moved back and forth as by a page. It is the shipped humanoid's left hand with four other tips
pinned, or the first tip of another model. There is no browser, which would use the same processor.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinopt.view.opening import open_page

HUMANOID = Path(__file__).parents[1] / "models" / "humanoid" / "humanoid.json"


def main(model: str, moves: int) -> None:
    """Prints the median, the 99th percentile and the maximum of a number of moves."""
    page = open_page(model, port=8400)
    frame = next((name for name in page.targets if "hand" in name), next(iter(page.targets)))
    target = page.targets[frame]
    start, size = target.placement, page.body.size()

    def move_to(place: NDArray[np.float64], phase: str) -> None:
        page.call(lambda: target._hear(place, phase, time.perf_counter()))

    move_to(start, "start")
    for move in range(moves):
        place = start.copy()
        place[:3, 3] += 0.06 * size * np.sin(move / 15.0) * np.array([0.4, 0.6, -0.5])
        move_to(place, "update")
        time.sleep(0.01)
    move_to(start, "end")
    time.sleep(1.0)
    times = np.array(page.times) * 1e3
    median, high = np.percentile(times, [50, 99])
    reached = page.answer is not None and page.answer.solution.reached
    page.scene.close()
    print(
        f"{Path(model).name}, {frame}: median {median:.2f} ms, p99 {high:.2f} ms, longest {times.max():.2f} ms "
        f"of {len(times)} moves; at the end {'reached' if reached else 'missed'}"
    )


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else str(HUMANOID), int(sys.argv[2]) if len(sys.argv) > 2 else 1000)
