//! What the readers of robots' files share: XML, elements read strictly, and what can be wrong with them.

mod element;
mod error;
mod parse;
mod reading;
mod repair;
mod rotation;

pub(super) use element::{Element, Named, exactly, is};
pub use error::{Fault, RobotFileError};
#[cfg(all(feature = "mjcf", feature = "urdf"))]
pub(super) use parse::root_name;
pub(super) use parse::{mended, parse};
pub(super) use reading::Reading;
pub use repair::{Mended, Repair};
pub(super) use rotation::{clean_sin_cos, rotation_of_wxyz};
