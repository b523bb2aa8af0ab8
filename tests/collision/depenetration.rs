//! Promise: a drag that starts deep in contact leaves it, within the frame's move bound, also if no small step reduces
//! the depth. It then approaches its targets.

use kinopt::Problem;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::ik::Drag;
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use support::random::Random;

use crate::avoidance_priority::ball_on_slides;

/// An arm among thin plates that it intersects. For links near a plate either side looks like an exit, but neither is
/// one for the whole arm.
#[test]
fn arms_intersecting_plates_get_free() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let model = robot.model();
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(300, 1).unwrap();
    let mut world = World::new();
    let at = Vector3::new;
    world
        .add_box("table", [0.8, 1.2, 0.04], at(0.6, 0.0, 0.3))
        .unwrap();
    world
        .add_box("wall", [0.6, 0.02, 0.6], at(0.4, 0.35, 0.6))
        .unwrap();
    world
        .add_box("shelf", [0.3, 1.0, 0.02], at(-0.4, 0.0, 0.7))
        .unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    let hand = model.frame("flange").unwrap();
    let mut kinematics = ForwardKinematics::new(model);
    let mut random = Random::new(11);
    let configuration = |random: &mut Random| -> Vec<f64> {
        let joints = model
            .moving_joints()
            .iter()
            .map(|joint| model.joints()[joint.index()].limits);
        joints
            .map(|limits| random.within(limits.lower, limits.upper))
            .collect()
    };
    let touches = |q: &[f64]| {
        checker
            .collisions(q)
            .unwrap()
            .first()
            .map(|pair| pair.distance)
    };
    let (mut begun, mut free, mut reached) = (0, 0, 0);
    while begun < 40 {
        let start = configuration(&mut random);
        if touches(&start).is_none_or(|distance| distance > -0.02) {
            continue;
        }
        let aim = loop {
            let q = configuration(&mut random);
            if touches(&q).is_none() {
                break kinematics.place(&q).unwrap()[hand.index()].translation;
            }
        };
        begun += 1;
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        tasks.add(Point::new(hand, aim));
        tasks.keep_clear(&checker);
        let problem = tasks.build().unwrap();
        let mut drag = Drag::new(problem, &start).unwrap();
        let mut is_out = false;
        for _ in 0..200 {
            let before = drag.q().to_vec();
            drag.advance();
            let moves = drag.q().iter().zip(&before).map(|(a, b)| (a - b).abs());
            assert!(moves.fold(0.0, f64::max) < 0.15 + 1e-9);
            let touching = touches(drag.q()).is_some();
            // Once free it never touches again, and it is not reached while in contact.
            assert!(!(touching && (is_out || drag.solution().reached)));
            is_out |= !touching;
            if drag.is_at_rest() {
                break;
            }
        }
        free += usize::from(is_out);
        reached += usize::from(drag.solution().reached);
    }
    // Some targets are behind a plate.
    assert!(reached * 2 > begun, "{reached} of {begun}");
    assert_eq!(free, begun);
}

/// All reachable space is filled: the drag searches for an exit, then rests.
#[test]
fn drag_without_exit_comes_to_rest() {
    let (hand, bodies) = ball_on_slides(0.5);
    let model = bodies.model().clone();
    let mut world = World::new();
    world
        .add_sphere("rock", 2.0, Placement::identity())
        .unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(hand, [0.1, 0.2, 0.0]));
    tasks.keep_clear(&checker);
    let mut drag = Drag::new(tasks.build().unwrap(), &[-0.2, 0.1]).unwrap();
    let rests = (0..200).position(|_| {
        drag.advance();
        drag.is_at_rest()
    });
    assert!(rests.is_some_and(|frames| frames < 100), "{rests:?}");
    assert!(!drag.solution().reached && !drag.solution().collisions().is_empty());
}
