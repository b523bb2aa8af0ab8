//! Jacobian by a forward pass on dual numbers, six variables at a time.

use nalgebra::DMatrix;

use super::Evaluation;
use crate::task::{CHUNK, DualScratch};
use kinopt_kinematics::scalar::{Dual, Scalar};

impl Evaluation<'_> {
    pub(super) fn dual_jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        let (instance, subset) = (self.instance, self.subset);
        let problem = instance.problem;
        let pass = &mut *self.scratch.dual;
        for first in (0..x.len()).step_by(CHUNK) {
            let chunk = first..x.len().min(first + CHUNK);
            for (k, (value, &x_k)) in pass.x.iter_mut().zip(x).enumerate() {
                *value = if chunk.contains(&k) {
                    Dual::variable(x_k, k - first)
                } else {
                    Dual::constant(x_k)
                };
            }
            instance.tree().forward(&pass.x, &mut pass.state);
            problem.map.scatter(&pass.x, &mut pass.q);
            for (index, task, task_rows) in problem.tasks_of(subset) {
                let all_frames = pass.state.frames();
                let DualScratch {
                    frames,
                    joints,
                    residual,
                } = &mut pass.gathered;
                frames.clear();
                frames.extend(task.frames.iter().map(|&slot| all_frames[slot]));
                joints.clear();
                joints.extend(task.coordinates.iter().map(|&c| pass.q[c]));
                residual.clear();
                residual.resize(task.rows.len(), Dual::zero());
                let residual_function = instance.residual(index);
                residual_function.evaluate_dual(frames, joints, residual);
                let rows = residual.iter().zip(&task.weights).zip(task_rows);
                for ((value, weight), row) in rows {
                    let derivatives = value.derivatives();
                    for k in chunk.clone() {
                        jacobian[(row, k)] = weight * derivatives[k - first];
                    }
                }
            }
        }
    }
}
