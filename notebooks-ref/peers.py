"""Inverse kinematics solvers from PyPI, each as one function from target and start to joint values.

A peer with its own restarts gets the time limit. A single local search is started again from random
configurations (`restarted`) until it succeeds or the time is over.
"""

import contextlib
import json
import os
import subprocess
import tempfile
import time
import warnings

import casadi as ca
import nlopt
import numpy as np
import pinocchio as pin

from models import REPOSITORY, read
from problem import Problem
from tools import IPOPT, by_nlopt, by_scipy, at_most

SEED = 20261121
TOLERANCE = 1e-6  # metres and radians
TIME_LIMIT_S = 0.5
ARMS = {"panda": ("base", "tool", 7), "ur5e": ("base", "flange", 6)}
COMMAND = REPOSITORY / "target" / "release" / "kinopt"


class Arm:
    """A robot's chain and its limits, with Pinocchio as the judge of all solutions."""

    def __init__(self, name):
        self.name = name
        self.base, self.tip, self.joints = ARMS[name]
        self.model = read(name)
        self.file = str(REPOSITORY / self.model.file)
        self.pin = pin.buildModelFromUrdf(self.file, mimic=True)
        self.data = self.pin.createData()
        self.frame = self.pin.getFrameId(self.tip, pin.FrameType.BODY)
        self.lower, self.upper = self.model.lower[: self.joints], self.model.upper[: self.joints]

    def whole(self, q):
        """q with the joints that do not move the tip, at rest."""
        return np.concatenate([q, self.model.rest()[self.joints:]])

    def place(self, q):
        pin.framesForwardKinematics(self.pin, self.data, self.whole(q))
        return self.data.oMf[self.frame].copy()

    def judge(self, q, target):
        """Returns true if q is within its limits and puts the tip on the target."""
        q = None if q is None else np.asarray(q, float).ravel()
        if q is None or q.shape != (self.joints,) or not np.all(np.isfinite(q)):
            return False
        if np.any(q < self.lower) or np.any(q > self.upper):
            return False
        at = self.place(q)
        turn = np.linalg.norm(pin.log3(at.rotation @ target.rotation.T))
        return np.linalg.norm(at.translation - target.translation) <= TOLERANCE and turn <= TOLERANCE

    def workload(self, count):
        rng = np.random.default_rng([SEED, len(self.name)])
        draw = lambda: rng.uniform(self.lower, self.upper)
        return [(self.place(draw()), draw()) for _ in range(count)]


def restarted(arm, search):
    """A local search from the start, then from random configurations, until one succeeds."""

    def solve(target, start):
        rng = np.random.default_rng(SEED)
        end = time.process_time() + TIME_LIMIT_S
        while True:
            q = search(target, start)
            if arm.judge(q, target) or time.process_time() > end:
                return q
            start = rng.uniform(arm.lower, arm.upper)

    return solve


def pinocchio_loop(arm):
    """The damped least-squares loop of Pinocchio's examples, with clamping."""

    def search(target, q):
        for _ in range(200):
            at = arm.place(q)
            error = pin.log6(at.actInv(target)).vector
            if np.linalg.norm(error) < 0.1 * TOLERANCE:
                break
            J = pin.computeFrameJacobian(arm.pin, arm.data, arm.whole(q), arm.frame, pin.LOCAL)[:, : arm.joints]
            q = np.clip(q + J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(6), error), arm.lower, arm.upper)
        return q

    return restarted(arm, search)


def least_squares(arm, tool):
    """A tool of notebook 2 on the cost 1/2 |position error|^2 + 1/2 |0.3 m/rad rotation vector|^2."""
    statement = {"model": arm.name, "start": arm.whole(np.zeros(arm.joints)), "tasks": [
        {"task": "pose", "frame": arm.tip, "target": np.zeros(3), "rotation": np.eye(3).ravel(),
         "weights": {"metres": 1.0, "radians": 0.3}}]}
    problem = Problem(statement)

    def search(target, start):
        # The order of the statement's numbers in the parameters.
        problem.p = np.concatenate([[1.0, 0.3], target.rotation.ravel(), target.translation])
        x, _ = tool(problem, arm.whole(start))
        return problem.project(x)[: arm.joints]

    at = arm.place((arm.lower + arm.upper) / 2 * 0.9)
    check = problem_check(statement, at)
    problem.p = np.concatenate([[1.0, 0.3], at.rotation.ravel(), at.translation])
    assert np.allclose(problem.p, check.p), "the order of parameters has changed"
    return restarted(arm, search)


def problem_check(statement, at):
    task = {**statement["tasks"][0], "target": at.translation, "rotation": at.rotation.ravel()}
    return Problem({**statement, "tasks": [task]})


def quick_ipopt(problem, start):
    solvers = problem.compiled.solvers
    if "quick" not in solvers:
        options = {**IPOPT, "ipopt.tol": 1e-10, "ipopt.max_iter": 100}
        solvers["quick"] = ca.nlpsol("quick", "ipopt", problem.compiled.nlp, options)
    found = solvers["quick"](x0=start, p=problem.p, lbx=problem.lower, ubx=problem.upper)
    return np.array(found["x"]).ravel(), True


def optik(arm):
    import optik
    robot = optik.Robot.from_urdf_file(arm.file, arm.base, arm.tip)
    robot.set_parallelism(1)
    # OptIK's tolerance is on a squared error.
    config = optik.SolverConfig("speed", max_time=TIME_LIMIT_S, tol_f=0.1 * TOLERANCE**2, tol_df=-1.0, tol_dx=-1.0)

    def solve(target, start):
        found = robot.ik(config, target.homogeneous, list(start))
        return None if found is None else np.array(found[0])

    return solve


def trac_ik(arm):
    from trac_ik import TracIK
    solver = TracIK(arm.base, arm.tip, arm.file, timeout=TIME_LIMIT_S, epsilon=0.3 * TOLERANCE)

    def solve(target, start):
        found = solver.ik(target.translation, target.rotation, start)
        # This peer has limits in single precision, so a result can exceed them by 5e-9 rad.
        return None if found is None else np.clip(found, arm.lower, arm.upper)

    return solve


def robotics_toolbox(arm):
    import roboticstoolbox as rtb
    with warnings.catch_warnings(), contextlib.redirect_stdout(None):
        warnings.simplefilter("ignore")
        ets = rtb.Robot.URDF(arm.file).ets(start=arm.base, end=arm.tip)

    def search(target, start):
        return ets.ik_LM(target.homogeneous, q0=start, ilimit=30, slimit=1, tol=0.1 * TOLERANCE**2, joint_limits=True).q

    return restarted(arm, search)


def ikpy(arm):
    import ikpy.chain
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        chain = ikpy.chain.Chain.from_urdf_file(arm.file, base_elements=[arm.base], symbolic=False)
    moving = [k for k, link in enumerate(chain.links) if link.joint_type == "revolute"]
    chain.active_links_mask = np.isin(np.arange(len(chain.links)), moving)

    def search(target, start):
        whole = np.zeros(len(chain.links))
        whole[moving] = np.clip(start, arm.lower + 1e-9, arm.upper - 1e-9)
        return chain.inverse_kinematics_frame(target.homogeneous, initial_position=whole, orientation_mode="all")[moving]

    return restarted(arm, search)


def pink(arm):
    import pink
    import qpsolvers
    assert "daqp" in qpsolvers.available_solvers
    task = pink.tasks.FrameTask(arm.tip, position_cost=1.0, orientation_cost=0.3, lm_damping=1e-9)

    def search(target, start):
        task.set_target(target)
        configuration = pink.Configuration(arm.pin, arm.data, arm.whole(start))
        for _ in range(100):
            if np.linalg.norm(task.compute_error(configuration)) < 0.3 * TOLERANCE:
                break
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                velocity = pink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=[configuration.model.configuration_limit],
                                         safety_break=False)
            configuration.integrate_inplace(velocity, 1.0)
        return np.clip(configuration.q[: arm.joints], arm.lower, arm.upper)

    return restarted(arm, search)


def eaik(arm):
    """Closed form, for six joints: all solutions, of which one within the limits counts."""
    if arm.joints != 6:
        return None
    from eaik.IK_URDF import UrdfRobot
    robot = UrdfRobot(arm.file)
    # EAIK has no tool: its tip is the last joint's origin, without rotation at zero.
    zero, last = arm.place(np.zeros(6)), robot.fwdKin(np.zeros(6))
    tool = zero.translation - last[:3, 3]

    def solve(target, start):
        wanted = np.eye(4)
        wanted[:3, :3] = target.rotation @ zero.rotation.T
        wanted[:3, 3] = target.translation - wanted[:3, :3] @ tool
        answers = [q for q in robot.IK(wanted).Q]
        return next((q for q in answers if arm.judge(q, target)), answers[0] if answers else None)

    return solve


PEERS = {
    "OptIK": optik,
    "TRAC-IK": trac_ik,
    "EAIK (closed form)": eaik,
    "Robotics Toolbox LM": robotics_toolbox,
    "Pinocchio loop": pinocchio_loop,
    "NLopt SLSQP": lambda arm: least_squares(arm, by_nlopt(nlopt.LD_SLSQP, at_most(200))),
    "NLopt L-BFGS": lambda arm: least_squares(arm, by_nlopt(nlopt.LD_LBFGS, at_most(400))),
    "SciPy trf": lambda arm: least_squares(arm, by_scipy("trf")),
    "CasADi IPOPT": lambda arm: least_squares(arm, quick_ipopt),
    "Pink": pink,
    "IKPy": ikpy,
}


def timed(arm, peer, workload):
    """Processor seconds and success for every target; None if the peer does not support the arm."""
    solve = peer(arm)
    if solve is None:
        return None
    solve(*workload[0])  # what is loaded at the first call does not count
    seconds, solved = [], []
    for target, start in workload:
        begun = time.process_time()
        try:
            q = solve(target, start.copy())
        except Exception:  # a peer that gives up by an exception has not solved it
            q = None
        seconds.append(time.process_time() - begun)
        solved.append(arm.judge(q, target))
    return np.array(seconds), np.array(solved)


def by_command(arm, workload, *options):
    """The equivalent by kinopt's command, which reports the time of each target without its own start."""
    def numbers(target):
        x, y, z, w = pin.Quaternion(target.rotation).coeffs()
        return [float(v) for v in (*target.translation, w, x, y, z)]

    document = {
        "base_link": arm.base, "tip_link": arm.tip, "joint_names": arm.model.variables[: arm.joints],
        "targets": [numbers(target) for target, _ in workload],
        "starts": [[float(v) for v in start] for _, start in workload],
    }
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(document, file)
        file.flush()
        printed = subprocess.run([COMMAND, "batch", arm.file, "--targets", file.name, "--json",
                                  "--tolerance", str(TOLERANCE), *options], check=True, capture_output=True, text=True)
    answers = json.loads(printed.stdout)
    order = [answers["joints"].index(name) for name in document["joint_names"]]
    seconds = np.array([s["micros"] * 1e-6 for s in answers["solutions"]])
    solved = [arm.judge([s["q"][k] for k in order], target) for s, (target, _) in zip(answers["solutions"], workload)]
    return seconds, np.array(solved)


@contextlib.contextmanager
def one_core():
    """Pins everything, including threads of peers and kinopt's command, to one core."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
