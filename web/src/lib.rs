//! WebAssembly module of the npm package `kinopt`: the concepts of the Rust library under the names of the Python
//! package in camel case.
//!
//! Numbers are passed as typed arrays. Results of every frame are views of the module's memory; see [`view`]. Errors
//! are exceptions with the library's messages; see [`error`].

// Exports to JavaScript must be `pub`, in any module.
#![allow(unreachable_pub)]

mod arguments;
mod arm;
#[cfg(feature = "bodies")]
mod armature;
#[cfg(feature = "bvh")]
mod capture;
#[cfg(any(feature = "bvh", feature = "gltf"))]
mod clip;
#[cfg(feature = "clip-ik")]
mod clip_ik;
mod clock;
#[cfg(feature = "bodies")]
mod contents;
#[cfg(feature = "bodies")]
mod drag;
mod error;
#[cfg(feature = "bodies")]
mod euler_clip;
#[cfg(any(feature = "bvh", feature = "gltf"))]
mod figure;
mod joint_path;
mod kinematics;
#[cfg(feature = "bodies")]
mod masses;
mod model;
mod names;
mod object;
#[cfg(feature = "bodies")]
mod parameters;
#[cfg(feature = "paths")]
mod path;
mod placement;
#[cfg(feature = "bodies")]
mod playback;
#[cfg(feature = "bodies")]
mod posing;
#[cfg(feature = "bodies")]
mod problem;
#[cfg(feature = "recording")]
mod recording;
#[cfg(feature = "retargeting")]
mod retargeting;
#[cfg(feature = "bodies")]
mod rig;
mod robot;
#[cfg(feature = "gltf")]
mod scene;
#[cfg(feature = "gltf")]
mod scene_file;
#[cfg(feature = "bodies")]
mod skeleton;
mod solution;
#[cfg(feature = "bodies")]
mod solver;
mod srdf;
#[cfg(feature = "bodies")]
mod task;
mod value;
mod view;
#[cfg(feature = "collision")]
mod world;
