"""Inverse kinematics as a layer of PyTorch: ``pip install 'kinopt[torch]'``.

``solve`` is a function of tensors, whose gradient follows from the implicit function theorem at the solution: no step
of the solver is recorded.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any

if find_spec("torch") is None:
    raise ImportError("kinopt.torch needs PyTorch: pip install 'kinopt[torch]'")

import numpy as np
import torch
from torch.autograd.function import once_differentiable

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

    For an arm ``targets`` is a tensor of shape (..., 4, 4), base_from_tool, metres. For a problem it is a dict of
    tensors by task, or an empty dict. Their shapes are (..., 4, 4) for a pose, (..., 3) for a position, (..., 3, 3) for
    an orientation, (..., n) for a posture. ``start`` has shape (nq,) or (..., nq). Leading axes are the batch and
    broadcast. The gradient of a pose is that of its motions, so any parametrisation of a pose gives correct gradients.

    Further parameters of a problem are differentiable. ``weights``, a tensor of shape (..., rows of ``Solution.rows``),
    replaces ``problem.weights``. ``joint_origins`` is a dict by joint of tensors of shape (..., 3), metres in the
    parent's axes: the lengths of links.

    ``missing`` selects the gradient of a solution without a derivative: "nan", "zero", or "raise" for an error. If
    solutions are not isolated, the gradient is that of the shortest change. ``solver`` is that of a problem; tight
    tolerances and no time limit give the best gradients.

    Raises ``InvalidValueError`` for other shapes, and ``NoDerivativeError`` if ``missing`` is "raise".
    """
    query, tensors = _solving.make_query(asked, targets, solver, missing, weights, joint_origins)
    sample = next((tensor for tensor in [*tensors, start] if isinstance(tensor, torch.Tensor)), None)
    kind = {"dtype": torch.float64} if sample is None else {"dtype": sample.dtype, "device": sample.device}
    tensors = [torch.as_tensor(tensor, **kind) for tensor in tensors]
    return _Solve.apply(query, torch.as_tensor(start, **kind), *tensors)


def _numbers(tensor: Any) -> Floats:
    return np.asarray(tensor.detach().cpu().numpy(), dtype=np.float64)


class _Solve(torch.autograd.Function):  # type: ignore[misc]
    """Solves in the forward pass, applies the reverse product in the backward pass."""

    @staticmethod
    def forward(ctx: Any, query: _solving.Query, start: Any, *targets: Any) -> Any:
        numbers = [_numbers(target) for target in targets]
        q = _solving.solve(query, numbers, _numbers(start))
        ctx.query, ctx.q, ctx.start = query, q, _numbers(start)
        ctx.save_for_backward(*targets)
        return torch.as_tensor(q).to(start)

    @staticmethod
    @once_differentiable  # type: ignore[untyped-decorator, misc, unused-ignore]
    def backward(ctx: Any, by_q: Any) -> Any:
        targets = ctx.saved_tensors
        numbers = [_numbers(target) for target in targets]
        slopes = _solving.pull(ctx.query, numbers, ctx.start, ctx.q, _numbers(by_q))
        moved = [torch.as_tensor(slope).to(target) for slope, target in zip(slopes, targets, strict=True)]
        return None, None, *moved
