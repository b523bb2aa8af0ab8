"""Folders of targets to folders of answers: what is finished stays on disk, so that a job can be begun again."""

from __future__ import annotations

import os
from typing import Any

import pyarrow as pa
import pyarrow.dataset
import ray.data

from ..errors import FileError, InvalidValueError, KinoptError
from .datasets import TableSolver, cores
from .folder import Folder

# A note in a file of answers: which file of targets they answer.
_STAMP = "kinopt targets"
# So many rows of a finished file are solved again when a job goes on.
_PROBED = 64


def write_blocks(
    table: pa.Table, folder: str | os.PathLike[str], rows: int = 16_384
) -> list[str]:
    """Writes a table as Parquet files of at most so many ``rows`` into ``folder``, made if need be.

    A file is what a worker solves at a time and what ``solve_files`` keeps. Returns the files' names, whose
    order is the table's. ``folder`` is a path or a URI. Raises ``FileError`` where it cannot be written and
    ``InvalidValueError`` for files of less than a row.
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
    """Solves every Parquet file of a folder of ``targets`` into a file of the same name in ``answers``.

    The folders are paths or URIs that all workers see. Rows and their order are those of the targets' files,
    so that they can be laid side by side, to the bit what ``solver`` says without Ray. ``workers`` (None: one
    for each core of the cluster) take a file at a time, read, solve and write it themselves. ``options`` go to
    Ray's ``map_batches``. Returns the answers, unread: Arrow's dataset, whose ``to_table()`` has the rows in order;
    for a dataset of Ray's, ``ray.data.read_parquet(answers)``.

    A file appears in ``answers`` when it is whole. A job that was ended, killed or switched off goes on
    where the same call is made again: files that are there are skipped, unless their targets changed since. The
    first rows of one are solved again, and ``InvalidValueError`` is raised where they come out differently: then
    these are the answers to another question. One job at a time for a folder of answers. A worker that dies is
    started again by Ray, and its file with it.

    Raises ``FileError`` where there are no targets, and ``InvalidValueError`` with the file's name for those that
    cannot be solved, after all others are.
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
        many = min(len(left), cores() if workers is None else workers)
        files = ray.data.from_items([{"name": name} for name in left], override_num_blocks=len(left))
        told = files.map_batches(
            _FileWorker,
            fn_constructor_args=(job,),
            batch_format="pyarrow",
            batch_size=1,
            compute=ray.data.ActorPoolStrategy(size=many),
            **options,
        )
        problems = sorted(row["problem"] for row in told.iter_rows() if row["problem"])
        if problems:
            raise InvalidValueError("; ".join(problems))
    return into.dataset(names)


class _Job:
    """Files of targets, and where their answers go."""

    def __init__(self, source: Folder, into: Folder, solver: TableSolver) -> None:
        self.source = source
        self.into = into
        self.solver = solver

    def is_done(self, name: str) -> bool:
        return self.into.note(name, _STAMP) == self.source.stamp(name)

    def probe(self, name: str) -> None:
        """Raises where a finished file does not hold what would be answered now."""
        again = self.solver(self.source.read(name).slice(0, _PROBED))
        before = self.into.read(name).slice(0, _PROBED)
        # As text, where a number is itself to the bit, and NaN too.
        if repr(again.to_pydict()) != repr(before.to_pydict()):
            raise InvalidValueError(
                f"{name} in {self.into.name} answers another question: give another folder, or delete it"
            )

    def solve(self, name: str) -> str | None:
        """Solves a file; returns what is wrong with it."""
        # Before it is read: what changes meanwhile is solved again the next time.
        stamp = self.source.stamp(name)
        try:
            answers = self.solver(self.source.read(name))
        except KinoptError as error:
            return f"{name}: {error}"
        self.into.write(name, answers, {_STAMP: stamp})
        return None


class _FileWorker:
    """What Ray makes once in every worker: it holds the job's solver."""

    def __init__(self, job: _Job) -> None:
        self.job = job

    def __call__(self, files: pa.Table) -> pa.Table:
        names = files["name"].to_pylist()
        problems = [self.job.solve(name) for name in names]
        return pa.table({"name": names, "problem": pa.array(problems, pa.string())})


__all__ = ["solve_files", "write_blocks"]
