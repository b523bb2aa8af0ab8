//! A point of a frame should be at a place.

use super::residual::not_finite;
use super::{LocalJacobian, Quantity, Residual, Rows};
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::spatial::{Placement, Vector3};

/// x − target, three rows in metres, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    frame: FrameId,
    /// In frame coordinates.
    offset: Vector3<f64>,
    target: Vector3<f64>,
}

impl Point {
    /// The frame's origin should be at `target`, in world coordinates.
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Vector3<f64>>) -> Self {
        Self {
            frame,
            offset: Vector3::zero(),
            target: target.into(),
        }
    }

    /// Not the origin but this point of the frame, in frame coordinates.
    #[must_use]
    pub fn at(mut self, offset: impl Into<Vector3<f64>>) -> Self {
        self.offset = offset.into();
        self
    }

    /// The point, in frame coordinates.
    #[must_use]
    pub fn offset(&self) -> Vector3<f64> {
        self.offset
    }

    /// Where the point should be, in world coordinates.
    #[must_use]
    pub fn target(&self) -> Vector3<f64> {
        self.target
    }

    /// Moves the target.
    pub fn set_target(&mut self, target: impl Into<Vector3<f64>>) {
        self.target = target.into();
    }
}

impl Residual for Point {
    fn kind(&self) -> &'static str {
        "point"
    }

    fn frames(&self) -> Vec<FrameId> {
        vec![self.frame]
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let at = frames[0].apply(Vector3::constant(self.offset));
        let miss = at - Vector3::constant(self.target);
        residual.copy_from_slice(&miss.to_array());
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        for (row, unit) in jacobian.linear_mut(0).iter_mut().zip(Vector3::UNITS) {
            *row = unit;
        }
        if self.offset != Vector3::zero() {
            // e · (ω × l) = ω · (l × e)
            let lever = frames[0].rotation * self.offset;
            for (row, unit) in jacobian.angular_mut(0).iter_mut().zip(Vector3::UNITS) {
                *row = lever.cross(unit);
            }
        }
        true
    }

    fn defect(&self) -> Option<String> {
        not_finite("its target", self.target.to_array())
            .or_else(|| not_finite("its offset", self.offset.to_array()))
    }
}
