//! Promise: after the first solve with a workspace, a solve allocates nothing, with any method on the exact derivative
//! routes. A moved target does not change this.

use crate::counting_allocator::allocations;
use kinopt::problem::{Derivatives, Problem, Targets, TaskId};
use kinopt::task::{FramePose, LookAt, Point, Posture};
use kinopt::{Solver, Workspace};
use nalgebra as na;
use support::bones::RandomRig;
use support::methods::solvers;
use support::random::{Random, part};

struct Drag {
    rig: RandomRig,
    problem: Problem,
    targets: Targets,
    task: TaskId<Point>,
    rest: Vec<f64>,
    at_rest: na::Vector3<f64>,
}

/// Pose and posture tasks, a dragged tip, and a gaze task without derivatives of its own.
fn drag() -> Drag {
    let rig = RandomRig::new(6);
    let model = rig.skeleton.model();
    let rest = model.neutral();
    let transforms = rig.transforms(&rest);
    let at_rest = rig.tip(&transforms, rig.tips[0]);
    let mut builder = Problem::builder(model);
    let task = builder.add(Point::new(rig.skeleton.tip(rig.tips[0]), at_rest));
    let held = rig.skeleton.pose(&rest).unwrap().model_from_bone[rig.tips[1].index()];
    builder.add(FramePose::new(rig.skeleton.tail(rig.tips[1]), held));
    let gaze = na::Vector3::x();
    builder.add(LookAt::new(
        rig.skeleton.tail(rig.tips[2]),
        gaze,
        [5.0, 1.0, 2.0],
    ));
    builder.add(Posture::new(model, &rest));
    let problem = builder.build().unwrap();
    Drag {
        rig,
        targets: problem.targets(),
        problem,
        task,
        rest,
        at_rest,
    }
}

fn move_target(drag: &mut Drag, random: &mut Random, size: f64) {
    let to = drag.at_rest + random.vector(size);
    drag.targets.get_mut(drag.task).unwrap().set_target(to);
}

fn limited(solver: Solver) -> Solver {
    solver
        .with_stopping(kinopt::solver::Stopping::default().with_max_iterations(8))
        .with_restarts(kinopt::ik::Restarts::default().with_attempts(2))
}

#[test]
fn allocations_are_counted() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1; 100]))) > 0);
    assert_eq!(allocations(|| ()), 0);
}

#[test]
fn repeated_solves_allocate_nothing() {
    let mut drag = drag();
    assert!(drag.rig.skeleton.bones().len() >= 19);
    for route in part(Derivatives::ALL, 2) {
        drag.problem = drag.problem.clone().with_derivatives(route);
        for solver in solvers().into_iter().map(limited) {
            let mut random = Random::new(3);
            let mut workspace = Workspace::new();
            move_target(&mut drag, &mut random, 0.3);
            let question = drag.problem.with_targets(&drag.targets).unwrap();
            solver.solve(question, &drag.rest, &mut workspace).unwrap();
            for reach in [0.0, 0.01, 1.0, 5.0] {
                let spent = allocations(|| {
                    move_target(&mut drag, &mut random, reach);
                    let question = drag.problem.with_targets(&drag.targets).unwrap();
                    solver.solve(question, &drag.rest, &mut workspace).unwrap();
                });
                assert_eq!(
                    spent,
                    0,
                    "{}, {route:?}, target {reach} away",
                    solver.method()
                );
            }
        }
    }
}

#[test]
fn solves_after_a_trivial_one_allocate_nothing() {
    let rig = RandomRig::new(6);
    let model = rig.skeleton.model();
    let rest = model.neutral();
    let at_rest = rig.tip(&rig.transforms(&rest), rig.tips[0]);
    let mut builder = Problem::builder(model);
    let task = builder.add(Point::new(rig.skeleton.tip(rig.tips[0]), at_rest));
    let problem = builder.build().unwrap();
    let mut failures = Vec::new();
    for route in [Derivatives::Analytic, Derivatives::Dual] {
        let problem = problem.clone().with_derivatives(route);
        let mut targets = problem.targets();
        for solver in solvers().into_iter().map(limited) {
            let mut workspace = Workspace::new();
            targets.get_mut(task).unwrap().set_target(at_rest);
            let question = problem.with_targets(&targets).unwrap();
            let first = solver.solve(question, &rest, &mut workspace).unwrap();
            assert_eq!((first.iterations, first.reached), (0, true));
            let away = at_rest * 3.0 + na::Vector3::new(1.0, 1.0, 1.0);
            targets.get_mut(task).unwrap().set_target(away);
            let question = problem.with_targets(&targets).unwrap();
            let spent = allocations(|| {
                solver.solve(question, &rest, &mut workspace).unwrap();
            });
            if spent > 0 {
                failures.push(format!("{} ({route:?}): {spent}", solver.method()));
            }
        }
    }
    assert!(failures.is_empty(), "allocations: {failures:?}");
}

#[test]
fn animation_frames_allocate_nothing() {
    use kinopt::animation::{Armature, Clip, Cursor, EulerClip, Limb, LimbGoal, Playback};
    use kinopt::animation::{EulerKey, EulerTrack};

    let rig = RandomRig::new(8);
    let armature = Armature::of_skeleton(&rig.skeleton);
    let mut random = Random::new(8);
    let tracks = rig.skeleton.bone_ids().map(|bone| EulerTrack {
        bone,
        keys: (0..5)
            .map(|key| EulerKey {
                time: f64::from(key),
                angles: [(); 3].map(|()| random.within(-1.0, 1.0)),
            })
            .collect(),
    });
    let keys = EulerClip::new(tracks.collect()).unwrap();
    let mut builder = Clip::builder("clip", &armature);
    builder.euler_clip(&keys).unwrap();
    let clip = builder.build();
    let lower = rig.tips[0];
    let upper = armature.parent(lower).unwrap();
    let limb = Limb::new(&armature, upper, lower, glam::Vec3A::X * 0.2).unwrap();
    let (mut pose, mut other) = (armature.rest().clone(), armature.rest().clone());
    let mut model = vec![glam::Affine3A::IDENTITY; armature.bones()];
    let mut cursor = Cursor::new();
    let mut frame = |elapsed: f64| {
        clip.sample(elapsed, Playback::Loop, &mut cursor, &mut pose)
            .unwrap();
        clip.sample(elapsed + 1.3, Playback::PingPong, &mut cursor, &mut other)
            .unwrap();
        pose.cross_fade(&other, 0.4).unwrap();
        let goal = LimbGoal {
            weight: 0.7,
            ..LimbGoal::at(glam::Vec3A::new(0.1, 0.3, 0.2))
        };
        limb.reach(&armature, &mut pose, &goal).unwrap();
        armature.local_to_model(&pose, &mut model).unwrap();
    };
    frame(0.0);
    let counted = allocations(|| (0..200).for_each(|k| frame(f64::from(k) / 60.0)));
    assert_eq!(counted, 0);
}

#[test]
fn frames_of_a_drag_allocate_nothing() {
    let scene = drag();
    let (at_rest, task) = (scene.at_rest, scene.task);
    let mut drag = kinopt::ik::Drag::new(scene.problem, &scene.rest).unwrap();
    drag.advance();
    let mut random = Random::new(9);
    // Out of reach and back, with perturbations where a frame settles on a miss.
    for frame in 0..40 {
        let size = if frame % 20 < 10 { 5.0 } else { 0.02 };
        let to = if frame % 4 == 0 {
            at_rest + random.vector(size)
        } else {
            at_rest * size
        };
        let allocated = allocations(|| {
            drag.target_mut(task).unwrap().set_target(to);
            drag.advance();
        });
        assert_eq!(allocated, 0, "frame {frame}");
    }
}
