//! Motion capture of a person, retargeted to a NAO.

use std::path::Path;

use glam::{DAffine3, DVec3};
use kinopt::collision::CollisionModel;
use kinopt::io::bvh;
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use kinopt::robot::{BaseJoint, Robot};

use super::FRAMES;
use super::panel::{Panel, PanelFrame};
use super::person_mesh::PersonMesh;
use super::robot_mesh::RobotMesh;
use crate::Failure;
use crate::picture::{AT_REST, POSED};
use crate::render::{View, linear};

/// Capture frames for each frame of the film.
const STEPS: usize = 3;
/// Metres per unit of the capture.
const METRES_PER_UNIT: f64 = 0.01;
/// Positions of the person and the robot in the scene, metres.
const SCENE_POSITIONS: [DVec3; 2] = [DVec3::new(-0.42, 0.0, 0.0), DVec3::new(0.78, 0.0, 0.0)];

/// Repeats a capture that ends as it starts three times. The second repetition has neighbours on both sides.
fn repeated(capture: &Capture) -> Result<Capture, Failure> {
    let frames = (0..FRAMES * STEPS).filter_map(|frame| capture.frame(frame));
    let numbers = frames.flatten().flat_map(|position| position.to_array());
    let numbers: Vec<f64> = numbers.collect();
    let rate = capture.frame_rate();
    Ok(Capture::new(
        capture.names().to_vec(),
        &numbers.repeat(3),
        rate,
    )?)
}

/// Returns the heights of the lowest and the highest point of a frame, metres.
fn heights(frame: &PanelFrame) -> [f64; 2] {
    let heights = frame.scene.positions.iter().map(|p| p.z);
    let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
    heights.fold([low, high], |[low, high], z| [low.min(z), high.max(z)])
}

/// Solves and meshes the panel.
pub(super) fn panel(root: &Path) -> Result<Panel, Failure> {
    let recorded = bvh::read(root.join("models/captures/steps.bvh"))?;
    let rate = (FRAMES * STEPS) as f64 / recorded.clip.duration();
    let capture = Capture::of_clip(&recorded.armature, &recorded.clip, rate)?;
    let capture = repeated(&capture)?;

    let robot = Robot::read(root.join("models/aldebaran_nao.urdf"))?;
    let robot = robot.with_base_joint(BaseJoint::FREE)?;
    let map = BodyMap::guess(&capture, robot.model())?.map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let retargeting = Retargeting::new(&robot, &map, &capture, options)?;
    let movement = retargeting.whole()?;

    let person = PersonMesh::new(&recorded.armature, &capture)?;
    let nao = RobotMesh::new(&CollisionModel::of(&robot)?)?;
    let upright = DAffine3::from_mat3(UpAxis::Y.turned_to_z().into());
    let metres = DAffine3::from_scale(DVec3::splat(METRES_PER_UNIT)) * upright;
    let mut kinematics = ForwardKinematics::new(robot.model());
    let configurations = movement.q.chunks(movement.nq);
    let mut poses = Vec::new();
    for q in configurations
        .skip(FRAMES * STEPS)
        .step_by(STEPS)
        .take(FRAMES)
    {
        poses.push(kinematics.place(q)?.to_vec());
    }

    // In the first frame both are on the ground and have equal heights.
    let [mut person_alone, mut nao_alone] = [PanelFrame::new(), PanelFrame::new()];
    let first = capture.frame(0).unwrap_or_default();
    person.add_to(&mut person_alone.scene, first, metres, DVec3::ZERO);
    let first = poses.first().map_or(&[][..], Vec::as_slice);
    nao.add_to(&mut nao_alone.scene, first, DAffine3::IDENTITY, DVec3::ZERO);
    let [low, high] = heights(&person_alone);
    let [nao_low, nao_high] = heights(&nao_alone);
    let size = (high - low) / (nao_high - nao_low);
    let on_ground =
        |position: DVec3, low: f64| DAffine3::from_translation(position - DVec3::Z * low);
    let scene_from_capture = on_ground(SCENE_POSITIONS[0], low) * metres;
    let scene_from_nao =
        on_ground(SCENE_POSITIONS[1], size * nao_low) * DAffine3::from_scale(DVec3::splat(size));

    let mut frames = Vec::new();
    for (number, placements) in poses.iter().enumerate() {
        let mut frame = PanelFrame::new();
        let positions = capture.frame(number * STEPS).unwrap_or_default();
        let grey = linear(AT_REST);
        person.add_to(&mut frame.scene, positions, scene_from_capture, grey);
        nao.add_to(&mut frame.scene, placements, scene_from_nao, linear(POSED));
        frames.push(frame);
    }
    let centre = DVec3::new(0.08, 0.0, 0.88);
    let eye = centre + DVec3::new(0.8, -6.0, 1.0);
    Ok(Panel::new(View::new(eye, centre, 2.75), frames))
}
