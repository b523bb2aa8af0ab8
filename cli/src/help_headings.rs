//! Headings of option groups in `--help`.

pub(crate) const TARGETS: &str = "Targets";
pub(crate) const BALANCE: &str = "Balance";
pub(crate) const MODEL: &str = "Model";
pub(crate) const SEARCH: &str = "Search";
pub(crate) const LIMITS: &str = "Limits";
pub(crate) const OUTPUT: &str = "Output";
pub(crate) const COLLISIONS: &str = "Collisions";
