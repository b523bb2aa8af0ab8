//! Picture of the README: the humanoid at rest, and with five targets reached at once.

use std::path::Path;

use glam::DVec3;
use kinopt::ik::Restarts;
use kinopt::io::rig::Rig;
use kinopt::task::{Orientation, Point, Posture, Quantity, Task};
use kinopt::{Problem, Solver};

use crate::Failure;
use crate::render::{Image, Quality, Scene, View, linear, render};
use crate::skin::add_posed;

/// Targets of the tips, metres.
const TARGETS: [(&str, [f64; 3]); 5] = [
    ("head", [0.14, 0.05, 1.72]),
    ("left_hand", [0.32, 0.6, 1.86]),
    ("right_hand", [0.06, -0.91, 1.32]),
    ("left_foot", [0.1, 0.1, 0.06]),
    ("right_foot", [-0.62, -0.28, 0.52]),
];
/// Weights of the nominal posture in successive solves, metres per radian. The first selects a natural pose; the last
/// does not disturb the targets.
const POSTURE_WEIGHTS: [f64; 3] = [0.1, 0.01, 1e-3];
/// Position tolerance, metres.
const TOLERANCE: f64 = 1e-4;

const SIZE: [usize; 2] = [1280, 820];
pub(crate) const PAPER: u32 = 0xfafafa;
pub(crate) const AT_REST: u32 = 0xc9ccd1;
pub(crate) const POSED: u32 = 0x5b9bd5;
const TARGET_COLOUR: u32 = 0xf2542d;
const BONE_COLOUR: u32 = 0xffffff;

/// Stacked angles of the rig with every tip at its target, radians.
pub(crate) fn reach(rig: &Rig) -> Result<Vec<f64>, Failure> {
    let rest = vec![0.0; rig.skeleton.angles()];
    let mut q = rest.clone();
    let mut reached = Err("there is nothing to solve".into());
    for weight in POSTURE_WEIGHTS {
        // Only the last problem has to be reached; the first two supply its start.
        let solution = Solver::default()
            .with_restarts(Restarts::none())
            .solve_once(&problem(rig, &rest, weight)?, &q)?;
        reached = match solution.reached {
            true => Ok(()),
            false => Err(solution.explain().to_string()),
        };
        q = solution.q;
    }
    reached.map_err(|why| format!("the picture's targets are not reached: {why}"))?;
    Ok(q)
}

fn problem(rig: &Rig, rest: &[f64], posture_weight: f64) -> Result<Problem, Failure> {
    let skeleton = &rig.skeleton;
    let mut problem = Problem::builder(skeleton.model());
    for (bone, target) in TARGETS {
        let tip = skeleton.tip(skeleton.bone(bone)?);
        let task = Task::new(Point::new(tip, target)).tolerance(Quantity::Metres, TOLERANCE);
        problem.add(task);
    }
    // The sole on the ground stays level.
    let foot = skeleton.bone("left_foot")?;
    if let Some(bone) = skeleton.bones().get(foot.index()) {
        let level = Orientation::new(skeleton.tail(foot), bone.model_from_rest.rotation);
        let level = Task::new(level).weight(Quantity::Radians, 5.0 * posture_weight);
        problem.add(level.preference());
    }
    let posture = Posture::new(skeleton.model(), rest);
    problem.add(Task::new(posture).weight(Quantity::JointUnits, posture_weight));
    Ok(problem.build()?)
}

/// Draws both figures.
pub(crate) fn picture(rig: &Rig, path: &Path) -> Result<(), Failure> {
    let rest = vec![0.0; rig.skeleton.angles()];
    let posed = reach(rig)?;
    let mut scene = Scene {
        paper: linear(PAPER),
        ..Scene::default()
    };
    let (rest_position, posed_position) =
        (DVec3::new(-0.35, -1.24, 0.0), DVec3::new(0.0, 0.42, 0.0));
    // The lowest point of each figure is on the ground.
    let mut place_on_ground = |q: &[f64], position: DVec3, colour: u32| -> Result<DVec3, Failure> {
        let mut figure_scene = Scene::default();
        add_posed(&mut figure_scene, rig, q, position, DVec3::ZERO)?;
        let lowest = figure_scene
            .positions
            .iter()
            .fold(f64::INFINITY, |lowest, p| lowest.min(p.z));
        let position = position - DVec3::Z * lowest;
        add_posed(&mut scene, rig, q, position, linear(colour))?;
        Ok(position)
    };
    let rest_position = place_on_ground(&rest, rest_position, AT_REST)?;
    let posed_position = place_on_ground(&posed, posed_position, POSED)?;

    let centre = DVec3::new(0.0, -0.4, 0.97);
    let view = View::new(centre + DVec3::new(6.2, -1.3, 1.1), centre, 2.2);
    let mut image = render(&scene, &view, SIZE, Quality::STILL);
    draw_bones(&mut image, &view, rig, &rest, rest_position)?;
    draw_bones(&mut image, &view, rig, &posed, posed_position)?;
    for (_, target) in TARGETS {
        ring(&mut image, &view, DVec3::from(target) + posed_position);
    }
    image.write(path)
}

pub(crate) fn draw_bones(
    image: &mut Image,
    view: &View,
    rig: &Rig,
    q: &[f64],
    position: DVec3,
) -> Result<(), Failure> {
    let placements = rig.skeleton.pose(q)?;
    for bone in rig.skeleton.bone_ids() {
        let ends = [placements.tail(bone)?, placements.tip(&rig.skeleton, bone)?];
        let ends = ends.map(|p| DVec3::from(p) + position);
        view.line(image, ends, 0.008, linear(BONE_COLOUR), 0.55);
        view.line(image, [ends[0]; 2], 0.024, linear(BONE_COLOUR), 0.8);
    }
    Ok(())
}

/// Draws a ring around a target, with a dot on the target.
pub(crate) fn ring(image: &mut Image, view: &View, centre: DVec3) {
    const CORNERS: usize = 48;
    let (right, up) = view.across();
    let point = |corner: usize| {
        let (sin, cos) = (corner as f64 / CORNERS as f64 * std::f64::consts::TAU).sin_cos();
        centre + (right * cos + up * sin) * 0.052
    };
    for corner in 0..CORNERS {
        view.line(
            image,
            [point(corner), point(corner + 1)],
            0.011,
            linear(TARGET_COLOUR),
            1.0,
        );
    }
    view.line(image, [centre; 2], 0.026, linear(TARGET_COLOUR), 1.0);
}
