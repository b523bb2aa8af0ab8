//! Arrays of a reach map, for saving and loading.

use super::cube_grid::CubeGrid;
use super::error::ReachMapError;
use super::fingerprint::ArmFingerprint;
use super::orientation_bins::OrientationBins;
use kinopt_kinematics::spatial::Vector3;

/// Cube that the tool never enters: it is proven.
pub(super) const EXCLUDED: u32 = u32::MAX;
/// Cube of another part of the map.
pub(super) const ABSENT: u32 = u32::MAX - 1;
/// Cell without a pose that is reached: it is proven.
pub(super) const UNREACHABLE: u32 = u32::MAX;
/// Cell without a solution at its centre and without a proof.
pub(super) const UNKNOWN: u32 = u32::MAX - 1;

/// Arrays of a [`ReachMap`](super::ReachMap).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReachMapData {
    /// The arm that the map was built for.
    pub arm: ArmFingerprint,
    /// Centre of the grid in the base frame, metres.
    pub centre: [f64; 3],
    /// Edge of a cube of positions, metres.
    pub position_step: f64,
    /// Number of cubes along each axis.
    pub cubes_per_axis: u32,
    /// Number of bins along each angle of a face of orientations; 0 for a goal without orientation.
    pub bins_per_face: u32,
    /// For each cube the number of its block of cells, or `u32::MAX` for a cube that the tool never enters, or
    /// `u32::MAX - 1` for a cube of another part. Cubes are in the order of x, y, z, with z fastest.
    pub cubes: Vec<u32>,
    /// For each cell of each block the row of its configuration, or `u32::MAX` for proven unreachable, or
    /// `u32::MAX - 1` for unknown. Cells are in the order of their bins.
    pub cells: Vec<u32>,
    /// Rows of configurations: fractions of the joint limits from 0 to 65 535, or of ±π for a joint without limits.
    pub configurations: Vec<u16>,
}

impl ReachMapData {
    pub(super) fn grid(&self) -> CubeGrid {
        CubeGrid {
            centre: self.centre.into(),
            step: self.position_step,
            per_axis: self.cubes_per_axis as usize,
        }
    }

    pub(super) fn bins(&self) -> OrientationBins {
        OrientationBins {
            per_face: self.bins_per_face as usize,
        }
    }

    /// Checks that all arrays fit together, so that queries stay within them.
    pub(super) fn check(&self) -> Result<(), ReachMapError> {
        let damaged = |array, problem| Err(ReachMapError::Damaged { array, problem });
        let joints = self.arm.joints.len();
        if joints == 0 || self.arm.lower.len() != joints || self.arm.upper.len() != joints {
            return damaged("joints", "and the joint limits have different lengths");
        }
        let ordered = |(lower, upper): (&f64, &f64)| lower <= upper;
        if !self.arm.lower.iter().zip(&self.arm.upper).all(ordered) {
            return damaged("lower", "has a limit above that in `upper`");
        }
        let is_size = self.position_step > 0.0 && self.position_step.is_finite();
        if !is_size || !Vector3::from(self.centre).is_finite() {
            return damaged(
                "position_step",
                "and `centre` must be finite, the step above 0",
            );
        }
        if self.cubes_per_axis > 1281 || self.cubes.len() != self.grid().cubes() {
            return damaged("cubes", "does not have `cubes_per_axis` cubed entries");
        }
        if self.bins_per_face > 64 {
            return damaged("bins_per_face", "is above 64");
        }
        let bins = self.bins().count();
        if !self.cells.len().is_multiple_of(bins) {
            return damaged("cells", "is not made of whole blocks of bins");
        }
        let blocks = self.cells.len() / bins;
        if (self.cubes.iter()).any(|&block| block < ABSENT && block as usize >= blocks) {
            return damaged("cubes", "has a block beyond those in `cells`");
        }
        if !self.configurations.len().is_multiple_of(joints) {
            return damaged("configurations", "is not made of whole rows");
        }
        let rows = self.configurations.len() / joints;
        if (self.cells.iter()).any(|&row| row < UNKNOWN && row as usize >= rows) {
            return damaged("cells", "has a row beyond those in `configurations`");
        }
        Ok(())
    }
}
