"""Waiting for what another thread or process does."""

import time


def wait_until(holds, pause=lambda: time.sleep(0.02), seconds=120.0):
    """Waits until `holds()`, which is then asserted by who waited: a busy machine takes its time."""
    deadline = time.monotonic() + seconds
    while not holds() and time.monotonic() < deadline:
        pause()
