//! Posture task: joints are near reference values.

use super::residual::{check_finite, error_if, moved_by};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual, Role,
    RowBlock,
};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::{JointId, JointKind, Model, quaternion_at};
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};

/// r = q ⊖ reference, a row for each joint in the joint's unit. A soft task by default.
///
/// A ball joint has three rows: the rotation vector from its reference, in its own axes. Redundancy is resolved so that
/// Σ r² is minimal. [`by_range`](Self::by_range) measures each joint relative to its range, so that joints with small
/// and large ranges move equally. [`with_weights`](Self::with_weights) sets which joints move more.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    joints: Vec<JointId>,
    reference: Vec<f64>,
    /// True for each ball joint, which has four coordinates.
    is_ball: Vec<bool>,
    /// Weight on the rows of each joint; empty for 1.
    weights: Vec<f64>,
}

impl Posture {
    /// A posture of every moving joint of `model` at its value in the configuration `reference`.
    ///
    /// A wrong length is an error when the problem is built.
    #[must_use]
    pub fn new(model: &Model, reference: &[f64]) -> Self {
        let mut joints = model.moving_joints().to_vec();
        joints.dedup();
        let kind = |joint: &JointId| model.joints()[joint.index()].kind;
        Self {
            is_ball: joints.iter().map(|joint| kind(joint).is_ball()).collect(),
            joints,
            reference: reference.to_vec(),
            weights: Vec::new(),
        }
    }

    /// A posture of some joints, each with its value in radians or metres; ball joints are not supported.
    #[must_use]
    pub fn of_joints(values: impl IntoIterator<Item = (JointId, f64)>) -> Self {
        let (joints, reference): (Vec<_>, _) = values.into_iter().unzip();
        Self {
            is_ball: vec![false; joints.len()],
            joints,
            reference,
            weights: Vec::new(),
        }
    }

    /// The joints of [`of_joints`](Self::of_joints) with their values.
    #[doc(hidden)]
    pub fn values(&self) -> impl Iterator<Item = (JointId, f64)> + '_ {
        self.joints
            .iter()
            .copied()
            .zip(self.reference.iter().copied())
    }

    /// Multiplies the rows of each joint by a weight of at least 0, one weight for each joint, in order.
    ///
    /// A ball joint has one weight too. A joint of weight 0 moves freely.
    #[must_use]
    pub fn with_weights(mut self, weights: impl IntoIterator<Item = f64>) -> Self {
        self.weights = weights.into_iter().collect();
        self
    }

    /// Weights each joint of `model` by the inverse of half its range.
    ///
    /// A joint without limits counts with π, or with the model's reach if it is prismatic. A ball joint counts with its
    /// largest half angle.
    #[must_use]
    pub fn by_range(self, model: &Model) -> Self {
        let reach = model.reach();
        let range_weight = |id: &JointId| {
            let joint = model.joints().get(id.index());
            let half_range = joint.map_or(0.0, |joint| match (joint.kind, &joint.ball) {
                (JointKind::Ball, Some(limits)) => limits.swing[0].max(limits.swing[1]),
                (JointKind::Ball, None) => std::f64::consts::PI,
                _ => {
                    let spread = model.sampling_spread(joint, reach);
                    let (lower, upper) = joint.limits.sampling_range(0.0, spread);
                    0.5 * (upper - lower)
                }
            });
            match half_range > 0.0 {
                true => 1.0 / half_range,
                false => 1.0,
            }
        };
        let weights: Vec<f64> = self.joints.iter().map(range_weight).collect();
        self.with_weights(weights)
    }

    /// Weights the joints so that the body stays upright and limbs move first.
    ///
    /// Joints that carry several limbs (a spine, the rotation of a [free](kinopt_kinematics::model::ModelBuilder::free) base) get
    /// five times the weight of limb joints. The translation of a free base gets weight 0. So legs bend before the
    /// spine.
    #[must_use]
    pub fn upright(self, model: &Model) -> Self {
        let weights = super::upright::upright_weights(model, &self.joints);
        self.with_weights(weights)
    }

    /// Sets the reference values.
    ///
    /// # Errors
    /// Returns an error for a wrong length and keeps the reference.
    pub fn set_reference(&mut self, reference: &[f64]) -> Result<(), SizeMismatch> {
        SizeMismatch::check(
            "numbers of the reference",
            reference.len(),
            self.reference.len(),
        )?;
        self.reference.copy_from_slice(reference);
        Ok(())
    }

    /// Writes the derivatives at some joint values, times `slope`.
    pub(super) fn differentiate_values(
        &self,
        joints: &[f64],
        slope: f64,
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let weights = || self.weights.iter().copied().chain(std::iter::repeat(1.0));
        if !self.is_ball.contains(&true) {
            jacobian.set_diagonal(weights().take(joints.len()).map(|weight| weight * slope));
            return true;
        }
        let (mut first, mut row) = (0, 0);
        for (&is_ball, weight) in self.is_ball.iter().zip(weights()) {
            let scaled_weight = weight * slope;
            if !is_ball {
                jacobian.push_column(row, [scaled_weight]);
                (first, row) = (first + 1, row + 1);
                continue;
            }
            let coordinates = first..first + 4;
            let (Some(values), Some(reference)) = (
                joints.get(coordinates.clone()),
                self.reference.get(coordinates.clone()),
            ) else {
                return false;
            };
            let mut variables = [Dual::constant(0.0); 4];
            for (k, (variable, &value)) in variables.iter_mut().zip(values).enumerate() {
                *variable = Dual::<4>::variable(value, k);
            }
            let rotation = rotation_from(reference, variables, &[]);
            for k in 0..4 {
                let entries = rotation.map(|part| part.derivatives()[k] * weight * slope);
                jacobian.push_column(row, entries);
            }
            (first, row) = (coordinates.end, row + 3);
        }
        true
    }

    fn apply_weights<S: Scalar>(&self, residual: &mut [S]) {
        let rows = self.weights.iter().zip(&self.is_ball);
        let rows =
            rows.flat_map(|(&weight, &ball)| std::iter::repeat_n(weight, if ball { 3 } else { 1 }));
        for (row, weight) in residual.iter_mut().zip(rows) {
            *row *= S::constant(weight);
        }
    }

    fn differences<S: Scalar>(&self, joints: &[S], step: &[S], residual: &mut [S]) {
        if self.reference.len() == self.joints.len() {
            for ((row, &value), &reference) in residual.iter_mut().zip(joints).zip(&self.reference)
            {
                *row = value - S::constant(reference);
            }
            for (row, &step_value) in residual.iter_mut().zip(step) {
                *row -= step_value;
            }
            return;
        }
        let mut step = step;
        let (mut values, mut references, mut rows) = (joints, &self.reference[..], residual);
        for &is_ball in &self.is_ball {
            let (coordinates, row_count) = if is_ball { (4, 3) } else { (1, 1) };
            let (joint_values, other_values) = values.split_at(coordinates);
            let (reference, other_references) = references.split_at(coordinates);
            let (row, other_rows) = rows.split_at_mut(row_count);
            match joint_values {
                &[w, x, y, z] => row.copy_from_slice(&rotation_from(reference, [w, x, y, z], step)),
                _ => row[0] = joint_values[0] - moved_by(reference[0], step),
            }
            step = step.get(row_count..).unwrap_or_default();
            (values, references, rows) = (other_values, other_references, other_rows);
        }
    }
}

/// The rotation vector from a reference quaternion, rotated by `step`, to another; zero for an invalid reference.
fn rotation_from<S: Scalar>(reference: &[f64], coordinates: [S; 4], step: &[S]) -> [S; 3] {
    let Some(Quaternion { w: real, v }) = quaternion_at(reference) else {
        return [S::zero(); 3];
    };
    let inverse_reference = Quaternion {
        w: S::constant(real),
        v: Vector3::constant(-v),
    };
    let [w, x, y, z] = coordinates;
    let v = Vector3::new(x, y, z);
    let mut rotation = inverse_reference * Quaternion { w, v };
    if let [x, y, z, ..] = *step {
        rotation = Quaternion::exp(-Vector3::new(x, y, z)) * rotation;
    }
    rotation.log().to_array()
}

impl Residual for Posture {
    const ROLE: Role = Role::Preference;

    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints.clone()).with_joint_values(self.reference.len())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::JointUnits, self.target_len())]
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
        self.differentiate_values(joints, 1.0, jacobian)
    }

    fn description(&self) -> Description {
        Description::new("posture").with_validity(self.validate())
    }
}

impl Posture {
    /// Returns the first defect of the parameters.
    pub(super) fn validate(&self) -> Result<(), String> {
        check_finite("its reference", self.reference.iter().copied())?;
        let (weights, joints) = (self.weights.len(), self.joints.len());
        error_if(weights != 0 && weights != joints, || {
            format!("it has {weights} weights for {joints} joints")
        })?;
        let is_invalid = |weight: &&f64| !(**weight >= 0.0 && weight.is_finite());
        if let Some(weight) = self.weights.iter().find(is_invalid) {
            return Err(format!(
                "its weight {weight} of a joint is no number of at least 0"
            ));
        }
        let mut first = 0;
        for &is_ball in &self.is_ball {
            let remaining = self.reference.get(first..).unwrap_or_default();
            if is_ball && remaining.len() >= 4 && quaternion_at(remaining).is_none() {
                return Err("its reference holds a quaternion of length zero".to_owned());
            }
            first += if is_ball { 4 } else { 1 };
        }
        Ok(())
    }
}

impl DifferentiableTarget for Posture {
    fn target_len(&self) -> usize {
        self.is_ball
            .iter()
            .map(|ball| if *ball { 3 } else { 1 })
            .sum()
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        _frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        self.differences(joints, step, residual);
        if !self.weights.is_empty() {
            self.apply_weights(residual);
        }
    }

    fn has_edges(&self) -> bool {
        false
    }
}
