"""Inverse kinematics as a function of JAX: ``pip install 'kinopt[jax]'``.

``solve`` works under ``jit``, ``vmap`` and ``grad``. The solver runs on the host, and the gradient follows from the
implicit function theorem at the solution (``custom_vjp``). With JAX's default 32-bit numbers, targets are rounded;
``jax.config.update("jax_enable_x64", True)`` avoids it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from importlib.util import find_spec
from typing import Any

if find_spec("jax") is None:
    raise ImportError("kinopt.jax needs JAX: pip install 'kinopt[jax]'")

import jax
import jax.numpy as jnp
import numpy as np

from . import _solving
from ._kinopt import Arm, Problem, Solver
from ._solving import Missing, NoDerivativeError
from .types import Floats

__all__ = ["NoDerivativeError", "solve"]


def solve(
    asked: Arm | Problem,
    targets: Any,
    start: Any,
    *,
    weights: Any = None,
    joint_origins: Mapping[str, Any] | None = None,
    solver: Solver | None = None,
    missing: Missing = "nan",
) -> Any:
    """Solves for the configurations of ``targets``, with gradients: shape (..., nq).

    For an arm ``targets`` is an array of shape (..., 4, 4), base_from_tool, metres. For a problem it is a dict of
    arrays by task. Their shapes are (..., 4, 4) for a pose, (..., 3) for a position, (..., 3, 3) for an orientation,
    (..., n) for a posture. ``start`` has shape (nq,) or (..., nq). Leading axes are the batch and broadcast. The
    gradient of a pose is that of its motions, so any parametrisation of a pose gives correct gradients.

    Further parameters of a problem are differentiable. ``weights``, an array of shape (..., rows of ``Solution.rows``),
    replaces ``problem.weights``. ``joint_origins`` is a dict by joint of arrays of shape (..., 3), metres in the
    parent's axes: the lengths of links.

    ``missing`` selects the gradient of a solution without a derivative: "nan", "zero", or "raise" for an error. If
    solutions are not isolated, the gradient is that of the shortest change.

    Raises ``InvalidValueError`` for other shapes.
    """
    query, arrays = _solving.make_query(asked, targets, solver, missing, weights, joint_origins)
    jax_arrays = tuple(jnp.asarray(array, float) for array in arrays)
    start = jnp.asarray(start, float)
    _solving.check_shapes(query, [array.shape for array in jax_arrays], start.shape)
    return _solve(query, jax_arrays, start)


def _numbers(array: Any) -> Floats:
    return np.asarray(array, dtype=np.float64)


def _is_traced(arrays: tuple[Any, ...]) -> bool:
    return any(isinstance(array, jax.core.Tracer) for array in arrays)


def _solve_on_host(query: _solving.Query, targets: tuple[Any, ...], start: Any) -> Floats:
    q = _solving.solve(query, [_numbers(target) for target in targets], _numbers(start))
    return q.astype(start.dtype)


def _pull_on_host(
    query: _solving.Query, targets: tuple[Any, ...], start: Any, q: Any, by_q: Any
) -> tuple[Floats, ...]:
    numbers = [_numbers(target) for target in targets]
    slopes = _solving.pull(query, numbers, _numbers(start), _numbers(q), _numbers(by_q))
    return tuple(slope.astype(target.dtype) for slope, target in zip(slopes, targets, strict=True))


# Compiled once for each query and shape: queries are hashable, and equal queries compare equal.
@partial(jax.jit, static_argnums=0)
def _solve_traced(query: _solving.Query, targets: tuple[Any, ...], start: Any) -> Any:
    shapes = [target.shape[: target.ndim - query.target_axes(k)] for k, target in enumerate(targets)]
    batch = np.broadcast_shapes(*shapes, start.shape[:-1])
    shape = jax.ShapeDtypeStruct((*batch, query.length), start.dtype)
    on_host = partial(_solve_on_host, query)
    return jax.pure_callback(on_host, shape, targets, start, vmap_method="broadcast_all")


@partial(jax.jit, static_argnums=0)
def _pull_traced(
    query: _solving.Query, targets: tuple[Any, ...], start: Any, q: Any, by_q: Any
) -> tuple[Any, ...]:
    shapes = tuple(jax.ShapeDtypeStruct(target.shape, target.dtype) for target in targets)
    on_host = partial(_pull_on_host, query)
    pulled = jax.pure_callback(on_host, shapes, targets, start, q, by_q, vmap_method="broadcast_all")
    return tuple(pulled)


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def _solve(query: _solving.Query, targets: tuple[Any, ...], start: Any) -> Any:
    if _is_traced((*targets, start)):
        return _solve_traced(query, targets, start)
    return jnp.asarray(_solve_on_host(query, targets, start))


def _forward(query: _solving.Query, targets: tuple[Any, ...], start: Any) -> Any:
    q = _solve(query, targets, start)
    return q, (targets, start, q)


def _backward(query: _solving.Query, saved: Any, by_q: Any) -> Any:
    targets, start, q = saved
    if _is_traced((*targets, start, q, by_q)):
        slopes = _pull_traced(query, targets, start, q, by_q)
    else:
        slopes = tuple(jnp.asarray(slope) for slope in _pull_on_host(query, targets, start, q, by_q))
    return slopes, jnp.zeros_like(start)


_solve.defvjp(_forward, _backward)
