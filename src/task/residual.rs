//! The trait that every residual, ours or a user's, answers.

use super::{LocalJacobian, Room, Rows};
use crate::model::{FrameId, JointId};
use crate::scalar::Scalar;
use crate::spatial::{Matrix3, Placement, Vector3, rotation_exp};

/// Whether a task must be met or is only preferred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Role {
    /// The problem counts as reached only when this task is within its tolerances.
    Goal,
    /// Pulls on the solution, but its error never counts as a miss: within what the goals leave free,
    /// unless [`Preferences`](crate::problem::Preferences) are traded.
    Preference,
}

/// A vector r(q) that is zero when all is as it should be.
///
/// Write [`evaluate`](Self::evaluate) once over the scalar and every derivative route works on it:
/// the analytic one differentiates the residual by the motion of its frames with dual numbers and
/// multiplies with the geometric Jacobian.
///
/// ```
/// use kinopt::model::FrameId;
/// use kinopt::spatial::Placement;
/// use kinopt::task::{Quantity, Residual, Rows};
/// use kinopt::Scalar;
///
/// /// Keeps a frame on a cylinder around the world's z axis.
/// #[derive(Clone)]
/// struct OnCylinder { frame: FrameId, radius: f64 }
///
/// impl Residual for OnCylinder {
///     fn frames(&self) -> Vec<FrameId> { vec![self.frame] }
///     fn rows(&self) -> Vec<Rows> { vec![Rows::new(Quantity::Metres, 1)] }
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
    /// Whether the residual is a goal or a preference unless the task says otherwise.
    const ROLE: Role = Role::Goal;

    /// What kind of task this is, in a word or two, for reports.
    fn kind(&self) -> &'static str {
        "custom"
    }

    /// Whether it is of the body as a whole rather than of its first frame: reports then name no frame.
    fn is_of_body(&self) -> bool {
        false
    }

    /// The frames it reads, in the order in which `evaluate` sees them.
    fn frames(&self) -> Vec<FrameId>;

    /// The moving joints whose values it reads, in the order in which `evaluate` sees them.
    fn joints(&self) -> Vec<JointId> {
        Vec::new()
    }

    /// How many numbers it expects `evaluate` to see of those joints, if it knows: one each, four for a ball.
    fn joint_values(&self) -> Option<usize> {
        None
    }

    /// Its rows in order, with what they measure.
    fn rows(&self) -> Vec<Rows>;

    /// Writes every row of `residual`. `frames[k]` is world_from_frame of the k-th frame, `joints[k]`
    /// the k-th joint's value in radians or metres; a ball joint has four, its unit quaternion w, x, y, z.
    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]);

    /// Writes the derivatives by hand and returns true, or returns false to leave them to dual
    /// numbers. `jacobian` comes in all zeros.
    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let _ = (frames, joints, jacobian);
        false
    }

    /// How many numbers its target is moved by, if it has one; for
    /// [`evaluate_moved`](Self::evaluate_moved).
    fn target_len(&self) -> usize {
        0
    }

    /// As [`evaluate`](Self::evaluate) with the target moved by a step of [`target_len`](Self::target_len)
    /// numbers, which only its derivative at zero is asked of: so a solution is differentiated by the
    /// target. Places and values are moved by the step itself, orientations about their own axes, as
    /// [`Model::integrate`](crate::model::Model::integrate) moves a free joint. The default has no target.
    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let _ = step;
        self.evaluate(frames, joints, residual);
    }

    /// Adds how Σ cᵢ rᵢ changes with each number that [`evaluate_moved`](Self::evaluate_moved) moves the target by, at none,
    /// and returns true, or returns false to leave that to dual numbers. `counts` are the cᵢ, one a row.
    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        counts: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        let _ = (frames, joints, counts, slopes);
        false
    }

    /// Whether rows of it may vanish within some room, as those of an interval do, so that they have an edge, where a
    /// solution may have no derivative. Saying no saves derivatives a look for it.
    fn has_edges(&self) -> bool {
        true
    }

    /// The rooms within which rows of it vanish, for what ranks below: to that they are inequalities, which hold it at an
    /// edge alone and only against what pulls outward, by their [`depths`](Self::depths). Rows that are in none are
    /// equations, even where they happen to be zero.
    ///
    /// ```
    /// use kinopt::model::FrameId;
    /// use kinopt::spatial::Placement;
    /// use kinopt::task::{Quantity, Residual, Room, Rows};
    /// use kinopt::Scalar;
    ///
    /// /// Keeps a frame outside a ball about the world's origin.
    /// #[derive(Clone)]
    /// struct OutsideBall { frame: FrameId, radius: f64 }
    ///
    /// impl OutsideBall {
    ///     fn depth<S: Scalar>(&self, frames: &[Placement<S>]) -> S {
    ///         frames[0].translation.norm() - S::constant(self.radius)
    ///     }
    /// }
    ///
    /// impl Residual for OutsideBall {
    ///     fn frames(&self) -> Vec<FrameId> { vec![self.frame] }
    ///     fn rows(&self) -> Vec<Rows> { vec![Rows::new(Quantity::Metres, 1)] }
    ///     fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], r: &mut [S]) {
    ///         r[0] = self.depth(frames).min(S::zero());
    ///     }
    ///     fn rooms(&self) -> Vec<Room> { vec![Room::new(0..1, 1)] }
    ///     fn depths<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], depths: &mut [S]) {
    ///         depths[0] = self.depth(frames);
    ///     }
    /// }
    /// ```
    fn rooms(&self) -> Vec<Room> {
        Vec::new()
    }

    /// Writes how deep within each edge of its [`rooms`](Self::rooms) it is, one room after the other: zero at the edge,
    /// positive on the inner side, in the unit of the room's rows and smooth on both sides. An edge that is not there
    /// now is infinitely far.
    fn depths<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], depths: &mut [S]) {
        let _ = (frames, joints, depths);
    }

    /// As [`differentiate`](Self::differentiate), of the [`depths`](Self::depths).
    fn differentiate_depths(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let _ = (frames, joints, jacobian);
        false
    }

    /// Looks at the residual's own numbers when a problem is built.
    ///
    /// # Errors
    /// What is wrong with them, in words that follow the task's name.
    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
}

/// A place, moved by the first three numbers of a step; as it is where there are fewer.
#[inline]
pub(super) fn moved<S: Scalar>(place: Vector3<f64>, step: &[S]) -> Vector3<S> {
    match *step {
        [x, y, z, ..] => Vector3::constant(place) + Vector3::new(x, y, z),
        _ => Vector3::constant(place),
    }
}

/// A value, moved by the first number of a step; as it is where there is none.
#[inline]
pub(super) fn moved_by<S: Scalar>(value: f64, step: &[S]) -> S {
    match step {
        [by, ..] => S::constant(value) + *by,
        [] => S::constant(value),
    }
}

/// An orientation, turned about its own axes by the first three numbers of a step.
#[inline]
pub(super) fn turned<S: Scalar>(rotation: Matrix3<f64>, step: &[S]) -> Matrix3<S> {
    let rotation = Matrix3::constant(rotation);
    match *step {
        [x, y, z, ..] => rotation * rotation_exp(Vector3::new(x, y, z)),
        _ => rotation,
    }
}

/// The frames that a residual reads whose targets are given in a base, as [`in_base`] takes them.
pub(super) fn frame_and_base(frame: FrameId, base: Option<FrameId>) -> Vec<FrameId> {
    std::iter::once(frame).chain(base).collect()
}

/// Where the first frame stands: in the second, if there is one.
#[inline]
pub(super) fn in_base<S: Scalar>(frames: &[Placement<S>]) -> Placement<S> {
    match frames {
        [placed, world_from_base, ..] => world_from_base.inverse() * *placed,
        _ => frames[0],
    }
}

/// Completes derivatives by the first frame's motion, in the axes of a base that stands still, to those by both,
/// in world axes: what moves against the base is the frame's motion less the base's own.
pub(super) fn add_base(frames: &[Placement<f64>], jacobian: &mut LocalJacobian) {
    let [frame, base, ..] = frames else { return };
    let away = frame.translation - base.translation;
    for row in 0..jacobian.rows() {
        let linear = base.rotation * jacobian.linear(0)[row];
        let angular = jacobian.angular(0).get(row).map(|own| base.rotation * *own);
        jacobian.linear_mut(0)[row] = linear;
        if let Some(angular) = angular {
            jacobian.angular_mut(0)[row] = angular;
        }
        jacobian.linear_mut(1)[row] = -linear;
        // v · (ω × d) = ω · (d × v)
        let turned = angular.unwrap_or(Vector3::zero()) + away.cross(linear);
        jacobian.angular_mut(1)[row] = -turned;
    }
}

/// Refuses the first of some numbers that is not finite.
pub(super) fn not_finite(what: &str, numbers: impl IntoIterator<Item = f64>) -> Result<(), String> {
    match numbers.into_iter().find(|number| !number.is_finite()) {
        Some(number) => Err(format!(
            "{what} holds {number}, which is not a finite number"
        )),
        None => Ok(()),
    }
}

/// Refuses a vector that is not finite, or has no direction.
pub(super) fn no_direction(what: &str, vector: Vector3<f64>) -> Result<(), String> {
    not_finite(what, vector.to_array())?;
    refuse(vector.norm() <= 0.0, || format!("{what} has no direction"))
}

/// Refuses a time step that is none.
pub(super) fn no_time_step(seconds: f64) -> Result<(), String> {
    let usable = seconds > 0.0 && seconds.is_finite();
    refuse(!usable, || {
        format!("its time step {seconds} s is not positive")
    })
}

/// Refuses a frame whose target is given in the frame itself.
pub(super) fn own_base(frame: FrameId, base: Option<FrameId>) -> Result<(), String> {
    refuse(base == Some(frame), || {
        "its frame is its own base, so nothing moves it there".to_owned()
    })
}

/// Refuses, with a reason.
pub(super) fn refuse(bad: bool, reason: impl FnOnce() -> String) -> Result<(), String> {
    if bad { Err(reason()) } else { Ok(()) }
}
