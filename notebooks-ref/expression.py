"""Rigid motions and rotation vectors as CasADi expressions (4 x 4 matrices, radians)."""

import casadi as ca
import numpy as np


def rigid(rotation, translation):
    return ca.vertcat(ca.horzcat(rotation, translation), ca.SX([[0.0, 0.0, 0.0, 1.0]]))


def inverse(placement):
    turn = placement[:3, :3].T
    return rigid(turn, -turn @ placement[:3, 3])


def about_x(angle):
    c, s = ca.cos(angle), ca.sin(angle)
    return rigid(ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c)), ca.SX.zeros(3))


def about_z(angle):
    c, s = ca.cos(angle), ca.sin(angle)
    return rigid(ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1)), ca.SX.zeros(3))


def about(axis, angle):
    """Rodrigues: R = I + sin(a) [n] + (1 - cos(a)) [n]^2 for a unit axis n."""
    n = ca.skew(axis)
    return rigid(ca.SX.eye(3) + ca.sin(angle) * n + (1 - ca.cos(angle)) * n @ n, ca.SX.zeros(3))


def turn_between(sine_axis, cosine):
    """The rotation vector n t from its axis times sine, n sin(t), and its cosine.

    t = atan2(|n sin t|, cos t). For small sin t with a positive cosine, t / sin t is its series, so that the
    expression has derivatives there. At a half turn it has none.
    """
    squared = ca.dot(sine_axis, sine_axis)
    near = ca.logic_and(squared < 1e-8, cosine > 0)
    safe = ca.if_else(near, 1.0, squared)
    sine = ca.sqrt(safe)
    series = 1 + squared / 6 + 3 * squared**2 / 40
    return sine_axis * ca.if_else(near, series, ca.atan2(sine, cosine) / sine)


def rotation_vector(turn):
    """log(R), a vector in the axes of R."""
    sine_axis = ca.vertcat(turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]) / 2
    return turn_between(sine_axis, (ca.trace(turn) - 1) / 2)


def angular_velocity(rotation, x):
    """The matrix A of w = A xdot, from dR/dx R^T = [w], by differentiating R."""
    columns = []
    for k in range(x.numel()):
        slope = ca.reshape(ca.jacobian(ca.vec(rotation), x[k]), 3, 3)
        columns.append(ca.inv_skew(slope @ rotation.T))
    return ca.horzcat(*columns)


def axes_of(placement):
    """x, y, z of the origin, then the rotation by rows: twelve numbers."""
    placement = np.asarray(placement)
    return [float(v) for v in (*placement[:3, 3], *placement[:3, :3].ravel())]
