//! Kinematics of seven revolute joints about their self-motion.

use super::angle::Angle;
use super::linear::solve_square;
use super::polish::pose_error;
use super::screw::Screw;
use super::six_revolute::{MethodChoice, SixRevolute};
use crate::simd_ik::Chain;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Largest number of Newton steps of a correction.
const MAX_STEPS: usize = 12;
/// Error at which a correction ends, lengths of the arm and radians.
const CLOSED: f64 = 1e-12;
/// Longest step of a correction, radians.
const MAX_STEP: f64 = 0.2;

/// Joints that slices may lock, the preferred first. The elbow is last, as it moves little in many self-motions.
const SWEPT_JOINTS: [usize; 7] = [2, 6, 4, 0, 5, 1, 3];
/// Number of joints that slices lock. A loop that is missing is small in all of them.
const SWEEPS: usize = 2;
/// Value of a locked joint at which no axes of the slice are parallel by chance, radians.
const GENERIC_VALUE: f64 = 0.83;

/// Configuration of seven joints, radians.
pub(super) type Q = [f64; 7];

/// A chain of seven revolute joints.
#[derive(Clone, Debug)]
pub(crate) struct SevenRevolute {
    /// Axes at zero joint values, in the base frame, lengths of the arm.
    axes: [Screw; 7],
    /// Pose of the tool at zero joint values, lengths of the arm.
    base_from_tool: Placement<f64>,
    /// Length of the arm, metres.
    pub(super) length: f64,
    /// Joints that slices lock.
    pub(super) sweeps: Vec<JointSweep>,
}

/// Joint that slices lock, and the method of its slices.
#[derive(Clone, Debug)]
pub(super) struct JointSweep {
    pub(super) joint: usize,
    method: MethodChoice,
}

impl SevenRevolute {
    /// Compiles the chain; `None` unless it has seven revolute joints.
    ///
    /// Slices lock joints that leave a closed form, if there are any.
    pub(crate) fn new(chain: &Chain) -> Option<Self> {
        let joints = chain.joints();
        let length = chain.extent();
        let turns = joints.iter().all(|joint| joint.kind.turns());
        if joints.len() != 7 || !turns || !(length.is_finite() && length > 0.0) {
            return None;
        }
        let zero = Screw {
            direction: Vector3::zero(),
            point: Vector3::zero(),
        };
        let mut axes = [zero; 7];
        let mut base_from_joint = Placement::identity();
        for (axis, joint) in axes.iter_mut().zip(joints) {
            base_from_joint = base_from_joint * joint.parent_from_joint;
            axis.direction = base_from_joint.rotation * joint.axis;
            axis.point = base_from_joint.translation * length.recip();
        }
        let mut base_from_tool = base_from_joint * *chain.joint_from_tip();
        base_from_tool.translation = base_from_tool.translation * length.recip();
        let mut chain = Self {
            axes,
            base_from_tool,
            length,
            sweeps: Vec::new(),
        };
        let has_closed_form = |&&joint: &&usize| {
            let (axes, _) = chain.slice_axes(joint, GENERIC_VALUE);
            SixRevolute::has_closed_form(&axes)
        };
        let mut joints: Vec<usize> = SWEPT_JOINTS
            .iter()
            .filter(has_closed_form)
            .copied()
            .collect();
        if joints.is_empty() {
            joints.extend(SWEPT_JOINTS);
        }
        joints.truncate(SWEEPS);
        let sweeps = joints.into_iter().map(|joint| JointSweep {
            joint,
            method: SixRevolute::method_of(&chain.slice_axes(joint, GENERIC_VALUE).0),
        });
        chain.sweeps = sweeps.collect();
        Some(chain)
    }

    /// Axes of the other joints and the tool's pose at zero joint values, with one joint locked.
    fn slice_axes(&self, joint: usize, value: f64) -> ([Screw; 6], Placement<f64>) {
        let lock = self.axes[joint].displacement(Angle::of_radians(value));
        let axes = std::array::from_fn(|i| match i < joint {
            true => self.axes[i],
            false => self.axes[i + 1].displaced(&lock),
        });
        (axes, lock * self.base_from_tool)
    }

    /// The six other joints, with the joint of a sweep at a value.
    pub(super) fn slice(&self, sweep: &JointSweep, value: f64) -> SixRevolute {
        let (axes, base_from_tool) = self.slice_axes(sweep.joint, value);
        SixRevolute::by_method(axes, base_from_tool, self.length, &sweep.method)
    }

    /// Pose error of a configuration to a target, and the Jacobian's columns, in lengths of the arm and radians.
    fn linearise(&self, q: &Q, target: &Placement<f64>) -> ([f64; 6], [[f64; 6]; 7]) {
        let mut displacement = Placement::identity();
        let mut current = self.axes;
        for ((axis, current), &q) in self.axes.iter().zip(&mut current).zip(q) {
            *current = axis.displaced(&displacement);
            let (sin, cos) = elementary::sin_cos(q);
            displacement = displacement * axis.displacement(Angle { cos, sin });
        }
        let pose = displacement * self.base_from_tool;
        let columns = current.map(|axis| {
            let v = axis.direction.cross(pose.translation - axis.point);
            let w = axis.direction;
            [v.x, v.y, v.z, w.x, w.y, w.z]
        });
        (pose_error(&pose, target), columns)
    }

    /// Moves a configuration to the target within the hyperplane row·q = value. Returns false if it does not converge.
    pub(super) fn correct(&self, q: &mut Q, target: &Placement<f64>, row: &Q, value: f64) -> bool {
        for _ in 0..MAX_STEPS {
            let (error, columns) = self.linearise(q, target);
            let gap = value - dot(row, q);
            let size = error
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
                .max(gap.abs());
            if size <= CLOSED {
                return true;
            }
            let mut rows = [*row; 7];
            let mut right = [gap; 7];
            for i in 0..6 {
                rows[i] = columns.map(|column| column[i]);
                right[i] = error[i];
            }
            let Some(step) = solve_square(rows, right) else {
                return false;
            };
            let longest = step
                .iter()
                .fold(0.0, |longest: f64, v| longest.max(v.abs()));
            let shrink = (MAX_STEP / longest).min(1.0);
            for (q, step) in q.iter_mut().zip(&step) {
                *q += step * shrink;
            }
        }
        let (error, _) = self.linearise(q, target);
        error.iter().all(|v| v.abs() <= 1e3 * CLOSED)
    }

    /// Unit tangent of the self-motion at a configuration: the vector of signed minors of the Jacobian.
    ///
    /// It has the direction of `last`, if that is given. `None` at a singular configuration.
    pub(super) fn tangent(&self, q: &Q, target: &Placement<f64>, last: Option<&Q>) -> Option<Q> {
        let (_, columns) = self.linearise(q, target);
        // Gram-Schmidt of the rows, then the residue of the axis with the largest one.
        let mut basis = [[0.0; 7]; 6];
        for i in 0..6 {
            let mut row = columns.map(|column| column[i]);
            for _ in 0..2 {
                for other in &basis[..i] {
                    let along = dot(&row, other);
                    row.iter_mut().zip(other).for_each(|(v, o)| *v -= along * o);
                }
            }
            let norm = dot(&row, &row).sqrt();
            if norm < 1e-9 {
                return None;
            }
            basis[i] = row.map(|v| v / norm);
        }
        let residue = |axis: usize| {
            let mut v = [0.0; 7];
            v[axis] = 1.0;
            for _ in 0..2 {
                for other in &basis {
                    let along = dot(&v, other);
                    v.iter_mut().zip(other).for_each(|(v, o)| *v -= along * o);
                }
            }
            v
        };
        let residues: [Q; 7] = std::array::from_fn(residue);
        let longest = residues
            .into_iter()
            .max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)))?;
        let norm = dot(&longest, &longest).sqrt();
        let sign = match last {
            Some(last) if dot(&longest, last) < 0.0 => -1.0,
            _ => 1.0,
        };
        Some(longest.map(|v| sign * v / norm))
    }
}

pub(super) fn dot(a: &Q, b: &Q) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
