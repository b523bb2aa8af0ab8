"""Single-threaded loop of a page, at the screen's rate during motion."""

from __future__ import annotations

import contextlib
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

#: Seconds between two frames.
FRAME_TIME = 1.0 / 60.0

Work = Callable[[], Any]
#: Called in each frame with the time in seconds; returns true to be called in the next frame too.
Ticker = Callable[[float], bool]


class Loop:
    """Runs posted work immediately, and tickers in each frame until they return false.

    All access to shown objects runs here, so it needs no locks. If the mouse moves faster than a solve, only its last
    position is solved.
    """

    def __init__(self, atomic: Callable[[], contextlib.AbstractContextManager[None]]) -> None:
        """`atomic` groups the messages of a frame."""
        self._atomic = atomic
        self._posted: deque[Work] = deque()
        self._tickers: dict[Ticker, None] = {}
        self._changed = threading.Condition()
        self._stopped = False
        self.failure: str | None = None
        self.thread: threading.Thread = threading.Thread(target=self._run, name="kinopt.view", daemon=True)
        self.thread.start()

    def post(self, work: Work) -> None:
        """Runs `work` on the loop's thread, after all work posted before."""
        with self._changed:
            self._posted.append(work)
            self._changed.notify()

    def tick(self, ticker: Ticker) -> None:
        """Calls `ticker` in each frame, from the next pass on, until it returns false."""
        with self._changed:
            self._tickers[ticker] = None
            self._changed.notify()

    def call(self, work: Work) -> Any:
        """Runs `work` on the loop's thread and returns its result."""
        if threading.current_thread() is self.thread or self._stopped:
            return work()
        result: list[Any] = []
        error: list[BaseException] = []
        done = threading.Event()

        def run() -> None:
            try:
                result.append(work())
            except BaseException as raised:  # noqa: BLE001 - it is raised where it was asked for
                error.append(raised)
            finally:
                done.set()

        self.post(run)
        while not done.wait(0.2):
            if not self.thread.is_alive():
                raise RuntimeError("the scene is closed")
        if error:
            raise error[0]
        return result[0]

    def stop(self) -> None:
        """Ends the thread after its current work."""
        with self._changed:
            self._stopped = True
            self._changed.notify()
        if threading.current_thread() is not self.thread:
            self.thread.join(timeout=2.0)

    def _run(self) -> None:
        next_frame = 0.0
        while True:
            with self._changed:
                while not (self._posted or self._stopped):
                    if not self._tickers:
                        self._changed.wait()
                        continue
                    left = next_frame - time.perf_counter()
                    if left <= 0.0 or not self._changed.wait(left):
                        break
                if self._stopped:
                    return
                posted = list(self._posted)
                self._posted.clear()
            with self._atomic():
                for work in posted:
                    self._guarded(work)
                now = time.perf_counter()
                if now < next_frame:
                    continue
                next_frame = max(next_frame + FRAME_TIME, now)
                for ticker in list(self._tickers):
                    if not self._guarded(partial(ticker, now)):
                        self._tickers.pop(ticker, None)

    def _guarded(self, work: Work) -> Any:
        """Shows an exception of a user's function, and continues."""
        try:
            return work()
        except Exception:  # noqa: BLE001
            self.failure = traceback.format_exc()
            traceback.print_exc()
            return None
