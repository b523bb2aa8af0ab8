//! Orientation task for a frame.

use super::residual::{
    add_base_derivatives, check_base, check_finite, frame_and_base, in_base, rotated,
};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{
    Matrix3, Placement, Vector3, rotation_log, rotation_log_jacobian,
};

/// r = log(R R_targetᵀ), the rotation vector from the target, of length within [0, π].
///
/// Three rows in radians, in world axes or those of the [base](Self::relative_to).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    frame: FrameId,
    base: Option<FrameId>,
    target: Matrix3<f64>,
}

impl Orientation {
    /// A task that rotates the frame to the orientation `target` (world_from_frame).
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Matrix3<f64>>) -> Self {
        Self {
            frame,
            base: None,
            target: target.into(),
        }
    }

    /// Gives the target in the coordinates of `base`, which may move with the joints (base_from_frame).
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

    /// The target orientation (world_from_frame or base_from_frame).
    #[must_use]
    pub fn target(&self) -> Matrix3<f64> {
        self.target
    }

    /// Sets the target.
    pub fn set_target(&mut self, target: impl Into<Matrix3<f64>>) {
        self.target = target.into();
    }

    /// The rotation vector from the target to `rotation`.
    pub(super) fn error<S: Scalar>(target: Matrix3<f64>, rotation: Matrix3<S>) -> [S; 3] {
        Self::error_from(Matrix3::constant(target), rotation)
    }

    /// The rotation vector from a target with derivatives to `rotation`.
    pub(super) fn error_from<S: Scalar>(target: Matrix3<S>, rotation: Matrix3<S>) -> [S; 3] {
        rotation_log(&(rotation * target.transpose())).to_array()
    }

    /// Writes the derivative of the rotation vector by ω to three rows of `jacobian`.
    ///
    /// It is J_l⁻¹(φ) (Chirikjian 2012, eq. 10.86, see [`rotation_log_jacobian`]).
    pub(super) fn differentiate_error(
        target: Matrix3<f64>,
        rotation: Matrix3<f64>,
        first_row: usize,
        jacobian: &mut LocalJacobian,
    ) {
        let rotation_error = Self::error(target, rotation);
        // Its rows are the columns of its transpose.
        let transposed = rotation_log_jacobian(rotation_error.into()).transpose();
        let rows = &mut jacobian.angular_mut(0)[first_row..];
        for (row, value) in rows
            .iter_mut()
            .zip([transposed.x, transposed.y, transposed.z])
        {
            *row = value;
        }
    }

    /// Adds the change of a weighted sum of the rows when the target rotates about its axes by s.
    ///
    /// The rotation vector is then log(exp(φ) exp(−R_target s)). Its derivative by R_target s is −J_r⁻¹(φ) =
    /// −J_l⁻¹(φ)ᵀ.
    pub(super) fn add_target_rotation_slopes(
        target: Matrix3<f64>,
        rotation: Matrix3<f64>,
        coefficients: Vector3<f64>,
        slopes: &mut [f64],
    ) {
        let slope_by_rotation =
            rotation_log_jacobian(Self::error(target, rotation).into()) * coefficients;
        let target_slopes = target.transpose_mul(slope_by_rotation).to_array();
        for (slope, target_slope) in slopes.iter_mut().zip(target_slopes) {
            *slope -= target_slope;
        }
    }
}

impl Residual for Orientation {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames(frame_and_base(self.frame, self.base))
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Radians, 3)]
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
        Self::differentiate_error(self.target, in_base(frames).rotation, 0, jacobian);
        add_base_derivatives(frames, jacobian);
        true
    }

    fn description(&self) -> Description {
        Description::new("orientation").with_validity(self.validate())
    }
}

impl Orientation {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_base(self.frame, self.base)?;
        check_rotation("its target is", &self.target)
    }
}

impl DifferentiableTarget for Orientation {
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
        let placement = in_base(frames);
        let target = rotated(self.target, step);
        residual.copy_from_slice(&Self::error_from(target, placement.rotation));
    }

    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        let &[x, y, z] = coefficients else {
            return false;
        };
        let (rotation, coefficients) = (in_base(frames).rotation, Vector3::new(x, y, z));
        Self::add_target_rotation_slopes(self.target, rotation, coefficients, slopes);
        true
    }

    fn has_edges(&self) -> bool {
        false
    }
}

/// Returns an error for a matrix that is not a rotation; `what` starts the message.
pub(super) fn check_rotation(what: &str, rotation: &Matrix3<f64>) -> Result<(), String> {
    let columns = [rotation.x, rotation.y, rotation.z];
    check_finite("its orientation", columns.iter().flat_map(|c| c.to_array()))?;
    Placement::new(*rotation, Vector3::zero())
        .check_rigid(1e-6)
        .map_err(|problem| format!("{what} no orientation: {problem}"))
}
