//! What the readers of robots' files share: XML, elements read strictly, and what can be wrong with them.

mod element;
mod error;
mod parse;
mod reading;
mod repair;

pub(super) use element::{Element, Named, is};
pub use error::{Fault, RobotFileError};
pub(super) use parse::{mended, parse};
pub(super) use reading::Reading;
pub use repair::{Mended, Repair};
