"""Writes tests/reference/motions.json: short clips within position and velocity limits, each minimised by IPOPT as
one problem.

`models.py` reads the robots. A clip's targets are tool positions along a random motion. From some frame on they
are shifted, so that velocity limits become active. Tasks and differences of velocities, accelerations or jerks
form one cost. Position limits are bounds, and velocity limits are linear constraints. IPOPT starts at the clip's
own start. A result counts if the first-order conditions hold. `notebooks-ref/run` runs this script.
"""

import casadi as ca
import numpy as np

import fixtures
from models import read
from tools import IPOPT

SEED = 20261123
ROBOTS = {"panda": ["tool"], "ur5e": ["flange"], "iiwa14": ["flange"], "baxter": ["left_tool", "right_tool"]}
CLIPS = 20
# Tolerances of the first-order conditions and of the constraints.
STATIONARY, KEPT = 1e-7, 1e-9


def smooth(rng, frames, count):
    """Waves of `count` numbers over the frames, approximately within ±1."""
    time = np.linspace(0, 1, frames)[:, None]
    phase, rate = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.5, 1.5, count)
    return np.sin(2 * np.pi * rate * time + phase)


class Clip:
    def __init__(self, number):
        rng = np.random.default_rng([SEED, number])
        name = list(ROBOTS)[number % len(ROBOTS)]
        self.model = model = read(name)
        self.tips, self.robot = ROBOTS[name], name
        self.frames, self.step = int(rng.integers(8, 17)), float(rng.choice([0.01, 0.02, 0.05]))
        # A motion in the middle of the ranges, with velocity limits close to its velocities.
        low = np.maximum(model.lower, -np.pi)
        high = np.minimum(model.upper, np.pi)
        middle, half = (low + high) / 2, (high - low) / 2
        base = middle + half * rng.uniform(-0.6, 0.6, len(middle))
        motion = base + 0.15 * half * smooth(rng, self.frames, len(middle))
        motion = np.clip(motion, model.lower, model.upper)
        fastest = np.abs(np.diff(motion, axis=0)).max(axis=0) / self.step
        self.speed = np.round(np.maximum(fastest * rng.uniform(0.5, 1.5), 0.01), 3)
        place = ca.Function("place", [model.x], [model.frames[tip][:3, 3] for tip in self.tips])
        self.place = place
        aside = rng.normal(0, 0.15, (len(self.tips), 3))
        leap = int(rng.integers(2, self.frames - 1))
        self.targets = np.array([[np.array(p).ravel() + (frame >= leap) * aside[k]
                                  for k, p in enumerate(self.placed(x))] for frame, x in enumerate(motion)])
        self.weights = np.where(rng.random((self.frames, len(self.tips))) < 0.1, 0.0, 1.0)
        self.order = 1 + number % 3
        self.rate = float(10 ** rng.uniform(-2, -0.5) * self.step**self.order)
        self.first = motion[0] if rng.random() < 0.5 else None
        self.last = None
        if rng.random() < 0.3:
            # Configurations that are reachable from the first one in time.
            reach = 0.4 * self.speed * self.step * (self.frames - 1)
            from_first = motion[0] + rng.uniform(-1, 1, len(reach)) * reach
            self.last = np.clip(from_first, model.lower + 1e-3, model.upper - 1e-3)
        self.start = np.repeat(motion[:1], self.frames, axis=0)

    def placed(self, x):
        found = self.place(x)
        return found if isinstance(found, tuple) else (found,)

    def solve(self):
        n = len(self.model.lower)
        x = [ca.MX.sym(f"x{frame}", n) for frame in range(self.frames)]
        cost = 0
        for frame, own in enumerate(x):
            for tip, place in enumerate(self.placed(own)):
                miss = self.weights[frame, tip] * (place - self.targets[frame, tip])
                cost += ca.dot(miss, miss) / 2
        rows = x
        for _ in range(self.order):
            rows = [(b - a) / self.step for a, b in zip(rows, rows[1:])]
        cost += sum(ca.dot(row, row) for row in rows) * self.rate**2 / 2
        moves = ca.vertcat(*[b - a for a, b in zip(x, x[1:])])
        all_x = ca.vertcat(*x)
        lower, upper = (np.tile(ends, (self.frames, 1)) for ends in (self.model.lower, self.model.upper))
        for frame, fixed in ((0, self.first), (self.frames - 1, self.last)):
            if fixed is not None:
                lower[frame] = upper[frame] = fixed
        most = np.tile(self.speed * self.step, self.frames - 1)
        nlp = {"x": all_x, "f": cost, "g": moves}
        solver = ca.nlpsol("clip", "ipopt", nlp, {**IPOPT, "ipopt.max_iter": 1000})
        found = solver(x0=self.start.ravel(), lbx=lower.ravel(), ubx=upper.ravel(), lbg=-most, ubg=most)
        values, force, held = (np.array(found[key]).ravel() for key in ("x", "lam_g", "lam_x"))
        slope = ca.Function("slope", [all_x], [ca.gradient(cost, all_x), ca.jacobian(moves, all_x)])
        gradient, by = (np.array(v) for v in slope(values))
        left = gradient.ravel() + by.T @ force + held
        way = by @ values
        # Complementarity: a nonzero multiplier needs an active bound.
        idle = np.concatenate([np.minimum(np.maximum(force, 0), most - way), np.minimum(np.maximum(-force, 0), way + most),
                               np.minimum(np.maximum(held, 0), upper.ravel() - values),
                               np.minimum(np.maximum(-held, 0), values - lower.ravel())])
        size = 1 + np.abs(gradient).max()
        good = np.abs(left).max() <= STATIONARY * size and np.nanmax(np.where(np.isfinite(idle), idle, 0)) <= STATIONARY
        kept = np.maximum(np.abs(way) - most, 0).max() <= KEPT
        bind = int((np.abs(np.abs(way) - most) < 1e-6).sum())
        return good and kept, float(found["f"]), bind, np.round(values.reshape(self.frames, -1), 2)


def main():
    problems, number = [], 0
    while len(problems) < CLIPS and number < 3 * CLIPS:
        clip = Clip(number)
        good, cost, bind, near = clip.solve()
        number += 1
        if not good:
            continue
        as_list = lambda values: None if values is None else np.asarray(values).tolist()
        problems.append({"robot": clip.model.file, "tips": clip.tips, "variables": clip.model.variables,
                         "time_step_s": clip.step, "order": clip.order, "rate": clip.rate, "max_speeds": as_list(clip.speed),
                         "targets": as_list(clip.targets), "weights": as_list(clip.weights), "first": as_list(clip.first),
                         "last": as_list(clip.last), "cost": cost, "near": as_list(near),
                         "moves_at_their_limit": bind})
    print(f"{len(problems)} clips of {number}")
    fixtures.write("motions.json", "CasADi + IPOPT", ca.__version__, SEED, "motions.py",
                   "metres, radians, seconds; targets by frame and tip; near: the variables of the minimum to two decimals; "
                   "cost = sum over frames of |weight (place - target)|^2 / 2 + |rate (difference of an order / time_step_s^order)|^2 / 2",
                   problems=problems)


if __name__ == "__main__":
    main()
