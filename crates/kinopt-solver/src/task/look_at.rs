//! Look-at task: an axis of a frame points at a target.

use super::residual::{check_direction, check_finite, moved};
use super::{Description, DifferentiableTarget, Extensions, Inputs, Quantity, Residual, RowBlock};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};

/// r = θ (a × s)/‖a × s‖ with cos θ = a · s. This rotation vector rotates the axis onto the line of sight.
///
/// a is the unit axis, s = (target − x)/‖target − x‖ the line of sight. Three rows in radians, in world axes, of rank
/// two. The norm is the angle between a and s, within [0, π].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAt {
    frame: FrameId,
    axis: Vector3<f64>,
    target: Vector3<f64>,
}

impl LookAt {
    /// A task that points `axis` from the frame's origin to `target`.
    ///
    /// `axis` is in frame coordinates, of any length except zero; `target` is in world coordinates. A target at the
    /// origin gives a residual of zero.
    #[must_use]
    pub fn new(
        frame: FrameId,
        axis: impl Into<Vector3<f64>>,
        target: impl Into<Vector3<f64>>,
    ) -> Self {
        Self {
            frame,
            axis: axis.into(),
            target: target.into(),
        }
    }

    /// Sets the target.
    pub fn set_target(&mut self, target: impl Into<Vector3<f64>>) {
        self.target = target.into();
    }
}

impl Residual for LookAt {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Radians, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn description(&self) -> Description {
        Description::new("look-at").with_validity(self.validate())
    }
}

impl LookAt {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its target", self.target.to_array())?;
        check_direction("its axis", self.axis)
    }
}

impl DifferentiableTarget for LookAt {
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
        let unit_axis = self.axis * (1.0 / self.axis.norm());
        let axis = frames[0].rotation * Vector3::constant(unit_axis);
        let sight = line_of_sight(&frames[0], axis, moved(self.target, step));
        residual.copy_from_slice(&rotation_onto(axis, sight).to_array());
    }

    fn has_edges(&self) -> bool {
        false
    }
}

/// The direction from a frame's origin to a target; `fallback` if the target is the origin.
#[inline]
pub(super) fn line_of_sight<S: Scalar>(
    frame: &Placement<S>,
    fallback: Vector3<S>,
    target: Vector3<S>,
) -> Vector3<S> {
    let sight = target - frame.translation;
    let squared = sight.norm_squared();
    let is_degenerate = squared.less_than(S::constant(f64::MIN_POSITIVE));
    let length = S::select(is_degenerate, S::one(), squared).sqrt();
    Vector3::select(is_degenerate, fallback, sight * (S::one() / length))
}

/// The shortest rotation vector from one unit vector to another, with an angle in [0, π].
#[inline]
pub(super) fn rotation_onto<S: Scalar>(axis: Vector3<S>, sight: Vector3<S>) -> Vector3<S> {
    // The half-angle quaternion (1 + a·s, a × s) rotates a onto s. It vanishes for opposite vectors, for which any axis
    // n perpendicular to a works. A rotation of a about n by ε leaves π − ε, so w = ε/2 and ε = (a × s)·n. This slope
    // lets a search leave the singularity. ½‖a + s‖² is 1 + a·s without cancellation.
    let w = (axis + sight).norm_squared() * S::constant(0.5);
    let is_opposite = w.less_than(S::constant(1e-12));
    let cross_product = axis.cross(sight);
    let perpendicular_axis = perpendicular(axis);
    let v = Vector3::select(is_opposite, perpendicular_axis, cross_product);
    let w = S::select(
        is_opposite,
        cross_product.dot(perpendicular_axis) * S::constant(0.5),
        w,
    );
    let scale = S::one() / w.mul_add(w, v.norm_squared()).sqrt();
    let rotation = Quaternion {
        w: w * scale,
        v: v * scale,
    };
    rotation.log()
}

/// A vector perpendicular to a unit vector, of length at least one half.
fn perpendicular<S: Scalar>(unit: Vector3<S>) -> Vector3<S> {
    let is_along_x = S::constant(0.5).less_than(unit.x.abs());
    let (zero, one) = (S::zero(), S::one());
    let other = Vector3::new(
        S::select(is_along_x, zero, one),
        S::select(is_along_x, one, zero),
        zero,
    );
    unit.cross(other)
}
