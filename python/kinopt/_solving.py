"""Solving and its reverse product on numpy arrays, for automatic differentiation: one query or several, with leading
batch axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from ._kinopt import Arm, Model, Problem, Solver
from .errors import InvalidValueError, KinoptError, UnknownNameError
from .types import Floats

Missing: TypeAlias = Literal["nan", "zero", "raise"]
Targets: TypeAlias = Any

# Number of axes of one target, by kind of task; 1 for other kinds.
_TARGET_AXES = {"pose": 2, "orientation": 2, "distance": 0, "joint coupling": 0}
# Kinds of tasks whose target is not fully a parameter of the solution.
_KINDS_WITHOUT_DERIVATIVE = ("plane", "ray", "frame velocity")
# Default solver. One object, so that queries compare equal.
_DEFAULT_SOLVER = Solver()
_SHAPE_MESSAGE = "a target must have shape (..., 4, 4), (..., 3, 3) or (..., n) to be differentiated by"


class NoDerivativeError(KinoptError):
    """A solution has no derivative with respect to its target: at a limit without force, singular, or not a
    solution."""


@dataclass(frozen=True)
class ArmQuery:
    """Pose query of an arm."""

    arm: Arm
    missing: Missing

    @property
    def length(self) -> int:
        """Length of a configuration."""
        return self.arm.degrees_of_freedom

    def target_axes(self, index: int) -> int:
        """Number of axes of one target."""
        return 2

    def solve(self, targets: Sequence[Floats], starts: Floats) -> Floats:
        """Solves N targets for N configurations."""
        return self.arm.solve_batch(targets[0], starts).q

    def pull(self, targets: Sequence[Floats], q: Floats, by_q: Floats) -> list[Floats]:
        """Pulls gradients with respect to N configurations back to their targets."""
        derivative = self.arm.derivative(targets[0], q)
        slopes = np.einsum("nd,ndk->nk", by_q, derivative.by_target)
        for index, differentiability in enumerate(derivative.differentiability):
            slopes[index] = _or_missing(slopes[index], differentiability, index, self.missing)
        return [np.stack([_on_target(*pair) for pair in zip(targets[0], slopes, strict=True)])]


@dataclass(frozen=True)
class ProblemQuery:
    """Query of a problem with targets for some of its tasks, followed by weights and joint origins as further
    parameters."""

    problem: Problem
    solver: Solver
    names: tuple[str | int, ...]
    missing: Missing
    is_weighed: bool = False
    joints: tuple[str, ...] = ()

    @property
    def length(self) -> int:
        """Length of a configuration."""
        return self.problem.configuration_len

    def task(self, name: str | int) -> int:
        """Index of a task."""
        if isinstance(name, int):
            return name
        names = self.problem.task_names
        if name not in names:
            raise UnknownNameError(f"there is no task {name!r}; the tasks are {names}")
        return names.index(name)

    def target_axes(self, index: int) -> int:
        """Number of axes of one target."""
        if index >= len(self.names):
            return 1
        task = self.problem.tasks[self.task(self.names[index])]
        kind = getattr(task, "task", task)._kind
        if kind in _KINDS_WITHOUT_DERIVATIVE:
            raise InvalidValueError(f"a solution has no derivative by the target of a {kind} task")
        return _TARGET_AXES.get(kind, 1)

    def restated(self, others: Sequence[Floats]) -> Problem:
        """The problem with one set of weights and joint origins."""
        problem = self.problem
        if self.is_weighed:
            problem = problem.with_weights(others[0])
        if self.joints:
            origins = others[len(others) - len(self.joints) :]
            problem = problem.with_joint_origins(dict(zip(self.joints, origins, strict=True)))
        return problem

    def problems(self, targets: Sequence[Floats], rows: int) -> list[tuple[Problem, list[int]]]:
        """The distinct problems of N queries, each with the indices of its queries."""
        others = targets[len(self.names) :]
        same: dict[bytes, list[int]] = {}
        for row in range(rows):
            same.setdefault(b"".join(other[row].tobytes() for other in others), []).append(row)
        return [(self.restated([other[indices[0]] for other in others]), indices) for indices in same.values()]

    def solve(self, targets: Sequence[Floats], starts: Floats) -> Floats:
        """Solves N targets for N configurations."""
        q = np.empty((len(starts), self.length))
        for problem, indices in self.problems(targets, len(starts)):
            by_name = {name: target[indices] for name, target in zip(self.names, targets, strict=False)}
            q[indices] = self.solver.solve_batch(problem, starts[indices], by_name).q
        return q

    def pull(self, targets: Sequence[Floats], q: Floats, by_q: Floats) -> list[Floats]:
        """Pulls gradients with respect to N configurations back to their targets."""
        slopes = [np.zeros_like(target) for target in targets]
        for problem, indices in self.problems(targets, len(q)):
            for index in indices:
                for slope, pulled in zip(slopes, self._pull(problem, index, targets, q, by_q), strict=True):
                    slope[index] = pulled
        return slopes

    def _pull(
        self, problem: Problem, index: int, targets: Sequence[Floats], q: Floats, by_q: Floats
    ) -> list[Floats]:
        """Gradients of one query."""
        query_targets = dict(zip(self.names, (target[index] for target in targets), strict=False))
        derivative = problem.derivative(q[index], query_targets)
        gradient = derivative.gradient(by_q=by_q[index])

        def or_missing(slope: Floats) -> Floats:
            return _or_missing(slope, derivative.differentiability, index, self.missing)

        slopes = []
        for name in self.names:
            by_task = gradient["targets"]
            task_gradient = by_task.get(name, by_task.get(problem.task_names[self.task(name)]))
            if task_gradient is None:
                raise InvalidValueError(f"a solution has no derivative by the target of {name}")
            slope = or_missing(task_gradient)
            if query_targets[name].ndim == 1 and slope.shape != query_targets[name].shape:
                slopes.append(_on_posture(problem.model, query_targets[name], slope))
            else:
                slopes.append(_on_target(query_targets[name], slope))
        if self.is_weighed:
            slopes.append(or_missing(gradient["weights"]))
        slopes.extend(or_missing(gradient["joint_origins"][joint]) for joint in self.joints)
        return slopes


Query: TypeAlias = ArmQuery | ProblemQuery


def make_query(
    arm_or_problem: Arm | Problem,
    targets: Any,
    solver: Solver | None,
    missing: Missing,
    weights: Any = None,
    joint_origins: Mapping[str, Any] | None = None,
) -> tuple[Query, list[Any]]:
    """Creates a query, and a list of the parameters of differentiation."""
    if missing not in ("nan", "zero", "raise"):
        raise InvalidValueError(f'missing is {missing!r}: "nan", "zero" or "raise"')
    if isinstance(arm_or_problem, Arm):
        if solver is not None:
            raise InvalidValueError("solver applies to problems only, not to arms")
        if weights is not None or joint_origins is not None:
            raise InvalidValueError("weights and joint_origins apply to problems only: use a Problem with a Pose")
        return ArmQuery(arm_or_problem, missing), [targets]
    if not isinstance(targets, Mapping):
        raise InvalidValueError("targets of a problem must be a dict by task")
    if not isinstance(joint_origins or {}, Mapping):
        raise InvalidValueError("joint_origins must be a dict by joint")
    origins = dict(joint_origins or {})
    is_weighed = weights is not None
    query = ProblemQuery(arm_or_problem, solver or _DEFAULT_SOLVER, tuple(targets), missing, is_weighed, tuple(origins))
    return query, [*targets.values(), *([weights] if is_weighed else []), *origins.values()]


def check_shapes(
    query: Query, targets: Sequence[tuple[int, ...]], start: tuple[int, ...]
) -> None:
    """Raises ``InvalidValueError`` for shapes of targets and of a start that do not match the query or each other."""
    batch = [start[:-1]]
    for k, shape in enumerate(targets):
        axes = query.target_axes(k)
        target_shape = shape[len(shape) - axes :]
        if len(shape) < axes or (axes == 2 and target_shape not in ((4, 4), (3, 3))):
            raise InvalidValueError(f"{_SHAPE_MESSAGE}, not {shape}")
        if isinstance(query, ArmQuery) and target_shape != (4, 4):
            raise InvalidValueError(f"targets has shape {shape}, expected (..., 4, 4)")
        batch.append(shape[: len(shape) - axes])
    if start[-1:] != (query.length,):
        raise InvalidValueError(f"start has shape {start}, expected (..., {query.length})")
    try:
        np.broadcast_shapes(*batch)
    except ValueError:
        raise InvalidValueError(f"targets {list(targets)} and start {start} do not broadcast") from None


def batched(
    query: Query, targets: Sequence[Floats], start: Floats
) -> tuple[tuple[int, ...], list[Floats], Floats]:
    """Returns the batch axes, and N rows of every target and of the start."""
    axes = [target.ndim - query.target_axes(k) for k, target in enumerate(targets)]
    shapes = [target.shape[:axis] for target, axis in zip(targets, axes, strict=True)]
    batch = np.broadcast_shapes(*shapes, start.shape[:-1])
    rows = int(np.prod(batch, dtype=int))
    many = [
        np.ascontiguousarray(
            np.broadcast_to(target, (*batch, *target.shape[axis:]))
        ).reshape(rows, *target.shape[axis:])
        for target, axis in zip(targets, axes, strict=True)
    ]
    starts = np.broadcast_to(start, (*batch, start.shape[-1])).reshape(rows, start.shape[-1])
    return batch, many, np.ascontiguousarray(starts)


def solve(query: Query, targets: Sequence[Floats], start: Floats) -> Floats:
    """Returns the configurations, with the batch axes in front."""
    batch, many, starts = batched(query, targets, start)
    return query.solve(many, starts).reshape(*batch, query.length)


def pull(query: Query, targets: Sequence[Floats], start: Floats, q: Floats, by_q: Floats) -> list[Floats]:
    """Returns the gradients with respect to the targets, with the shapes of the targets."""
    batch, many, _ = batched(query, targets, start)
    rows = int(np.prod(batch, dtype=int))
    slopes = query.pull(many, q.reshape(rows, -1), by_q.reshape(rows, -1))
    return [
        _summed(slope.reshape(*batch, *slope.shape[1:]), target.shape)
        for slope, target in zip(slopes, targets, strict=True)
    ]


def _summed(slope: Floats, shape: tuple[int, ...]) -> Floats:
    """Sums over broadcast axes."""
    slope = slope.sum(axis=tuple(range(slope.ndim - len(shape))))
    broadcast_axes = tuple(k for k, length in enumerate(shape) if length == 1 and slope.shape[k] != 1)
    summed: Floats = slope.sum(axis=broadcast_axes, keepdims=True)
    return summed


def _or_missing(slope: Floats, differentiability: str, index: int, missing: Missing) -> Floats:
    if differentiability in ("unique", "shortest_of_many"):
        return slope
    if missing == "raise":
        raise NoDerivativeError(f"solution {index} has no derivative: {differentiability}")
    return np.full_like(slope, np.nan if missing == "nan" else 0.0)


def _cross(v: Floats) -> Floats:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _on_posture(model: Any, posture: Floats, slope: Floats) -> Floats:
    """Gradient with respect to the numbers of a posture, from that with respect to its velocity. For each quaternion p
    it is G with <G, p ⊗ (0, v / 2)> = slope · v for every rotation v in the ball's own axes. It is zero along p,
    because the length of p has no effect."""
    while not isinstance(model, Model):
        model = model.model
    # Mimic joints share the coordinate of their source joint.
    is_ball = {
        joint.coordinate: joint.kind == "ball"
        for joint in model.joints
        if joint.coordinate is not None
    }
    width = sum(3 if ball else 1 for ball in is_ball.values())
    if len(posture) != model.configuration_len or len(slope) != width:
        raise InvalidValueError(f"{_SHAPE_MESSAGE}, not {posture.shape} with {slope.size} degrees of freedom")
    gradient = np.empty_like(posture)
    row = 0
    for coordinate in sorted(is_ball):
        if not is_ball[coordinate]:
            gradient[coordinate] = slope[row]
            row += 1
            continue
        length = np.linalg.norm(posture[coordinate : coordinate + 4])
        w, v = posture[coordinate] / length, posture[coordinate + 1 : coordinate + 4] / length
        by_turn = 2.0 * slope[row : row + 3] / length
        gradient[coordinate] = -v @ by_turn
        gradient[coordinate + 1 : coordinate + 4] = w * by_turn + np.cross(v, by_turn)
        row += 3
    return gradient


def _on_target(target: Floats, slope: Floats) -> Floats:
    """Gradient with respect to the numbers of a target, from that with respect to its motion. It is G with <G, T ξ> =
    slope · ξ for every motion ξ of a pose T. So the chain rule holds for any parametrisation of a pose."""
    if target.shape == (4, 4):
        gradient = np.zeros((4, 4))
        gradient[:3, :3] = 0.5 * target[:3, :3] @ _cross(slope[3:])
        gradient[:3, 3] = target[:3, :3] @ slope[:3]
        return gradient
    if target.shape == (3, 3) and slope.shape == (3,):
        return 0.5 * target @ _cross(slope)
    if target.shape == slope.shape or target.size == slope.size == 1:
        return slope.reshape(target.shape)
    raise InvalidValueError(f"{_SHAPE_MESSAGE}, not {target.shape} with {slope.size} degrees of freedom")
