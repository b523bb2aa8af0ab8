//! Ray task: a frame's origin is on a line, such as a viewing ray.

use super::residual::{check_finite, error_if, moved};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = (I − d dᵀ)(x − m): the part of x − m perpendicular to the line. Its direction is d = (e − m)/‖e − m‖.
///
/// Three rows in metres, of rank two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    frame: FrameId,
    eye: Vector3<f64>,
    through: Vector3<f64>,
}

impl Ray {
    /// A task that moves the frame's origin to the line through the eye e and the point m, in world coordinates.
    ///
    /// m is, for example, the unprojected mouse position. [`Camera::viewing_ray`](super::Camera::viewing_ray) returns
    /// both points. They must be finite and distinct.
    #[must_use]
    pub fn new(
        frame: FrameId,
        eye: impl Into<Vector3<f64>>,
        through: impl Into<Vector3<f64>>,
    ) -> Self {
        Self {
            frame,
            eye: eye.into(),
            through: through.into(),
        }
    }

    /// Sets the line.
    pub fn set_line(&mut self, eye: impl Into<Vector3<f64>>, through: impl Into<Vector3<f64>>) {
        self.eye = eye.into();
        self.through = through.into();
    }

    fn direction(&self) -> Vector3<f64> {
        let axis = self.eye - self.through;
        axis * (1.0 / axis.norm())
    }
}

impl Residual for Ray {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], jacobian: &mut LocalJacobian) -> bool {
        let direction = self.direction();
        for (row, unit) in jacobian.linear_mut(0).iter_mut().zip(Vector3::UNITS) {
            *row = unit - direction * unit.dot(direction);
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("ray").with_validity(self.validate())
    }
}

impl Ray {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        let points = [self.eye, self.through];
        check_finite("its line", points.iter().flat_map(|p| p.to_array()))?;
        let length = (self.eye - self.through).norm();
        error_if(length <= 0.0, || {
            "its eye and point coincide, so they span no line".to_owned()
        })
    }
}

impl DifferentiableTarget for Ray {
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
        let direction = Vector3::constant(self.direction());
        let offset = frames[0].translation - moved(self.through, step);
        let perpendicular = offset - direction * offset.dot(direction);
        residual.copy_from_slice(&perpendicular.to_array());
    }

    fn has_edges(&self) -> bool {
        false
    }
}
