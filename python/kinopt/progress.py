"""Progress bars for long computations."""

from __future__ import annotations

from collections.abc import Callable


def bar() -> Callable[[int, int], None]:
    """A tqdm progress bar, called with (done, total); without tqdm it shows nothing."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return lambda done, total: None
    shown = None

    def report(done: int, total: int) -> None:
        nonlocal shown
        if shown is None:
            shown = tqdm(total=total)
        shown.update(done - shown.n)
        if done >= total:
            shown.close()

    return report


__all__ = ["bar"]
