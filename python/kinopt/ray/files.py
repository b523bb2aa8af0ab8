"""Folders of targets solved to folders of solutions: finished files stay, so an interrupted job can continue."""

from __future__ import annotations

import os
from typing import Any

import pyarrow as pa
import pyarrow.dataset
import ray.data

from ..errors import FileError, InvalidValueError, KinoptError
from .datasets import TableSolver, cores
from .folder import Folder

# Metadata key in a file of solutions, with the stamp of its file of targets.
_STAMP = "kinopt targets"
# Number of rows of a finished file that are solved again when a job continues.
_PROBED_ROWS = 64


def write_blocks(
    table: pa.Table, folder: str | os.PathLike[str], rows: int = 16_384
) -> list[str]:
    """Writes a table as Parquet files of at most ``rows`` rows into ``folder``, which is created if missing.

    A file is the unit of work of ``solve_files``. Returns the names of the files, in the order of the table. ``folder``
    is a path or a URI. Raises ``FileError`` if it cannot be written and ``InvalidValueError`` for ``rows`` below 1.
    """
    if rows < 1:
        raise InvalidValueError(f"rows is {rows}, which is less than 1")
    into = Folder(folder)
    into.make()
    names: list[str] = []
    for first in range(0, table.num_rows, rows):
        names.append(f"{len(names):06}.parquet")
        into.write(names[-1], table.slice(first, rows))
    return names


def solve_files(
    targets: str | os.PathLike[str],
    answers: str | os.PathLike[str],
    solver: TableSolver,
    *,
    workers: int | None = None,
    **options: Any,
) -> pyarrow.dataset.Dataset:
    """Solves every Parquet file of a folder of ``targets`` into a file of equal name in ``answers``.

    The folders are paths or URIs that all workers can access. Rows and their order are those of the targets' files, so
    that the tables can be joined by row. Rows equal exactly the results of ``solver`` without Ray. Each of ``workers``
    (None: one for each core of the cluster) reads, solves and writes one file at a time. ``options`` go to Ray's
    ``map_batches``. Returns the solutions, unread: an Arrow dataset, whose ``to_table()`` has the rows in order; for a
    dataset of Ray, use ``ray.data.read_parquet(answers)``.

    A file appears in ``answers`` when it is complete. After an interruption, an equal call continues the job: existing
    files are skipped, unless their targets changed. The first rows of one of them are solved again, and
    ``InvalidValueError`` is raised if they differ, because the files then belong to another query. Only one job at a
    time may use a folder of ``answers``. Ray restarts a worker that dies, with its file.

    Raises ``FileError`` without targets, and ``InvalidValueError`` with the name of a file that cannot be solved, after
    all other files.
    """
    source, into = Folder(targets), Folder(answers)
    names = source.names()
    if not names:
        raise FileError(f"there are no Parquet files in {source.name}")
    into.make()
    job = _Job(source, into, solver)
    left = [name for name in names if not job.is_done(name)]
    for name in [name for name in names if name not in left][:1]:
        job.probe(name)
    if left:
        worker_count = min(len(left), cores() if workers is None else workers)
        files = ray.data.from_items([{"name": name} for name in left], override_num_blocks=len(left))
        results = files.map_batches(
            _FileWorker,
            fn_constructor_args=(job,),
            batch_format="pyarrow",
            batch_size=1,
            compute=ray.data.ActorPoolStrategy(size=worker_count),
            **options,
        )
        problems = sorted(row["problem"] for row in results.iter_rows() if row["problem"])
        if problems:
            raise InvalidValueError("; ".join(problems))
    return into.dataset(names)


class _Job:
    """Files of targets, and the folder of their solutions."""

    def __init__(self, source: Folder, into: Folder, solver: TableSolver) -> None:
        self.source = source
        self.into = into
        self.solver = solver

    def is_done(self, name: str) -> bool:
        return self.into.note(name, _STAMP) == self.source.stamp(name)

    def probe(self, name: str) -> None:
        """Raises an error if a finished file differs from the current results."""
        recomputed = self.solver(self.source.read(name).slice(0, _PROBED_ROWS))
        stored = self.into.read(name).slice(0, _PROBED_ROWS)
        # Compared as text, which is exact and treats NaN as equal.
        if repr(recomputed.to_pydict()) != repr(stored.to_pydict()):
            raise InvalidValueError(
                f"{name} in {self.into.name} belongs to another query: use another folder, or delete it"
            )

    def solve(self, name: str) -> str | None:
        """Solves a file; returns the error text, or None."""
        # Taken before reading: a later change of the file then invalidates the result.
        stamp = self.source.stamp(name)
        try:
            results = self.solver(self.source.read(name))
        except KinoptError as error:
            return f"{name}: {error}"
        self.into.write(name, results, {_STAMP: stamp})
        return None


class _FileWorker:
    """Ray actor that holds the solver of the job; created once in every worker."""

    def __init__(self, job: _Job) -> None:
        self.job = job

    def __call__(self, files: pa.Table) -> pa.Table:
        names = files["name"].to_pylist()
        problems = [self.job.solve(name) for name in names]
        return pa.table({"name": names, "problem": pa.array(problems, pa.string())})


__all__ = ["solve_files", "write_blocks"]
