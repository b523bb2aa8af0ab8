//! Derivatives of a problem's rows by its parameters: targets, weights and joint origins.

use super::{Evaluation, ParameterVector};
use crate::task::{CHUNK, DualScratch, ErasedResidual};
use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::kinematics::joint_rotations;
use kinopt_kinematics::model::Model;
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Workspace for derivatives by parameters.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParameterScratch {
    step: Vec<Dual<CHUNK>>,
    dual: DualScratch,
    rows: Vec<f64>,
    /// For each row of a task, its coefficient before weighting.
    coefficients: Vec<f64>,
    rotations: Vec<Matrix3<f64>>,
    /// For each joint, the force on it and on its descendants, or its velocity.
    by_joint: Vec<Vector3<f64>>,
}

impl Evaluation<'_> {
    /// Adds the derivatives of `factor` · cᵀr by the parameters to `slopes`, for the weighted rows r at x.
    ///
    /// `coefficients` is c, one entry for each row of the whole problem. With a model, joint origins are parameters
    /// too.
    pub(crate) fn add_parameter_slopes(
        &mut self,
        x: &[f64],
        (coefficients, factor): (&[f64], f64),
        model: Option<&Model>,
        scratch: &mut ParameterScratch,
        slopes: &mut ParameterVector,
    ) {
        self.forward(x);
        let problem = self.instance.problem;
        let model = model.filter(|_| !slopes.joint_origins().is_empty());
        scratch.by_joint.clear();
        scratch
            .by_joint
            .resize(slopes.joint_origins().len(), Vector3::zero());
        let mut first_block = 0;
        for (index, task) in problem.tasks.iter().enumerate() {
            let task_block = first_block;
            first_block += task.blocks.len();
            let c = &coefficients[task.rows.clone()];
            if c.iter().all(|c| *c == 0.0) {
                continue;
            }
            Self::gather(self.scratch, task);
            let residual = self.instance.residual(index);
            let target = slopes.target_mut(index);
            scratch.coefficients.clear();
            let weighted = c.iter().zip(&task.weights);
            scratch
                .coefficients
                .extend(weighted.map(|(c, weight)| factor * c * weight));
            let (frames, joints) = self.scratch.task_inputs();
            if !target.is_empty()
                && !residual.add_target_slopes(frames, joints, &scratch.coefficients, target)
            {
                scratch.load_constants((frames, joints), task.rows.len());
                for first in (0..target.len()).step_by(CHUNK) {
                    let count = CHUNK.min(target.len() - first);
                    scratch.differentiate_target(residual, target.len(), first, count);
                    for (row, coefficient) in
                        scratch.dual.residual.iter().zip(&scratch.coefficients)
                    {
                        let slopes = target[first..first + count].iter_mut();
                        for (slope, derivative) in slopes.zip(row.derivatives()) {
                            *slope += coefficient * derivative;
                        }
                    }
                }
            }
            scratch.rows.resize(task.rows.len(), 0.0);
            residual.evaluate(frames, joints, &mut scratch.rows);
            let blocks = task.blocks.iter();
            for (block, slope) in blocks.zip(slopes.weights_of(task_block, task)) {
                let rows = block.rows_after(task.rows.start, 0);
                let terms = c[rows.clone()].iter().zip(&scratch.rows[rows]);
                *slope += factor * terms.map(|(c, row)| c * row).sum::<f64>();
            }
            if let Some(model) = model {
                Self::differentiate(self.scratch, task, residual);
                for (k, &slot) in task.frames.iter().enumerate() {
                    let parts = self.scratch.local().linear(k).iter().zip(c);
                    let force = parts.fold(Vector3::zero(), |sum, (&part, &c)| sum + part * c);
                    let frame = &model.frames()[self.instance.tree().frame(slot).index()];
                    if let Some(joint) = frame.joint {
                        scratch.by_joint[joint.index()] += force;
                    }
                }
            }
        }
        let Some(model) = model else {
            return;
        };
        joint_rotations(model, self.scratch.q(), &mut scratch.rotations);
        for (index, joint) in model.joints().iter().enumerate().rev() {
            let force = scratch.by_joint[index];
            let force_in_parent = match joint.parent {
                Some(parent) => {
                    scratch.by_joint[parent.index()] += force;
                    scratch.rotations[parent.index()].transpose_mul(force)
                }
                None => force,
            };
            slopes.joint_origins_mut()[index] += force_in_parent * factor;
        }
    }

    /// Writes the derivatives of one task's weighted rows at x by its target, parameter by parameter.
    pub(crate) fn rows_by_target(
        &mut self,
        x: &[f64],
        index: usize,
        scratch: &mut ParameterScratch,
        columns: &mut Vec<f64>,
    ) {
        self.forward(x);
        columns.clear();
        let Some(task) = self.instance.problem.tasks.get(index) else {
            return;
        };
        Self::gather(self.scratch, task);
        let residual = self.instance.residual(index);
        scratch.load_constants(self.scratch.task_inputs(), task.rows.len());
        let len = residual.target_len();
        for first in (0..len).step_by(CHUNK) {
            let count = CHUNK.min(len - first);
            scratch.differentiate_target(residual, len, first, count);
            for k in 0..count {
                let rows = scratch.dual.residual.iter().zip(&task.weights);
                columns.extend(rows.map(|(row, weight)| weight * row.derivatives()[k]));
            }
        }
    }

    /// Writes the rates of the whole problem's weighted rows at x for given rates of its parameters.
    pub(crate) fn rows_by_parameters(
        &mut self,
        x: &[f64],
        rates: &ParameterVector,
        model: Option<&Model>,
        scratch: &mut ParameterScratch,
        rows: &mut [f64],
    ) {
        self.forward(x);
        rows.fill(0.0);
        let problem = self.instance.problem;
        let model = model.filter(|_| !rates.joint_origins().is_empty());
        if let Some(model) = model {
            joint_rotations(model, self.scratch.q(), &mut scratch.rotations);
            scratch.by_joint.clear();
            for (joint, &origin_rate) in model.joints().iter().zip(rates.joint_origins()) {
                let velocity = match joint.parent {
                    Some(parent) => {
                        scratch.by_joint[parent.index()]
                            + scratch.rotations[parent.index()] * origin_rate
                    }
                    None => origin_rate,
                };
                scratch.by_joint.push(velocity);
            }
        }
        let mut first_block = 0;
        for (index, task) in problem.tasks.iter().enumerate() {
            let blocks = first_block..first_block + task.blocks.len();
            first_block = blocks.end;
            Self::gather(self.scratch, task);
            let residual = self.instance.residual(index);
            let task_rows = &mut rows[task.rows.clone()];
            let weight_rates = &rates.weights()[blocks];
            if weight_rates.iter().any(|rate| *rate != 0.0) {
                let (frames, joints) = self.scratch.task_inputs();
                residual.evaluate(frames, joints, task_rows);
                for (block, rate) in task.blocks.iter().zip(weight_rates) {
                    for row in &mut task_rows[block.rows_after(task.rows.start, 0)] {
                        *row *= rate;
                    }
                }
            }
            let target = rates.target(index);
            if target.iter().any(|rate| *rate != 0.0) {
                scratch.load_constants(self.scratch.task_inputs(), task.rows.len());
                let rates_along = target.iter().map(|&rate| {
                    let mut derivatives = [0.0; CHUNK];
                    derivatives[0] = rate;
                    Dual::new(0.0, derivatives)
                });
                scratch.step.clear();
                scratch.step.extend(rates_along);
                scratch.evaluate(residual);
                let velocity = scratch.dual.residual.iter().zip(&task.weights);
                for (row, (velocity, weight)) in task_rows.iter_mut().zip(velocity) {
                    *row += weight * velocity.derivatives()[0];
                }
            }
            if let Some(model) = model {
                Self::differentiate(self.scratch, task, residual);
                for (k, &slot) in task.frames.iter().enumerate() {
                    let frame = &model.frames()[self.instance.tree().frame(slot).index()];
                    let Some(joint) = frame.joint else { continue };
                    let velocity = scratch.by_joint[joint.index()];
                    let parts = self.scratch.local().linear(k).iter();
                    for (row, part) in task_rows.iter_mut().zip(parts) {
                        *row += part.dot(velocity);
                    }
                }
            }
        }
    }
}

impl ParameterScratch {
    /// Copies the input of a residual as constants.
    fn load_constants(&mut self, (frames, joints): (&[Placement<f64>], &[f64]), rows: usize) {
        let dual = &mut self.dual;
        dual.frames.clear();
        dual.frames.extend(frames.iter().map(Placement::constant));
        dual.joints.clear();
        dual.joints
            .extend(joints.iter().map(|&value| Dual::constant(value)));
        refill(&mut dual.residual, rows, Dual::zero());
    }

    /// Evaluates with a range of the target's parameters as variables.
    fn differentiate_target(
        &mut self,
        residual: &dyn ErasedResidual,
        len: usize,
        first: usize,
        count: usize,
    ) {
        refill(&mut self.step, len, Dual::zero());
        for k in 0..count {
            self.step[first + k] = Dual::variable(0.0, k);
        }
        self.evaluate(residual);
    }

    fn evaluate(&mut self, residual: &dyn ErasedResidual) {
        let dual = &mut self.dual;
        residual.evaluate_moved(&dual.frames, &dual.joints, &self.step, &mut dual.residual);
    }
}
