//! Reader of MJCF, the format of MuJoCo.
//!
//! A document and its includes form one tree of tags. Attributes are looked up through the default classes. The reader
//! is strict with bodies, joints and sites. Faulty elements that no joint depends on are left out with a note.
//!
//! Semantics: MuJoCo's documentation, "XML Reference"; tests compare with poses that MuJoCo computes.

mod attributes;
mod body;
mod build;
mod compiler;
mod contact;
mod defaults;
mod equality;
mod geom;
mod inertial;
mod inertias;
mod joint;
mod loops;
mod mesh;
mod names;
mod orientation;
mod passive;
mod reader;
mod segment;
mod solid;
mod tree;

pub use reader::MjcfReader;
