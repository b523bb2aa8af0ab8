//! Promise: a problem with changed weights or joint origins equals bitwise the problem built with them. It no longer
//! equals the original problem.

use kinopt::model::{FrameId, JointId, Limits};
use kinopt::problem::{Evaluation, ProblemError};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Posture, Quantity, Task};
use kinopt::{Model, Problem, Solver, Workspace};
use support::random::Random;

const POSITIONS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.3],
    [0.0, 0.1, 0.0],
    [0.3, 0.0, 0.0],
    [0.2, 0.0, 0.1],
];

fn at(position: [f64; 3]) -> Placement<f64> {
    Placement::translation(Vector3::from(position))
}

/// Chain of a ball joint and three revolute joints, with its tip.
fn arm(places: [[f64; 3]; 4]) -> (Model, Vec<JointId>, FrameId) {
    let mut builder = Model::builder("arm");
    let limits = Limits::new(-2.0, 2.0);
    let shoulder = builder.ball("shoulder", None, at(places[0]), [0.0, 0.0, 1.0], None);
    let mut joints = vec![shoulder];
    for (k, axis) in [[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
        .into_iter()
        .enumerate()
    {
        let parent = joints.last().copied();
        joints.push(builder.revolute(
            format!("hinge {k}"),
            parent,
            at(places[k + 1]),
            axis,
            limits,
        ));
    }
    let tip = builder.frame("tip", joints.last().copied(), at([0.1, 0.0, 0.2]));
    (builder.build().unwrap(), joints, tip)
}

/// Pose of the tip and a posture, with weights in the order of the report.
fn problem(model: &Model, tip: FrameId, weights: [f64; 3]) -> Problem {
    let mut builder = Problem::builder(model);
    let pose = Task::new(FramePose::new(tip, at([0.3, 0.2, 0.4])));
    let pose = pose.weight(Quantity::Metres, weights[0]);
    builder.add(pose.weight(Quantity::Radians, weights[1]));
    let posture = Task::new(Posture::new(model, &model.neutral()));
    builder.add(posture.weight(Quantity::JointUnits, weights[2]));
    builder.build().unwrap()
}

fn assert_equal(a: &Problem, b: &Problem, model: &Model, seed: u64) {
    let mut random = Random::new(seed);
    let x: Vec<f64> = (0..a.variables()).map(|_| random.unit()).collect();
    let rows = |problem: &Problem| {
        let mut residual = vec![0.0; problem.rows()];
        Evaluation::new(problem, &mut problem.scratch()).residual(&x, &mut residual);
        residual
    };
    assert_eq!(rows(a), rows(b));
    // One workspace for both: it must distinguish them.
    let mut workspace = Workspace::new();
    let mut solve = |problem: &Problem| {
        let solved = Solver::default().solve(problem, &model.neutral(), &mut workspace);
        let solution = solved.unwrap();
        (solution.q.clone(), solution.cost, solution.reached)
    };
    assert_eq!(solve(a), solve(b));
}

#[test]
fn changed_weights_equal_a_rebuilt_problem() {
    let (model, _, tip) = arm(POSITIONS);
    let first = problem(&model, tip, [1.0, 0.3, 0.01]);
    assert_eq!(first.weights(), [1.0, 0.3, 0.01]);
    for weights in [[2.0, 0.1, 1.0], [0.0, 0.5, 0.2], [0.0, 0.0, 1.0]] {
        let moved = first.clone().with_weights(&weights).unwrap();
        assert_eq!(moved.weights(), weights);
        assert_equal(&moved, &problem(&model, tip, weights), &model, 1);
        // And back.
        let back = moved.with_weights(&first.weights()).unwrap();
        assert_equal(&back, &first, &model, 2);
    }
}

#[test]
fn changed_joint_origins_equal_a_rebuilt_problem() {
    let (model, joints, tip) = arm(POSITIONS);
    let mut random = Random::new(7);
    for _ in 0..8 {
        let places = POSITIONS.map(|position| position.map(|number| number + 0.1 * random.unit()));
        let moved = model.clone();
        let moved = moved
            .with_joint_origins(joints.iter().copied().zip(places))
            .unwrap();
        let (built, _, _) = arm(places);
        let weights = [1.0, 0.3, 0.01];
        let first = problem(&model, tip, weights);
        let mut workspace = Workspace::new();
        Solver::default()
            .solve(&first, &model.neutral(), &mut workspace)
            .unwrap();
        let restated = first.with_joint_origins(&moved).unwrap();
        assert_equal(&restated, &problem(&built, tip, weights), &model, 3);
    }
}

#[test]
fn invalid_weights_and_origins_are_rejected() {
    let (model, joints, tip) = arm(POSITIONS);
    let first = problem(&model, tip, [1.0, 0.3, 0.01]);
    let few = first.clone().with_weights(&[1.0]);
    assert!(matches!(
        few,
        Err(ProblemError::WeightCount {
            given: 1,
            expected: 3
        })
    ));
    for weight in [f64::NAN, -0.5, f64::INFINITY] {
        let invalid = first.clone().with_weights(&[1.0, weight, 1.0]);
        assert!(
            matches!(invalid, Err(ProblemError::BadWeight { .. })),
            "{weight}"
        );
    }
    let mut other = Model::builder("arm");
    other.revolute(
        "hinge",
        None,
        at([0.0; 3]),
        [0.0, 0.0, 1.0],
        Limits::new(-1.0, 1.0),
    );
    let other = other.build().unwrap();
    assert!(matches!(
        first.with_joint_origins(&other),
        Err(ProblemError::ForeignModel { .. })
    ));
    assert!(
        model
            .clone()
            .with_joint_origins([(joints[0], [f64::NAN, 0.0, 0.0])])
            .is_err()
    );
    assert!(other.with_joint_origins([(joints[3], [0.0; 3])]).is_err());
}

/// The last value of a repeated weight or tolerance applies.
#[test]
fn last_weight_and_tolerance_apply() {
    let (model, _, tip) = arm(POSITIONS);
    let start = model.neutral();
    let solved = |change: &dyn Fn(Task<FramePose>) -> Task<FramePose>| {
        let mut tasks = Problem::builder(&model);
        tasks.add(change(Task::new(FramePose::new(tip, at([0.5, 0.3, 0.2])))));
        tasks.add(Posture::new(&model, &start));
        tasks.preferences(kinopt::problem::Preferences::Traded);
        Solver::default()
            .solve_once(&tasks.build().unwrap(), &start)
            .unwrap()
    };
    let once = solved(&|task| {
        task.weight(Quantity::Metres, 3.0)
            .tolerance(Quantity::Metres, 0.4)
    });
    let twice = solved(&|task| {
        let task = task
            .weight(Quantity::Metres, 0.2)
            .weight(Quantity::Metres, 3.0);
        task.tolerance(Quantity::Metres, 1e-9)
            .tolerance(Quantity::Metres, 0.4)
    });
    let first = solved(&|task| {
        task.weight(Quantity::Metres, 0.2)
            .tolerance(Quantity::Metres, 1e-9)
    });
    assert_eq!(twice.q, once.q);
    assert_eq!(
        format!("{:?}", twice.tasks().next()),
        format!("{:?}", once.tasks().next())
    );
    assert_ne!(first.q, once.q);
}
