//! Triangle meshes, and files of meshes and matrices.
//!
//! Depend on [`kinopt`](https://docs.rs/kinopt), which re-exports this crate. Hidden items may change in any version.

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod dmat;
#[doc(hidden)]
pub mod json;
pub mod mesh;
pub mod obj;
pub mod ply;
