//! Promise: the same input gives the same bits, whatever the workspace did before.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::problem::{Derivatives, Problem};
use kinopt::task::{Point, Pose};
use kinopt::{Solution, Solver, Workspace};
use support::bones::RandomRig;
use support::methods::solvers;
use support::placement;
use support::random::Random;
use support::sample::part;
use support::trees::RandomTree;

/// Everything a solution holds, bit for bit.
fn bits(solution: &Solution) -> (Vec<u64>, String) {
    let q = solution.q.iter().map(|v| v.to_bits()).collect();
    (q, format!("{solution:?}\n{}", solution.explain()))
}

struct Question {
    problem: Problem,
    start: Vec<f64>,
}

/// Problems of several shapes, reachable and not.
fn questions() -> Vec<Question> {
    let mut all = Vec::new();
    for seed in 0..3 {
        let mut random = Random::new(seed);
        let tree = RandomTree::new(seed, 6 + 3 * seed as usize);
        let q = tree.configuration(&mut random);
        let frame = tree.frames.len() - 2;
        let mut builder = Problem::builder(&tree.model);
        let target = placement(&tree.frames_at(&q)[frame]);
        builder.add(Pose::new(tree.frames[frame], target));
        all.push(Question {
            problem: builder.build().unwrap(),
            start: tree.configuration(&mut random),
        });
    }
    let rig = RandomRig::new(4);
    let mut random = Random::new(4);
    all.push(Question {
        problem: rig.drawn_to(|| random.vector(0.8)),
        start: rig.skeleton.model().neutral(),
    });
    all
}

fn quick(solver: Solver) -> Solver {
    solver
        .with_stopping(kinopt::solver::Stopping::default().with_max_iterations(15))
        .with_restarts(kinopt::ik::Restarts::default().with_attempts(2))
}

#[test]
fn reused_moved_and_fresh_workspaces_agree() {
    let mut questions = questions();
    for solver in solvers().into_iter().map(quick) {
        for route in part(Derivatives::ALL, 2) {
            let mut shared = Workspace::new();
            for question in &mut questions {
                question.problem = question.problem.clone().with_derivatives(route);
            }
            let fresh: Vec<_> = questions
                .iter()
                .map(|question| {
                    let own = solver.solve_once(&question.problem, &question.start);
                    bits(&own.unwrap())
                })
                .collect();
            // There and back through problems of other shapes, each twice in a row.
            for k in [0, 0, 1, 3, 2, 3, 1] {
                let Question { problem, start } = &questions[k];
                let again = bits(solver.solve(problem, start, &mut shared).unwrap());
                assert_eq!(again, fresh[k], "{}, {route:?}", solver.method());
            }
        }
    }
}

#[test]
fn a_target_moved_away_and_back_gives_the_same_answer() {
    let rig = RandomRig::new(9);
    let mut random = Random::new(9);
    let near = random.vector(0.8);
    let mut builder = Problem::builder(rig.skeleton.model());
    let task = builder.add(Point::new(rig.skeleton.tip(rig.tips[0]), near));
    let problem = builder.build().unwrap();
    let start = rig.skeleton.model().neutral();
    for solver in solvers().into_iter().map(quick) {
        let mut workspace = Workspace::new();
        let first = bits(solver.solve(&problem, &start, &mut workspace).unwrap());
        let mut targets = problem.targets();
        targets
            .get_mut(task)
            .unwrap()
            .set_target(random.vector(2.0));
        let question = problem.with_targets(&targets).unwrap();
        let elsewhere = bits(solver.solve(question, &start, &mut workspace).unwrap());
        assert_ne!(first, elsewhere);
        targets.get_mut(task).unwrap().set_target(near);
        let question = problem.with_targets(&targets).unwrap();
        let back = bits(solver.solve(question, &start, &mut workspace).unwrap());
        assert_eq!(first, back, "{}", solver.method());
    }
}

#[test]
fn threads_that_share_a_problem_agree() {
    let questions = questions();
    let solver = Solver::default();
    let alone: Vec<_> = questions
        .iter()
        .map(|q| bits(&solver.solve_once(&q.problem, &q.start).unwrap()))
        .collect();
    std::thread::scope(|scope| {
        let (questions, solver, alone) = (&questions, &solver, &alone);
        for _ in 0..3 {
            scope.spawn(move || {
                for (question, expected) in questions.iter().zip(alone) {
                    let own = solver.solve_once(&question.problem, &question.start);
                    assert_eq!(bits(&own.unwrap()), *expected);
                }
            });
        }
    });
}
