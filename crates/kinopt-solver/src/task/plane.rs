//! Plane task: a frame's origin is in a plane.

use super::residual::{check_direction, check_finite, moved};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = n · (x − p), the signed distance: one row in metres, n the unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    frame: FrameId,
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Plane {
    /// A task that moves the frame's origin to the plane through `point` with `normal`, in world coordinates.
    ///
    /// `normal` has any length except zero.
    #[must_use]
    pub fn new(
        frame: FrameId,
        point: impl Into<Vector3<f64>>,
        normal: impl Into<Vector3<f64>>,
    ) -> Self {
        Self {
            frame,
            point: point.into(),
            normal: normal.into(),
        }
    }

    /// Sets the plane.
    pub fn set_plane(&mut self, point: impl Into<Vector3<f64>>, normal: impl Into<Vector3<f64>>) {
        self.point = point.into();
        self.normal = normal.into();
    }

    fn unit_normal(&self) -> Vector3<f64> {
        self.normal * (1.0 / self.normal.norm())
    }
}

impl Residual for Plane {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], jacobian: &mut LocalJacobian) -> bool {
        jacobian.linear_mut(0)[0] = self.unit_normal();
        true
    }

    fn description(&self) -> Description {
        Description::new("plane").with_validity(self.validate())
    }
}

impl Plane {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its point", self.point.to_array())?;
        check_direction("its normal", self.normal)
    }
}

impl DifferentiableTarget for Plane {
    fn target_len(&self) -> usize {
        3
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let offset = frames[0].translation - moved(self.point, step);
        residual[0] = offset.dot(Vector3::constant(self.unit_normal()));
    }

    fn has_edges(&self) -> bool {
        false
    }
}
