//! Whole motions: many frames solved as one.
#![allow(clippy::unwrap_used, clippy::panic)]

mod bad_motions;
mod clip_minima;
mod contacts;
mod turning_bodies;
mod walker;
mod windows;
