//! Queries that `web/tests/bits.test.js` solves in WebAssembly, which equals the portable path.

use kinopt::arm::{Arm, Search};
use kinopt::ik::Drag;
use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::Problem;
use kinopt::spatial::Vector3;
use kinopt::task::Point;
use support::arms::robot;
use support::bones::humanoid;
use support::random::Random;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[Case::double("web", web)];

fn web(record: &mut Record) {
    poses(record, "poses, first", Search::First);
    poses(record, "poses, start", Search::Start);
    drag(record);
}

/// 200 poses of the Panda, each from another start.
fn poses(record: &mut Record, field: &str, search: Search) {
    let robot = robot("franka_panda");
    let arm = Arm::builder(&robot, "base", "flange").with_search(search);
    let arm = arm.build().unwrap();
    let mut random = Random::split_mix(11);
    let solve = |_| {
        let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        arm.solve(target, &random.configuration(&arm)).unwrap().q
    };
    record.numbers(field, (0..200).flat_map(solve));
}

/// The humanoid's left hand moves out of reach; the other tips are pinned.
fn drag(record: &mut Record) {
    let rig = humanoid();
    let (skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let hand = skeleton.bone("left_hand").unwrap();
    let tips: Vec<_> = rig
        .constrained
        .iter()
        .map(|&bone| skeleton.tip(bone))
        .collect();
    let mut kinematics = ForwardKinematics::of_frames(skeleton.model(), &tips).unwrap();
    let placed = kinematics.place(&rest).unwrap();
    let mut tasks = Problem::builder(skeleton.model());
    let points = tips.iter().zip(placed);
    let points = points.map(|(&tip, at)| (tasks.add(Point::new(tip, at.translation)), at));
    let points: Vec<_> = points.collect();
    let dragged = rig
        .constrained
        .iter()
        .position(|&bone| bone == hand)
        .unwrap();
    let (task, from) = (points[dragged].0, points[dragged].1.translation);
    let mut drag = Drag::new(tasks.build().unwrap(), &rest).unwrap();
    let frame = |frame: i32| {
        let along = 0.01 * f64::from(frame);
        let target = Vector3::new(from.x - 0.25 * along, from.y + 0.5 * along, from.z + along);
        drag.target_mut(task).unwrap().set_target(target);
        drag.advance().q.to_vec()
    };
    record.numbers("drag", (0..120).flat_map(frame));
}
