//! Promise: no returned configuration violates a limit, for any joints, tasks, method and start, reached or not. Limits
//! include cones and twists of ball joints, total angles, base bounds, mimic joints, locked joints and move limits.
//! Quaternions have unit length to 1e-12.
//!
//! Longer run: `KINOPT_CASES=1000000 cargo test --release --test solver limit_kinds`.

use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::{BoundKind, Drag, MoveLimits, Restarts, Solution};
use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::{Preferences, ProblemBuilder, ProblemInstance};
use kinopt::solver::{Silent, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Bounded, CentreOfMass, Distance, FramePose, Gaze, LookAt, Manipulability, Orientation, Plane,
    Point, Posture, Ray, Residual, Smoothness, SupportPolygon, Task,
};
use kinopt::{Problem, Solver, Workspace};
use support::bodies::{Body, direction};
use support::methods::solvers;
use support::random::{Random, case_count};
use support::vector;

/// Adds a task of a random kind at a reachable pose or up to `off` metres from it.
fn add_task(tasks: &mut ProblemBuilder<'_>, body: &Body, random: &mut Random, off: f64) {
    let model = &body.model;
    let q = match random.below(2) {
        0 => model.random_configuration(random.bits()),
        _ => body.on_edges(random),
    };
    let mut kinematics = ForwardKinematics::new(model);
    let at = kinematics.place(&q).unwrap();
    let mut pick = || body.frames[random.below(body.frames.len())];
    let (frame, other) = (pick(), pick());
    let frame_pose = at[frame.index()];
    let aside = vector(random.vector(off));
    let position = frame_pose.translation + aside;
    let pose = Placement::new(frame_pose.rotation, position);
    match random.below(16) {
        0..4 => {
            tasks.add(FramePose::new(frame, pose));
        }
        4 | 5 => {
            tasks.add(Point::new(frame, position).at(vector(random.vector(0.2))));
        }
        6 => {
            tasks.add(Orientation::new(frame, frame_pose.rotation));
        }
        // A frame relative to itself has no free pose.
        7 if frame != other => {
            let base = at[other.index()];
            let seen = base.inverse() * pose;
            tasks.add(FramePose::new(frame, seen).relative_to(other));
        }
        8 => {
            tasks.add(LookAt::new(frame, direction(random), position));
        }
        9 => {
            tasks.add(Gaze::at(frame, direction(random), position, 0.3));
        }
        10 => {
            tasks.add(Bounded::new(FramePose::new(frame, pose), 0.05));
        }
        11 => {
            tasks.add(CentreOfMass::new(&body.masses, position));
        }
        12 => {
            let corners = (0..4).map(|_| position + vector(random.vector(0.2)));
            let polygon = SupportPolygon::new(&body.masses).with_points(corners);
            tasks.add(polygon);
        }
        13 => {
            let task = Manipulability::new(model, None, frame, 0.1).of_position();
            // A frame that too few joints move is rejected.
            match task.description().defect() {
                None => tasks.add(Task::new(task).preference()).index(),
                Some(_) => tasks.add(Point::new(frame, position)).index(),
            };
        }
        14 => {
            tasks.add(Task::new(Posture::new(model, &q)).preference().scale(0.1));
            tasks.add(Smoothness::new(model, &model.neutral(), 0.1));
        }
        _ => {
            tasks.add(Plane::new(frame, position, direction(random)));
            tasks.add(Ray::new(other, position + Vector3::UNITS[0], position));
            if frame != other {
                tasks.add(Distance::new(frame, other, random.within(0.0, 1.0)));
            }
        }
    }
}

fn problem(body: &Body, random: &mut Random) -> Problem {
    let mut tasks = Problem::builder(&body.model);
    tasks.parameters(body.map.clone());
    let off = [0.0, 0.05, 0.5, 5.0][random.below(4)];
    for _ in 0..1 + random.below(3) {
        add_task(&mut tasks, body, random, off);
    }
    if random.below(4) == 0 {
        tasks.preferences(Preferences::Traded);
    }
    tasks.build().unwrap()
}

fn start(body: &Body, random: &mut Random) -> Vec<f64> {
    match random.below(6) {
        0 => body.model.neutral(),
        1 => body.on_edges(random),
        2 => body.anywhere(random, 3.0),
        3 => body.anywhere(random, 1e12),
        _ => body.model.random_configuration(random.bits()),
    }
}

/// Move limits: zero, tiny, one step, or larger than the ranges.
fn moves(body: &Body, random: &mut Random) -> Vec<f64> {
    let mut largest = Vec::new();
    let size = [1e-6, 0.01, 0.3, 2.0][random.below(4)];
    for rule in &body.rules {
        let bound = match random.below(8) {
            0 => 0.0,
            1 => f64::INFINITY,
            _ => random.within(0.0, size),
        };
        largest.resize(largest.len() + rule.coordinates(), bound);
    }
    largest
}

/// Mostly few iterations, so that searches end anywhere; one in 40 runs to its end.
fn settings(solver: Solver, random: &mut Random) -> Solver {
    if random.below(40) == 0 {
        return solver;
    }
    let stopping = Stopping::default().with_max_iterations(1 + random.below(25));
    let attempts = Restarts::default().with_attempts(1 + random.below(3));
    let attempts = attempts.with_seed(random.bits());
    solver.with_stopping(stopping).with_restarts(attempts)
}

/// Counts of outcomes.
#[derive(Debug, Default)]
struct Tally {
    reached: usize,
    missed: usize,
    against_a_limit: usize,
    against_a_move: usize,
}

/// Solves one problem of a robot by a random entry point.
fn solve_and_check(body: &Body, random: &mut Random, tally: &mut Tally, workspace: &mut Workspace) {
    let look = |solution: &Solution, by: &str| {
        if let Some(fault) = body.broken(&solution.q) {
            panic!("by {by}: {fault}\n{}", solution.explain());
        }
    };
    let problem = problem(body, random);
    let start = start(body, random);
    match random.below(10) {
        0 => {
            let mut drag = Drag::new(problem, &start).unwrap();
            for _ in 0..1 + random.below(4) {
                drag.advance();
                look(drag.solution(), "a drag");
            }
        }
        1 => {
            let stopping = Stopping::default().with_max_iterations(5);
            let ccd = Ccd::default().with_stopping(stopping);
            let fabrik = Fabrik::default().with_stopping(stopping);
            let methods: [&dyn Geometric; 2] = [&ccd, &fabrik];
            for method in methods {
                let result = method.solve_question((&problem).into(), &start, &mut Silent);
                // Some tasks and joints are not supported by geometric solvers.
                if let Ok(solution) = result {
                    look(&solution, method.name());
                }
            }
        }
        2 | 3 => {
            let most = moves(body, random);
            let limits = MoveLimits::new(&problem, &most, &start).unwrap();
            let mut stood = vec![0.0; start.len()];
            let mut x = vec![0.0; problem.variables()];
            let question = ProblemInstance::from(&problem).with_moves(&limits).unwrap();
            problem.parameters().reduce(&start, &mut x).unwrap();
            question.space().project(&mut x);
            problem.parameters().expand(&x, &mut stood).unwrap();
            let solver = settings(Solver::default(), random);
            let solution = solver.solve(question, &start, workspace).unwrap();
            look(solution, "moves");
            let fault = support::configuration_rules::moved_too_far(
                &body.rules,
                &most,
                &stood,
                &solution.q,
            );
            assert_eq!(fault, None, "{}", solution.explain());
            let blocked = solution
                .active_limits()
                .any(|limit| limit.kind == BoundKind::Move);
            tally.against_a_move += usize::from(blocked);
        }
        _ => {
            let mut methods = solvers();
            // Half of the cases use the default method.
            let method = random.below(2 * methods.len()) % methods.len() * random.below(2);
            let solver = settings(methods.swap_remove(method), random);
            let solution = solver.solve(&problem, &start, workspace).unwrap();
            look(solution, solver.method());
            tally.reached += usize::from(solution.reached);
            tally.missed += usize::from(!solution.reached);
            tally.against_a_limit += usize::from(solution.active_limits().next().is_some());
        }
    }
}

#[test]
fn no_result_violates_a_limit() {
    const QUERIES: usize = 4;
    let mut workspace = Workspace::new();
    let mut tally = Tally::default();
    let case_count = case_count(20_000, 600);
    for seed in 0..case_count / QUERIES {
        let random = &mut Random::new(seed as u64);
        let body = Body::new(random, 2 + seed % 9);
        for q in [
            body.model.neutral(),
            body.model.random_configuration(random.bits()),
        ] {
            let fault = support::configuration_rules::broken(&body.rules, &[], &q);
            assert_eq!(fault, None, "seed {seed}");
        }
        if body.map.variables() > 0 {
            for _ in 0..QUERIES {
                solve_and_check(&body, random, &mut tally, &mut workspace);
            }
        }
    }
    let least = case_count / 20;
    let counts = [
        tally.reached,
        tally.missed,
        tally.against_a_limit,
        tally.against_a_move,
    ];
    assert!(counts.iter().all(|count| *count > least), "{tally:?}");
}
