//! Promise: so it is for ways round and ways out: tracks of an arm that spends its freedom to go round balls, and chains that are pierced by plates,
//! some of which come out through other plates only, or where what is preferred is left.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::ik::Drag;
use kinopt::problem::Problem;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture};
use support::arms::robot;
use support::random::Random;

use crate::clear_body_mixes::chain;
use crate::digest::{Digest, Value, check};
use crate::drags::told;
use crate::every_joint::{place, vector};
use crate::paths::bare_arm;
use crate::searches::places;

fn tracks() -> Value {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::new(bodies);
    let q = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let plain = bare_arm(&robot, "base", "flange");
    let rest = robot.model().neutral();
    let plain = plain.with_checker(&checker, &rest).unwrap();
    let begin = plain.base_from_tool(&q).unwrap();
    let mut digest = Digest::new();
    // So that several ways round are free.
    for seed in [9, 32, 90, 256] {
        let mut random = Random::new(seed);
        let mut world = World::new();
        for k in 0..3 {
            let at = begin.translation * random.within(0.2, 0.9) + vector(&mut random, 0.5);
            world.add_sphere(&format!("ball {k}"), 0.06, at).unwrap();
        }
        let arm = plain.with_world(&world, None).unwrap();
        let way = vector(&mut random, 0.25);
        let at = |k: u32| begin.translation + way * (f64::from(k) / 10.0);
        let path: Vec<_> = (0..=10)
            .map(|k| Placement::new(begin.rotation, at(k)))
            .collect();
        let track = arm.track(&path, &q).unwrap();
        track.solutions.iter().for_each(|own| digest.told(own));
        digest.noted(&track.jumps);
    }
    digest.value()
}

fn pierced() -> Value {
    let mut digest = Digest::new();
    // Two find no way out but through plates that they are not in; in frames of each only the goals alone lead on.
    for case in [2, 13, 17, 83, 87] {
        let mut random = Random::new(5000 + case);
        let (model, own) = chain(&mut random, case % 2 == 0);
        let hand = model.frame("hand").unwrap();
        let q = model.random_configuration(30 + case);
        let aim = places(&model, &model.random_configuration(60 + case))[hand.index()].translation;
        let placed = places(&model, &q);
        let mut world = World::new();
        for k in 0..2 + random.below(5) {
            let link = model.frame(&format!("link {}", random.below(5))).unwrap();
            let mut at = place(&mut random, 1.2);
            if k == 0 {
                at = placed[link.index()] * Placement::translation(Vector3::new(0.25, 0.0, 0.0));
            }
            let plate = [[0.9, 0.02, 0.9], [0.02, 0.9, 0.9]][random.below(3).min(1)];
            world.add_box(&format!("plate {k}"), plate, at).unwrap();
        }
        let checker = Checker::new(own).with_world(&world).unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(hand, aim));
        if random.below(2) == 0 {
            tasks.add(Posture::new(&model, &q));
        }
        tasks.keep_clear(&checker);
        let mut drag = Drag::new(tasks.build().unwrap(), &q).unwrap();
        for _ in 0..70 {
            drag.advance();
            told(&mut digest, &drag);
            if drag.is_at_rest() {
                break;
            }
        }
    }
    digest.value()
}

#[test]
fn of_ways_round_and_out() {
    check(&[
        ("tracks that go round balls", tracks()),
        ("chains that plates pierce", pierced()),
    ]);
}
