"""Bounded least-squares problems: a statement in plain numbers, compiled by CasADi.

    minimise  cost(x) = 1/2 sum |w r(x)|^2     subject to  lower <= x <= upper

A statement is a list of tasks, each a dict that goes into the fixture as it is. Residuals are those
that the library documents, written down again here:

    point        x - target                                        3 rows, metres
    ray          (I - d d^T)(x - through), d = unit(eye - through)  3 rows, metres
    plane        n . (x - point), n = unit(normal)                  1 row, metres
    distance     |x_a - x_b| - distance                             1 row, metres
    orientation  log(R R_target^T)                                  3 rows, radians, world axes
    pose         x - target, then log(R R_target^T)                 3 rows metres, 3 rows radians
    look-at      the rotation vector from the axis to the sight     3 rows, radians
    posture      x - reference                                      a row a variable, joint units
    centring     (x - middle) / half range                          a row a variable, ratio
"""

import functools

import casadi as ca
import numpy as np

from expression import rotation_vector, turn_between
from models import read

model = functools.cache(read)


def unit(vector):
    return vector / ca.norm_2(vector)


def rows(task, shape, parameter):
    """Weighted rows of one task. `parameter(numbers)` turns its numbers into symbols."""
    kind, frames = task["task"], shape.frames
    weights = task["weights"]
    number = lambda key: parameter(task[key])
    place = frames[task["frame"]] if "frame" in task else None
    metres = parameter([weights["metres"]]) if "metres" in weights else None
    radians = parameter([weights["radians"]]) if "radians" in weights else None
    at = place[:3, 3] if place is not None else None
    if kind == "point":
        return metres * (at - number("target"))
    if kind == "ray":
        through = number("through")
        d = unit(number("eye") - through)
        return metres * ((at - through) - d * ca.dot(d, at - through))
    if kind == "plane":
        return metres * ca.dot(unit(number("normal")), at - number("point"))
    if kind == "distance":
        other = frames[task["other"]][:3, 3]
        return metres * (ca.norm_2(at - other) - parameter([task["distance"]]))
    if kind in ("orientation", "pose"):
        target = ca.reshape(number("rotation"), 3, 3).T
        turn = radians * rotation_vector(place[:3, :3] @ target.T)
        return turn if kind == "orientation" else ca.vertcat(metres * (at - number("target")), turn)
    if kind == "look-at":
        axis = place[:3, :3] @ unit(number("axis"))
        sight = unit(number("target") - at)
        return radians * turn_between(ca.cross(axis, sight), ca.dot(axis, sight))
    if kind == "posture":
        return parameter([weights["joint units"]]) * (shape.x - number("reference"))
    if kind == "centring":
        middle, half = (shape.lower + shape.upper) / 2, (shape.upper - shape.lower) / 2
        return parameter([weights["ratio"]]) * (shape.x - middle) / half
    raise ValueError(f"no task {kind}")


def shape_of(statement):
    """Key of all properties except numbers: problems with equal keys share one compiled expression."""
    tasks = tuple(tuple((key, task.get(key)) for key in ("task", "frame", "other")) + tuple(task["weights"])
                  for task in statement["tasks"])
    return statement["model"], tasks


class Compiled:
    """The expressions of one shape of problem: residual, cost and gradient, as functions of x and p."""

    def __init__(self, statement):
        shape = model(statement["model"])
        symbols = []

        def parameter(numbers):
            symbols.append(ca.SX.sym(f"p{len(symbols)}", len(numbers)))
            return symbols[-1]

        weighted = ca.vertcat(*(rows(task, shape, parameter) for task in statement["tasks"]))
        x, p = shape.x, ca.vertcat(*symbols)
        cost = ca.dot(weighted, weighted) / 2
        self.nlp = {"x": x, "p": p, "f": cost}
        self.residual = ca.Function("r", [x, p], [weighted])
        self.jacobian = ca.Function("J", [x, p], [ca.jacobian(weighted, x)])
        self.cost = ca.Function("f", [x, p], [cost])
        self.slope = ca.Function("g", [x, p], [cost, ca.gradient(cost, x)])
        self.curvature = ca.Function("H", [x, p], [ca.hessian(cost, x)[0]])
        self.solvers = {}


_compiled = {}


class Problem:
    """One statement with its numbers."""

    def __init__(self, statement):
        shape = shape_of(statement)
        if shape not in _compiled:
            _compiled[shape] = Compiled(statement)
        self.compiled = _compiled[shape]
        self.model = model(statement["model"])
        self.lower, self.upper = self.model.lower, self.model.upper
        self.start = np.array(statement["start"])
        self.p = []
        for task in statement["tasks"]:
            rows(task, self.model, self._collect)
        self.p = np.array(self.p)

    def _collect(self, numbers):
        self.p.extend(float(v) for v in numbers)
        return ca.SX(ca.DM(numbers))

    def residual(self, x):
        return np.array(self.compiled.residual(x, self.p)).ravel()

    def jacobian(self, x):
        return np.array(self.compiled.jacobian(x, self.p))

    def cost(self, x):
        return float(self.compiled.cost(x, self.p))

    def slope(self, x):
        cost, gradient = self.compiled.slope(x, self.p)
        return float(cost), np.array(gradient).ravel()

    def project(self, x):
        return np.clip(x, self.lower, self.upper)

    def kkt(self, x):
        """|proj(x - gradient) - x|, largest entry: zero exactly where the KKT conditions hold."""
        _, gradient = self.slope(x)
        return float(np.max(np.abs(self.project(x - gradient) - x)))
