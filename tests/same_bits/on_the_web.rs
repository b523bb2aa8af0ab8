//! Promise: so it is in WebAssembly. The package's tests in Node (`web/tests/bits.test.js`) ask the same questions, and
//! compare with the portable paths' digests.
#![allow(clippy::unwrap_used)]

use kinopt::Problem;
use kinopt::arm::{Arm, Search};
use kinopt::ik::Drag;
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::task::Point;
use support::arms::robot;

use crate::digest::{Digest, Value, check};
use support::random::Random;

/// 200 poses of the Panda from as many starts, by two ways of searching.
fn poses(search: Search) -> Value {
    let robot = robot("franka_panda");
    let arm = Arm::builder(&robot, "base", "flange").with_search(search);
    let arm = arm.build().unwrap();
    let mut random = Random::split_mix(11);
    let mut draw = || random.configuration(&arm);
    let mut digest = Digest::new();
    for _ in 0..200 {
        let target = arm.base_from_tool(&draw()).unwrap();
        digest.doubles(arm.solve(target, &draw()).unwrap().q);
    }
    digest.value()
}

/// The humanoid's left hand on its way across and out of reach, the other pins held.
fn drag() -> Value {
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let (skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let hand = skeleton.bone("left_hand").unwrap();
    let tips = rig.constrained.iter().map(|&bone| skeleton.tip(bone));
    let tips: Vec<_> = tips.collect();
    let mut kinematics = ForwardKinematics::of_frames(skeleton.model(), &tips).unwrap();
    let places = kinematics.place(&rest).unwrap();
    let mut tasks = Problem::builder(skeleton.model());
    let mut dragged = None;
    for ((&pinned, &tip), place) in rig.constrained.iter().zip(&tips).zip(places) {
        let task = tasks.add(Point::new(tip, place.translation));
        if pinned == hand {
            dragged = Some((task, place.translation));
        }
    }
    let (dragged, from) = dragged.unwrap();
    let mut drag = Drag::new(tasks.build().unwrap(), &rest).unwrap();
    let mut digest = Digest::new();
    for frame in 0..120 {
        let along = 0.01 * f64::from(frame);
        let target = [from.x - 0.25 * along, from.y + 0.5 * along, from.z + along];
        let point = drag.target_mut(dragged).unwrap();
        point.set_target(target);
        digest.doubles(drag.advance().q.iter().copied());
    }
    digest.value()
}

#[test]
fn of_arms_and_drags() {
    check(&[
        ("on the web: poses, first", poses(Search::First)),
        ("on the web: poses, start", poses(Search::Start)),
        ("on the web: a drag", drag()),
    ]);
}
