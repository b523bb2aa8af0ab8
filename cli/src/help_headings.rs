//! Headings of option groups in `--help`.

pub(crate) const TARGETS: &str = "Targets";
pub(crate) const MODEL: &str = "Model";
pub(crate) const SEARCH: &str = "Search";
pub(crate) const LIMITS: &str = "Limits of the search";
pub(crate) const PREFERENCES: &str = "Preferences";
pub(crate) const FOLLOWING: &str = "Following";
pub(crate) const OUTPUT: &str = "Output";
pub(crate) const MESHES: &str = "Meshes";
pub(crate) const COLLISIONS: &str = "Collision shapes";
