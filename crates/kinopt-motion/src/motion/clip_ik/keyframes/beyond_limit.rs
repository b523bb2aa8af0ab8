//! Joint limits that solved keyframes exceed.

use nalgebra::DVector;

use super::basis::Row;
use kinopt_kinematics::skeleton::BoneId;

/// Joint limit that solved keyframes still exceed, for example because of a key that was not solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BeyondLimit {
    /// Bone of the limit.
    pub bone: BoneId,
    /// Index of the bone's angle: 0, 1 or 2 for first twist, bend and second twist.
    pub angle: usize,
    /// Largest excess of the spline's control points over the limit, radians.
    pub by: f64,
    /// Time of the largest excess, seconds in the clip.
    pub at: f64,
}

/// Excess below which a limit counts as satisfied, radians: an allowance for rounding.
const EXCESS_TOLERANCE: f64 = 1e-9;

impl BeyondLimit {
    /// Returns the largest excess of each angle, in the order of the rows.
    pub(super) fn all(rows: &[Row], x: &DVector<f64>) -> Vec<Self> {
        let mut limits: Vec<Self> = Vec::new();
        for row in rows {
            let by = row.limit_excess(x);
            if by <= EXCESS_TOLERANCE {
                continue;
            }
            let entry = Self {
                bone: row.bone,
                angle: row.angle,
                by,
                at: row.time,
            };
            match limits.last_mut() {
                Some(last) if (last.bone, last.angle) == (entry.bone, entry.angle) => {
                    if by > last.by {
                        *last = entry;
                    }
                }
                _ => limits.push(entry),
            }
        }
        limits
    }
}
