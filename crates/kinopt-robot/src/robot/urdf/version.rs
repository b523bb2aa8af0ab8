//! Version of the URDF standard that a file follows.

use crate::robot::xml::Element;

/// Major and minor version of the URDF standard; 1.0 by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(pub(super) u32, pub(super) u32);

impl Version {
    pub(super) fn of(robot: &Element<'_>) -> Self {
        let read = |version: &str| {
            let (major, minor) = version.trim().split_once('.')?;
            Some(Self(major.parse().ok()?, minor.parse().ok()?))
        };
        robot.text("version").and_then(read).unwrap_or(Self(1, 0))
    }

    /// Defaults of `lower` and `upper`, radians or metres.
    pub(super) fn default_limits(self) -> (f64, f64) {
        if self < Self(1, 2) {
            (0.0, 0.0)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        }
    }
}
