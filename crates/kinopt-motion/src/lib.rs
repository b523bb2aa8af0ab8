//! Trajectory optimisation, clip IK and retargeting.
//!
//! Depend on [`kinopt`](https://docs.rs/kinopt), which re-exports this crate. Hidden items may change in any version.

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod motion;
