"""Solvers of a problem from one start: CasADi with IPOPT, NLopt and SciPy."""

import warnings

import casadi as ca
import nlopt
import numpy as np
import scipy
import scipy.optimize

IPOPT = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-13,
    "ipopt.acceptable_iter": 0,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 300,
    "error_on_fail": False,
}


def ipopt(problem, start):
    """Interior point method with the exact Hessian of the cost."""
    solvers = problem.compiled.solvers
    if "ipopt" not in solvers:
        solvers["ipopt"] = ca.nlpsol("ipopt", "ipopt", problem.compiled.nlp, IPOPT)
    solver = solvers["ipopt"]
    found = solver(x0=start, p=problem.p, lbx=problem.lower, ubx=problem.upper)
    return np.array(found["x"]).ravel(), bool(solver.stats()["success"])


def at_most(count):
    return lambda variables: count


def by_nlopt(algorithm, evaluations, local=None):
    def solve(problem, start):
        best = [np.inf, start]
        lower, upper = problem.lower, problem.upper
        if local is not None:  # a global method needs ends to sample between
            lower = np.where(np.isfinite(lower), lower, start - np.pi)
            upper = np.where(np.isfinite(upper), upper, start + np.pi)

        def objective(x, gradient):
            if gradient.size:
                cost, gradient[:] = problem.slope(x)
            else:
                cost = problem.cost(x)
            if cost < best[0]:
                best[:] = cost, x.copy()
            return cost

        def method(name):
            optimiser = nlopt.opt(name, len(start))
            optimiser.set_lower_bounds(lower)
            optimiser.set_upper_bounds(upper)
            optimiser.set_xtol_rel(1e-14)
            optimiser.set_ftol_rel(1e-15)
            return optimiser

        nlopt.srand(1)
        optimiser = method(algorithm)
        optimiser.set_min_objective(objective)
        optimiser.set_maxeval(evaluations(len(start)))
        if local is not None:
            inner = method(local)
            inner.set_ftol_rel(1e-15)
            inner.set_maxeval(300)
            optimiser.set_local_optimizer(inner)
        try:
            optimiser.optimize(start)
            code = optimiser.last_optimize_result()
        except (RuntimeError, nlopt.RoundoffLimited):
            code = -1
        # 5 is the limit on evaluations: the normal end of a global method only.
        return best[1], code > 0 and (code != 5 or local is not None)

    return solve


def by_scipy(method):
    def solve(problem, start):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = scipy.optimize.least_squares(
                problem.residual, start, jac=problem.jacobian, bounds=(problem.lower, problem.upper),
                method=method, ftol=1e-15, xtol=1e-15, gtol=1e-15, max_nfev=200)
        return found.x, found.status > 0

    return solve


TOOLS = {
    "CasADi IPOPT": ipopt,
    "NLopt SLSQP": by_nlopt(nlopt.LD_SLSQP, at_most(600)),
    "NLopt L-BFGS": by_nlopt(nlopt.LD_LBFGS, at_most(2000)),
    "NLopt MMA": by_nlopt(nlopt.LD_MMA, at_most(500)),
    # Its quadratic models cost n^2 per step, so problems with many variables get few steps.
    "NLopt BOBYQA": by_nlopt(nlopt.LN_BOBYQA, lambda variables: 1500 if variables <= 10 else 300),
    "NLopt MLSL": by_nlopt(nlopt.G_MLSL_LDS, at_most(2500), local=nlopt.LD_LBFGS),
    "SciPy trf": by_scipy("trf"),
    "SciPy dogbox": by_scipy("dogbox"),
}


def versions():
    return f"CasADi {ca.__version__} with IPOPT, NLopt {nlopt.__version__}, SciPy {scipy.__version__}"
