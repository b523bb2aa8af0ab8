//! Promise: equal input gives bitwise equal results, whatever the workspace solved before.

use kinopt::ik::Restarts;
use kinopt::model::Limits;
use kinopt::problem::{Derivatives, Preferences, Problem, ProblemBuilder};
use kinopt::solver::{Stopping, Termination};
use kinopt::task::{FramePose, Point, Posture, Task};
use kinopt::{Solution, Solver, Workspace};
use support::bones::RandomRig;
use support::methods::solvers;
use support::random::{Random, part};
use support::trees::RandomTree;
use support::{placement, planar_arm};

/// Contents of a solution, bitwise.
fn bits(solution: &Solution) -> (Vec<u64>, String) {
    let q = solution.q.iter().map(|v| v.to_bits()).collect();
    (q, format!("{solution:?}\n{}", solution.explain()))
}

struct ProblemInstance {
    problem: Problem,
    start: Vec<f64>,
}

/// Problems of several sizes, reachable and not.
fn questions() -> Vec<ProblemInstance> {
    let mut all = Vec::new();
    for seed in 0..3 {
        let mut random = Random::new(seed);
        let tree = RandomTree::new(seed, 6 + 3 * seed as usize);
        let q = tree.configuration(&mut random);
        let frame = tree.frames.len() - 2;
        let mut builder = Problem::builder(&tree.model);
        let target = placement(&tree.frames_at(&q)[frame]);
        builder.add(FramePose::new(tree.frames[frame], target));
        all.push(ProblemInstance {
            problem: builder.build().unwrap(),
            start: tree.configuration(&mut random),
        });
    }
    let rig = RandomRig::new(4);
    let mut random = Random::new(4);
    all.push(ProblemInstance {
        problem: rig.drawn_to(|| random.vector(0.8)),
        start: rig.skeleton.model().neutral(),
    });
    all
}

fn quick(solver: Solver) -> Solver {
    solver
        .with_stopping(Stopping::default().with_max_iterations(15))
        .with_restarts(Restarts::default().with_attempts(2))
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
                    let solution = solver.solve_once(&question.problem, &question.start);
                    bits(&solution.unwrap())
                })
                .collect();
            // Visits problems of other sizes, some twice in a row.
            for k in [0, 0, 1, 3, 2, 3, 1] {
                let ProblemInstance { problem, start } = &questions[k];
                let again = bits(solver.solve(problem, start, &mut shared).unwrap());
                assert_eq!(again, fresh[k], "{}, {route:?}", solver.method());
            }
        }
    }
}

#[test]
fn target_moved_and_restored_gives_equal_results() {
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
        let other = bits(solver.solve(question, &start, &mut workspace).unwrap());
        assert_ne!(first, other);
        targets.get_mut(task).unwrap().set_target(near);
        let question = problem.with_targets(&targets).unwrap();
        let back = bits(solver.solve(question, &start, &mut workspace).unwrap());
        assert_eq!(first, back, "{}", solver.method());
    }
}

#[test]
fn threads_sharing_a_problem_agree() {
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
                    let fresh = solver.solve_once(&question.problem, &question.start);
                    assert_eq!(bits(&fresh.unwrap()), *expected);
                }
            });
        }
    });
}

/// Problems of a planar arm with every kind of end: reached, unreachable, at limits, with soft tasks, with levels,
/// stalled, cut short, non-finite.
fn endings() -> Vec<(&'static str, Problem, Solver)> {
    let model = planar_arm(&[1.0, 0.8, 0.5], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    let hand = |at: [f64; 3]| Point::new(tip, at);
    let posture = |q: [f64; 3]| Task::new(Posture::new(&model, &q));
    let build = |state: &dyn Fn(&mut ProblemBuilder<'_>)| {
        let mut tasks = Problem::builder(&model);
        state(&mut tasks);
        tasks.build().unwrap()
    };
    let (near, far) = ([1.2, 0.9, 0.0], [4.0, 1.0, 0.0]);
    let problem_at = |at: [f64; 3]| {
        build(&|tasks| {
            tasks.add(hand(at));
        })
    };
    let limited = build(&|tasks| {
        tasks.add(hand([-1.5, 1.0, 0.0]));
        tasks.bound(model.joint("joint 0").unwrap(), Limits::new(0.0, 0.2));
    });
    let preferring = build(&|tasks| {
        tasks.add(hand(near));
        tasks.add(posture([0.3; 3]));
    });
    let traded = build(&|tasks| {
        tasks.preferences(Preferences::Traded);
        tasks.add(hand(near));
        tasks.add(posture([-0.3, 1.3, -1.3]));
    });
    let ranked = build(&|tasks| {
        tasks.add(hand([1.9, 1.9, 0.0]));
        tasks.add(posture([0.9, 0.2, 0.1]).goal().at_level(1));
    });
    let usual = Solver::default();
    let once = |stopping: Stopping| {
        let once = usual.clone().with_restarts(Restarts::none());
        once.with_stopping(stopping)
    };
    let steps = Stopping::default().with_max_iterations(2);
    let exact = Stopping::default()
        .with_gradient_tolerance(0.0)
        .with_step_tolerance(0.0);
    vec![
        ("reached", problem_at(near), usual.clone()),
        ("far", problem_at(far), usual.clone()),
        ("against limits", limited, usual.clone()),
        ("within a preference", preferring, usual.clone()),
        ("traded", traded, usual.clone()),
        ("on levels", ranked, usual.clone()),
        ("to the last digit", problem_at(far), once(exact)),
        ("cut short", problem_at(near), once(steps)),
        ("no number", problem_at([1e300, 0.0, 0.0]), usual),
    ]
}

/// A workspace and its solution keep nothing of the previous problem, whatever its end.
#[test]
fn previous_problem_has_no_influence() {
    let (endings, start) = (endings(), [0.3, 0.4, 0.45]);
    let fresh: Vec<_> = (endings.iter())
        .map(|(_, problem, solver)| solver.solve_once(problem, &start).unwrap())
        .collect();
    // Each solution has state that could persist.
    assert!(fresh[1].is_out_of_reach() && fresh[7].termination == Termination::IterationLimit);
    assert!(fresh[2].active_limits().next().is_some());
    assert!(fresh[4].pulling_preferences().next().is_some());
    assert_eq!(fresh[6].termination, Termination::Stationary);
    for (first, problem, solver) in &endings {
        for ((second, other, solver_of_other), expected) in endings.iter().zip(&fresh) {
            let mut workspace = Workspace::new();
            solver.solve(problem, &start, &mut workspace).unwrap();
            let reported = solver_of_other.solve(other, &start, &mut workspace);
            assert_eq!(
                bits(reported.unwrap()),
                bits(expected),
                "{second} after {first}"
            );
        }
    }
}

/// A search with constant cost leaves no state for the next.
#[test]
fn stalled_search_has_no_influence() {
    let model = planar_arm(&[1.0, 0.8, 0.5], Some((-2.5, 2.5)));
    let mut builder = Problem::builder(&model);
    let tip = model.frame("tip").unwrap();
    let task = builder.add(Point::new(tip, [0.0; 3]));
    let problem = builder.build().unwrap();
    let stopping = Stopping::default()
        .with_gradient_tolerance(0.0)
        .with_step_tolerance(0.0)
        .with_max_iterations(400);
    let places = [[4.0, 1.0, 0.0], [1.2, 0.9, 0.0], [-3.0, 2.0, 0.0]];
    let target_lists = places.map(|position| {
        let mut targets = problem.targets();
        targets.get_mut(task).unwrap().set_target(position);
        targets
    });
    let start = [0.3, 0.4, 0.2];
    for solver in solvers() {
        let once = solver.with_restarts(Restarts::none());
        let once = once.with_stopping(stopping);
        let fresh = target_lists.each_ref().map(|targets| {
            let question = problem.with_targets(targets).unwrap();
            bits(&once.solve_once(question, &start).unwrap())
        });
        let mut workspace = Workspace::new();
        for k in [0, 1, 2, 0, 2, 1] {
            let question = problem.with_targets(&target_lists[k]).unwrap();
            let again = bits(once.solve(question, &start, &mut workspace).unwrap());
            assert_eq!(again, fresh[k], "{} {k}", once.method());
        }
    }
}
