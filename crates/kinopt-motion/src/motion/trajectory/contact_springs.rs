//! Contacts by the method of multipliers (Hestenes 1969, "Multiplier and gradient methods"; Powell 1969).
//!
//! Stiff springs connect the points of consecutive samples. Their rest lengths move until nothing slides.

use nalgebra::DMatrix;

use super::block_banded::BlockBanded;
use super::stretch::SampleSpan;
use super::{Contact, MotionError, MotionProblem};
use kinopt_kinematics::model::{Model, ParameterMap};
use kinopt_solver::problem::{Evaluation, Problem, ProblemInstance, Scratch};
use kinopt_solver::solver::{LeastSquares, dot};
use kinopt_solver::task::{Point, Quantity};

/// Number of rows per point.
const ROWS_PER_POINT: usize = 3;

/// Weight of sliding, relative to the largest weight of a length.
const STIFFNESS_RATIO: f64 = 300.0;

/// Contact springs of consecutive samples, with the memory to evaluate them.
pub(super) struct ContactSprings<'a> {
    motion: &'a MotionProblem,
    scratch: Option<Scratch>,
    /// Weight of sliding, per metre.
    stiffness: f64,
    /// Rest offset of the spring to the next sample, metres, by sample and row.
    rest_offsets: Vec<f64>,
    /// Positions of the points at two samples, and their Jacobians by steps.
    positions: [Vec<f64>; 2],
    jacobians: [DMatrix<f64>; 2],
}

impl<'a> ContactSprings<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        let rows = motion
            .contact_points
            .as_ref()
            .map_or(0, |contact_points| contact_points.rows());
        Self {
            scratch: motion
                .contact_points
                .as_ref()
                .map(|contact_points| contact_points.scratch()),
            stiffness: motion.stiffness,
            rest_offsets: Vec::new(),
            positions: [vec![0.0; rows], vec![0.0; rows]],
            jacobians: [(); 2].map(|()| DMatrix::zeros(rows, motion.variables())),
            motion,
        }
    }

    fn rows(&self) -> usize {
        self.positions[0].len()
    }

    /// Resets the rest offsets for `frames` other samples.
    pub(super) fn reset(&mut self, frames: usize) {
        self.rest_offsets.clear();
        self.rest_offsets.resize(frames * self.rows(), 0.0);
    }

    /// Evaluates the points of a sample into the second entries. The previous ones move to the first.
    fn evaluate(&mut self, x: &[f64], differentiate: bool) {
        let (Some(contact_points), Some(scratch)) =
            (&self.motion.contact_points, &mut self.scratch)
        else {
            return;
        };
        self.positions.swap(0, 1);
        let mut evaluation = Evaluation::new(
            ProblemInstance::from(contact_points).by_variables(),
            scratch,
        );
        evaluation.residual(x, &mut self.positions[1]);
        if differentiate {
            self.jacobians.swap(0, 1);
            evaluation.jacobian(x, &mut self.jacobians[1]);
            let rows = self.jacobians[1].nrows();
            let entries = self.jacobians[1].as_mut_slice();
            self.motion.space.by_steps(x, rows, entries);
        }
    }

    /// Returns whether any contact is active at a sample and the next.
    fn is_active_over_step(&self, frame: usize) -> bool {
        let mut contacts = self.motion.contacts.iter();
        contacts.any(|contact| contact.is_active_over_step(frame))
    }

    /// Calls `visit` with local sample index, row and sliding for each active row between consecutive samples.
    fn for_each_active(
        &mut self,
        stretch: SampleSpan,
        x: &[f64],
        differentiate: bool,
        mut visit: impl FnMut(&mut Self, usize, usize, f64),
    ) {
        if self.motion.contact_points.is_none() {
            return;
        }
        let n = self.motion.variables();
        let frames = x.len() / n;
        let mut last_evaluated = None;
        // Fixed samples do not move relative to each other.
        for local in stretch.fixed_count.saturating_sub(1)..frames.saturating_sub(1) {
            if !self.is_active_over_step(stretch.first + local) {
                continue;
            }
            if last_evaluated != Some(local) {
                self.evaluate(&x[local * n..(local + 1) * n], differentiate);
            }
            self.evaluate(&x[(local + 1) * n..(local + 2) * n], differentiate);
            last_evaluated = Some(local + 1);
            let mut row = 0;
            for contact in &self.motion.contacts {
                let rows = row..row + ROWS_PER_POINT * contact.points.len();
                row = rows.end;
                if contact.is_active_over_step(stretch.first + local) {
                    for row in rows {
                        let slip = self.positions[1][row] - self.positions[0][row];
                        visit(self, local, row, slip);
                    }
                }
            }
        }
    }

    /// Returns the penalty ½ w² Σ (slip + rest)².
    pub(super) fn cost(&mut self, stretch: SampleSpan, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.for_each_active(stretch, x, false, |springs, local, row, slip| {
            let extension =
                springs.stiffness * (slip + springs.rest_offsets[local * springs.rows() + row]);
            sum += extension * extension;
        });
        0.5 * sum
    }

    /// Returns the same penalty, and adds its gradient and JᵀJ.
    pub(super) fn linearise(
        &mut self,
        stretch: SampleSpan,
        x: &[f64],
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) -> f64 {
        let n = self.motion.variables();
        let squared = self.stiffness * self.stiffness;
        let mut sum = 0.0;
        let (mut from, mut to) = (vec![0.0; n], vec![0.0; n]);
        let mut moving = Vec::with_capacity(n);
        self.for_each_active(stretch, x, true, |springs, local, row, slip| {
            let extension = slip + springs.rest_offsets[local * springs.rows() + row];
            sum += squared * extension * extension;
            moving.clear();
            for column in 0..n {
                from[column] = -springs.jacobians[0][(row, column)];
                to[column] = springs.jacobians[1][(row, column)];
                if from[column] != 0.0 || to[column] != 0.0 {
                    moving.push(column);
                }
            }
            for (k, &a) in moving.iter().enumerate() {
                gradient[local * n + a] += squared * from[a] * extension;
                gradient[(local + 1) * n + a] += squared * to[a] * extension;
                for &b in &moving[k..] {
                    hessian.add(local, 0, a, b, squared * from[a] * from[b]);
                    hessian.add(local + 1, 0, a, b, squared * to[a] * to[b]);
                }
                for &b in &moving {
                    hessian.add(local, 1, a, b, squared * from[a] * to[b]);
                }
            }
        });
        0.5 * sum
    }

    /// Updates the rest offsets. Returns the largest sliding between consecutive samples, metres.
    pub(super) fn update_multipliers(&mut self, stretch: SampleSpan, x: &[f64]) -> f64 {
        let mut max_sliding = 0.0_f64;
        self.for_each_active(stretch, x, false, |springs, local, row, slip| {
            let rows = springs.rows();
            springs.rest_offsets[local * rows + row] += slip;
            max_sliding = max_sliding.max(slip.abs());
        });
        max_sliding
    }

    /// Returns the largest distance of a contact point from its position at the start of the contact, metres.
    pub(super) fn slip(&mut self, stretch: SampleSpan, x: &[f64]) -> f64 {
        let mut max_sliding = 0.0_f64;
        // A contact has one span.
        let mut sums = vec![[0.0; ROWS_PER_POINT]; self.rows() / ROWS_PER_POINT];
        self.for_each_active(stretch, x, false, |_, _, row, slip| {
            let sum = &mut sums[row / ROWS_PER_POINT];
            sum[row % ROWS_PER_POINT] += slip;
            if row % ROWS_PER_POINT == ROWS_PER_POINT - 1 {
                max_sliding = max_sliding.max(dot(sum, sum).sqrt());
            }
        });
        max_sliding
    }
}

/// Builds one problem from the points of all contacts.
pub(super) fn contact_problem(
    model: &Model,
    map: &ParameterMap,
    contacts: &[Contact],
    frames: usize,
) -> Result<Option<Problem>, MotionError> {
    let mut points = Problem::builder(model);
    points.parameters(map.clone());
    let mut any = false;
    for contact in contacts {
        let span = contact.span();
        if span.end > frames || span.start + 2 > span.end {
            return Err(MotionError::BadSpan {
                start: span.start,
                end: span.end,
                frames,
            });
        }
        for &point in &contact.points {
            points.add(Point::new(contact.frame, [0.0; 3]).at(point));
            any = true;
        }
    }
    Ok(any.then(|| points.build()).transpose()?)
}

/// Returns the weight of contact sliding per metre, which is far above the weights of tasks.
pub(super) fn stiffness(problem: &Problem) -> f64 {
    let blocks = problem
        .compiled_tasks()
        .iter()
        .flat_map(|task| task.blocks());
    let metres = blocks.filter(|block| block.measure.quantity == Quantity::Metres);
    STIFFNESS_RATIO * metres.map(|block| block.weight).fold(1.0, f64::max)
}
