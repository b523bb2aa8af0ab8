//! Reader of URDF.
//!
//! roxmltree parses the XML. The reader is strict with every element that a joint depends on: it returns an exact model
//! or an error with file, line and element. Defaults and the corrections of a lenient reader are listed as repairs.

mod corrections;
mod document;
mod joint_element;
mod link_element;
mod origin;
mod reader;
mod topology;
mod version;

pub use corrections::with_origin_corrections;
pub use reader::UrdfReader;
