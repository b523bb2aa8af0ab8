//! Promise: so it is for strict levels, with rooms above and preferences below, met and missed at each of them.
#![allow(clippy::unwrap_used)]

use kinopt::ik::Restarts;
use kinopt::model::{FrameId, Masses, ParameterMap};
use kinopt::problem::{Preferences, Problem, ProblemBuilder};
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Bounded, CentreOfMass, FramePose, Gaze, LimitCentring, Orientation, Plane, Point, PoseBounds,
    Posture, SupportPolygon, Task,
};
use kinopt::{Solver, Workspace};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, map, masses, model, vector};
use crate::searches::places;

/// What is asked first, with or without room: reached at a configuration or not.
fn first(
    tasks: &mut ProblemBuilder<'_>,
    masses: &Masses,
    at: &[Placement<f64>],
    case: usize,
    [foot, hand, back]: [FrameId; 3],
) {
    let [low, near, mid] = [foot, hand, back].map(|frame| at[frame.index()]);
    let square = [
        [-0.4, -0.4, 0.0],
        [0.4, -0.4, 0.0],
        [0.4, 0.4, 0.0],
        [-0.4, 0.4, 0.0],
    ];
    match case {
        0 => drop(tasks.add(FramePose::new(foot, low)).index()),
        1 => {
            let room = PoseBounds::within([0.1, 0.05, 0.0, 0.3, 3.2, 0.2]);
            tasks.add(FramePose::new(foot, low).with_goal(room));
            tasks.add(
                SupportPolygon::new(masses)
                    .with_points(square)
                    .with_margin(0.05),
            );
        }
        2 => {
            let plane = Plane::new(hand, near.translation, [0.3, 0.1, 1.0]);
            tasks.add(Bounded::at_most(plane, 0.02));
            tasks.add(Bounded::new(Point::new(back, mid.translation), 0.05));
            tasks.add(Gaze::along(hand, [1.0, 0.0, 0.0], near.rotation.x, 0.3));
        }
        3 => drop(
            tasks
                .add(Point::new(
                    foot,
                    low.translation + Vector3::new(9.0, 0.0, 0.0),
                ))
                .index(),
        ),
        4 => {
            let feet = SupportPolygon::new(masses).with_points_on(foot, square);
            tasks.add(feet.with_margin(0.01));
            tasks.add(Point::new(foot, low.translation).at([0.1, 0.0, 0.0]));
        }
        _ => {
            tasks.add(Orientation::new(back, mid.rotation));
            tasks.add(CentreOfMass::new(masses, [0.1, 0.0, 0.2]).free_along(kinopt::task::Axis::Z));
        }
    }
}

fn levels() -> [Value; 2] {
    let (mut met, mut told, mut random) = (Digest::new(), Digest::new(), Random::new(181));
    let mut workspace = Workspace::new();
    for case in 0..20 {
        let model = model(&mut random, case % 3 == 1);
        let masses = masses(&model, &mut random);
        let map = if case % 2 == 0 {
            ParameterMap::free(&model)
        } else {
            map(&model)
        };
        let (mut x, mut q) = (
            vec![0.0; map.variables()],
            model.random_configuration(case as u64),
        );
        map.reduce(&q, &mut x).unwrap();
        map.expand_within_limits(&x, &mut q).unwrap();
        let at = places(&model, &q);
        let [foot, hand, back, head] = frames(&model, &["foot", "hand", "back", "head"])[..] else {
            unreachable!()
        };
        let mut tasks = Problem::builder(&model);
        tasks.parameters(map);
        first(&mut tasks, &masses, &at, case % 6, [foot, hand, back]);
        let off = vector(&mut random, [0.02, 0.4, 3.0][case % 3]);
        let reach = Point::new(hand, at[hand.index()].translation + off);
        tasks.add(Task::new(reach).at_level(1));
        let look = Orientation::new(head, at[hand.index()].rotation);
        tasks.add(Task::new(look).at_level(2).named("look"));
        if case % 4 > 0 {
            tasks.add(Posture::new(&model, &model.neutral()));
            tasks.add(Task::new(LimitCentring::new(&model)).at_level(1 + case % 2));
        }
        if case % 8 == 7 {
            tasks.preferences(Preferences::Traded);
        }
        let problem = tasks.build().unwrap();
        let restarts = Restarts::default().with_attempts(1 + case % 3);
        let stopping = Stopping::default().with_max_iterations(5 + case / 2);
        let solver = Solver::default()
            .with_restarts(restarts)
            .with_stopping(stopping);
        let start = if case % 5 == 0 {
            q
        } else {
            configuration(&model, &mut random)
        };
        let solution = solver.solve(&problem, &start, &mut workspace).unwrap();
        met.solution(solution);
        told.told(solution);
    }
    [met.value(), told.value()]
}

#[test]
fn of_levels() {
    let [met, told] = levels();
    check(&[
        ("strict levels with rooms and preferences", met),
        ("strict levels, in words", told),
    ]);
}
