//! Reads robots from MJCF, MuJoCo's files.
//!
//! A document and what it includes become one tree of tags; attributes are asked for through the classes of
//! defaults; bodies, joints and sites are read strictly and what no joint depends on is left out with a note.
//! Semantics: MuJoCo's documentation, "XML Reference", held against MuJoCo's own placements.

mod attributes;
mod body;
mod build;
mod compiler;
mod contact;
mod defaults;
mod equality;
mod geom;
mod inertial;
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
mod weights;

pub use reader::MjcfReader;
