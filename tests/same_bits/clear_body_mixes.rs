//! Promise: so it is for bodies of every joint and shape that keep clear, with goals, levels, preferences and clearances of every kind drawn
//! at random: searched for, dragged into what is in the way, from contact and out of it, in one workspace after the other.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, Clearance, CollisionModel, CollisionObject, Shape, World};
use kinopt::ik::{Drag, Restarts};
use kinopt::model::{Limits, Model};
use kinopt::problem::{Derivatives, Problem, TaskId};
use kinopt::solver::{GaussNewton, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, LimitCentring, Point, Posture, Task};
use kinopt::{Solver, Workspace};
use support::random::Random;

use crate::checker_mixes::{LINKS, shapes, spheres};
use crate::digest::{Digest, Value, check};
use crate::drags::told;
use crate::every_joint::{model, place, vector};
use crate::searches::places;
use crate::shape_mixes::{KINDS, shape};

/// Obstacles about a place, some through it.
fn world_about(random: &mut Random, at: Vector3<f64>, count: usize) -> World {
    let mut world = World::new();
    for k in 0..count {
        let kind = [random.below(4), random.below(KINDS - 1)][k % 2];
        let own = shape(random, kind, 0.3);
        let mut stands = place(random, 0.4);
        stands.translation += at;
        world.add(&format!("thing {k}"), own, stands).unwrap();
    }
    world
}

/// Tasks of a hand, and others if drawn, for a body that keeps clear.
fn problem(
    model: &Model,
    checker: &Checker,
    q: &[f64],
    random: &mut Random,
) -> (Problem, TaskId<Point>, Vector3<f64>) {
    let placed = places(model, q);
    let [hand, foot, head] = ["hand", "foot", "head"].map(|name| model.frame(name).unwrap());
    let mut tasks = Problem::builder(model);
    let from = placed[hand.index()].translation;
    let point = Task::new(Point::new(hand, from + vector(random, 0.1)));
    let goal = tasks.add(point);
    match random.below(4) {
        0 => {
            let at = placed[foot.index()].translation;
            tasks.add(Task::new(Point::new(foot, at)).scale(3.0));
        }
        1 => {
            let held = Task::new(Point::new(foot, placed[foot.index()].translation));
            tasks.add(held.at_level(usize::from(random.below(3) == 0)));
        }
        _ => {}
    }
    if random.below(5) == 0 {
        tasks.add(FramePose::new(head, placed[head.index()]));
    }
    match random.below(4) {
        0 => {
            tasks.add(Posture::new(model, &model.neutral()));
        }
        1 => {
            tasks.add(Task::new(LimitCentring::new(model)).scale(0.1));
        }
        2 => {
            let own = Clearance::new(checker, random.within(0.05, 0.4));
            let own = Task::new(own);
            tasks.add(if random.below(2) == 0 {
                own.preference()
            } else {
                own
            });
        }
        _ => {}
    }
    if random.below(8) != 0 {
        tasks.keep_clear(checker);
    }
    (tasks.build().unwrap(), goal, from)
}

fn solver(random: &mut Random) -> Solver {
    let attempts = [1, 2, 3][random.below(3)];
    let own = match random.below(4) {
        0 => Solver::new(GaussNewton::default()),
        _ => Solver::default(),
    };
    let own = own.with_restarts(Restarts::default().with_attempts(attempts));
    own.with_stopping(Stopping::default().with_max_iterations([3, 6, 10][random.below(3)]))
}

fn checker(own: CollisionModel, random: &mut Random) -> Checker {
    let around = spheres(&own, [0.6, 1.0][random.below(2)]);
    let own = match random.below(2) {
        0 => Checker::new(own),
        _ => Checker::new(own).with_spheres(around),
    };
    own.with_margin([0.0, 0.0, 0.02, 0.1][random.below(4)])
        .unwrap()
}

fn bodies() -> [Value; 2] {
    let (mut searched, mut dragged, mut random) = (Digest::new(), Digest::new(), Random::new(931));
    let mut workspace = Workspace::new();
    for case in 0..7 {
        let model = model(&mut random, case % 4 == 1);
        let q = model.random_configuration(700 + case as u64);
        let hand = places(&model, &q)[model.frame("hand").unwrap().index()].translation;
        let own = shapes(&model, &mut random, [4, 1, 6][case % 3]);
        let own = own.with_touching_ignored(&model.neutral()).unwrap();
        let mut world = world_about(&mut random, hand, 1 + case % 4);
        if random.below(3) == 0 {
            let held = LINKS[random.below(LINKS.len())];
            world
                .attach("thing 0", held, vector(&mut random, 0.2))
                .unwrap();
        }
        let checker = checker(own, &mut random).with_world(&world).unwrap();
        let (problem, goal, from) = problem(&model, &checker, &q, &mut random);
        let solver = solver(&mut random);
        for start in [&q, &model.random_configuration(800 + case as u64), &q] {
            searched.told(solver.solve(&problem, start, &mut workspace).unwrap());
        }
        let stopping = Stopping::default().with_max_iterations([2, 4, 6][random.below(3)]);
        let mut drag = Drag::new(problem, &q).unwrap();
        drag = drag.with_solver(Solver::default(), stopping).unwrap();
        if random.below(3) == 0 {
            drag = drag.with_max_move([0.03, 0.4][random.below(2)]).unwrap();
        }
        let way = vector(&mut random, 0.6);
        for share in [0.1, 0.5, 0.6, 0.0] {
            drag.target_mut(goal)
                .unwrap()
                .set_target(from + way * share);
            drag.advance();
            told(&mut dragged, &drag);
        }
        drag.settle(1);
        told(&mut dragged, &drag);
        if random.below(2) == 0 {
            drag.set_configuration(&model.random_configuration(900 + case as u64))
                .unwrap();
            drag.advance();
            told(&mut dragged, &drag);
        }
    }
    [searched.value(), dragged.value()]
}

/// A chain of links on a plane or in space, whose shapes are thin.
pub(crate) fn chain(random: &mut Random, flat: bool) -> (Model, CollisionModel) {
    let mut builder = Model::builder("chain");
    let link = Placement::translation(Vector3::new(0.5, 0.0, 0.0));
    let (mut last, mut objects) = (None, Vec::new());
    for k in 0..5 {
        let axis = Vector3::UNITS[if flat { 2 } else { [2, 1][k % 2] }];
        let limits = Limits::new(-2.5, 2.5);
        let joint = builder.revolute(format!("joint {k}"), last, link, axis, limits);
        let frame = builder.frame(format!("link {k}"), Some(joint), Placement::identity());
        let kind = [
            Shape::cuboid([0.4, 0.05, 0.05]),
            Shape::capsule(0.03, 0.3),
            Shape::sphere(0.06),
        ];
        let own = kind[random.below(3)].clone().unwrap();
        let at = Vector3::new(0.25, 0.0, 0.0);
        objects.push(CollisionObject::new(format!("shape {k}"), frame, at, own));
        last = Some(joint);
    }
    builder.frame("hand", last, link);
    let model = builder.build().unwrap();
    let own = CollisionModel::new(&model, objects).unwrap();
    (model, own)
}

/// Chains that begin within plates and balls, and are led through others.
fn chains() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(932));
    for case in 0..8 {
        let (model, own) = chain(&mut random, case % 2 == 0);
        let hand = model.frame("hand").unwrap();
        let q = model.random_configuration(30 + case);
        let aim = places(&model, &model.random_configuration(60 + case))[hand.index()].translation;
        let mut world = World::new();
        let placed = places(&model, &q);
        if case % 5 < 2 {
            // Around where the hand is to be: whatever reaches it touches.
            world.add_sphere("ball", 0.2, aim).unwrap();
        }
        for k in 0..1 + random.below(4) {
            let link = model.frame(&format!("link {}", random.below(5))).unwrap();
            // Through a link, as a plate that it pierces, or anywhere.
            let mut at = place(&mut random, 0.8);
            if k < 2 {
                at = placed[link.index()] * Placement::translation(Vector3::new(0.25, 0.0, 0.0));
            }
            let name = format!("plate {k}");
            match random.below(4) {
                0 => world.add_sphere(&name, 0.15, at).unwrap(),
                1 => world.add_box(&name, [0.5, 0.02, 0.5], at).unwrap(),
                _ => world.add_box(&name, [0.02, 0.6, 0.6], at).unwrap(),
            }
        }
        let checker = checker(own, &mut random).with_world(&world).unwrap();
        let mut tasks = Problem::builder(&model);
        let goal = tasks.add(Point::new(hand, aim));
        if random.below(2) == 0 {
            tasks.add(Posture::new(&model, &q));
        }
        tasks.keep_clear(&checker);
        let mut problem = tasks.build().unwrap();
        if case % 4 == 3 {
            problem = problem.with_derivatives(Derivatives::ForwardDifference);
        }
        let attempts = Restarts::default().with_attempts(4);
        let solver = Solver::default().with_restarts(attempts);
        let solver = solver.with_stopping(Stopping::default().with_max_iterations(40));
        digest.told(&solver.solve_once(&problem, &q).unwrap());
        let mut drag = Drag::new(problem, &q).unwrap();
        for frame in 0..18 {
            drag.advance();
            if frame % 5 == 0 {
                told(&mut digest, &drag);
            }
        }
        told(&mut digest, &drag);
        drag.target_mut(goal).unwrap().set_target(aim * 0.5);
        drag.settle(4);
        told(&mut digest, &drag);
    }
    digest.value()
}

#[test]
fn of_mixed_bodies_that_keep_clear() {
    let [searched, dragged] = bodies();
    check(&[
        ("searches of mixed bodies that keep clear", searched),
        ("drags of mixed bodies that keep clear", dragged),
    ]);
}

#[test]
fn of_mixed_chains_in_contact() {
    check(&[("chains that come out of what they touch", chains())]);
}
