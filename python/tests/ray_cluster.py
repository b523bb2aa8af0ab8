"""Ray on this machine alone, started as well as a busy one can."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from waiting import wait_until

ray = pytest.importorskip("ray", reason="SKIPPED LOUDLY: ray is not installed: pip install 'kinopt[ray]'")


@contextmanager
def ray_cluster() -> Iterator[None]:
    """Ray with two workers, until it is left."""
    # Workers step back behind all else that a machine does, and get no turn on a busy one.
    os.environ["RAY_worker_niceness"] = "0"
    wait_until(_started, seconds=400.0)
    assert ray.is_initialized()
    try:
        yield
    finally:
        ray.shutdown()


def _started() -> bool:
    """Ray gives up after half a minute, in which a busy machine does not begin."""
    try:
        ray.init("local", num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    except Exception as failure:  # noqa: BLE001 - it has no class of its own
        if "timed out during startup" not in str(failure):
            raise
        ray.shutdown()
    return bool(ray.is_initialized())
