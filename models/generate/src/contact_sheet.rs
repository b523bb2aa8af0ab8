//! Contact sheet of a rig: the rest pose and poses across its limits, for visual inspection.

use std::path::Path;

use glam::DVec3;
use kinopt::io::rig::Rig;

use crate::Failure;
use crate::render::{Quality, Scene, View, linear, render};
use crate::skin::add_posed;

const POSES: usize = 5;
const SIZE: [usize; 2] = [1800, 560];

/// Draws the rig at rest and in other poses in a row, seen from the direction `eye`.
pub(crate) fn contact_sheet(rig: &Rig, eye: DVec3, path: &Path) -> Result<(), Failure> {
    let mut scene = Scene {
        paper: linear(0xf4f5f7),
        ..Scene::default()
    };
    let across = DVec3::Z.cross(eye).normalize();
    let height = rig.skeleton.size();
    for pose in 0..POSES {
        let column = pose as f64 - 0.5 * (POSES - 1) as f64;
        let q = angles(rig, pose);
        let shift = across * (column * 0.8 * height);
        add_posed(&mut scene, rig, &q, shift, linear(0x8fa9c4))?;
    }
    let heights = scene.positions.iter().map(|p| p.z);
    scene.ground = heights.fold(f64::INFINITY, f64::min);
    let centre = DVec3::Z * 0.45 * height;
    let view = View::new(
        centre + eye.normalize() * 6.0 * height,
        centre,
        1.35 * height,
    );
    let quality = Quality {
        samples: 1,
        paper_samples: 1,
        ..Quality::STILL
    };
    render(&scene, &view, SIZE, quality).write(path)
}

/// Stacked angles of a pose, radians: zero for pose 0, then up to two thirds of each limit. Powers of an irrational
/// number spread the angles evenly and without correlation.
fn angles(rig: &Rig, pose: usize) -> Vec<f64> {
    let limits = rig.skeleton.bones().iter().flat_map(|bone| bone.limits);
    let angles = limits.enumerate().map(|(index, limits)| {
        let unit = (index as f64 * 0.618_034 + pose as f64 * 0.381_97).fract();
        let fraction = if pose == 0 {
            0.0
        } else {
            0.66 * (2.0 * unit - 1.0)
        };
        fraction.abs()
            * if fraction < 0.0 {
                limits.lower
            } else {
                limits.upper
            }
    });
    angles.collect()
}
