//! Limits that a clip does not keep.

use nalgebra::DVector;

use super::basis::Row;
use crate::skeleton::BoneId;

/// A limit that solved keyframes are still beyond, as keys that were not solved for are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BeyondLimit {
    /// Which bone.
    pub bone: BoneId,
    /// Which of its angles: 0, 1 or 2 for first twist, bend, second twist.
    pub angle: usize,
    /// By how much at most, in radians, told of the spline's control points.
    pub by: f64,
    /// When that is, in seconds of the clip.
    pub at: f64,
}

/// What rounding may hide, radians.
const HIDDEN: f64 = 1e-9;

impl BeyondLimit {
    /// The most of each angle that is beyond, in the order of the rows.
    pub(super) fn all(rows: &[Row], x: &DVector<f64>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for row in rows {
            let by = row.beyond(x);
            if by <= HIDDEN {
                continue;
            }
            let told = Self {
                bone: row.bone,
                angle: row.angle,
                by,
                at: row.time,
            };
            match all.last_mut() {
                Some(last) if (last.bone, last.angle) == (told.bone, told.angle) => {
                    if by > last.by {
                        *last = told;
                    }
                }
                _ => all.push(told),
            }
        }
        all
    }
}
