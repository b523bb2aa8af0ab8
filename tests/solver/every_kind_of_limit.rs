//! Promise: no configuration that is returned is outside a limit, whatever the joints (cones and twists of balls,
//! whole angles, rooms of bases, followers, what is held and how far joints may go from the start included), the tasks, the method and the start, reached or not,
//! and its quaternions are of unit length to 1e-12.
//!
//! A longer search: `KINOPT_CASES=1000000 cargo test --release --test solver every_kind_of_limit`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::{BoundKind, Drag, MoveLimits, Restarts, Solution};
use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::{Preferences, ProblemBuilder, ProblemInstance};
use kinopt::solver::{Silent, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    CentreOfMass, Distance, Gaze, LookAt, Manipulability, Orientation, Plane, Point, Pose, Posture,
    Ray, Residual, Smoothness, SupportPolygon, Task, Within,
};
use kinopt::{Problem, Solver, Workspace};
use support::bodies::{Body, direction};
use support::methods::solvers;
use support::random::Random;
use support::sample::cases;
use support::vector;

/// One of any kind, at a place that some configuration has or up to `off` metres away from it.
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
    let here = at[frame.index()];
    let aside = vector(random.vector(off));
    let place = here.translation + aside;
    let pose = Placement::new(here.rotation, place);
    match random.below(16) {
        0..4 => {
            tasks.add(Pose::new(frame, pose));
        }
        4 | 5 => {
            tasks.add(Point::new(frame, place).at(vector(random.vector(0.2))));
        }
        6 => {
            tasks.add(Orientation::new(frame, here.rotation));
        }
        // In itself a frame has no place to go.
        7 if frame != other => {
            let base = at[other.index()];
            let seen = base.inverse() * pose;
            tasks.add(Pose::new(frame, seen).relative_to(other));
        }
        8 => {
            tasks.add(LookAt::new(frame, direction(random), place));
        }
        9 => {
            tasks.add(Gaze::at(frame, direction(random), place, 0.3));
        }
        10 => {
            tasks.add(Within::new(Pose::new(frame, pose), 0.05));
        }
        11 => {
            tasks.add(CentreOfMass::new(&body.masses, place));
        }
        12 => {
            let corners = (0..4).map(|_| place + vector(random.vector(0.2)));
            let polygon = SupportPolygon::new(&body.masses).with_points(corners);
            tasks.add(polygon);
        }
        13 => {
            let task = Manipulability::new(model, None, frame, 0.1).of_position();
            // A frame that too little moves has none.
            match task.validate() {
                Ok(()) => tasks.add(Task::new(task).preference()).index(),
                Err(_) => tasks.add(Point::new(frame, place)).index(),
            };
        }
        14 => {
            tasks.add(Task::new(Posture::new(model, &q)).preference().times(0.1));
            tasks.add(Smoothness::new(model, &model.neutral(), 0.1));
        }
        _ => {
            tasks.add(Plane::new(frame, place, direction(random)));
            tasks.add(Ray::new(other, place + Vector3::UNITS[0], place));
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

/// How far joints may go: not at all, hardly, a step, as far as they can.
fn moves(body: &Body, random: &mut Random) -> Vec<f64> {
    let mut most = Vec::new();
    let size = [1e-6, 0.01, 0.3, 2.0][random.below(4)];
    for rule in &body.rules {
        let own = match random.below(8) {
            0 => 0.0,
            1 => f64::INFINITY,
            _ => random.within(0.0, size),
        };
        most.resize(most.len() + rule.coordinates(), own);
    }
    most
}

/// Most in a few steps, so that they are cut off anywhere; some to their ends.
fn settings(solver: Solver, random: &mut Random) -> Solver {
    if random.below(40) == 0 {
        return solver;
    }
    let few = Stopping::default().with_max_iterations(1 + random.below(25));
    let attempts = Restarts::default().with_attempts(1 + random.below(3));
    let attempts = attempts.with_seed(random.bits());
    solver.with_stopping(few).with_restarts(attempts)
}

/// What a body was asked, and what came of it.
#[derive(Debug, Default)]
struct Tally {
    reached: usize,
    missed: usize,
    against_a_limit: usize,
    against_a_move: usize,
}

/// One question to a body, by one of all ways to answer it.
fn ask(body: &Body, random: &mut Random, tally: &mut Tally, workspace: &mut Workspace) {
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
            let few = Stopping::default().with_max_iterations(5);
            let ccd = Ccd::default().with_stopping(few);
            let fabrik = Fabrik::default().with_stopping(few);
            let methods: [&dyn Geometric; 2] = [&ccd, &fabrik];
            for method in methods {
                let answer = method.solve_question((&problem).into(), &start, &mut Silent);
                // There are tasks and joints that it has no answer for.
                if let Ok(solution) = answer {
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
            let fault =
                support::kept_limits::moved_too_far(&body.rules, &most, &stood, &solution.q);
            assert_eq!(fault, None, "{}", solution.explain());
            let blocked = solution
                .active_limits()
                .any(|limit| limit.kind == BoundKind::Move);
            tally.against_a_move += usize::from(blocked);
        }
        _ => {
            let mut methods = solvers();
            // As most are asked.
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
fn none_is_left_by_what_is_returned() {
    const QUESTIONS: usize = 4;
    let mut workspace = Workspace::new();
    let mut tally = Tally::default();
    let wanted = cases(20_000, 600);
    for seed in 0..wanted / QUESTIONS {
        let random = &mut Random::new(seed as u64);
        let body = Body::new(random, 2 + seed % 9);
        for q in [
            body.model.neutral(),
            body.model.random_configuration(random.bits()),
        ] {
            let fault = support::kept_limits::broken(&body.rules, &[], &q);
            assert_eq!(fault, None, "seed {seed}");
        }
        if body.map.variables() > 0 {
            for _ in 0..QUESTIONS {
                ask(&body, random, &mut tally, &mut workspace);
            }
        }
    }
    let least = wanted / 20;
    let counts = [
        tally.reached,
        tally.missed,
        tally.against_a_limit,
        tally.against_a_move,
    ];
    assert!(counts.iter().all(|count| *count > least), "{tally:?}");
}
