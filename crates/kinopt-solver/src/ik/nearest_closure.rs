//! Loop closure nearest to a start configuration.

use std::f64::consts::TAU;

use super::{Restarts, Solution, SolveError, Solver, Workspace};
use crate::problem::{Problem, ProblemInstance};
use crate::search::{slide_per_radian, variables_at};
use crate::solver::half_squared;
use kinopt_kinematics::model::Source;
use kinopt_kinematics::random::RandomStream;

/// Number of additional starts, sampled no further from the start than the nearest known closure. Beyond this number,
/// no nearer closure is assumed to exist.
const SAMPLES: u64 = 32;
/// Improvement below which two closures count as equally near, radians.
const DISTANCE_TOLERANCE: f64 = 1e-6;

/// Loop problem with its start variables.
pub(super) struct NearestClosure<'a> {
    problem: &'a Problem,
    start: Vec<f64>,
    /// Variables per unit of distance: 1 for angles, the equivalent of 1 radian for prismatic joints.
    units: Vec<f64>,
}

impl<'a> NearestClosure<'a> {
    /// # Errors
    /// Returns the errors of a solver for an invalid start.
    pub(super) fn new(problem: &'a Problem, start: &[f64]) -> Result<Self, SolveError> {
        let length_per_radian = slide_per_radian(problem);
        let angles = problem.names().variable_is_angle.iter();
        Ok(Self {
            problem,
            start: variables_at(ProblemInstance::from(problem), start)?,
            units: angles
                .map(|&angle| if angle { 1.0 } else { length_per_radian })
                .collect(),
        })
    }

    /// Returns the nearest closure, or the solution of the first search if that leaves loops open.
    ///
    /// # Errors
    /// Returns the errors of the solver.
    pub(super) fn close(&self, solver: &Solver) -> Result<Solution, SolveError> {
        let map = self.problem.parameters();
        let mut q = vec![0.0; self.problem.configuration_len()];
        map.scatter_within_limits(&self.start, &mut q);
        let mut nearest = solver.solve_once(self.problem, &q)?;
        if !nearest.loops_closed() {
            return Ok(nearest);
        }
        let mut x = vec![0.0; self.start.len()];
        let mut distance = self.unwind(&mut nearest.q, &mut x);
        let single_attempt = solver.clone().with_restarts(Restarts::none());
        let mut workspace = Workspace::new();
        for index in 0..SAMPLES {
            if distance < DISTANCE_TOLERANCE {
                break;
            }
            self.sample(index, distance, &mut x);
            map.scatter_within_limits(&x, &mut q);
            let solution = single_attempt.solve(self.problem, &q, &mut workspace)?;
            if !solution.loops_closed() {
                continue;
            }
            q.copy_from_slice(&solution.q);
            let closure_distance = self.unwind(&mut q, &mut x);
            if closure_distance < distance - DISTANCE_TOLERANCE {
                distance = closure_distance;
                nearest.q.copy_from_slice(&q);
            }
        }
        Ok(nearest)
    }

    /// Samples variables at most `distance` from the start.
    fn sample(&self, index: u64, distance: f64, x: &mut [f64]) {
        let mut random = RandomStream::new(0, index);
        x.fill_with(|| 2.0 * random.unit() - 1.0);
        let length = (2.0 * half_squared(x)).sqrt();
        let radius = distance * random.unit() / length.max(f64::MIN_POSITIVE);
        for ((x, start), unit) in x.iter_mut().zip(&self.start).zip(&self.units) {
            *x = start + radius * unit * *x;
        }
        ProblemInstance::from(self.problem).space().project(x);
    }

    /// Removes full revolutions away from the start from revolute joints, and returns the distance to the start,
    /// radians.
    fn unwind(&self, q: &mut [f64], x: &mut [f64]) -> f64 {
        let map = self.problem.parameters();
        map.gather(q, x);
        let balls = map.balls();
        let mut squared_distance = 0.0;
        for (k, (x, start)) in x.iter_mut().zip(&self.start).enumerate() {
            if balls
                .iter()
                .any(|ball| (ball.variable..ball.variable + 3).contains(&k))
            {
                continue;
            }
            let revolutions = TAU * ((start - *x) / TAU).round();
            let (lower, upper) = (self.problem.lower()[k], self.problem.upper()[k]);
            let is_within_bounds = lower <= *x + revolutions && *x + revolutions <= upper;
            if revolutions != 0.0 && is_within_bounds && self.has_single_joint(k) {
                *x += revolutions;
                q[map.leaders()[k]] = *x;
            }
            let displacement = (*x - start) / self.units[k];
            squared_distance += displacement * displacement;
        }
        let balls = balls.iter().map(|ball| ball.angle_between(&self.start, x));
        (squared_distance + balls.map(|angle| angle * angle).sum::<f64>()).sqrt()
    }

    /// Returns whether a variable is an angle with exactly one joint, that is, without mimic joints.
    fn has_single_joint(&self, variable: usize) -> bool {
        let is_of_variable = |source: &&Source| {
            source
                .slope()
                .is_some_and(|(source_variable, _)| source_variable == variable)
        };
        let sources = self
            .problem
            .parameters()
            .sources()
            .iter()
            .filter(is_of_variable);
        self.problem.names().variable_is_angle[variable] && sources.count() == 1
    }
}
