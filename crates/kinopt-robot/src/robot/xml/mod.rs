//! Shared parts of the readers of robot files: XML parsing, strict elements and errors.

// Some functions have only the lenient URDF reader as caller.
#[cfg_attr(not(feature = "urdf"), allow(dead_code))]
mod element;
mod error;
#[cfg_attr(not(feature = "urdf"), allow(dead_code))]
mod parse;
#[cfg_attr(not(feature = "urdf"), allow(dead_code))]
mod reading;
mod repair;
#[cfg(any(feature = "mjcf", feature = "urdf"))]
mod rotation;

#[cfg(feature = "urdf")]
pub(super) use element::Named;
#[cfg(feature = "mjcf")]
pub(super) use element::exactly;
pub(super) use element::{Element, is};
pub(crate) use error::Read;
pub use error::{ParseIssue, RobotFileError};
#[cfg(feature = "mjcf")]
pub(super) use parse::root_name;
pub(super) use parse::{parse, repaired_xml};
pub(super) use reading::Reading;
pub use repair::{Repair, RepairKind};
#[cfg(any(feature = "mjcf", feature = "urdf"))]
pub(super) use rotation::rotation_of_wxyz;
