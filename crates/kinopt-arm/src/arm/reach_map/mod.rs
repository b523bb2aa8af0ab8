//! Reach maps: for cells of poses, a configuration that reaches the centre, or a proof that no pose is reached.

mod base_placement;
mod build;
mod configuration_codes;
mod cube_grid;
mod data;
mod decisions;
mod error;
mod fingerprint;
mod merging;
mod orientation_bins;
mod query;

pub use base_placement::BasePlacement;
pub use build::ReachMapBuilder;
pub use data::ReachMapData;
pub use error::ReachMapError;
pub use fingerprint::ArmFingerprint;
pub use query::{CellReach, PoseReach};

use super::arm::Arm;

/// Table of the poses that an arm reaches.
///
/// The grid divides positions into cubes about the arm's base, and orientations into bins. A cell is one cube and one
/// bin. Each cell holds a configuration that reaches its centre, or a proof that no pose in it is reached, or neither.
/// A [query](Self::query) looks a cell up, and [`decide`](Self::decide) continues with exact inverse kinematics from the
/// cell's configuration.
///
/// Maps of equal arms and options are bitwise equal, whatever the number of threads.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// # use kinopt::arm::{Arm, CellReach, PoseBounds, ReachMap};
/// # use kinopt::robot::Robot;
/// # use kinopt::spatial::{Placement, Vector3};
/// let robot = Robot::read("models/franka_panda.urdf")?;
/// let arm = Arm::builder(&robot, "base", "flange").with_goal(PoseBounds::position()).build()?;
/// let map = ReachMap::builder(&arm).with_position_step(0.2).build()?;
/// let above = Placement::translation(Vector3::new(0.0, 0.0, 1.5));
/// assert_eq!(map.query(&above)?, CellReach::Unreachable);
/// let front = Placement::translation(Vector3::new(0.5, 0.0, 0.4));
/// assert!(matches!(map.query(&front)?, CellReach::Reached { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ReachMap {
    data: ReachMapData,
}

impl ReachMap {
    /// Starts the builder of the map of an arm, with its tool, goal and tolerances.
    #[must_use]
    pub fn builder(arm: &Arm) -> ReachMapBuilder<'_> {
        ReachMapBuilder::new(arm)
    }

    /// A map from the arrays of [`data`](Self::data).
    ///
    /// # Errors
    /// Returns an error that names an array that does not fit to another one.
    pub fn from_data(data: ReachMapData) -> Result<Self, ReachMapError> {
        data.check()?;
        Ok(Self { data })
    }

    /// Arrays of the map, for saving.
    #[must_use]
    pub fn data(&self) -> &ReachMapData {
        &self.data
    }

    /// Checks that the map was built for an equal arm.
    ///
    /// # Errors
    /// Returns an error that names what differs: joints, limits, goal, tolerances, or the placement of the tool.
    pub fn check_arm(&self, arm: &Arm) -> Result<(), ReachMapError> {
        self.data.arm.check(&ArmFingerprint::of(arm)?)
    }
}
