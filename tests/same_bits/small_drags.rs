//! Promise: so it is for drags of small arms that are stuck: stretched out straight, folded, between limits, under a floor; with
//! the nudges, the ways out and the ways out of contact that lead them on, to rest and back.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::{Drag, Restarts};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model};
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::{LevenbergMarquardt, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{LimitCentring, Point, Posture, Quantity, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drags::{Floor, told};
use crate::every_joint::vector;
use crate::searches::places;

/// A chain of hinges, in a plane or not, one of which may be a slide.
pub(crate) fn chain(random: &mut Random, links: usize, planar: bool, limits: Option<f64>) -> Model {
    let mut own = Model::builder("arm");
    let z = Vector3::UNITS[2];
    let mut last = None;
    for k in 0..links {
        let at = Placement::translation([if k == 0 { 0.0 } else { 0.4 }, 0.0, 0.0].into());
        let axis = if planar { z } else { vector(random, 1.0) };
        let name = format!("joint {k}");
        let ends = limits.map(|half| {
            Limits::new(
                -half * random.within(0.3, 1.0),
                half * random.within(0.3, 1.0),
            )
        });
        last = Some(match ends {
            Some(ends) if k == 2 => own.prismatic(name, last, at, [0.6, 0.8, 0.0], ends),
            Some(ends) => own.revolute(name, last, at, axis, ends),
            None => own.continuous(name, last, at, axis),
        });
    }
    own.frame("tip", last, Placement::translation([0.3, 0.0, 0.0].into()));
    own.build().unwrap()
}

fn stuck() -> [Value; 2] {
    let (mut frames, mut settled, mut random) = (Digest::new(), Digest::new(), Random::new(201));
    for case in 0..24 {
        let limits = [None, Some(2.5), Some(0.8)][case % 3];
        let model = chain(&mut random, 2 + case % 4, case % 2 == 0, limits);
        let tip = model.frame("tip").unwrap();
        let straight = model.neutral();
        let q = if case % 5 < 3 {
            straight
        } else {
            model.random_configuration(case as u64)
        };
        let from = places(&model, &q)[tip.index()].translation;
        let mut tasks = Problem::builder(&model);
        let goal = tasks.add(Point::new(tip, from));
        match case % 7 {
            3 => {
                tasks.add(Posture::new(&model, &q));
            }
            5 => {
                tasks.add(
                    Task::new(LimitCentring::new(&model))
                        .scale(0.3)
                        .goal()
                        .tolerance(Quantity::Ratio, 0.4),
                );
            }
            6 => {
                tasks.add(Task::new(Posture::new(&model, &q)).scale(0.1));
                tasks.preferences(Preferences::Traded);
            }
            _ => {}
        }
        let problem = tasks.build().unwrap();
        let drag = Drag::new(problem, &q).unwrap();
        let mut drag = match case % 8 {
            4 => drag
                .with_search(Restarts::default().with_attempts(3))
                .unwrap(),
            6 => drag.with_max_move(0.04).unwrap(),
            7 => {
                let few = Stopping::default().with_max_iterations(3);
                drag.with_solver(Solver::new(LevenbergMarquardt::default()), few)
                    .unwrap()
            }
            _ => drag,
        };
        // Towards the root, out of reach, somewhere within it, back.
        let goals = [
            from * 0.6,
            from * 5.0,
            places(&model, &model.random_configuration(9))[tip.index()].translation,
            from,
        ];
        for to in goals {
            drag.target_mut(goal).unwrap().set_target(to);
            for _ in 0..9 {
                drag.advance();
                frames.solution(drag.solution());
                frames.doubles(drag.q().iter().copied());
                frames.noted(&(drag.is_speed_limited(), drag.is_at_rest(), drag.jump()));
            }
        }
        for to in [goals[2], from * 0.3, goals[1]] {
            drag.set_configuration(&q).unwrap();
            drag.target_mut(goal).unwrap().set_target(to);
            drag.settle(12);
            told(&mut settled, &drag);
            drag.set_configuration(&q).unwrap();
            drag.follow(12);
            told(&mut settled, &drag);
        }
    }
    [frames.value(), settled.value()]
}

/// Arms that begin under a floor, or are led under one, some of which have to go on down before they can come up.
fn under() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(202));
    for case in 0..14 {
        let model = match case % 2 {
            0 => {
                // A crank whose end keeps it from the short way up.
                let mut own = Model::builder("crank");
                let ends = Limits::new(-1.75 - 0.02 * f64::from(case), 2.5);
                let at = Placement::identity();
                let crank = own.revolute("crank", None, at, [0.0, -1.0, 0.0], ends);
                let aside = own.continuous("aside", Some(crank), at, Vector3::UNITS[0]);
                own.frame(
                    "tip",
                    Some(aside),
                    Placement::translation([1.0, 0.0, 0.0].into()),
                );
                own.build().unwrap()
            }
            _ => chain(&mut random, 4, false, Some(1.5)),
        };
        let own = [model.frame("tip").unwrap()];
        let q = match case % 2 {
            0 => vec![-1.74 - 0.02 * f64::from(case), 0.1],
            _ => model.random_configuration(case as u64),
        };
        let at = places(&model, &q)[own[0].index()].translation;
        let floor = Floor {
            kinematics: ForwardKinematics::of_frames(&model, &own).unwrap(),
            frames: own.to_vec(),
            height: at.z + [0.1, -0.03, 0.3][case as usize % 3],
        };
        let mut tasks = Problem::builder(&model);
        let goal = tasks.add(Point::new(own[0], at));
        if case % 4 > 1 {
            tasks.add(Posture::new(&model, &model.neutral()));
        }
        tasks.keep_clear(&floor);
        let mut drag = Drag::new(tasks.build().unwrap(), &q).unwrap();
        for to in [at - Vector3::UNITS[2] * 0.2, at + vector(&mut random, 0.5)] {
            drag.target_mut(goal).unwrap().set_target(to);
            for _ in 0..14 {
                drag.advance();
                digest.solution(drag.solution());
                digest.noted(&(drag.q(), drag.is_at_rest(), drag.solution().collisions()));
            }
        }
        told(&mut digest, &drag);
    }
    digest.value()
}

#[test]
fn of_small_drags() {
    let [frames, settled] = stuck();
    check(&[
        ("drags of arms that are stuck, frame by frame", frames),
        ("drags of arms that are stuck, to rest", settled),
        ("drags of arms under a floor", under()),
    ]);
}
