//! Segments of a configuration: joints, or the joints of a free joint together.

use super::{Joint, JointId, JointKind, ModelError};
use crate::spatial::{Quaternion, Vector3};

/// The layout of a segment in a configuration and in a velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(hidden)]
pub enum SegmentKind {
    /// One coordinate and one velocity component.
    Scalar,
    /// A unit quaternion w, x, y, z, and an angular velocity in the rotated frame's axes.
    Ball,
    /// x, y, z and a unit quaternion; linear and angular velocity in the moved frame's axes.
    Free,
}

impl SegmentKind {
    pub(crate) const fn coordinates(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Ball => 4,
            Self::Free => 7,
        }
    }

    pub(crate) const fn degrees_of_freedom(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Ball => 3,
            Self::Free => 6,
        }
    }
}

/// A part of a configuration that is integrated as a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(hidden)]
pub struct Segment {
    #[doc(hidden)]
    pub kind: SegmentKind,
    /// Its joint, or the first joint of a free joint.
    pub(crate) joint: JointId,
    /// Index of its first coordinate in a configuration.
    #[doc(hidden)]
    pub coordinate: usize,
    /// Index of its first component in a velocity.
    #[doc(hidden)]
    pub velocity: usize,
}

impl Segment {
    /// The ball joint of a ball or free segment.
    pub(crate) fn ball(&self) -> JointId {
        match self.kind {
            SegmentKind::Free => JointId::new(self.joint.index() + 3),
            _ => self.joint,
        }
    }

    /// Index of its quaternion in a configuration; `None` for a scalar segment.
    pub(crate) fn quaternion(&self) -> Option<usize> {
        match self.kind {
            SegmentKind::Scalar => None,
            SegmentKind::Ball => Some(self.coordinate),
            SegmentKind::Free => Some(self.coordinate + 3),
        }
    }
}

/// The segments of joints in configuration order; `free` lists the first joint of each free joint.
///
/// # Errors
/// Returns an error for a free joint whose four joints are not consecutive.
pub(super) fn segments(
    joints: &[Joint],
    order: &[JointId],
    free: &[JointId],
) -> Result<Vec<Segment>, ModelError> {
    let mut segments = Vec::with_capacity(order.len());
    let (mut coordinate, mut velocity, mut position) = (0, 0, 0);
    while let Some(&joint) = order.get(position) {
        let first_joint = &joints[joint.index()];
        let kind = match first_joint.kind {
            JointKind::Ball => SegmentKind::Ball,
            _ if free.contains(&joint) => SegmentKind::Free,
            _ => SegmentKind::Scalar,
        };
        let parts = if kind == SegmentKind::Free { 4 } else { 1 };
        let candidates = order[position..].iter().zip(joint.index()..).take(parts);
        let mut violations = candidates.enumerate().map(|(part, (id, index))| {
            let kind = joints[id.index()].kind;
            let fits = if part < 3 {
                kind.slides()
            } else {
                kind.is_ball()
            };
            id.index() != index || !fits
        });
        let is_complete = position + parts <= order.len();
        if !is_complete || (parts > 1 && violations.any(|is_violated| is_violated)) {
            return Err(ModelError::BrokenFreeJoint {
                joint: first_joint.name.clone(),
            });
        }
        segments.push(Segment {
            kind,
            joint,
            coordinate,
            velocity,
        });
        coordinate += kind.coordinates();
        velocity += kind.degrees_of_freedom();
        position += parts;
    }
    Ok(segments)
}

/// The quaternion w, x, y, z at the start of a slice, normalised; `None` if it is zero or not finite.
#[doc(hidden)]
pub fn quaternion_at(numbers: &[f64]) -> Option<Quaternion<f64>> {
    let &[w, x, y, z] = numbers.first_chunk()?;
    // Scaled, so that a length of 1e-200 still has a direction.
    let largest = [w, x, y, z].iter().fold(0.0_f64, |max, c| max.max(c.abs()));
    if !(largest > 0.0 && largest.is_finite()) || [w, x, y, z].iter().any(|c| c.is_nan()) {
        return None;
    }
    let [w, x, y, z] = [w, x, y, z].map(|c| c / largest);
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let v = Vector3::new(x / length, y / length, z / length);
    Some(Quaternion { w: w / length, v })
}

/// Writes w, x, y, z.
pub(crate) fn write_quaternion(rotation: Quaternion<f64>, to: &mut [f64]) {
    let Quaternion { w, v } = rotation;
    to.copy_from_slice(&[w, v.x, v.y, v.z]);
}
