//! Picture of dragging: the humanoid without limits, at rest, dragged by a hand within its reach, and beyond it.

use std::path::Path;

use glam::DVec3;
use kinopt::Problem;
use kinopt::animation::Armature;
use kinopt::ik::Drag;
use kinopt::ik::hold_postures;
use kinopt::io::rig::Rig;
use kinopt::model::Limits;
use kinopt::task::Point;

use crate::Failure;
use crate::picture::{AT_REST, PAPER, POSED, draw_bones, ring};
use crate::render::{Quality, Scene, View, linear, render};
use crate::skin::add_posed;

/// Target of the left hand, metres, and position of the figure in the picture.
const FIGURES: [(Option<[f64; 3]>, f64); 3] = [
    (None, -1.75),
    (Some([0.45, 0.35, 1.45]), -0.2),
    (Some([0.7, 0.95, 1.75]), 1.25),
];
const SIZE: [usize; 2] = [900, 400];
/// Maximum number of frames until the body rests.
const MAX_FRAMES: usize = 300;

/// Stacked angles after a drag of the left hand to a target, radians.
fn drag(rig: &Rig, target: [f64; 3]) -> Result<Vec<f64>, Failure> {
    let armature = Armature::of_skeleton(&rig.skeleton);
    let skeleton = armature.skeleton("bare", |_| [Limits::UNBOUNDED; 3])?;
    let rest = skeleton.model().neutral();
    let pose = skeleton.pose(&rest)?;
    let hand = skeleton.bone("left_hand")?;
    let holds = skeleton.holds(&[hand]);
    let mut tasks = Problem::builder(skeleton.model());
    tasks.parameters(holds.parameters(&skeleton, &rest)?);
    tasks.add(Point::new(skeleton.tip(hand), target));
    for &end in &holds.ends {
        tasks.add(Point::new(skeleton.tip(end), pose.tip(&skeleton, end)?));
    }
    for posture in hold_postures(&holds, &skeleton, &rest)? {
        tasks.add(posture);
    }
    let mut drag = Drag::new(tasks.build()?, &rest)?;
    drag.settle(MAX_FRAMES);
    Ok(drag.q().to_vec())
}

/// Draws the three figures.
pub(crate) fn dragged(rig: &Rig, path: &Path) -> Result<(), Failure> {
    let rest = vec![0.0; rig.skeleton.angles()];
    let mut scene = Scene {
        paper: linear(PAPER),
        ..Scene::default()
    };
    let mut figures = Vec::new();
    for (target, offset) in FIGURES {
        let position = DVec3::new(0.0, offset, 0.0);
        let (q, colour) = match target {
            Some(target) => (drag(rig, target)?, POSED),
            None => (rest.clone(), AT_REST),
        };
        add_posed(&mut scene, rig, &q, position, linear(colour))?;
        figures.push((q, target, position));
    }
    let centre = DVec3::new(0.0, 0.05, 0.98);
    let view = View::new(centre + DVec3::new(7.5, -0.6, 1.0), centre, 2.45);
    let mut image = render(&scene, &view, SIZE, Quality::STILL);
    for (q, target, position) in figures {
        draw_bones(&mut image, &view, rig, &q, position)?;
        if let Some(target) = target {
            ring(&mut image, &view, DVec3::from(target) + position);
        }
    }
    image.write(path)
}
