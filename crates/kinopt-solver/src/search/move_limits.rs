//! Limits of joint displacements from a configuration, for a control step or a frame of a drag.

use super::{SolveError, check_start};
use crate::problem::{Problem, ProblemInstance};
use crate::solver::TurnLimit;
use kinopt_kinematics::bad_option::{AT_LEAST_0, BadOption};

/// Displacement of a prismatic joint that corresponds to one radian, relative to the model's reach.
const REACH_PER_RADIAN: f64 = 0.25;
/// Largest rotation angle of a ball joint, radians.
const MAX_TURN_ANGLE: f64 = std::f64::consts::PI;
/// Smallest angle of a ball joint's move, radians; smaller moves lock the joint, as quaternions cannot resolve them.
const MIN_TURN_ANGLE: f64 = 1e-12;

/// Hard limits of the displacements of a problem's joints from a start.
///
/// For a revolute or prismatic joint the displacement is `|q − q₀|`, and the limit holds exactly. For a ball joint it
/// is the angle between its two rotations, up to the rounding of quaternions. The prismatic joints and the ball of a
/// free joint have separate limits. A mimic joint is limited through its source joint.
///
/// A limit that stops a joint is one of the [`active_limits`](super::Solution::active_limits), with the kind
/// [`BoundKind::Move`](super::BoundKind::Move).
///
/// ```
/// use kinopt::ik::{MoveLimits, Solver};
/// use kinopt::model::Model;
/// use kinopt::problem::{Problem, ProblemInstance};
/// use kinopt::spatial::{Placement, Vector3};
/// use kinopt::task::Point;
///
/// let mut builder = Model::builder("arm");
/// let x = Vector3::new(1.0, 0.0, 0.0);
/// let shoulder = builder.ball("shoulder", None, Placement::identity(), x, None);
/// let hand = builder.frame("hand", Some(shoulder), x);
/// let model = builder.build()?;
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Point::new(hand, [0.0, 1.0, 0.0]));
/// let problem = tasks.build()?;
///
/// // 2 rad/s for 0.01 s.
/// let start = model.neutral();
/// let moves = MoveLimits::new(&problem, &[0.02; 4], &start)?;
/// let step = Solver::default().solve_once(ProblemInstance::from(&problem).with_moves(&moves)?, &start)?;
/// let mut turned = [0.0; 3];
/// model.difference(&start, &step.q, &mut turned)?;
/// assert!((turned[2] - 0.02).abs() < 1e-9);
/// let held: Vec<_> = step.active_limits().map(|limit| limit.joint).collect();
/// assert_eq!(held, ["shoulder"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MoveLimits {
    /// Largest displacement by variable; infinite for the variables of a ball joint.
    max_moves: Vec<f64>,
    turns: Vec<TurnLimit>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// First of the three variables of each locked ball joint.
    locked_balls: Vec<usize>,
    /// The limit also holds exactly for the rounded difference `|q − q₀|`.
    is_exact: bool,
}

impl MoveLimits {
    /// Limits displacements from `start`, in radians and metres. `max_moves` has the length of a configuration; the
    /// four numbers of a ball joint are equal. Infinity is no limit. `Robot::moves_within` computes them from
    /// velocity limits.
    ///
    /// # Errors
    /// A wrong number of moves, a move that is negative or NaN, or four moves of a ball joint that differ. Also a start
    /// that [`Solver::solve`](crate::Solver::solve) rejects.
    pub fn new(problem: &Problem, max_moves: &[f64], start: &[f64]) -> Result<Self, SolveError> {
        if max_moves.len() != problem.configuration_len() {
            return Err(SolveError::MovesLength {
                model: problem.names().model.clone(),
                given: max_moves.len(),
                expected: problem.configuration_len(),
            });
        }
        for &max_move in max_moves {
            BadOption::check("max_move", max_move, AT_LEAST_0)?;
        }
        let map = problem.parameters();
        let mut limits = Self::of_variables(problem, map.least_by_variable(max_moves), true);
        for ball in map.balls() {
            let ball_moves = &max_moves[ball.coordinate..ball.coordinate + 4];
            if ball_moves.iter().any(|max_move| *max_move != ball_moves[0]) {
                let joint = &problem.names().joints[ball.variable];
                return Err(SolveError::MovesOfBall {
                    joint: joint.clone(),
                });
            }
            limits.limit_turn(problem, ball.variable, ball_moves[0]);
        }
        limits.start_at(problem, start)?;
        Ok(limits)
    }

    /// Limits displacements from `start` by an angle in radians. For prismatic joints a radian corresponds to a quarter
    /// of the model's reach.
    ///
    /// # Errors
    /// An angle that is not above 0, or a start that [`Solver::solve`](crate::Solver::solve) rejects.
    pub fn by_angle(problem: &Problem, radians: f64, start: &[f64]) -> Result<Self, SolveError> {
        let is_positive = |radians| radians > 0.0;
        BadOption::check("max_move", radians, (is_positive, "a number above 0"))?;
        let mut limits = Self::of_variables(problem, Vec::new(), false);
        limits.set_angle(problem, radians);
        limits.start_at(problem, start)?;
        Ok(limits)
    }

    fn of_variables(problem: &Problem, max_moves: Vec<f64>, is_exact: bool) -> Self {
        Self {
            max_moves,
            turns: Vec::new(),
            lower: problem.lower().to_vec(),
            upper: problem.upper().to_vec(),
            locked_balls: Vec::new(),
            is_exact,
        }
    }

    /// Sets the angle of [`by_angle`](Self::by_angle).
    pub(crate) fn set_angle(&mut self, problem: &Problem, radians: f64) {
        let angles = problem.names().variable_is_angle.iter();
        let metres_per_radian = slide_per_radian(problem);
        self.max_moves.clear();
        self.max_moves.extend(angles.map(|&angle| match angle {
            true => radians,
            false => radians * metres_per_radian,
        }));
        self.turns.clear();
        self.locked_balls.clear();
        for ball in problem.parameters().balls() {
            self.max_moves[ball.variable..ball.variable + 3].fill(f64::INFINITY);
            self.limit_turn(problem, ball.variable, radians);
        }
    }

    /// Lowers the limits to `steps`, by variable. The first variable of a ball joint holds its angle.
    pub(crate) fn lower_to(&mut self, problem: &Problem, steps: &[f64]) {
        for (max_move, step) in self.max_moves.iter_mut().zip(steps) {
            *max_move = max_move.min(*step);
        }
        for ball in problem.parameters().balls() {
            let first = ball.variable;
            self.max_moves[first..first + 3].fill(f64::INFINITY);
            let angle = steps[first];
            let turn_limit = self
                .turns
                .iter_mut()
                .find(|turn| turn.variables().start == first);
            match turn_limit {
                Some(turn) => turn.max_angle = turn.max_angle.min(angle),
                None => self.limit_turn(problem, first, angle),
            }
        }
    }

    /// Limits the rotation of the ball joint whose variables start at `first`.
    fn limit_turn(&mut self, problem: &Problem, first: usize, max_angle: f64) {
        let mut balls = problem.parameters().balls().iter();
        let Some(ball) = balls.find(|ball| ball.variable == first) else {
            return;
        };
        if max_angle < MIN_TURN_ANGLE {
            self.locked_balls.push(first);
        } else if max_angle < MAX_TURN_ANGLE {
            let turn = TurnLimit::from_zero(first, ball.chart, [0.0; 3], max_angle);
            self.turns.push(turn);
        }
    }

    /// Sets another start with equal limits.
    ///
    /// # Errors
    /// A start that [`Solver::solve`](crate::Solver::solve) rejects.
    pub fn start_at(&mut self, problem: &Problem, start: &[f64]) -> Result<(), SolveError> {
        check_start(problem, start)?;
        let mut x = vec![0.0; problem.variables()];
        problem.parameters().gather(start, &mut x);
        ProblemInstance::from(problem).space().project(&mut x);
        self.start_from(problem, &x);
        Ok(())
    }

    /// As [`start_at`](Self::start_at), for variables within the problem's limits. Does not allocate.
    pub(crate) fn start_from(&mut self, problem: &Problem, x: &[f64]) {
        let limits = problem.lower().iter().zip(problem.upper());
        let bounds = self.lower.iter_mut().zip(&mut self.upper);
        let is_exact = self.is_exact;
        let bound = |x: f64, displacement: f64| {
            if is_exact {
                within(x, displacement)
            } else {
                x + displacement
            }
        };
        for ((&x, &max_move), ((lower, upper), (&low, &high))) in
            x.iter().zip(&self.max_moves).zip(bounds.zip(limits))
        {
            (*lower, *upper) = (bound(x, -max_move).max(low), bound(x, max_move).min(high));
        }
        for &first in &self.locked_balls {
            let variables = first..first + 3;
            self.lower[variables.clone()].copy_from_slice(&x[variables.clone()]);
            self.upper[variables.clone()].copy_from_slice(&x[variables]);
        }
        for turn in &mut self.turns {
            turn.centre_at(x);
        }
    }
}

impl<'a> ProblemInstance<'a> {
    /// Limits the displacements of joints from a start.
    ///
    /// # Errors
    /// Moves of a problem with other variables.
    pub fn with_moves(self, moves: &'a MoveLimits) -> Result<Self, SolveError> {
        match moves.lower.len() == self.variables() {
            true => Ok(self.near(moves)),
            false => Err(SolveError::ForeignMoves {
                model: self.problem.names().model.clone(),
                given: moves.lower.len(),
                expected: self.variables(),
            }),
        }
    }

    /// As [`with_moves`](Self::with_moves), for moves of this problem.
    pub(crate) fn near(self, moves: &'a MoveLimits) -> Self {
        self.within(&moves.lower, &moves.upper, &moves.turns)
    }
}

/// Displacement of a prismatic joint that corresponds to one radian.
#[doc(hidden)]
pub fn slide_per_radian(problem: &Problem) -> f64 {
    match problem.reach() {
        reach if reach > 0.0 => REACH_PER_RADIAN * reach,
        _ => 1.0,
    }
}

/// `start + displacement`, rounded such that its computed distance from `start` is at most `displacement`.
#[doc(hidden)]
pub fn within(start: f64, displacement: f64) -> f64 {
    let end = start + displacement;
    if end.is_infinite() || (end - start).abs() <= displacement.abs() {
        end
    } else if displacement > 0.0 {
        end.next_down()
    } else {
        end.next_up()
    }
}
