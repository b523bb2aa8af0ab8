//! Rotations of captured joints, with the bone tree and rest pose that they refer to.

use glam::DQuat;

use super::RetargetError;
use kinopt_kinematics::spatial::Vector3;

/// Largest deviation of a quaternion's length from 1.
const NORM_TOLERANCE: f64 = 1e-3;

/// Bone tree, rest pose and rotations of the joints of a [`Capture`](super::Capture).
///
/// All numbers are in the world of the capture. A quaternion is w, x, y, z and maps the axes of a joint to the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointRotations {
    /// Index of each joint's parent; `None` for a root. Parents may come in any order.
    pub parents: Vec<Option<usize>>,
    /// Position of each joint in the rest pose, in the capture's unit.
    pub rest_positions: Vec<Vector3<f64>>,
    /// Rotation of each joint in the rest pose.
    pub rest_rotations: Vec<[f64; 4]>,
    /// Rotation of each joint in each capture frame: frame by frame, joint by joint.
    pub rotations: Vec<[f64; 4]>,
}

/// Checked rotations, as unit quaternions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PosedTree {
    pub(super) parents: Vec<Option<usize>>,
    pub(super) rest: Vec<DQuat>,
    /// Frame by frame, joint by joint.
    pub(super) rotations: Vec<DQuat>,
}

impl JointRotations {
    /// Returns the rest positions and the checked rotations for captured joints.
    pub(super) fn checked(
        self,
        names: &[String],
        frames: usize,
    ) -> Result<(Vec<Vector3<f64>>, PosedTree), RetargetError> {
        let joints = names.len();
        for (given, expected, what) in [
            (self.parents.len(), joints, "parents"),
            (self.rest_positions.len(), joints, "rest positions"),
            (self.rest_rotations.len(), joints, "rest rotations"),
            (self.rotations.len(), joints * frames, "rotations"),
        ] {
            if given != expected {
                return Err(RetargetError::RotationCount {
                    what,
                    given,
                    expected,
                });
            }
        }
        let is_cyclic = |joint: usize| {
            let parent = |joint: &usize| self.parents.get(*joint).copied().flatten();
            std::iter::successors(Some(joint), parent)
                .nth(joints)
                .is_some()
        };
        let bad_parent = |&joint: &usize| {
            self.parents[joint].is_some_and(|parent| parent >= joints) || is_cyclic(joint)
        };
        if let Some(joint) = (0..joints).find(bad_parent) {
            return Err(RetargetError::BadParent {
                joint: names[joint].clone(),
            });
        }
        let finite = |position: &Vector3<f64>| position.is_finite();
        if let Some(joint) = self.rest_positions.iter().position(|at| !finite(at)) {
            return Err(RetargetError::BadRotation {
                joint: names[joint].clone(),
                frame: None,
            });
        }
        let unit = |q: &[f64; 4], joint: usize, frame: Option<usize>| {
            let quaternion = DQuat::from_xyzw(q[1], q[2], q[3], q[0]);
            match (quaternion.length() - 1.0).abs() <= NORM_TOLERANCE {
                true => Ok(quaternion.normalize()),
                false => Err(RetargetError::BadRotation {
                    joint: names[joint].clone(),
                    frame,
                }),
            }
        };
        let rest = self.rest_rotations.iter().enumerate();
        let rest = rest.map(|(joint, q)| unit(q, joint, None));
        let rotations = self.rotations.iter().enumerate();
        let rotations = rotations.map(|(index, q)| unit(q, index % joints, Some(index / joints)));
        let tree = PosedTree {
            rest: rest.collect::<Result<_, _>>()?,
            rotations: rotations.collect::<Result<_, _>>()?,
            parents: self.parents,
        };
        Ok((self.rest_positions, tree))
    }
}
