//! Derivatives of residuals by dual numbers: one frame's twist, or six joints, at a time.

use super::LocalJacobian;
use super::local_jacobian::reserve_total;
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Directions differentiated at once: the six of one frame's twist.
pub(crate) const CHUNK: usize = 6;

/// Workspace for the derivatives of residuals by dual numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct DualScratch {
    pub(crate) frames: Vec<Placement<Dual<CHUNK>>>,
    pub(crate) joints: Vec<Dual<CHUNK>>,
    pub(crate) residual: Vec<Dual<CHUNK>>,
}

impl DualScratch {
    /// Reserves memory for a residual of this shape.
    pub(crate) fn reserve(&mut self, rows: usize, frames: usize, joints: usize) {
        reserve_total(&mut self.frames, frames);
        reserve_total(&mut self.joints, joints);
        reserve_total(&mut self.residual, rows);
    }

    /// An empty workspace with the capacities of this one.
    pub(crate) fn clone_empty(&self) -> Self {
        Self {
            frames: Vec::with_capacity(self.frames.capacity()),
            joints: Vec::with_capacity(self.joints.capacity()),
            residual: Vec::with_capacity(self.residual.capacity()),
        }
    }
}

/// Differentiates `evaluate` by frames and joints: one frame, or six joints, at a time.
pub(super) fn by_dual_numbers(
    evaluate: impl Fn(&[Placement<Dual<CHUNK>>], &[Dual<CHUNK>], &mut [Dual<CHUNK>]),
    frames: &[Placement<f64>],
    joints: &[f64],
    jacobian: &mut LocalJacobian,
    scratch: &mut DualScratch,
) {
    let rows = jacobian.rows();
    let DualScratch {
        frames: dual_frames,
        joints: dual_joints,
        residual: r,
    } = scratch;
    dual_frames.clear();
    dual_frames.extend(frames.iter().map(Placement::constant));
    dual_joints.clear();
    dual_joints.extend(joints.iter().map(|&value| Dual::constant(value)));
    r.clear();
    r.resize(rows, Dual::zero());

    for (k, frame) in frames.iter().enumerate() {
        dual_frames[k] = moved_by_unit_twists(frame);
        evaluate(dual_frames, dual_joints, r);
        for (row, value) in r.iter().enumerate() {
            let [vx, vy, vz, wx, wy, wz] = value.derivatives();
            jacobian.linear_mut(k)[row] = Vector3::new(vx, vy, vz);
            jacobian.angular_mut(k)[row] = Vector3::new(wx, wy, wz);
        }
        dual_frames[k] = Placement::constant(frame);
    }
    for first in (0..joints.len()).step_by(CHUNK) {
        let chunk = first..joints.len().min(first + CHUNK);
        for k in chunk.clone() {
            dual_joints[k] = Dual::variable(joints[k], k - first);
        }
        evaluate(dual_frames, dual_joints, r);
        for (row, value) in r.iter().enumerate() {
            let derivatives = value.derivatives();
            for k in chunk.clone() {
                jacobian.joint_mut(k)[row] = derivatives[k - first];
            }
        }
        for k in chunk {
            dual_joints[k] = Dual::constant(joints[k]);
        }
    }
}

/// The placement with derivatives along its three velocities and three angular velocities.
///
/// They are in world axes at the frame's origin.
pub(super) fn moved_by_unit_twists(frame: &Placement<f64>) -> Placement<Dual<CHUNK>> {
    let twist = |direction| Dual::<CHUNK>::variable(0.0, direction);
    let velocity = Vector3::new(twist(0), twist(1), twist(2));
    let angular_velocity = Vector3::new(twist(3), twist(4), twist(5));
    let mut moved = Placement::constant(frame);
    moved.translation += velocity;
    let rotation = &mut moved.rotation;
    for column in [&mut rotation.x, &mut rotation.y, &mut rotation.z] {
        *column += angular_velocity.cross(*column);
    }
    moved
}
