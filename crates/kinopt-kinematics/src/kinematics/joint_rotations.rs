//! Orientations of all joints of a model.

use super::motion::NodeMotion;
use crate::model::{JointId, JointKind, Model, quaternion_at};
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// Writes the orientation of every joint of `model` in the world at `q`, after its own motion.
///
/// Entries are in the order of [`JointId::index`].
#[doc(hidden)]
pub fn joint_rotations(model: &Model, q: &[f64], rotations: &mut Vec<Matrix3<f64>>) {
    rotations.clear();
    for (index, joint) in model.joints().iter().enumerate() {
        let parent = joint.parent.map(|parent| rotations[parent.index()]);
        let rest_rotation =
            parent.unwrap_or(Matrix3::identity()) * joint.parent_from_joint.rotation;
        let values = model
            .coordinate(JointId::new(index))
            .map(|first| &q[first..]);
        rotations.push(match (joint.kind, values) {
            (JointKind::Ball, Some(values)) => {
                rest_rotation
                    * quaternion_at(values).map_or(Matrix3::identity(), Quaternion::to_matrix)
            }
            (kind, Some(&[value, ..])) => match NodeMotion::new(kind, joint.axis) {
                Some(motion) if motion.turns() => {
                    let rest_placement = Placement::new(rest_rotation, Vector3::zero());
                    let trigonometry = elementary::sin_cos(value);
                    motion.apply(rest_placement, value, trigonometry).rotation
                }
                _ => rest_rotation,
            },
            _ => rest_rotation,
        });
    }
}
