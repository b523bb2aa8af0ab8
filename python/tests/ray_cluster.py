"""A local Ray cluster, with a long time to start."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from waiting import wait_until

ray = pytest.importorskip("ray", reason="SKIPPED LOUDLY: ray is not installed: pip install 'kinopt[ray]'")


@contextmanager
def ray_cluster() -> Iterator[None]:
    """Ray with two workers, for the time of a context."""
    # By default workers have a low priority, and do not run on a machine with other load.
    os.environ["RAY_worker_niceness"] = "0"
    wait_until(_started, seconds=400.0)
    assert ray.is_initialized()
    try:
        yield
    finally:
        ray.shutdown()


def _started() -> bool:
    """Starts Ray; false after its timeout of half a minute, which a machine with other load exceeds."""
    try:
        ray.init("local", num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    except Exception as failure:  # noqa: BLE001 - it has no class of its own
        if "timed out during startup" not in str(failure):
            raise
        ray.shutdown()
    return bool(ray.is_initialized())
