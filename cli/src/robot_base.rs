//! Base joint and closed loops of a robot, from the model settings of a problem.

use kinopt::model::{FrameId, Limits, Loop, LoopKind};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::skeleton::SkeletonRoot;
use kinopt_bindings::problem_file::ModelSettings;

use crate::failure::Outcome;

/// Base joint without an option.
const FIXED: &str = "fixed";

/// Bounds of the base, by axis.
fn bounds(settings: &ModelSettings) -> impl Iterator<Item = (&str, Limits)> {
    let bounds = settings.base_bounds.iter();
    bounds.map(|(axis, [lower, upper])| (axis.as_str(), Limits::new(*lower, *upper)))
}

/// Root joint of a skeleton; its bounds are relative to the rest pose.
pub(crate) fn skeleton_root(settings: &ModelSettings) -> Outcome<SkeletonRoot> {
    match settings.base_joint.as_deref().unwrap_or(FIXED) {
        "free" => {
            let base = BaseJoint::named("free", bounds(settings));
            match base.map_err(|error| usage!("base_bounds: {error}"))? {
                BaseJoint::Free { room } => Ok(SkeletonRoot::Free { bounds: room }),
                _ => Ok(SkeletonRoot::Fixed),
            }
        }
        FIXED if settings.base_bounds.is_empty() => Ok(SkeletonRoot::Fixed),
        FIXED => Err(usage!("base_bounds: the root is fixed")),
        _ => Err(usage!(
            "--base-joint of a skeleton is free or fixed; other types are for robots"
        )),
    }
}

/// Robot on its base joint.
pub(crate) fn on_base(settings: &ModelSettings, robot: Robot, file: &str) -> Outcome<Robot> {
    let kind = settings.base_joint.as_deref().unwrap_or(FIXED);
    let base = BaseJoint::named(kind, bounds(settings));
    let base = base.map_err(|error| usage!("base_bounds of a {kind} base: {error}"))?;
    let robot = robot.with_base_joint(base);
    robot.map_err(|error| failure!("{file}: base joint: {error}"))
}

/// Robot with these loops and passive joints.
pub(crate) fn with_loops(settings: &ModelSettings, robot: Robot, file: &str) -> Outcome<Robot> {
    let mut robot = match settings.without_loops {
        true => robot.without_loops(),
        false => robot,
    };
    let connected = settings
        .connect
        .iter()
        .map(|closed| (closed, LoopKind::Connect));
    let welded = settings.weld.iter().map(|closed| (closed, LoopKind::Weld));
    for (closed, kind) in connected.chain(welded) {
        let [first, second] = &closed.frames;
        let frame = |name: &String| -> Outcome<FrameId> {
            let frame_id = robot.model().frame(name);
            frame_id.map_err(|error| failure!("{file}: {}: {error}", kind.name()))
        };
        let frames = [frame(first)?, frame(second)?];
        let name = format!("{first}={second}");
        let own_loop = match kind {
            LoopKind::Weld => Loop::weld(&name, frames),
            _ => Loop::connect(&name, frames),
        };
        let with_loop = robot.with_loop(own_loop.at(closed.placements));
        robot = with_loop.map_err(|error| failure!("{file}: {error}"))?;
    }
    if settings.passive.is_empty() {
        return Ok(robot);
    }
    let named = robot.with_passive_joints(&settings.passive);
    named.map_err(|error| failure!("{file}: passive: {error}"))
}
