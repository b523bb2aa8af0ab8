"""Solves statements by every tool, judges the solutions, and groups them into local minima."""

import itertools
import multiprocessing
import os

import numpy as np

from problem import Problem, shape_of
from tools import TOOLS, ipopt

# Largest KKT residual that counts as stationary, in units of the cost per joint unit.
STATIONARY = 1e-7
# Costs that differ by less than this fraction, or lie below this cost, belong to one minimum.
SAME_COST, NO_COST = 1e-6, 1e-12
RANDOM_STARTS = 3


def answer(problem, solve, start):
    x, claims = solve(problem, start)
    x = problem.project(x)  # tools may leave the bounds by rounding
    return {"x": [float(v) for v in x], "cost": problem.cost(x), "kkt": problem.kkt(x), "success": bool(claims)}


def solve(statement, number):
    """The statement with every tool's solution, and the list of local minima."""
    problem = Problem(statement)
    start = problem.start
    answers = {tool: answer(problem, solve, start) for tool, solve in TOOLS.items()}
    ends = list(answers.items())
    rng = np.random.default_rng([number, 7])
    for k in range(RANDOM_STARTS):
        ends.append((f"CasADi IPOPT from random start {k + 1}", answer(problem, ipopt, problem.model.sample(rng))))
    minima = minima_of(ends, start)
    best = min(range(len(minima)), key=lambda k: minima[k]["cost"], default=None)
    nearest = min(range(len(minima)), key=lambda k: minima[k]["distance"], default=None)
    return {**statement, "answers": answers, "minima": minima, "best": best, "nearest": nearest}


def minima_of(ends, start):
    """Stationary solutions grouped by cost. Redundant models have families of minimisers of one cost. Such a family
    is one minimum here, at the distance of its member nearest to the start.
    """
    stationary = sorted((end for end in ends if end[1]["kkt"] <= STATIONARY), key=lambda end: end[1]["cost"])
    minima = []
    for tool, end in stationary:
        distance = float(np.linalg.norm(np.array(end["x"]) - start))
        last = minima[-1] if minima else None
        if last and end["cost"] <= max(NO_COST, last["cost"] * (1 + SAME_COST)):
            last["by"].append(tool)
            last["distance"] = min(last["distance"], distance)
        else:
            minima.append({"cost": end["cost"], "distance": distance, "by": [tool]})
    return minima


def _solve_group(group):
    return [(number, solve(statement, number)) for number, statement in group]


def solve_all(statements, processes=None):
    """Solves all statements on all cores. Statements of one shape are together, so that each shape is compiled once."""
    numbered = sorted(enumerate(statements), key=lambda s: repr(shape_of(s[1])))
    groups = []
    for _, group in itertools.groupby(numbered, key=lambda s: repr(shape_of(s[1]))):
        group = list(group)
        groups += [group[k:k + 14] for k in range(0, len(group), 14)]
    groups.sort(key=len, reverse=True)
    processes = processes or len(os.sched_getaffinity(0))
    with multiprocessing.Pool(processes) as pool:
        done = [pair for part in pool.imap_unordered(_solve_group, groups) for pair in part]
    return [record for _, record in sorted(done, key=lambda pair: pair[0])]
