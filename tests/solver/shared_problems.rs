//! Promise: a problem is immutable. Threads solve it with targets of their own, and each result equals bitwise that of
//! a problem built with those targets.

use kinopt::problem::{ProblemError, TaskId};
use kinopt::task::{Orientation, Point};
use kinopt::{Problem, Solver, Workspace};
use support::bones::RandomRig;
use support::random::{Random, cases};

/// Point tasks of two tips of a rig.
fn problem(rig: &RandomRig, places: [[f64; 3]; 2]) -> (Problem, [TaskId<Point>; 2]) {
    let mut builder = Problem::builder(rig.skeleton.model());
    let tips = [0, 1].map(|k| rig.skeleton.tip(rig.tips[k]));
    let ids = [0, 1].map(|k| builder.add(Point::new(tips[k], places[k])));
    (builder.build().unwrap(), ids)
}

#[test]
fn threads_share_a_problem_with_own_targets() {
    let rig = RandomRig::new(11);
    let rest = rig.skeleton.model().neutral();
    let (shared, ids) = problem(&rig, [[0.0; 3]; 2]);
    let before = Solver::default().solve_once(&shared, &rest).unwrap();
    std::thread::scope(|scope| {
        for seed in 0..4 {
            let (rig, rest, shared) = (&rig, &rest, &shared);
            scope.spawn(move || {
                let mut random = Random::new(seed);
                let mut workspace = Workspace::new();
                let mut targets = shared.targets();
                for _ in cases(5, 2) {
                    let places = [0; 2].map(|_| random.vector(1.0).into());
                    for (id, position) in ids.into_iter().zip(places) {
                        targets.get_mut(id).unwrap().set_target(position);
                    }
                    let question = shared.with_targets(&targets).unwrap();
                    let solver = Solver::default();
                    let ours = solver.solve(question, rest, &mut workspace).unwrap();
                    let (own_problem, _) = problem(rig, places);
                    let fresh = solver.solve_once(&own_problem, rest).unwrap();
                    assert_eq!(ours.q, fresh.q);
                    assert_eq!(ours.cost.to_bits(), fresh.cost.to_bits());
                }
            });
        }
    });
    let after = Solver::default().solve_once(&shared, &rest).unwrap();
    assert_eq!(before.q, after.q);
}

#[test]
fn foreign_targets_and_ids_are_rejected() {
    let rig = RandomRig::new(11);
    let (shared, [first, _]) = problem(&rig, [[0.0; 3]; 2]);
    let mut builder = Problem::builder(rig.skeleton.model());
    let tip = rig.skeleton.tip(rig.tips[0]);
    let turn = builder.add(Orientation::new(tip, kinopt::spatial::Matrix3::identity()));
    let other = builder.build().unwrap();

    let mut targets = other.targets();
    let error = targets.get_mut(first).unwrap_err();
    assert!(
        matches!(&error, ProblemError::ForeignTask { task: 0, tasks } if tasks == &["orientation"])
    );
    assert!(targets.get(turn).is_ok());
    let error = shared.with_targets(&targets).unwrap_err();
    assert!(
        matches!(
            error,
            ProblemError::ForeignTargets {
                given: 1,
                expected: 2,
                ..
            }
        ),
        "{error}"
    );
}

/// The common tasks are equal; only the number of tasks differs.
#[test]
fn targets_of_another_count_are_rejected() {
    let rig = RandomRig::new(11);
    let (two, _) = problem(&rig, [[0.0; 3]; 2]);
    let mut builder = Problem::builder(rig.skeleton.model());
    builder.add(Point::new(rig.skeleton.tip(rig.tips[0]), [0.0; 3]));
    let one = builder.build().unwrap();
    for (problem, targets, counts) in [(&two, one.targets(), (1, 2)), (&one, two.targets(), (2, 1))]
    {
        let error = problem.with_targets(&targets).err();
        let reported = match &error {
            Some(ProblemError::ForeignTargets {
                given, expected, ..
            }) => Some((*given, *expected)),
            _ => None,
        };
        assert_eq!(reported, Some(counts), "{error:?}");
    }
}
