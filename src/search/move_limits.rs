//! Limits of joint displacements from a configuration, for a control step or a frame of a drag.

use super::{SolveError, check_start};
use crate::bad_option::{AT_LEAST_0, BadOption};
use crate::problem::{Problem, ProblemInstance};
use crate::solver::TurnLimit;

/// Displacement of a prismatic joint that corresponds to one radian, relative to the model's reach.
const REACH_PER_RADIAN: f64 = 0.25;
/// Largest rotation angle of a ball joint, radians.
const FARTHEST_TURN: f64 = std::f64::consts::PI;
/// Smallest angle of a ball joint's move, radians; smaller moves lock the joint, as quaternions cannot resolve them.
const LEAST_TURN: f64 = 1e-12;

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
    most: Vec<f64>,
    turns: Vec<TurnLimit>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// First of the three variables of each locked ball joint.
    still: Vec<usize>,
    /// The limit also holds exactly for the rounded difference `|q − q₀|`.
    to_the_bit: bool,
}

impl MoveLimits {
    /// Limits displacements from `start`, in radians and metres. `most` has the length of a configuration; the four
    /// numbers of a ball joint are equal. Infinity is no limit. [`Robot::moves_within`] computes them from velocity
    /// limits.
    ///
    /// [`Robot::moves_within`]: crate::robot::Robot::moves_within
    ///
    /// # Errors
    /// A wrong number of moves, a move that is negative or NaN, or four moves of a ball joint that differ. Also a start
    /// that [`Solver::solve`](crate::Solver::solve) rejects.
    pub fn new(problem: &Problem, most: &[f64], start: &[f64]) -> Result<Self, SolveError> {
        if most.len() != problem.configuration_len() {
            return Err(SolveError::MovesLength {
                model: problem.names().model.clone(),
                given: most.len(),
                expected: problem.configuration_len(),
            });
        }
        for &most in most {
            BadOption::check("max_move", most, AT_LEAST_0)?;
        }
        let map = problem.parameters();
        let mut own = Self::of_variables(problem, map.least_by_variable(most), true);
        for ball in map.balls() {
            let four = &most[ball.coordinate..ball.coordinate + 4];
            if four.iter().any(|most| *most != four[0]) {
                let joint = &problem.names().joints[ball.variable];
                return Err(SolveError::MovesOfBall {
                    joint: joint.clone(),
                });
            }
            own.limit_turn(problem, ball.variable, four[0]);
        }
        own.start_at(problem, start)?;
        Ok(own)
    }

    /// Limits displacements from `start` by an angle in radians. For prismatic joints a radian corresponds to a quarter
    /// of the model's reach.
    ///
    /// # Errors
    /// An angle that is not above 0, or a start that [`Solver::solve`](crate::Solver::solve) rejects.
    pub fn by_angle(problem: &Problem, radians: f64, start: &[f64]) -> Result<Self, SolveError> {
        let above = |radians| radians > 0.0;
        BadOption::check("max_move", radians, (above, "a number above 0"))?;
        let mut own = Self::of_variables(problem, Vec::new(), false);
        own.set_angle(problem, radians);
        own.start_at(problem, start)?;
        Ok(own)
    }

    fn of_variables(problem: &Problem, most: Vec<f64>, to_the_bit: bool) -> Self {
        Self {
            most,
            turns: Vec::new(),
            lower: problem.lower().to_vec(),
            upper: problem.upper().to_vec(),
            still: Vec::new(),
            to_the_bit,
        }
    }

    /// Sets the angle of [`by_angle`](Self::by_angle).
    pub(crate) fn set_angle(&mut self, problem: &Problem, radians: f64) {
        let angles = problem.names().variable_is_angle.iter();
        let slide = slide_per_radian(problem);
        self.most.clear();
        self.most.extend(angles.map(|&angle| match angle {
            true => radians,
            false => radians * slide,
        }));
        self.turns.clear();
        self.still.clear();
        for ball in problem.parameters().balls() {
            self.most[ball.variable..ball.variable + 3].fill(f64::INFINITY);
            self.limit_turn(problem, ball.variable, radians);
        }
    }

    /// Lowers the limits to `steps`, by variable. The first variable of a ball joint holds its angle.
    pub(crate) fn lower_to(&mut self, problem: &Problem, steps: &[f64]) {
        for (most, step) in self.most.iter_mut().zip(steps) {
            *most = most.min(*step);
        }
        for ball in problem.parameters().balls() {
            let first = ball.variable;
            self.most[first..first + 3].fill(f64::INFINITY);
            let angle = steps[first];
            let known = self
                .turns
                .iter_mut()
                .find(|turn| turn.variables().start == first);
            match known {
                Some(turn) => turn.max_angle = turn.max_angle.min(angle),
                None => self.limit_turn(problem, first, angle),
            }
        }
    }

    /// Limits the rotation of the ball joint whose variables start at `first`.
    fn limit_turn(&mut self, problem: &Problem, first: usize, most: f64) {
        let mut balls = problem.parameters().balls().iter();
        let Some(ball) = balls.find(|ball| ball.variable == first) else {
            return;
        };
        if most < LEAST_TURN {
            self.still.push(first);
        } else if most < FARTHEST_TURN {
            let turn = TurnLimit::from_zero(first, ball.chart, [0.0; 3], most);
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
        let to_the_bit = self.to_the_bit;
        let end = |x: f64, by: f64| if to_the_bit { within(x, by) } else { x + by };
        for ((&x, &most), ((lower, upper), (&low, &high))) in
            x.iter().zip(&self.most).zip(bounds.zip(limits))
        {
            (*lower, *upper) = (end(x, -most).max(low), end(x, most).min(high));
        }
        for &first in &self.still {
            let three = first..first + 3;
            self.lower[three.clone()].copy_from_slice(&x[three.clone()]);
            self.upper[three.clone()].copy_from_slice(&x[three]);
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
pub(crate) fn slide_per_radian(problem: &Problem) -> f64 {
    match problem.reach() {
        reach if reach > 0.0 => REACH_PER_RADIAN * reach,
        _ => 1.0,
    }
}

/// `start + by`, rounded such that its computed distance from `start` is at most `by`.
pub(crate) fn within(start: f64, by: f64) -> f64 {
    let end = start + by;
    if end.is_infinite() || (end - start).abs() <= by.abs() {
        end
    } else if by > 0.0 {
        end.next_down()
    } else {
        end.next_up()
    }
}
