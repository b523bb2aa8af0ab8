//! Rigs from several sides, at rest and posed: for the eye of whoever changes them.

use std::path::Path;

use glam::DVec3;
use kinopt::io::rig::Rig;

use crate::Failure;
use crate::render::{Scene, View, linear, render};
use crate::skin::add_posed;

/// The rig in each of the poses, one beside the other, from the side of `eye`.
pub(crate) fn contact_sheet(
    rig: &Rig,
    poses: &[Vec<f64>],
    eye: DVec3,
    size: [usize; 2],
    path: &Path,
) -> Result<(), Failure> {
    let mut scene = Scene {
        paper: linear(0xf4f5f7),
        ..Scene::default()
    };
    let across = DVec3::Z.cross(eye).normalize();
    let (tall, apart) = (
        rig.mesh
            .as_ref()
            .and_then(|m| m.bounding_box())
            .map_or(1.0, |[_, high]| f64::from(high.z)),
        0.85,
    );
    for (index, q) in poses.iter().enumerate() {
        let place = index as f64 - 0.5 * (poses.len() - 1) as f64;
        add_posed(
            &mut scene,
            rig,
            q,
            across * (place * apart * tall),
            linear(0x8fa9c4),
        )?;
    }
    scene.ground = scene
        .positions
        .iter()
        .fold(f64::INFINITY, |low, p| low.min(p.z));
    let centre = DVec3::Z * (0.5 * tall + 0.5 * scene.ground);
    let view = View::new(
        centre + eye.normalize() * 6.0 * tall,
        centre,
        1.2 * tall - scene.ground,
    );
    render(&scene, &view, size, 2).write(path)
}
