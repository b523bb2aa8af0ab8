"""Datasets of targets solved by workers that each hold an arm or a problem."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pyarrow as pa
import ray
import ray.data
from ray.data import Dataset

TableSolver = Callable[[pa.Table], pa.Table]
"""Function from a table of targets to one of solutions: ``SolveArm``, ``SolveProblem``, or a subclass of them."""


class Worker:
    """Ray actor that holds a solver; created once in every worker."""

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
    """Maps a dataset of targets (``ray.data.read_parquet``, ``from_arrow``, ...) to one of solutions, by
    ``map_batches``.

    ``solver`` is a ``SolveArm`` or ``SolveProblem``, held by each of ``workers`` processes. ``workers`` is a number, or
    (minimum, maximum); None is up to one for each core of the cluster. ``options`` go to ``map_batches``: ``memory``,
    ``max_restarts``, ``num_cpus`` (default one core, less if no core would remain for reading), ...

    Like every dataset it is computed when it is read, written or materialised. Rows equal those without Ray exactly, at
    any number of workers and any batch size. The order of rows is Ray's, which is preserved if
    ``ray.data.DataContext``'s ``execution_options.preserve_order`` is set; otherwise add a column of indices. Ray
    restarts a worker that dies and repeats its batch; an exception in a worker ends the job.

    Raises the exceptions of Ray's ``map_batches`` for unknown options, and, when the dataset is computed, Ray's
    ``RayTaskError`` around exceptions of ``solver``.
    """
    min_workers, max_workers = workers if isinstance(workers, tuple) else (workers or 1, workers or cores())
    # Workers with a whole core each would leave none for reading.
    options.setdefault("num_cpus", min(1.0, (cores() - 1) * 1000 // max_workers / 1000))
    return dataset.map_batches(
        Worker,
        fn_constructor_args=(solver,),
        batch_format="pyarrow",
        batch_size=batch_size,
        compute=ray.data.ActorPoolStrategy(min_size=min_workers, max_size=max_workers),
        **options,
    )


def cores() -> int:
    """Number of cores of Ray's cluster; starts a cluster on this machine if there is none."""
    if not ray.is_initialized():
        ray.init()
    return max(1, int(ray.cluster_resources().get("CPU", 1)))


__all__ = ["TableSolver", "solve"]
