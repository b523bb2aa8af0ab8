//! A Panda that moves its tool between three poses, around the obstacles of a table.

use std::path::Path;

use glam::{DAffine3, DVec3};
use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::path::{CartesianPath, PathSolver, TimingLimits};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};

use super::panel::{Panel, PanelFrame};
use super::robot_mesh::RobotMesh;
use super::shape_mesh::ShapeMesh;
use super::{FRAMES, FRAMES_PER_SECOND};
use crate::Failure;
use crate::picture::{AT_REST, POSED};
use crate::render::{View, linear};

/// Poses of the tool: position (metres), azimuth and tilt (degrees), and a flag for the marked targets.
///
/// The tool returns to the first pose.
const KEYS: [([f64; 3], [f64; 2], bool); 6] = [
    ([0.45, 0.35, 0.53], [0.0, 0.0], true),
    ([0.36, 0.0, 0.55], [0.0, 50.0], false),
    ([0.56, -0.25, 0.42], [-20.0, 85.0], true),
    ([0.36, -0.18, 0.62], [-10.0, 60.0], false),
    ([0.56, -0.25, 0.68], [-20.0, 20.0], true),
    ([0.48, 0.1, 0.68], [0.0, 10.0], false),
];
/// Points of the path from key to key.
const POINTS_PER_KEY: usize = 40;
/// Smallest distance of links from obstacles and other links, metres.
const MARGIN: f64 = 0.01;
/// Acceleration limit of each joint, rad/s².
const ACCELERATION: f64 = 5.0;
/// Number of frames in which the tool rests at the first pose.
const REST_FRAMES: usize = 4;
/// Start configuration for the first pose, radians.
const START: [f64; 7] = [0.6, -0.4, 0.0, -2.2, 0.0, 1.8, 0.8];

/// Returns the pose of a tool whose z axis is tilted from straight down towards the azimuth.
fn pose([x, y, z]: [f64; 3], degrees: [f64; 2]) -> Placement<f64> {
    let [(sin_azimuth, cos_azimuth), (sin_tilt, cos_tilt)] =
        degrees.map(|angle| angle.to_radians().sin_cos());
    let tool_axis = DVec3::new(sin_tilt * cos_azimuth, sin_tilt * sin_azimuth, -cos_tilt);
    let side = DVec3::new(sin_azimuth, -cos_azimuth, 0.0);
    let axes = [side.cross(tool_axis), side, tool_axis].map(|axis| Vector3::from(axis.to_array()));
    let [forward, side, tool_axis] = axes;
    let rotation = Matrix3::from_columns(forward, side, tool_axis);
    Placement::new(rotation, Vector3::new(x, y, z))
}

/// Solves the path of the tool and returns the configuration of the arm in each frame.
fn motion(arm: &Arm) -> Result<Vec<Vec<f64>>, Failure> {
    let mut keys: Vec<Placement<f64>> = KEYS.iter().map(|key| pose(key.0, key.1)).collect();
    let first = keys[0];
    keys.push(first);
    let path = CartesianPath::spline(keys, None, POINTS_PER_KEY)?;
    let start = arm.solve(first, &START)?;
    let start = match start.reached {
        true => start.q,
        false => return Err(start.explain().to_string().into()),
    };
    let solver = PathSolver::new(arm).with_start(&start).with_end(&start);
    let solution = solver.solve(&path)?;
    if !solution.reached() {
        return Err(format!(
            "the path of the arm is not whole: {:?}, {:?}, {:?}",
            solution.jumps, solution.report.missed, solution.report.blocked
        )
        .into());
    }
    let accelerations = vec![ACCELERATION; arm.joint_count()];
    let limits = TimingLimits::of(arm).with_acceleration_limits(&accelerations);
    let trajectory = solution.trajectory(&limits)?;
    let seconds = (FRAMES - REST_FRAMES) as f64 / FRAMES_PER_SECOND as f64;
    let speed = trajectory.duration() / seconds;
    if speed > 1.0 {
        return Err(format!("the motion of the arm takes longer than {seconds} s").into());
    }
    let time = |frame: usize| frame as f64 / FRAMES_PER_SECOND as f64 * speed;
    Ok((0..FRAMES)
        .map(|frame| trajectory.report.at(time(frame)).q)
        .collect())
}

/// Solves and meshes the panel.
pub(super) fn panel(root: &Path) -> Result<Panel, Failure> {
    let robot = Robot::read(root.join("models/franka_panda.urdf"))?;
    let world = World::read(root.join("models/worlds/table.json"))?;
    let checker = Checker::of(&robot)?
        .with_world(&world)?
        .with_margin(MARGIN)?;
    let model = robot.model();
    let mut q = model.neutral();
    let arm = Arm::new(&robot, "base", "tool")?.with_checker(&checker, &q)?;

    let mesh = RobotMesh::new(checker.model())?;
    let mut obstacles = Vec::new();
    for obstacle in world.obstacles() {
        obstacles.push((ShapeMesh::new(&obstacle.shape)?, obstacle.placement));
    }
    let mut kinematics = ForwardKinematics::new(model);
    let mut frames = Vec::new();
    for q_arm in motion(&arm)? {
        arm.configuration(&q_arm, &mut q)?;
        let placements = kinematics.place(&q)?;
        let mut frame = PanelFrame::new();
        mesh.add_to(
            &mut frame.scene,
            placements,
            DAffine3::IDENTITY,
            linear(POSED),
        );
        for (mesh, placement) in &obstacles {
            mesh.add_to(&mut frame.scene, (*placement).into(), linear(AT_REST));
        }
        let targets = KEYS.iter().filter(|key| key.2);
        frame.targets = targets.map(|key| DVec3::from(key.0)).collect();
        frames.push(frame);
    }
    let centre = DVec3::new(0.45, 0.0, 0.45);
    let eye = centre + DVec3::new(-0.6, -4.0, 0.75);
    Ok(Panel::new(View::new(eye, centre, 1.55), frames))
}
