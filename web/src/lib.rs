//! The WebAssembly module of the npm package `kinopt`: the concepts of the Rust library under the names of the Python
//! package in camel case.
//!
//! Numbers come in and go out as typed arrays. What is posed every frame is read where it lies, as views of the module's
//! memory; see [`view`]. Errors are exceptions with the library's own messages.

// What JavaScript sees must be `pub`, in whatever module it is.
#![allow(unreachable_pub)]

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
mod given;
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
mod view;
#[cfg(feature = "collision")]
mod world;

/// An exception with an error's own message, in which options have their names of JavaScript.
fn raise(error: impl std::fmt::Display) -> wasm_bindgen::JsError {
    wasm_bindgen::JsError::new(&names::of_javascript(&error.to_string()))
}
