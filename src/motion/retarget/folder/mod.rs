//! Folders of movements: what goes where, what is left of it, and what was asked, so that whoever began a folder, another goes on.
//!
//! Files are written under [another name](unfinished) first, so that one that is there is whole.

mod error;
mod movement_folder;
mod question;

pub use error::FolderError;
pub use movement_folder::{Movement, MovementFolder, unfinished};
pub use question::FolderQuestion;

/// In a folder of movements: what was asked of it, so that it has the answers to one question.
pub const QUESTION: &str = "retarget.json";
