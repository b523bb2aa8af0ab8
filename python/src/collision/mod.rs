//! Collision shapes of robots, and spheres that cover them.

mod model;
mod spheres;

pub(crate) use model::{CollisionModel, Taking};
pub(crate) use spheres::SphereModel;
