//! Targets of one sample.

use super::on_terrain::SoleGround;
use kinopt_kinematics::spatial::Vector3;

/// Targets of one sample, in the unit of the solved body.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameTargets<'a> {
    /// Position of each driven point.
    pub(super) positions: &'a [Vector3<f64>],
    /// Directions of the driven axes of feet and hands, or empty.
    pub(super) directions: &'a [Vector3<f64>],
    /// Contact of each driven point, from 0 (free) to 1 (locked in place).
    pub(super) contacts: &'a [f64],
    /// Level at which each driven point holds an object, from 0 to 1, or empty.
    pub(super) grasps: &'a [f64],
    /// Terrain under each sole, or empty for level ground.
    pub(super) grounds: &'a [SoleGround],
}

impl<'a> FrameTargets<'a> {
    /// Targets without orientations, objects and terrain.
    pub(super) fn of_points(positions: &'a [Vector3<f64>], contacts: &'a [f64]) -> Self {
        Self {
            positions,
            directions: &[],
            contacts,
            grasps: &[],
            grounds: &[],
        }
    }
}
