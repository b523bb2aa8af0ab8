//! Picture of balance: the humanoid on a free base, within a person's cones, with flat feet and balanced over them.
//!
//! The figures are a crouched configuration, and drags of the left hand down, ahead and up.

use std::path::Path;

use glam::DVec3;
use kinopt::Problem;
use kinopt::ik::{Drag, crouched_configuration};
use kinopt::io::cones;
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::ParameterMap;
use kinopt::problem::TaskId;
use kinopt::skeleton::{BallSkeleton, SkeletonRoot};
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, SupportPolygon, Task};

use crate::Failure;
use crate::picture::{AT_REST, PAPER, POSED, ring};
use crate::render::{Quality, Scene, View, linear, render};
use crate::skin::add_placed;

/// Target of the left hand, metres, and offset of the figure to the right of the picture's centre, metres.
const FIGURES: [(Option<[f64; 3]>, f64); 4] = [
    (None, -2.05),
    (Some([0.4, 0.3, 0.35]), -0.75),
    (Some([0.85, 0.2, 0.8]), 0.5),
    (Some([0.75, 0.2, 1.75]), 1.9),
];
/// Eye position, and the picture's right direction along the ground.
pub(crate) const EYE_OFFSET: DVec3 = DVec3::new(5.0, -6.0, 1.0);
const RIGHT_DIRECTION: DVec3 = DVec3::new(0.768, 0.64, 0.0);
const SIZE: [usize; 2] = [1000, 400];
/// Number of frames of the drag, and maximum number until the body rests.
const FRAMES: [u32; 2] = [60, 300];
/// Distance of a sole's rear edge behind the toes, metres.
const SOLE_LENGTH: f64 = 0.2;
/// Half width of a sole, metres.
const SOLE_HALF_WIDTH: f64 = 0.035;
/// Distance of the centre of mass from the edges of the support polygon, metres.
const MARGIN: f64 = 0.02;
/// Density, kg/m³. The centre of mass does not depend on it.
const DENSITY: f64 = 1000.0;

/// Drag of the left hand, with both feet flat and the centre of mass over them.
pub(crate) struct Crouch {
    pub(crate) drag: Drag,
    pub(crate) target: TaskId<Point>,
    /// Position of the hand in the crouched configuration, metres.
    pub(crate) start: Vector3<f64>,
}

/// Humanoid on a free base, within the cones of a file.
pub(crate) fn body(rig: &Rig, cones: &Path) -> Result<BallSkeleton, Failure> {
    let cones = cones::read(cones)?;
    let skeleton = rig.skeleton.clone();
    Ok(BallSkeleton::new(skeleton, &cones, SkeletonRoot::FREE)?)
}

impl Crouch {
    /// Starts in the crouched configuration.
    pub(crate) fn new(rig: &Rig, body: &BallSkeleton) -> Result<Self, Failure> {
        let masses = rig.masses(DENSITY)?;
        let model = body.model();
        let hand = body.tip(body.bone("left_hand")?);
        let feet = [body.bone("left_foot")?, body.bone("right_foot")?].map(|foot| body.tip(foot));
        let map = ParameterMap::free(model);
        let stance =
            crouched_configuration(model, &map, &feet, &model.neutral(), Vector3::UNITS[2])?;
        let mut kinematics = ForwardKinematics::new(model);
        let placements = kinematics.place(&stance)?;
        let start = placements[hand.index()].translation;
        let mut tasks = Problem::builder(model);
        let target = tasks.add(Point::new(hand, start));
        let mut balance = SupportPolygon::new(&masses).with_margin(MARGIN);
        for foot in feet {
            let toes = placements[foot.index()].translation;
            let corners =
                [0.0, -SOLE_LENGTH].map(|x| [-SOLE_HALF_WIDTH, SOLE_HALF_WIDTH].map(|y| (x, y)));
            let corners = corners.into_iter().flatten();
            balance = balance.with_points(corners.map(|(x, y)| toes + Vector3::new(x, y, 0.0)));
            tasks.add(Task::new(FramePose::new(foot, placements[foot.index()])).scale(10.0));
        }
        tasks.add(Task::new(balance).scale(10.0));
        tasks.add(Posture::new(model, &stance).upright(model));
        let drag = Drag::new(tasks.build()?, &stance)?;
        Ok(Self {
            drag,
            target,
            start,
        })
    }

    /// Sets the target and advances the drag by one frame.
    pub(crate) fn advance(&mut self, target: Vector3<f64>) -> Result<(), Failure> {
        self.drag.target_mut(self.target)?.set_target(target);
        self.drag.advance();
        Ok(())
    }
}

/// Configuration at the end of a drag of the left hand to a target, from the crouched configuration.
fn dragged_to(mut crouch: Crouch, target: Option<[f64; 3]>) -> Result<Vec<f64>, Failure> {
    let Some(target) = target.map(Vector3::from) else {
        return Ok(crouch.drag.q().to_vec());
    };
    let start = crouch.start;
    for frame in 1..=FRAMES[0] {
        let share = f64::from(frame) / f64::from(FRAMES[0]);
        crouch.advance(start + (target - start) * share)?;
    }
    let solution = crouch.drag.settle(FRAMES[1] as usize);
    match solution.reached {
        true => Ok(solution.q.clone()),
        false => Err(solution.explain().to_string().into()),
    }
}

/// Draws the four figures.
pub(crate) fn crouching(rig: &Rig, cones: &Path, path: &Path) -> Result<(), Failure> {
    let body = body(rig, cones)?;
    let mut scene = Scene {
        paper: linear(PAPER),
        ..Scene::default()
    };
    for (target, offset) in FIGURES {
        let placements = body.pose(&dragged_to(Crouch::new(rig, &body)?, target)?)?;
        let colour = if target.is_some() { POSED } else { AT_REST };
        add_placed(
            &mut scene,
            rig,
            &placements,
            RIGHT_DIRECTION * offset,
            linear(colour),
        )?;
    }
    let centre = DVec3::new(0.1, 0.0, 0.9);
    let view = View::new(centre + EYE_OFFSET, centre, 2.3);
    let mut image = render(&scene, &view, SIZE, Quality::STILL);
    for (target, offset) in FIGURES {
        if let Some(target) = target {
            ring(
                &mut image,
                &view,
                DVec3::from(target) + RIGHT_DIRECTION * offset,
            );
        }
    }
    image.write(path)
}
