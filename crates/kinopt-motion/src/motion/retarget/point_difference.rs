//! Task of the vector between points of two frames.

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{Description, Inputs, LocalJacobian, Quantity, Residual, RowBlock};

/// Residual r = w (a − b − target) of the vector from point b to point a, in world axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PointDifference {
    frames: [FrameId; 2],
    offsets: [Vector3<f64>; 2],
    target: Vector3<f64>,
    weight: f64,
    /// Factor of the weight.
    share: f64,
}

impl PointDifference {
    /// Creates the task for points on two frames, which must differ. The points are in frame coordinates.
    pub(super) fn new(frames: [FrameId; 2], offsets: [Vector3<f64>; 2], weight: f64) -> Self {
        Self {
            frames,
            offsets,
            target: Vector3::zero(),
            weight,
            share: 1.0,
        }
    }

    /// Sets the target of the vector, metres.
    pub(super) fn set_target(&mut self, target: Vector3<f64>) {
        self.target = target;
    }

    /// Sets the factor of the weight.
    pub(super) fn set_share(&mut self, share: f64) {
        self.share = share;
    }

    fn weight(&self) -> f64 {
        self.share * self.weight
    }
}

impl Residual for PointDifference {
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
        Description::new("point difference")
    }
}
