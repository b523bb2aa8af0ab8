"""Datasets of targets through workers that each hold an arm or a problem."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pyarrow as pa
import ray
import ray.data
from ray.data import Dataset

TableSolver = Callable[[pa.Table], pa.Table]
"""A table of targets to a table of answers: ``SolveArm``, ``SolveProblem``, or what is derived from them."""


class Worker:
    """What Ray makes once in every worker: it holds a solver."""

    def __init__(self, solver: TableSolver) -> None:
        self.solver = solver

    def __call__(self, targets: pa.Table) -> pa.Table:
        return self.solver(targets)


def solve(
    dataset: Dataset,
    solver: TableSolver,
    *,
    workers: int | tuple[int, int] | None = None,
    batch_size: int = 4096,
    **options: Any,
) -> Dataset:
    """A dataset of targets (``ray.data.read_parquet``, ``from_arrow``, ...) to one of answers, by ``map_batches``.

    ``solver`` is a ``SolveArm`` or ``SolveProblem``, which each of ``workers`` processes holds: so many, or from
    so few to so many; None is up to one for each core of the cluster. ``options`` go to ``map_batches``:
    ``memory``, ``max_restarts``, ``num_cpus`` (a core, less where nothing would be left to read with), ...

    Like every dataset it is computed when it is read, written or materialised. Every row is the same to the bit
    as without Ray, with any number of workers and any batch size; the order of rows is Ray's, which keeps
    it where ``ray.data.DataContext``'s ``execution_options.preserve_order`` is set, so let a column number them.
    Ray starts a worker again that dies and solves again what it had; an exception in a worker ends the job.

    Raises what Ray's ``map_batches`` does for options that it does not know, and, where the dataset is computed, Ray's
    ``RayTaskError`` around what ``solver`` raised.
    """
    fewest, most = workers if isinstance(workers, tuple) else (workers or 1, workers or cores())
    # With a whole core for each worker of as many as there are, nothing could be read for them.
    options.setdefault("num_cpus", min(1.0, (cores() - 1) * 1000 // most / 1000))
    return dataset.map_batches(
        Worker,
        fn_constructor_args=(solver,),
        batch_format="pyarrow",
        batch_size=batch_size,
        compute=ray.data.ActorPoolStrategy(min_size=fewest, max_size=most),
        **options,
    )


def cores() -> int:
    """The cores that Ray's cluster has; a cluster on this machine is started where there is none."""
    if not ray.is_initialized():
        ray.init()
    return max(1, int(ray.cluster_resources().get("CPU", 1)))


__all__ = ["TableSolver", "solve"]
