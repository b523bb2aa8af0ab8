//! Shared helpers of the tests: random models, reference evaluations and handwritten files.
//!
//! Reference evaluations use nalgebra alone, so that no promise is judged by the code under test.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "only tests use it"
)]

pub mod armatures;
pub mod arms;
pub mod bodies;
pub mod body_tasks;
pub mod bones;
pub mod box_sides;
pub mod changed_bodies;
pub mod checked_arms;
pub mod classics;
pub mod configuration_rules;
pub mod convex_shapes;
pub mod courses;
pub mod dual_numbers;
pub mod fault_tables;
pub mod figures;
pub mod folders;
pub mod follower_chains;
pub mod gltf_text;
pub mod limbs;
pub mod lines;
pub mod maps;
pub mod methods;
pub mod path_steps;
pub mod random;
pub mod retargeted;
pub mod shipped_arms;
pub mod simd_chains;
pub mod skins;
pub mod small_rig;
pub mod state_machines;
pub mod stationary;
pub mod tasks;
pub mod trees;
#[path = "../../examples/rust/twisted_tube/tube.rs"]
pub mod twisted_tube;
pub mod urdf_matrices;

use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;

/// Rigid transform of the reference evaluations.
pub type Rigid = na::IsometryMatrix3<f64>;

/// The same rigid transform as the library's type, with equal numbers.
pub fn placement(rigid: &Rigid) -> Placement<f64> {
    Placement::new(
        rigid.rotation.into_inner().into(),
        rigid.translation.vector.into(),
    )
}

pub fn rigid(rotation: na::Rotation3<f64>, translation: na::Vector3<f64>) -> Rigid {
    Rigid::from_parts(na::Translation3::from(translation), rotation)
}

/// The largest difference between two placements, entry by entry.
pub fn apart(ours: &Placement<f64>, theirs: &Rigid) -> f64 {
    let rotation: na::Matrix3<f64> = ours.rotation.into();
    let translation: na::Vector3<f64> = ours.translation.into();
    let turned = (rotation - theirs.rotation.matrix()).amax();
    turned.max((translation - theirs.translation.vector).amax())
}

pub fn vector(v: na::Vector3<f64>) -> Vector3<f64> {
    v.into()
}

/// A planar arm in the xy plane: links along x, joints about z, a frame `tip` at the end.
pub fn planar_arm(links: &[f64], limits: Option<(f64, f64)>) -> kinopt::Model {
    use kinopt::model::{Limits, Model};
    let mut builder = Model::builder("planar arm");
    let about_z = Vector3::new(0.0, 0.0, 1.0);
    let along_x = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    let (mut parent, mut offset) = (None, Placement::identity());
    for (k, &link) in links.iter().enumerate() {
        let name = format!("joint {k}");
        parent = Some(match limits {
            Some((lower, upper)) => {
                builder.revolute(name, parent, offset, about_z, Limits::new(lower, upper))
            }
            None => builder.continuous(name, parent, offset, about_z),
        });
        offset = along_x(link);
    }
    builder.frame("tip", parent, offset);
    builder.build().unwrap()
}

/// Position of a planar arm's tip.
pub fn planar_tip(links: &[f64], q: &[f64]) -> na::Vector3<f64> {
    let mut angle = 0.0;
    let mut tip = na::Vector3::zeros();
    for (link, turn) in links.iter().zip(q) {
        angle += turn;
        tip += na::Vector3::new(f64::cos(angle), f64::sin(angle), 0.0) * *link;
    }
    tip
}
