//! Joint velocity minimisation.

use super::residual::check_time_step;
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Posture, Quantity,
    Residual, Role, RowBlock,
};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::Model;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;

/// r = (q ⊖ previous) / Δt, in radians or metres per second: a row for each joint, three for a ball joint.
///
/// A soft task by default.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothness {
    previous: Posture,
    time_step_s: f64,
}

impl Smoothness {
    /// A task for every moving joint of `model`, with the configuration `previous` of `time_step_s` seconds ago.
    ///
    /// A wrong length is an error when the problem is built.
    #[must_use]
    pub fn new(model: &Model, previous: &[f64], time_step_s: f64) -> Self {
        Self {
            previous: Posture::new(model, previous),
            time_step_s,
        }
    }

    /// Multiplies the rows of each joint by a weight: see [`Posture::with_weights`].
    #[must_use]
    pub fn with_weights(mut self, weights: impl IntoIterator<Item = f64>) -> Self {
        self.previous = self.previous.with_weights(weights);
        self
    }

    /// Weights each joint by the inverse of half its range: see [`Posture::by_range`].
    #[must_use]
    pub fn by_range(mut self, model: &Model) -> Self {
        self.previous = self.previous.by_range(model);
        self
    }

    /// Sets the configuration at the start of the next time step.
    ///
    /// # Errors
    /// Returns the errors of [`Posture::set_reference`].
    pub fn set_previous(&mut self, previous: &[f64]) -> Result<(), SizeMismatch> {
        self.previous.set_reference(previous)
    }
}

impl Residual for Smoothness {
    const ROLE: Role = Role::Preference;

    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        self.previous.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        let count = self.previous.rows().iter().map(|rows| rows.count).sum();
        vec![RowBlock::new(Quantity::JointUnitsPerSecond, count)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(
        &self,
        _frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        self.previous
            .differentiate_values(joints, 1.0 / self.time_step_s, jacobian)
    }

    fn description(&self) -> Description {
        Description::new("smoothness").with_validity(self.validate())
    }
}

impl Smoothness {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        self.previous.validate()?;
        check_time_step(self.time_step_s)
    }
}

impl DifferentiableTarget for Smoothness {
    fn target_len(&self) -> usize {
        self.previous.target_len()
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        self.previous.evaluate_moved(frames, joints, step, residual);
        let per_second = S::constant(1.0 / self.time_step_s);
        for row in residual {
            *row *= per_second;
        }
    }

    fn has_edges(&self) -> bool {
        false
    }
}
