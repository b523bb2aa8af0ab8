//! Reads robots from URDF.
//!
//! roxmltree parses the XML, and every element that a joint depends on is read strictly: there is an
//! error with a file, a line and a name, or a model that says what the file says. What a file leaves
//! to defaults, and what a lenient reader mended, is listed.

mod document;
mod joint_element;
mod link_element;
mod origin;
mod reader;
mod topology;
mod version;

pub use reader::UrdfReader;
