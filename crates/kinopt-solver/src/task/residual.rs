//! The trait of all residuals.

use super::{Description, Extensions, Inputs, LocalJacobian, RowBlock};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, rotation_exp};

/// The role of a task: required or soft.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Role {
    /// A required task: a solution counts as reached only if this task is within its tolerances.
    Goal,
    /// A soft task: it influences the solution, but its error never counts as not reached.
    ///
    /// It acts in the null space of the required tasks, unless [`Preferences`](crate::problem::Preferences) are
    /// weighted.
    Preference,
}

/// A vector r(q) that is zero when the task is fulfilled.
///
/// Write [`evaluate`](Self::evaluate) once over the scalar; all derivative methods then work. The analytic method
/// differentiates the residual by the twists of its frames with dual numbers. It multiplies the result with the
/// geometric Jacobian.
///
/// ```
/// use kinopt::model::FrameId;
/// use kinopt::spatial::Placement;
/// use kinopt::task::{Inputs, Quantity, Residual, RowBlock};
/// use kinopt::Scalar;
///
/// /// Keeps a frame on a cylinder around the world's z axis.
/// #[derive(Clone)]
/// struct OnCylinder { frame: FrameId, radius: f64 }
///
/// impl Residual for OnCylinder {
///     fn inputs(&self) -> Inputs { Inputs::frames([self.frame]) }
///     fn rows(&self) -> Vec<RowBlock> { vec![RowBlock::new(Quantity::Metres, 1)] }
///     fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
///         let at = frames[0].translation;
///         r[0] = (at.x * at.x + at.y * at.y).sqrt() - S::constant(self.radius);
///     }
/// }
/// # let residual = OnCylinder { frame: kinopt_frame(), radius: 0.5 };
/// # let mut r = [0.0];
/// # residual.evaluate(&[Placement::translation([0.3, 0.4, 9.0].into())], &[], &mut r);
/// # assert!(r[0].abs() < 1e-15);
/// # fn kinopt_frame() -> FrameId {
/// #     let mut b = kinopt::model::Model::builder("m");
/// #     b.frame("f", None, Placement::identity())
/// # }
/// ```
pub trait Residual: Clone + Send + Sync + 'static {
    /// The role of a task with this residual, unless the task sets another one.
    const ROLE: Role = Role::Goal;

    /// The optional traits of this residual that a problem uses: [`InequalityResidual`] and [`DifferentiableTarget`].
    ///
    /// [`InequalityResidual`]: super::InequalityResidual
    /// [`DifferentiableTarget`]: super::DifferentiableTarget
    const EXTENSIONS: Extensions<Self> = Extensions::NONE;

    /// The frames and joints that it reads, in the order of the arguments of [`evaluate`](Self::evaluate).
    fn inputs(&self) -> Inputs;

    /// Its row blocks in order.
    fn rows(&self) -> Vec<RowBlock>;

    /// Writes every row of `residual`.
    ///
    /// `frames[k]` is world_from_frame of the k-th frame. `joints[k]` is the k-th joint's value in radians or metres; a
    /// ball joint has four values, its unit quaternion w, x, y, z.
    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]);

    /// Writes exact derivatives and returns true, or returns false to use dual numbers. `jacobian` is zero on entry.
    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let _ = (frames, joints, jacobian);
        false
    }

    /// Its kind for reports, and the result of the check of its parameters.
    ///
    /// A problem reads it when the task is added.
    fn description(&self) -> Description {
        Description::default()
    }
}

/// A position moved by the first three numbers of a step; unchanged by a shorter step.
#[inline]
pub(super) fn moved<S: Scalar>(position: Vector3<f64>, step: &[S]) -> Vector3<S> {
    match *step {
        [x, y, z, ..] => Vector3::constant(position) + Vector3::new(x, y, z),
        _ => Vector3::constant(position),
    }
}

/// A value moved by the first number of a step; unchanged by an empty step.
#[inline]
pub(super) fn moved_by<S: Scalar>(value: f64, step: &[S]) -> S {
    match step {
        [offset, ..] => S::constant(value) + *offset,
        [] => S::constant(value),
    }
}

/// An orientation rotated about its axes by the first three numbers of a step; unchanged by a shorter step.
#[inline]
pub(super) fn rotated<S: Scalar>(rotation: Matrix3<f64>, step: &[S]) -> Matrix3<S> {
    let rotation = Matrix3::constant(rotation);
    match *step {
        [x, y, z, ..] => rotation * rotation_exp(Vector3::new(x, y, z)),
        _ => rotation,
    }
}

/// The frames of a residual with an optional base, in the order that [`in_base`] expects.
pub(super) fn frame_and_base(frame: FrameId, base: Option<FrameId>) -> Vec<FrameId> {
    std::iter::once(frame).chain(base).collect()
}

/// The placement of the first frame in the second, or in the world without a second.
#[inline]
pub(super) fn in_base<S: Scalar>(frames: &[Placement<S>]) -> Placement<S> {
    match frames {
        [world_from_frame, world_from_base, ..] => world_from_base.inverse() * *world_from_frame,
        _ => frames[0],
    }
}

/// Extends derivatives by the first frame, in the axes of a fixed base, to derivatives by frame and base in world axes.
///
/// The relative motion is the frame's motion minus the base's motion.
pub(super) fn add_base_derivatives(frames: &[Placement<f64>], jacobian: &mut LocalJacobian) {
    let [frame, base, ..] = frames else { return };
    let offset = frame.translation - base.translation;
    for row in 0..jacobian.rows() {
        let linear = base.rotation * jacobian.linear(0)[row];
        let angular = jacobian
            .angular(0)
            .get(row)
            .map(|angular_slope| base.rotation * *angular_slope);
        jacobian.linear_mut(0)[row] = linear;
        if let Some(angular) = angular {
            jacobian.angular_mut(0)[row] = angular;
        }
        jacobian.linear_mut(1)[row] = -linear;
        // v · (ω × d) = ω · (d × v)
        let angular_row = angular.unwrap_or(Vector3::zero()) + offset.cross(linear);
        jacobian.angular_mut(1)[row] = -angular_row;
    }
}

/// Returns an error for the first number that is not finite.
pub(super) fn check_finite(
    what: &str,
    numbers: impl IntoIterator<Item = f64>,
) -> Result<(), String> {
    match numbers.into_iter().find(|number| !number.is_finite()) {
        Some(number) => Err(format!(
            "{what} holds {number}, which is not a finite number"
        )),
        None => Ok(()),
    }
}

/// Returns an error for a vector that is not finite or is zero.
pub(super) fn check_direction(what: &str, vector: Vector3<f64>) -> Result<(), String> {
    check_finite(what, vector.to_array())?;
    error_if(vector.norm() <= 0.0, || format!("{what} has no direction"))
}

/// Returns an error for a time step that is not positive and finite.
pub(super) fn check_time_step(seconds: f64) -> Result<(), String> {
    let is_valid = seconds > 0.0 && seconds.is_finite();
    error_if(!is_valid, || {
        format!("its time step {seconds} s is not positive")
    })
}

/// Returns an error for a frame that is its own base.
pub(super) fn check_base(frame: FrameId, base: Option<FrameId>) -> Result<(), String> {
    error_if(base == Some(frame), || {
        "its frame is its own base, so nothing moves it there".to_owned()
    })
}

/// Returns an error with `reason` if `condition` is true.
pub(super) fn error_if(condition: bool, reason: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Err(reason()) } else { Ok(()) }
}
