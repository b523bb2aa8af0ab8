//! Heading of the pelvis from the hip positions.

use super::limbs::Limbs;
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{Description, Inputs, LocalJacobian, Quantity, Residual, RowBlock};

/// Weight of the rotation of the hip line, in metres of position per radian.
const ROTATION_WEIGHT: f64 = 0.3;
/// Distance of the hips below which they define no line, metres.
const MIN_HIP_DISTANCE: f64 = 1e-3;

/// Residual r = w (a − b − target) of the vector from one hip to the other.
///
/// Hips are so close that their positions barely determine the heading of the pelvis. Without this task legs would wind
/// up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HipLine {
    limbs: [usize; 2],
    frames: [FrameId; 2],
    offsets: [Vector3<f64>; 2],
    length: f64,
    target: Vector3<f64>,
}

impl HipLine {
    /// Creates the task from the first two hips, if there are two. `stance_positions` has the end positions of all
    /// limbs in a configuration.
    pub(super) fn new(limbs: &Limbs, stance_positions: &[Vector3<f64>]) -> Option<Self> {
        let [a, b] = *limbs.hips.first_chunk::<2>()?;
        let frames = [a, b].map(|k| limbs.all[k].frame);
        let length = (stance_positions[a] - stance_positions[b]).norm();
        (length > MIN_HIP_DISTANCE && frames[0] != frames[1]).then(|| Self {
            limbs: [a, b],
            frames,
            offsets: [a, b].map(|k| limbs.all[k].offset),
            length,
            target: stance_positions[a] - stance_positions[b],
        })
    }

    /// Sets the direction of the line from the targets of the hips. The direction stays if these coincide.
    pub(super) fn set_direction(&mut self, targets: &[Vector3<f64>]) {
        let [a, b] = self.limbs;
        let direction = targets[a] - targets[b];
        let length = direction.norm();
        if length > 0.0 {
            self.target = direction * (self.length / length);
        }
    }

    fn weight(&self) -> f64 {
        ROTATION_WEIGHT / self.length
    }
}

impl Residual for HipLine {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let [a, b] = [0, 1].map(|k| frames[k].apply(Vector3::constant(self.offsets[k])));
        let error = (a - b - Vector3::constant(self.target)) * S::constant(self.weight());
        residual.copy_from_slice(&error.to_array());
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        for (k, weight) in [self.weight(), -self.weight()].into_iter().enumerate() {
            let lever = frames[k].rotation * self.offsets[k];
            jacobian.set_point(k, Some(lever), weight);
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("hip line")
    }
}
