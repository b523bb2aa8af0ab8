//! Collision models of robots, and spheres that cover them.

mod model;
mod obstacles;
mod spheres;

pub(crate) use model::{CollisionModel, CollisionOptions};
pub(crate) use obstacles::Obstacles;
pub(crate) use spheres::SphereModel;
