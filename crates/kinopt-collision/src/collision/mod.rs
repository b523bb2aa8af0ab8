//! Shapes, exact distances between them, and worlds of obstacles.
//!
//! A [`Shape`] is validated when it is made and is cheap to clone. [`separation`] returns the signed distance of two
//! shapes, negative if they overlap, with the closest points. A [`World`] holds named obstacles: shapes with a
//! placement, some of them attached to a frame of the robot.
//!
//! ```
//! use kinopt::collision::{Shape, World, separation};
//! use kinopt::spatial::{Placement, Vector3};
//!
//! let mut world = World::new();
//! world.add_box("table", [1.0, 0.6, 0.04], Vector3::new(0.5, 0.0, 0.4))?;
//! let ball = Shape::sphere(0.1)?;
//! let table = world.obstacle("table")?;
//! let above = Placement::translation(Vector3::new(0.5, 0.0, 0.6));
//! let apart = separation(&ball, &above, &table.shape, &table.placement);
//! assert!((apart.distance - 0.08).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod aabb_tree;
mod bounding_box;
mod checker;
mod convex_surface;
mod distance;
#[doc(hidden)]
pub mod dynamic_aabb_tree;
mod mesh_file;
mod mesh_folders;
mod model;
mod shape;
mod sphere_model;
#[doc(hidden)]
pub mod wide_aabb_tree;
pub(crate) mod world;

pub use bounding_box::BoundingBox;
#[doc(hidden)]
pub use checker::FIRST_PLANE;
pub use checker::{Checker, CheckerWorkspace, Clearance, MotionCheck, MotionChecker};
pub(crate) use distance::ROUNDING;
pub use distance::{Separation, separation, separation_within};
pub use kinopt_solver::problem::{BodyKind, Collision};
pub use mesh_file::MeshFile;
pub use model::{
    CollisionModel, CollisionModelBuilder, CollisionModelError, CollisionObject, MeshUse,
};
pub use shape::{
    Ball, ConvexHull, HeightField, PointCloud, Shape, ShapeError, ShapeKind, ShapeNote, TriMesh,
};
pub use sphere_model::{Resolution, SphereGroup, SphereModel};
pub use world::{Obstacle, World, WorldError};
