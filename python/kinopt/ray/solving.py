"""Worker functions: from a table of targets to a table of solutions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from .. import tasks
from .._kinopt import Arm, Problem, Solver
from ..errors import InvalidValueError, UnknownNameError
from ..types import Floats
from .tables import column, numbers

ANSWERS = ("q", "reached", "position_error", "orientation_error", "attempts", "iterations")
"""Columns that a solved table has in addition."""


class SolveArm:
    """Solves tables of targets of an arm: the solver that ``solve`` and ``solve_files`` hold in every worker.

    ``target`` names the column of base_from_tool, 16 numbers for each row, row-major, metres. ``start`` is a common
    start, shape (dof,), radians and metres (None: the one nearest to all zeros). Or ``starts`` names a column of them,
    dof numbers for each row. ``keep`` names the columns that are copied to the solutions; None is all except those of
    targets and starts. ``threads`` is for each worker.

    A call with a table returns a table with an equal number and order of rows. Its columns are ``q`` (dof numbers for
    each row, radians and metres, within the limits), ``reached``, ``position_error`` (metres), ``orientation_error``
    (radians), ``attempts``, ``iterations``, exactly as ``arm.solve_batch``. Subclass it to add columns.

    Raises ``InvalidValueError`` for a start of another shape. A call raises it for columns that are missing or of other
    shapes, for targets that are not placements, and for a kept column with the name of a result.
    """

    def __init__(
        self,
        arm: Arm,
        start: ArrayLike | None = None,
        *,
        target: str = "target",
        starts: str | None = None,
        keep: Sequence[str] | None = None,
        threads: int | None = 1,
    ) -> None:
        if start is not None and starts is not None:
            raise InvalidValueError("give start or starts, not both")
        # An empty batch validates the start, before it reaches a worker.
        arm.solve_batch(np.empty((0, 4, 4)), start, threads)
        self.arm = arm
        self.start = start
        self.target = target
        self.starts = starts
        self.keep = keep
        self.threads = threads

    def __call__(self, targets: pa.Table) -> pa.Table:
        """Solves a table of targets."""
        start = self.start if self.starts is None else numbers(targets, self.starts)
        batch = self.arm.solve_batch(numbers(targets, self.target, (4, 4)), start, self.threads)
        return with_results(kept_columns(targets, self.keep, (self.target, self.starts)), batch)


class SolveProblem:
    """Solves tables of targets of a problem: the solver that ``solve`` and ``solve_files`` hold in every worker.

    ``targets`` names the column of each task's targets: {"hand": "hand_target"}; other tasks keep the problem's
    targets. A row holds the numbers of a target, row-major. These are 3 for a point, 16 for a pose, 9 for an
    orientation, 6 for a plane (point, normal) or a ray (eye, through). They are 1 for a distance and nq for a posture.
    ``start`` is a common start, shape (nq,), or ``starts`` names a column of them. ``solver`` is a ``kinopt.Solver``,
    ``max_move`` the largest displacement of joints from their start, as in its ``solve_batch``; ``keep`` and
    ``threads`` are as for ``SolveArm``.

    A call with a table returns a table with an equal number and order of rows, with the columns of ``SolveArm``,
    exactly as ``solver.solve_batch``. Errors are empty if no required task has their unit. It can be sent to workers if
    the residuals of the problem can be pickled.

    Raises ``UnknownNameError`` for unknown tasks and ``InvalidValueError`` for a start of another shape. A call raises
    the latter for columns that are missing or of other shapes and for invalid targets and moves.
    """

    def __init__(
        self,
        problem: Problem,
        start: ArrayLike | None = None,
        *,
        targets: Mapping[str, str] | None = None,
        starts: str | None = None,
        solver: Solver | None = None,
        max_move: ArrayLike | Mapping[str, float] | None = None,
        keep: Sequence[str] | None = None,
        threads: int | None = 1,
    ) -> None:
        if (start is None) == (starts is None):
            raise InvalidValueError("give either start or starts")
        self.problem = problem
        self.start: Floats | None = None if start is None else np.asarray(start, dtype=np.float64)
        self.targets: dict[str, str] = dict(targets or {})
        self.starts = starts
        self.solver: Solver = Solver() if solver is None else solver
        self.max_move = max_move
        self.keep = keep
        self.threads = threads
        for name in self.targets:
            if name not in problem.task_names:
                raise UnknownNameError(f"there is no task {name!r} among {problem.task_names}")
        dof = problem.configuration_len
        if self.start is not None and not (self.start.shape == (dof,) and np.isfinite(self.start).all()):
            raise InvalidValueError(f"start must be {dof} finite numbers")
        self._shapes = {name: _target_shape(problem, name) for name in self.targets}

    def __call__(self, targets: pa.Table) -> pa.Table:
        """Solves a table of targets."""
        if self.start is not None:
            starts = np.tile(self.start, (targets.num_rows, 1))
        else:
            starts = numbers(targets, str(self.starts), (self.problem.configuration_len,))
        solver_targets = {
            name: numbers(targets, column_name, self._shapes[name]) for name, column_name in self.targets.items()
        }
        batch = self.solver.solve_batch(
            self.problem, starts, solver_targets, max_move=self.max_move, threads=self.threads
        )
        return with_results(kept_columns(targets, self.keep, (*self.targets.values(), self.starts)), batch)


def _target_shape(problem: Problem, name: str) -> tuple[int, ...]:
    """Shape of a task's target."""
    task = problem.tasks[problem.task_names.index(name)]
    task = task.task if isinstance(task, tasks.Bounded) else task
    shapes: dict[type, tuple[int, ...]] = {
        tasks.Pose: (4, 4),
        tasks.Orientation: (3, 3),
        tasks.Plane: (2, 3),
        tasks.Ray: (2, 3),
        tasks.Distance: (),
    }
    return shapes.get(type(task), (-1,))


def kept_columns(table: pa.Table, keep: Sequence[str] | None, used: Sequence[str | None]) -> pa.Table:
    """The columns to copy: those of ``keep``, or all that are not ``used``."""
    if keep is None:
        keep = [name for name in table.column_names if name not in used]
    missing = [name for name in keep if name not in table.column_names]
    hidden = [name for name in keep if name in ANSWERS]
    if missing:
        raise InvalidValueError(f"there is no column {missing[0]!r} among {table.column_names}")
    if hidden:
        raise InvalidValueError(f"column {hidden[0]!r} has the name of a result: rename or drop it")
    return table.select(keep)


def with_results(table: pa.Table, batch: Any) -> pa.Table:
    """The table with the results of a batch appended."""
    for name in ANSWERS:
        values = getattr(batch, name)
        # A problem without required tasks in this unit has no such errors.
        values = pa.nulls(len(batch), pa.float64()) if values is None else column(values)
        table = table.append_column(name, values)
    return table


__all__ = ["ANSWERS", "SolveArm", "SolveProblem"]
