//! Promise: so it is for checkers whose world changes by one thing at a time: things come, go, are taken by links that carry others, left, let
//! touch and kept apart again, as the last or the only one of them; and for going back to a world of before.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{place, vector};
use crate::shape_mixes::{KINDS, shape};

const LINKS: [&str; 6] = ["base", "upper", "lower", "hand", "left", "right"];

/// A chain with a hand of two fingers, in any order of frames.
fn grasping(random: &mut Random) -> Checker {
    let mut builder = Model::builder("grasping");
    let link = Placement::translation(Vector3::new(0.0, 0.0, 0.3));
    let [x, y, z] = Vector3::UNITS;
    let turns = Limits::new(-2.0, 2.0);
    let upper = builder.revolute("a", None, link, z, turns);
    let lower = builder.revolute("b", Some(upper), link, y, turns);
    let hand = builder.revolute("c", Some(lower), link, x, turns);
    let slides = Limits::new(0.0, 0.1);
    let left = builder.prismatic("d", Some(hand), link, y, slides);
    let right = builder.prismatic("e", Some(hand), link, -y, slides);
    let joints = [
        None,
        Some(upper),
        Some(lower),
        Some(hand),
        Some(left),
        Some(right),
    ];
    let mut objects = Vec::new();
    let turn = random.below(6);
    for k in 0..6 {
        let at = (k + turn) % 6;
        let frame = builder.frame(LINKS[at], joints[at], Placement::identity());
        // Some links have no shapes.
        if random.below(5) > 0 {
            let own = [
                Shape::sphere(0.08),
                Shape::capsule(0.03, 0.2),
                Shape::cuboid([0.1; 3]),
            ];
            let own = own[random.below(3)].clone().unwrap();
            objects.push(CollisionObject::new(
                "own",
                frame,
                vector(random, 0.05),
                own,
            ));
        }
    }
    Checker::new(CollisionModel::new(&builder.build().unwrap(), objects).unwrap())
}

fn step(world: &mut World, random: &mut Random) -> Result<(), String> {
    let held = Placement::translation(vector(random, 0.15));
    let stands = place(random, 0.5);
    let some = |random: &mut Random, world: &World| match world.len() {
        0 => "nothing".to_owned(),
        count => world
            .obstacles()
            .nth(random.below(count))
            .unwrap()
            .name
            .clone(),
    };
    let (one, other) = (some(random, world), some(random, world));
    let link = LINKS[random.below(6)];
    let touching = world
        .obstacles()
        .find(|own| !own.allowed_collisions.is_empty());
    let touching = touching.map(|own| [own.name.clone(), own.allowed_collisions[0].clone()]);
    let result = match random.below(13) {
        0 | 1 | 12 if world.len() % 24 < 5 => {
            // Also under the name of a link.
            let names = ["can", "cup", "plate", "hand", "pen"];
            let kind = random.below(KINDS);
            world.add(names[random.below(5)], shape(random, kind, 0.5), stands)
        }
        0 | 12 => world.remove(&one),
        1..=3 => world.attach(&one, link, held),
        4 | 5 => world.detach(&one, stands),
        6 => world.move_to(&one, stands),
        7 | 8 => world.allow_collision(&one, link),
        9 => world.allow_collision(&one, &other),
        _ => match touching {
            Some([one, other]) => world.forbid_collision(&one, &other),
            None => Ok(()),
        },
    };
    result.map_err(|error| error.to_string())
}

/// Of a file, with what need not be there.
const BEGIN: &str = r#"{"spheres": [{"name": "can", "radius": 0.1, "may_touch": ["ghost", "left"]}, {"name": "cup", "radius": 0.3, "position": [0.2, 0, 0.5]}],
"boxes": [{"name": "pen", "size": [0.2, 0.3, 0.5], "attached": "lower"}], "order": ["cup", "pen", "can"], "may_be_missing": ["ghost"]}"#;

fn steps() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(941));
    for case in 0..30 {
        let mut checker = grasping(&mut random);
        let model = checker.model().model().clone();
        digest.noted(&checker.model().pairs());
        let mut world = match case % 3 {
            0 => World::from_json(BEGIN.as_bytes(), "begin.json").unwrap(),
            _ => World::new(),
        };
        if case % 6 == 3 {
            world = world.scaled(0.5).unwrap();
        }
        if case % 2 == 1 {
            // So many far away that a tree keeps what does not change.
            for k in 0..24 {
                let away = Vector3::new(50.0, f64::from(k), 0.0);
                world.add_sphere(&format!("far {k}"), 0.01, away).unwrap();
            }
        }
        let mut before = world.clone();
        for turn in 0..24 {
            if let Err(problem) = step(&mut world, &mut random) {
                digest.bytes(problem);
            }
            match random.below(12) {
                0 => before = world.clone(),
                1 => world = before.clone(),
                _ => {}
            }
            match checker.clone().with_world(&world) {
                Ok(changed) => checker = changed,
                Err(error) => digest.text(error.to_string()),
            }
            let q = model.random_configuration(case * 100 + turn);
            digest.noted(&checker.collisions(&q).unwrap());
            let mut workspace = checker.workspace();
            digest.noted(&checker.nearest(&mut workspace, &q, f64::INFINITY));
            digest.noted(&world.notes());
        }
        digest.bytes(world.to_json());
    }
    digest.value()
}

#[test]
fn of_mixed_steps_of_worlds() {
    check(&[("checkers of worlds that change thing by thing", steps())]);
}
