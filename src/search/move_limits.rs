//! How far joints may go from a configuration: a step of a controller, a frame of a drag.

use super::{SolveError, check_start};
use crate::bad_option::{AT_LEAST_0, BadOption};
use crate::problem::{Problem, Question};
use crate::solver::TurnLimit;

/// A slide moves as far as a joint at this share of the model's reach would carry it.
const REACH_PER_RADIAN: f64 = 0.25;
/// Half a turn is as far as a ball can be turned.
const FARTHEST_TURN: f64 = std::f64::consts::PI;
/// A ball that may turn by less than this, in radians, stays where it is: quaternions tell no less.
const LEAST_TURN: f64 = 1e-12;

/// How far the joints of one problem may go from where they stand, hard: `|q − q₀|` of a hinge or a slide, to the bit,
/// and of a ball the angle between its two rotations, to the rounding of quaternions. A free joint's slides and its
/// ball are limited one by one. What would go further is told among the
/// [`active_limits`](super::Solution::active_limits) as a [`BoundKind::Move`](super::BoundKind::Move).
///
/// A joint that follows another is limited through that one, too.
///
/// ```
/// use kinopt::ik::{MoveLimits, Solver};
/// use kinopt::model::Model;
/// use kinopt::problem::{Problem, Question};
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
/// // 2 rad/s for a hundredth of a second.
/// let start = model.neutral();
/// let moves = MoveLimits::new(&problem, &[0.02; 4], &start)?;
/// let step = Solver::default().solve_once(Question::from(&problem).with_moves(&moves)?, &start)?;
/// let mut turned = [0.0; 3];
/// model.difference(&start, &step.q, &mut turned)?;
/// assert!((turned[2] - 0.02).abs() < 1e-9);
/// let held: Vec<_> = step.active_limits().map(|limit| limit.joint).collect();
/// assert_eq!(held, ["shoulder"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MoveLimits {
    /// By variable; infinite for those of a ball.
    most: Vec<f64>,
    turns: Vec<TurnLimit>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The three variables of balls that must not turn.
    still: Vec<usize>,
    /// Whether `|q − q₀|`, as rounded, is within the move, too.
    to_the_bit: bool,
}

impl MoveLimits {
    /// Moves of at most so much from `start`, in radians and metres: one for every number of a configuration, of
    /// which those of a ball's quaternion are the same; infinity for no limit. [`Robot::moves_within`] has them
    /// from speeds.
    ///
    /// [`Robot::moves_within`]: crate::robot::Robot::moves_within
    ///
    /// # Errors
    /// Another number of moves, one that is negative or NaN, or four of a ball that are not the same; a start as
    /// [`Solver::solve`](crate::Solver::solve) refuses it.
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

    /// Moves by an angle at most from `start`, in radians, of slides as far as a joint would carry what is a quarter
    /// of the model's reach away.
    ///
    /// # Errors
    /// A number that is not above 0; a start as [`Solver::solve`](crate::Solver::solve) refuses it.
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

    /// Lowers the moves to these, by variable; those of a ball are its angle.
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
                Some(turn) => turn.most = turn.most.min(angle),
                None => self.limit_turn(problem, first, angle),
            }
        }
    }

    /// Limits the turn of the ball whose variables begin here.
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

    /// Takes for the start another configuration, from which moves are limited alike.
    ///
    /// # Errors
    /// A start as [`Solver::solve`](crate::Solver::solve) refuses it.
    pub fn start_at(&mut self, problem: &Problem, start: &[f64]) -> Result<(), SolveError> {
        check_start(problem, start)?;
        let mut x = vec![0.0; problem.variables()];
        problem.parameters().gather(start, &mut x);
        Question::from(problem).space().project(&mut x);
        self.start_from(problem, &x);
        Ok(())
    }

    /// As [`start_at`](Self::start_at), for variables within the problem's limits. Allocates nothing.
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

impl<'a> Question<'a> {
    /// The same with no joint going further than these moves.
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

    /// [`with_moves`](Self::with_moves) of the same problem.
    pub(crate) fn near(self, moves: &'a MoveLimits) -> Self {
        self.within(&moves.lower, &moves.upper, &moves.turns)
    }
}

/// How far a slide moves for what weighs as much as a radian.
pub(crate) fn slide_per_radian(problem: &Problem) -> f64 {
    match problem.reach() {
        reach if reach > 0.0 => REACH_PER_RADIAN * reach,
        _ => 1.0,
    }
}

/// `start + by`, rounded so that it is no further away than `by` in floating point.
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
