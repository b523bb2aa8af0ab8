"""Waiting for another thread or process."""

import time


def wait_until(holds, pause=lambda: time.sleep(0.02), seconds=120.0):
    """Waits until `holds()`, which the caller then asserts; long, for machines with other load."""
    deadline = time.monotonic() + seconds
    while not holds() and time.monotonic() < deadline:
        pause()
