//! Promise: a floating-base robot with hardly more variables than task rows gets more attempts, and basin hopping limb
//! by limb from low minima.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, JointId, Limits, Model, ModelBuilder};
use kinopt::solver::{Iteration, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::FramePose;
use kinopt::{Problem, Solver, Workspace};

const X: usize = 0;
const Y: usize = 1;
const Z: usize = 2;

/// Revolute joint: axis, offset from the previous joint (metres), range (radians).
type Hinge = (usize, [f64; 3], [f64; 2]);

/// Five joints a leg, as on robots with single-axis feet.
const LEG: [Hinge; 5] = [
    (Z, [0.0, 0.09, -0.17], [-0.43, 0.43]),
    (X, [0.04, 0.0, 0.0], [-0.43, 0.43]),
    (Y, [0.0, 0.11, 0.0], [-2.5, 2.5]),
    (Y, [0.0, 0.0, -0.4], [-0.26, 2.05]),
    (Y, [0.0, 0.0, -0.4], [-0.87, 0.52]),
];
const ARM: [Hinge; 4] = [
    (Y, [0.0, 0.16, 0.43], [-2.87, 2.87]),
    (X, [0.0, 0.05, 0.0], [-0.34, 3.11]),
    (Z, [0.0, 0.0, -0.13], [-1.3, 4.45]),
    (Y, [0.02, 0.0, -0.2], [-1.25, 2.61]),
];

/// Chain of revolute joints, or its mirror image, and the frame at its end.
fn limb(
    builder: &mut ModelBuilder,
    name: &str,
    on: JointId,
    hinges: &[Hinge],
    mirrored: bool,
) -> FrameId {
    let mut parent = on;
    for (k, &(axis, [x, y, z], [low, high])) in hinges.iter().enumerate() {
        // Mirroring at the xz plane reverses rotations about x and z.
        let (y, limits) = match mirrored {
            true if axis != Y => (-y, Limits::new(-high, -low)),
            true => (-y, Limits::new(low, high)),
            false => (y, Limits::new(low, high)),
        };
        let at = Placement::translation([x, y, z].into());
        let joint = format!("{name} {k}");
        parent = builder.revolute(joint, Some(parent), at, Vector3::UNITS[axis], limits);
    }
    let end = Placement::translation([0.1, 0.0, -0.05].into());
    builder.frame(name, Some(parent), end)
}

fn body() -> (Model, [FrameId; 4]) {
    let mut builder = Model::builder("body");
    let still = Placement::identity();
    let base = builder.free("base", None, still, [Limits::UNBOUNDED; 3]);
    let waist = Limits::new(-2.35, 2.35);
    let waist = builder.revolute("waist", Some(base), still, Vector3::UNITS[Z], waist);
    let ends = [
        limb(&mut builder, "left foot", base, &LEG, false),
        limb(&mut builder, "right foot", base, &LEG, true),
        limb(&mut builder, "left hand", waist, &ARM, false),
        limb(&mut builder, "right hand", waist, &ARM, true),
    ];
    (builder.build().expect("it is whole"), ends)
}

/// Pose tasks of all ends at a configuration.
fn ends_as_at(model: &Model, ends: &[FrameId], q: &[f64]) -> Problem {
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(q).expect("a configuration");
    let mut tasks = Problem::builder(model);
    for &end in ends {
        tasks.add(FramePose::new(end, placed[end.index()]));
    }
    tasks.build().expect("a valid problem")
}

/// Without basin hopping one of these takes 157 attempts.
#[test]
fn low_redundancy_targets_take_100_attempts() {
    let (model, ends) = body();
    let standing = model.neutral();
    let mut workspace = Workspace::new();
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(100));
    for seed in 0..40 {
        let mut target_q = model.random_configuration(seed);
        target_q[..7].copy_from_slice(&standing[..7]);
        let problem = ends_as_at(&model, &ends, &target_q);
        assert_eq!((problem.variables(), problem.rows()), (25, 24));
        let solution = solver.solve(&problem, &standing, &mut workspace);
        let solution = solution.expect("a valid start");
        assert!(solution.reached, "{seed}: {}", solution.explain());
        assert!(model.is_within_limits(&solution.q));
    }
}

#[test]
fn low_redundancy_raises_the_default_attempts() {
    let (model, ends) = body();
    let made = |ends: &[FrameId], restarts: Restarts| {
        let mut far_start = model.neutral();
        far_start[0] = 1e3;
        let problem = ends_as_at(&model, ends, &far_start);
        let stopping = Stopping::default().with_max_iterations(1);
        let solver = Solver::default().with_stopping(stopping);
        let solver = solver.with_restarts(restarts);
        let solution = solver.solve_once(&problem, &model.neutral());
        solution.expect("a valid start").attempts
    };
    assert_eq!(made(&ends, Restarts::default()), 512);
    assert_eq!(made(&ends[..3], Restarts::default()), 32);
    assert_eq!(made(&ends, Restarts::default().with_attempts(20)), 20);
}

/// Minima of an earlier problem have no influence.
#[test]
fn basin_hopping_ignores_earlier_problems() {
    let (model, ends) = body();
    let standing = model.neutral();
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(14));
    let solve = |problem: &Problem, workspace: &mut Workspace| {
        let solution = solver.solve(problem, &standing, workspace);
        solution.expect("a valid start").clone()
    };
    let as_it_stands = ends_as_at(&model, &ends, &standing);
    let mut hopped = 0;
    for seed in 0..6 {
        let mut target_q = model.random_configuration(seed);
        target_q[..7].copy_from_slice(&standing[..7]);
        let problem = ends_as_at(&model, &ends, &target_q);
        let mut workspace = Workspace::new();
        assert!(solve(&as_it_stands, &mut workspace).reached);
        let again = solve(&problem, &mut workspace);
        let fresh = solve(&problem, &mut Workspace::new());
        assert_eq!((&again.q, again.attempts), (&fresh.q, fresh.attempts));
        hopped += usize::from(fresh.attempts > 8);
    }
    assert!(hopped > 0);
}

/// Attempts can only agree if they are independent. If agreement is requested, none starts from another's end.
#[test]
fn agreeing_attempts_start_independently() {
    let (model, ends) = body();
    let starts = |distance: f64| {
        let mut target_q = model.neutral();
        target_q[0] = distance;
        let restarts = Restarts::default().with_attempts(16).with_agreeing(99);
        let stopping = Stopping::default().with_max_iterations(1);
        let solver = Solver::default().with_stopping(stopping);
        let solver = solver.with_restarts(restarts);
        let mut seen = Vec::new();
        let mut watch = |iteration: &Iteration<'_>| {
            if iteration.index == 0 {
                seen.push(iteration.x.to_vec());
            }
            ControlFlow::Continue(())
        };
        let problem = ends_as_at(&model, &ends, &target_q);
        let (start, mut workspace) = (model.neutral(), Workspace::new());
        let reported = solver.solve_observed(&problem, &start, &mut workspace, &mut watch);
        assert_eq!(reported.expect("a valid start").attempts, 16);
        seen
    };
    let [near, far] = [1e3, -2e3].map(starts);
    assert_eq!(near.len(), far.len());
    // Every other attempt is sampled from the whole box.
    for k in (8..16).step_by(2) {
        assert_eq!(near[k], far[k], "{k}");
    }
}
