//! WebAssembly module of the npm package `kinopt`: the concepts of the Rust library under the names of the Python
//! package in camel case.
//!
//! Numbers are passed as typed arrays. Results of every frame are views of the module's memory; see [`view`]. Errors
//! are exceptions with the library's messages.

// Exports to JavaScript must be `pub`, in any module.
#![allow(unreachable_pub)]

mod arguments;
mod arm;
mod armature;
#[cfg(feature = "bvh")]
mod capture;
#[cfg(any(feature = "bvh", feature = "gltf"))]
mod clip;
#[cfg(feature = "clip-ik")]
mod clip_ik;
mod clock;
mod contents;
mod drag;
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
mod parameters;
#[cfg(feature = "paths")]
mod path;
mod placement;
mod playback;
mod problem;
#[cfg(feature = "recording")]
mod recording;
#[cfg(feature = "retargeting")]
mod retargeting;
mod rig;
mod robot;
#[cfg(feature = "gltf")]
mod scene;
#[cfg(feature = "gltf")]
mod scene_file;
mod skeleton;
mod solution;
mod solver;
mod srdf;
mod task;
mod value;
mod view;
#[cfg(feature = "collision")]
mod world;

/// Exception with the message of an error, with option names of JavaScript.
fn raise(error: impl std::fmt::Display) -> wasm_bindgen::JsError {
    wasm_bindgen::JsError::new(&names::of_javascript(&error.to_string()))
}
