//! Position task for a point of a frame.

use super::residual::{
    add_base_derivatives, check_base, check_finite, frame_and_base, in_base, moved,
};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = x + R o − target, with o the [offset](Self::at) on the frame.
///
/// Three rows in metres, in world axes or those of the [base](Self::relative_to).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    frame: FrameId,
    base: Option<FrameId>,
    /// In frame coordinates, metres.
    offset: Vector3<f64>,
    target: Vector3<f64>,
}

impl Point {
    /// A task that moves the frame's origin to `target`, metres in world coordinates.
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Vector3<f64>>) -> Self {
        Self {
            frame,
            base: None,
            offset: Vector3::zero(),
            target: target.into(),
        }
    }

    /// Sets the point of the frame, in frame coordinates, metres; the origin by default.
    #[must_use]
    pub fn at(mut self, offset: impl Into<Vector3<f64>>) -> Self {
        self.offset = offset.into();
        self
    }

    /// Gives the target in the coordinates of `base`, which may move with the joints.
    #[must_use]
    pub fn relative_to(mut self, base: FrameId) -> Self {
        self.base = Some(base);
        self
    }

    /// The frame of the target's coordinates; `None` for the world.
    #[must_use]
    pub fn base(&self) -> Option<FrameId> {
        self.base
    }

    /// The point of the frame, in frame coordinates, metres.
    #[must_use]
    pub fn offset(&self) -> Vector3<f64> {
        self.offset
    }

    /// The target, in world coordinates or those of the base, metres.
    #[must_use]
    pub fn target(&self) -> Vector3<f64> {
        self.target
    }

    /// Sets the target.
    pub fn set_target(&mut self, target: impl Into<Vector3<f64>>) {
        self.target = target.into();
    }
}

impl Residual for Point {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames(frame_and_base(self.frame, self.base))
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let has_offset = self.offset != Vector3::zero();
        let lever = has_offset.then(|| in_base(frames).rotation * self.offset);
        jacobian.set_point(0, lever, 1.0);
        add_base_derivatives(frames, jacobian);
        true
    }

    fn description(&self) -> Description {
        Description::new("point").with_validity(self.validate())
    }
}

impl Point {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_base(self.frame, self.base)?;
        check_finite("its target", self.target.to_array())?;
        check_finite("its offset", self.offset.to_array())
    }
}

impl DifferentiableTarget for Point {
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
        let position = in_base(frames).apply(Vector3::constant(self.offset));
        let error = position - moved(self.target, step);
        residual.copy_from_slice(&error.to_array());
    }

    fn add_target_slopes(
        &self,
        _frames: &[Placement<f64>],
        _joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        for (slope, coefficient) in slopes.iter_mut().zip(coefficients) {
            *slope -= coefficient;
        }
        true
    }

    fn has_edges(&self) -> bool {
        false
    }
}
