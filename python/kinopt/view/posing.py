"""Solvers and options that pose a body for the targets on the page."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import kinopt
from kinopt import tasks

from .body import Body
from .balance import DRAGGED, PINNED
from .closing import closed
from .transforms import inverse

Array = NDArray[np.float64]

#: Follows the mouse without jumps: a path follower for an arm, a drag for everything else.
FOLLOW = "follow the mouse"
#: Searches for arms only, independent for each target.
ARM_SEARCHES = {
    "arm: from the current pose": "start",
    "arm: nearest": "nearest",
    "arm: first solution": "first",
}
#: Methods for any problem, independent for each target.
GEOMETRIC_METHODS = ("ccd", "fabrik")
METHODS = ("levenberg-marquardt", "gauss-newton", "projected-gradient", "ccd", "fabrik")
#: Largest joint displacement in a frame of a body at rest, radians or metres.
MOTION_TOLERANCE = 1e-6
#: Nominal postures in the null space of the targets.
POSTURES = ("pose when grabbed", "rest", "none")


@dataclass(frozen=True)
class Goal:
    """Goal of one frame: its `placement` (world_from_frame), with the orientation if `turns`.

    A `pinned` frame stays while others are dragged: the feet of a standing body.
    """

    frame: str
    placement: Array
    turns: bool
    pinned: bool = False


@dataclass(frozen=True)
class Choices:
    """Choices of the user on the page."""

    solver: str = FOLLOW
    #: Metres (for rigs, the rig's unit) and radians within which a target counts as reached.
    tolerance: float = 1e-6
    posture: str = POSTURES[0]
    #: True to keep the other frames of a character in place.
    holds: bool = True


@dataclass
class Answer:
    """Configuration of the body, with the errors of its targets."""

    q: Array
    solution: Any
    #: Duration of the solve, seconds.
    seconds: float
    #: True if the body continues to move with constant targets.
    goes_on: bool
    #: Text about a jump to another branch; only with searches.
    jump_text: str | None = None


class Posing:
    """Solves for moving goals, from the current configuration.

    Arms, problems and drags are kept until the goals or a choice change.
    """

    def __init__(self, body: Body, world: kinopt.World | None = None, margin: float = 0.0) -> None:
        self.body = body
        self.choices: Choices = Choices()
        #: Obstacles of collision avoidance, with the margin in metres; None disables it.
        self.world: kinopt.World | None = world
        self.margin: float = margin
        #: Holds of a character by dragged frame: frames that stay, bones that stay.
        self._engine: _Engine | None = None
        self._engine_key: tuple[Any, ...] = ()

    def choose(self, **choices: Any) -> None:
        """Changes choices by name."""
        self.choices = replace(self.choices, **choices)
        self.state_anew()

    def state_anew(self) -> None:
        """Makes the next solve create its problem again, from the current configuration."""
        self._engine = None

    def _clear_of(self) -> dict[str, Any]:
        """Collision avoidance options of arms and problems."""
        return {} if self.world is None else {"world": self.world, "margin": self.margin}

    def solvers(self) -> list[str]:
        """Names of the solvers for this body."""
        arms = list(ARM_SEARCHES) if isinstance(self.body.thing, kinopt.Robot) else []
        return [FOLLOW, *arms, *METHODS]

    def solve(self, goals: list[Goal]) -> Answer | None:
        """One frame: the body's next configuration for these goals; None without goals."""
        if not goals:
            return None
        moved = 0 if self.world is None else self.world.revision
        engine_key = (self.choices, moved, tuple((goal.frame, goal.turns) for goal in goals))
        if self._engine is None or engine_key != self._engine_key:
            self._engine = self._state(goals)
            self._engine_key = engine_key
        begun = time.perf_counter()
        answer = self._engine.advance({goal.frame: self._target(goal) for goal in goals}, self.body.q)
        answer.seconds = time.perf_counter() - begun
        return answer

    def with_joint(self, joint: str, value: float, goals: list[Goal]) -> Answer:
        """The body with one joint at a value, and the goals met by the others as far as possible."""
        self.body.standing()
        q = self.body.q
        moving = self.body.model.coordinate_names
        q[moving.index(joint)] = value
        follows = kinopt.ParameterMap(self.body.thing)
        q = follows.expand(follows.reduce(q))
        self.state_anew()
        if not goals:
            closed_q = closed(self.body.thing, q, joint)
            # Loops limit the motion of the joint.
            return Answer(self.body.q if closed_q is None else closed_q, None, 0.0, False)
        begun = time.perf_counter()
        locked = kinopt.ParameterMap(self.body.thing, lock={joint: float(q[moving.index(joint)])})
        problem = kinopt.Problem(
            self.body.thing,
            self._tasks(goals),
            parameters=locked,
            tolerance=self.choices.tolerance,
            **self._clear_of(),
        )
        targets = {goal.frame: self._target(goal) for goal in goals}
        solution = kinopt.Drag(problem, q, max_move=np.inf).follow(targets, frames=20)
        return Answer(solution.q, solution, time.perf_counter() - begun, False)

    def _target(self, goal: Goal) -> Array:
        target = inverse(self.body.at) @ goal.placement
        return target if goal.turns else target[:3, 3]

    def _tasks(self, goals: list[Goal]) -> list[Any]:
        goal_tasks = []
        for goal in goals:
            kind = tasks.Pose if goal.turns else tasks.Point
            level = DRAGGED if self.body.stands and not goal.pinned else PINNED
            goal_tasks.append(kind(goal.frame, self._target(goal), name=goal.frame, level=level))
        return goal_tasks

    def _reference(self) -> Array | None:
        match self.choices.posture:
            case "rest":
                neutral: Array = self.body.model.neutral()
                return neutral
            case "none":
                return None
        return self.body.q

    def _state(self, goals: list[Goal]) -> _Engine:
        self.body.standing()
        choices, thing = self.choices, self.body.thing
        alone = len(goals) == 1 and isinstance(thing, kinopt.Robot)
        # A path follower stops before an obstacle; a drag slides along it.
        arms = ARM_SEARCHES if self.world is not None else (FOLLOW, *ARM_SEARCHES)
        if alone and choices.solver in arms:
            arm = self._arm(goals[0])
            if arm is not None:
                search = choices.solver != FOLLOW
                return _ArmEngine(arm, goals[0], self.body.q, search)
        all_tasks = self._tasks(goals)
        reference = self._reference()
        parameters = None
        holding = None
        if choices.holds:
            pinned = [goal.frame for goal in goals if goal.pinned]
            holding = self.body.holding([goal.frame for goal in goals], self.body.q, reference, pinned)
        if holding is not None:
            all_tasks += holding.tasks
            parameters = holding.parameters
        if choices.solver in GEOMETRIC_METHODS:
            # Geometric methods support required tasks only.
            all_tasks = [task for task in all_tasks if not isinstance(task, (tasks.Posture, tasks.SupportPolygon))]
        elif reference is not None and not (holding and holding.has_posture):
            weights: Literal["upright"] | None = "upright" if self.body.stands else None
            all_tasks.append(tasks.Posture(reference, name="posture", joint_weights=weights))
        problem = kinopt.Problem(
            thing, all_tasks, parameters=parameters, tolerance=choices.tolerance, **self._clear_of()
        )
        if choices.solver in METHODS:
            return _SolverEngine(problem, kinopt.Solver(choices.solver))
        return _DragEngine(kinopt.Drag(problem, self.body.q))

    def _arm(self, goal: Goal) -> Any:
        """The arm from the world to a robot's frame; None if nothing moves there."""
        reference = self._reference()
        options: dict[str, Any] = {
            "position_tolerance": self.choices.tolerance,
            "orientation_tolerance": self.choices.tolerance,
            "search": ARM_SEARCHES.get(self.choices.solver),
            "goal": kinopt.PoseBounds.pose() if goal.turns else kinopt.PoseBounds.position(),
            **self._clear_of(),
        }
        try:
            arm = kinopt.Arm(self.body.thing, None, goal.frame, **options)
            if reference is not None and self.choices.solver == FOLLOW:
                options["posture"] = arm.joint_values(reference)
                arm = kinopt.Arm(self.body.thing, None, goal.frame, **options)
        except kinopt.KinoptError:
            return None
        return arm


class _Engine:
    def advance(self, targets: Mapping[str, Array], q: Array) -> Answer:
        raise NotImplementedError


class _ArmEngine(_Engine):
    """One tip of a robot, solved by an arm."""

    def __init__(self, arm: Any, goal: Goal, q: Array, search: bool) -> None:
        self._arm, self._turns, self._search = arm, goal.turns, search
        self._follower = None if search else arm.follower(arm.joint_values(q))

    def advance(self, targets: Mapping[str, Array], q: Array) -> Answer:
        (target,) = targets.values()
        if not self._turns:
            target = np.block([[np.eye(3), target[:, None]], [np.zeros((1, 3)), 1.0]])
        jump = None
        if self._follower is None:
            solution = self._arm.solve(target, self._arm.joint_values(q))
            jump_text = None
        else:
            solution, jump = self._follower.advance(target)
            jump_text = None if jump is None or not jump.reconfiguration else f"{jump.joint} jumped by {jump.distance:.2g}"
        settled = self._arm.configuration(solution.q, q)
        # A path follower that misses comes nearer frame by frame, until it is at rest.
        goes_on = self._follower is not None and not solution.reached
        return Answer(settled, solution, 0.0, goes_on and np.abs(settled - q).max() > MOTION_TOLERANCE, jump_text)


class _SolverEngine(_Engine):
    """An independent search for each target."""

    def __init__(self, problem: Any, solver: Any) -> None:
        self._problem, self._solver = problem, solver

    def advance(self, targets: Mapping[str, Array], q: Array) -> Answer:
        solution = self._solver.solve(self._problem, q, dict(targets))
        return Answer(solution.q, solution, 0.0, False)


class _DragEngine(_Engine):
    """Follows the mouse without jumps, frame by frame."""

    def __init__(self, drag: Any) -> None:
        self._drag = drag

    def advance(self, targets: Mapping[str, Array], q: Array) -> Answer:
        solution = self._drag.advance(dict(targets))
        goes_on = self._drag.is_speed_limited or not (solution.reached or self._drag.is_at_rest)
        return Answer(solution.q, solution, 0.0, goes_on)
