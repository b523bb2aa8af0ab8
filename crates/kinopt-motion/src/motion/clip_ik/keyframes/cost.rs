//! Cost of keys: squared distances of bones from their targets at many sample times.

use nalgebra::{DMatrix, DVector};

use super::basis::KeyAngle;
use super::interior::Cost;
use crate::motion::clip_ik::{ClipIkError, Reach};
use kinopt_animation::animation::{EulerClip, Playback};
use kinopt_kinematics::skeleton::Skeleton;
use kinopt_solver::problem::{Evaluation, Problem, Scratch, Targets, TaskId};
use kinopt_solver::solver::LeastSquares;
use kinopt_solver::task::Point;

/// Sample time of the clip.
#[derive(Debug)]
struct Sample {
    /// Values of the problem's variables in the clip.
    x: Vec<f64>,
    targets: Targets,
    /// Weights of the rows of each reach.
    weights: Vec<f64>,
    /// Variable of the problem, index of the key's angle, and derivative of the former with respect to the latter.
    gains: Vec<(usize, usize, f64)>,
}

/// ½ Σ ‖w r‖² over sample times, and ½ λ² ‖Δ‖².
#[derive(Debug)]
pub(super) struct KeyCost {
    problem: Problem,
    scratch: Scratch,
    samples: Vec<Sample>,
    change_weight: f64,
    residual: Vec<f64>,
    jacobian: DMatrix<f64>,
}

/// Number of rows of a point.
const ROWS_PER_POINT: usize = 3;

impl KeyCost {
    pub(super) fn new(
        (skeleton, clip): (&Skeleton, &EulerClip),
        reaches: &[Reach],
        keys: &[KeyAngle],
        times: &[f64],
        (span, change_weight): ([f64; 2], f64),
    ) -> Result<Self, ClipIkError> {
        // Keys may exceed their limits, which are rows instead of bounds.
        let model = skeleton.model().without_limits();
        let mut builder = Problem::builder(&model);
        let tasks: Vec<TaskId<Point>> = reaches
            .iter()
            .map(|reach| builder.add(Point::new(skeleton.tip(reach.bone), [0.0; 3])))
            .collect();
        let problem = builder.build()?;
        let map = problem.parameters();
        let (variables, rows) = (problem.variables(), problem.rows());
        let mut q = vec![0.0; skeleton.angles()];
        let mut samples = Vec::with_capacity(times.len());
        for &time in times {
            clip.sample(time, Playback::Hold, &mut q)?;
            let mut x = vec![0.0; variables];
            map.gather(&q, &mut x);
            let mut targets = problem.targets();
            let mut weights = Vec::with_capacity(reaches.len());
            for (reach, &task) in reaches.iter().zip(&tasks) {
                targets
                    .get_mut(task)?
                    .set_target(reach.target(time).to_array());
                weights.push(reach.weight(time, span));
            }
            let gains = keys.iter().enumerate().filter_map(|(k, key)| {
                let gain = key.gain(time);
                let (variable, ratio) = map.sources()[key.coordinate].slope()?;
                (gain != 0.0).then(|| (variable, k, gain / ratio))
            });
            let gains = gains.collect();
            samples.push(Sample {
                x,
                targets,
                weights,
                gains,
            });
        }
        Ok(Self {
            scratch: problem.scratch(),
            residual: vec![0.0; rows],
            jacobian: DMatrix::zeros(rows, variables),
            problem,
            samples,
            change_weight,
        })
    }

    /// Returns the distance of each reach from its target at sample times with full weight.
    pub(super) fn misses(
        &mut self,
        keys: &DVector<f64>,
    ) -> Result<Vec<Vec<Option<f64>>>, ClipIkError> {
        let mut all_misses = Vec::with_capacity(self.samples.len());
        for k in 0..self.samples.len() {
            self.evaluate(k, keys, false)?;
            let weights = self.samples[k]
                .weights
                .iter()
                .zip(self.residual.chunks(ROWS_PER_POINT));
            let miss = weights.map(|(weight, rows)| {
                (*weight >= 1.0).then(|| kinopt_solver::solver::dot(rows, rows).sqrt())
            });
            all_misses.push(miss.collect());
        }
        Ok(all_misses)
    }

    fn evaluate(
        &mut self,
        index: usize,
        keys: &DVector<f64>,
        differentiate: bool,
    ) -> Result<(), ClipIkError> {
        let sample = &self.samples[index];
        let mut x = sample.x.clone();
        for &(variable, key, gain) in &sample.gains {
            x[variable] += gain * keys[key];
        }
        let instance = self.problem.with_targets(&sample.targets)?;
        let mut evaluation = Evaluation::new(instance, &mut self.scratch);
        evaluation.residual(&x, &mut self.residual);
        if differentiate {
            evaluation.jacobian(&x, &mut self.jacobian);
        }
        Ok(())
    }

    fn sum(
        &mut self,
        keys: &DVector<f64>,
        mut visit: impl FnMut(&Self, usize),
    ) -> Result<f64, ClipIkError> {
        let mut sum = self.change_weight * self.change_weight * keys.norm_squared();
        for k in 0..self.samples.len() {
            self.evaluate(k, keys, true)?;
            let weighted = self.samples[k]
                .weights
                .iter()
                .zip(self.residual.chunks(ROWS_PER_POINT));
            sum += weighted
                .map(|(w, rows)| w * w * kinopt_solver::solver::dot(rows, rows))
                .sum::<f64>();
            visit(self, k);
        }
        Ok(0.5 * sum)
    }
}

impl Cost for KeyCost {
    type Error = ClipIkError;

    fn value(&mut self, keys: &DVector<f64>) -> Result<f64, ClipIkError> {
        self.sum(keys, |_, _| {})
    }

    fn linearise(
        &mut self,
        keys: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Result<f64, ClipIkError> {
        let squared = self.change_weight * self.change_weight;
        gradient.copy_from(&(keys * squared));
        hessian.fill(0.0);
        hessian.fill_diagonal(squared);
        self.sum(keys, |cost, k| {
            let sample = &cost.samples[k];
            for (row, residual) in cost.residual.iter().enumerate() {
                let weight = sample.weights[row / ROWS_PER_POINT];
                let weight = weight * weight;
                if weight == 0.0 {
                    continue;
                }
                for &(variable, a, gain) in &sample.gains {
                    let slope = weight * gain * cost.jacobian[(row, variable)];
                    gradient[a] += slope * residual;
                    for &(other, b, gain) in &sample.gains {
                        hessian[(a, b)] += slope * gain * cost.jacobian[(row, other)];
                    }
                }
            }
        })
    }
}
