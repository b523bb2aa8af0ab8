//! Promise: a workspace that solved other problems gives the result of a new one, bitwise. No earlier limit, lock or
//! solution has an influence, whether earlier targets were reachable or not.
#![allow(clippy::unwrap_used)]

use kinopt::ik::{DerivativeWorkspace, Drag, SolutionDerivative};
use kinopt::model::FrameId;
use kinopt::problem::{Problem, ProblemBuilder, TaskId};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Gaze, LimitCentring, LookAt, Manipulability, Point, Pose, PoseBounds, Posture, Task,
};
use kinopt::{Solver, Workspace};
use support::arms::panda;
use support::random::{Random, cases};
use support::trees::configuration_of;

use crate::soft_task_fixtures::placement_of;

const ELBOW: &str = "link4";

/// Pose of the tool, and the tasks that `more` adds.
fn problem(goal: PoseBounds, more: impl Fn(&mut ProblemBuilder<'_>)) -> (Problem, TaskId<Pose>) {
    let (robot, _, tool) = panda();
    let mut builder = Problem::builder(robot.model());
    builder.parameters(robot.map().clone());
    let tool = robot.model().frame(tool).unwrap();
    let pose = builder.add(Pose::new(tool, Placement::identity()).with_goal(goal));
    more(&mut builder);
    (builder.build().unwrap(), pose)
}

/// Solves random targets, every other one far away, with a reused workspace and with new ones.
fn assert_reuse_equals_new(seed: u64, (problem, pose): (Problem, TaskId<Pose>)) {
    let (robot, _, tool) = panda();
    let model = robot.model();
    let (mut random, solver) = (Random::new(seed), Solver::default());
    let (mut workspace, mut reported) = (Workspace::new(), [0; 2]);
    for turn in cases(60, 12) {
        let [target_q, start] = [(); 2].map(|()| configuration_of(model, &mut random));
        let mut target = placement_of(model, tool, &target_q);
        if turn % 2 == 0 {
            target.translation = target.translation * random.within(1.1, 2.0);
        }
        let mut targets = problem.targets();
        targets.get_mut(pose).unwrap().set_target(target);
        let query = || problem.with_targets(&targets).unwrap();
        let fresh = solver.solve_once(query(), &start).unwrap();
        let again = solver.solve(query(), &start, &mut workspace).unwrap();
        assert_eq!(format!("{again:?}"), format!("{fresh:?}"), "{turn}");
        reported[usize::from(fresh.reached)] += 1;
    }
    assert!(reported[0] > 0, "{reported:?}");
}

fn frame(name: &str) -> FrameId {
    panda().0.model().frame(name).unwrap()
}

#[test]
fn reused_workspace_with_soft_tasks() {
    let (robot, ..) = panda();
    let model = robot.model();
    let rest = configuration_of(model, &mut Random::new(9));
    let pulls = |builder: &mut ProblemBuilder<'_>| {
        builder.add(Posture::new(model, &rest));
        builder.add(LimitCentring::new(model));
    };
    assert_reuse_equals_new(1, problem(PoseBounds::pose(), pulls));
    assert_reuse_equals_new(2, problem(PoseBounds::position(), pulls));
    assert_reuse_equals_new(
        3,
        problem(PoseBounds::position(), |builder| {
            let tool = model.frame(panda().2).unwrap();
            builder.add(Manipulability::new(model, None, tool, 0.1));
        }),
    );
}

#[test]
fn reused_workspace_with_relaxed_levels() {
    let (robot, ..) = panda();
    let model = robot.model();
    let rest = configuration_of(model, &mut Random::new(10));
    let elbow = placement_of(model, ELBOW, &rest).translation;
    let low = |builder: &mut ProblemBuilder<'_>| {
        builder.add(Task::new(Point::new(frame(ELBOW), elbow)).at_level(1));
        builder.add(Posture::new(model, &rest));
    };
    assert_reuse_equals_new(4, problem(PoseBounds::pose(), low));
    assert_reuse_equals_new(
        5,
        problem(PoseBounds::within([0.05, 0.05, 0.05, 0.5, 0.5, 0.5]), low),
    );
    assert_reuse_equals_new(
        6,
        problem(PoseBounds::position(), |builder| {
            let forward = Vector3::new(1.0, 0.2, 0.5);
            let (axis, ahead) = (Vector3::UNITS[0], frame("link6"));
            builder.add(Task::new(Gaze::along(ahead, axis, forward, 0.3)).at_level(1));
            builder.add(Task::new(LookAt::new(ahead, axis, forward)).at_level(2));
            builder.add(Posture::new(model, &rest));
        }),
    );
}

/// A drag that is set to another configuration continues as a new drag from there.
#[test]
fn relocated_drag_equals_a_new_drag() {
    let (robot, _, tool) = panda();
    let model = robot.model();
    let rest = configuration_of(model, &mut Random::new(11));
    let elbow = placement_of(model, ELBOW, &rest).translation;
    let problems = [
        problem(PoseBounds::pose(), |_| ()),
        problem(PoseBounds::position(), |builder| {
            builder.add(Posture::new(model, &rest));
        }),
        problem(PoseBounds::pose(), |builder| {
            builder.add(Task::new(Point::new(frame(ELBOW), elbow)).at_level(1));
        }),
    ];
    for (k, (problem, pose)) in problems.into_iter().enumerate() {
        let mut random = Random::new(20 + k as u64);
        let start = configuration_of(model, &mut random);
        let mut used = Drag::new(problem.clone(), &start).unwrap();
        for turn in cases(12, 4) {
            let [target_q, other] = [(); 2].map(|()| configuration_of(model, &mut random));
            let mut target = placement_of(model, tool, &target_q);
            let share = if turn % 2 == 0 { 1.6 } else { 1.0 };
            target.translation = target.translation * share;
            used.target_mut(pose).unwrap().set_target(target);
            for _ in 0..6 {
                used.advance();
            }
            used.settle(40);
            used.set_configuration(&other).unwrap();
            let mut fresh = Drag::new(problem.clone(), &other).unwrap();
            let new_target = placement_of(model, tool, &configuration_of(model, &mut random));
            for drag in [&mut used, &mut fresh] {
                drag.target_mut(pose).unwrap().set_target(new_target);
            }
            for step in 0..12 {
                let message = [&mut used, &mut fresh].map(|drag| match step {
                    11 => format!("{:?}", drag.settle(60)),
                    _ => format!("{:?}", drag.advance()),
                });
                assert_eq!(message[0], message[1], "{k}, {turn}: frame {step}");
                assert_eq!(used.jump(), fresh.jump());
            }
        }
    }
}

/// The derivative of a solution does not depend on earlier derivatives in its workspace.
#[test]
fn reused_derivative_workspace() {
    let (robot, _, tool) = panda();
    let model = robot.model();
    let mut random = Random::new(31);
    let rest = configuration_of(model, &mut random);
    let problems = [
        problem(PoseBounds::pose(), |_| ()),
        problem(PoseBounds::position(), |builder| {
            builder.add(Posture::new(model, &rest));
        }),
    ];
    let mut reused = DerivativeWorkspace::default();
    for turn in cases(60, 16) {
        let (problem, pose) = &problems[turn / 2 % 2];
        let q = configuration_of(model, &mut random);
        let mut target = placement_of(model, tool, &q);
        if turn % 3 == 0 {
            target.translation = target.translation * 1.5;
        }
        let mut targets = problem.targets();
        targets.get_mut(*pose).unwrap().set_target(target);
        let query = problem.with_targets(&targets).unwrap();
        let solution = Solver::default().solve_once(query, &q).unwrap();
        let mut new = DerivativeWorkspace::default();
        let reported = [&mut reused, &mut new].map(|memory| {
            let mut derivative = SolutionDerivative::new(query, &solution.q, memory).unwrap();
            let by_target = derivative.by_target(0).unwrap();
            (derivative.differentiability().clone(), by_target)
        });
        assert_eq!(reported[0], reported[1], "{turn}");
    }
}

/// A resumed derivative gives the products of the factorised one; resuming with another problem fails.
#[test]
fn resumed_derivative_equals_the_factorised() {
    let (robot, _, tool) = panda();
    let model = robot.model();
    let q = configuration_of(model, &mut Random::new(32));
    let (pose_problem, pose) = problem(PoseBounds::pose(), |_| ());
    let mut targets = pose_problem.targets();
    let target = placement_of(model, tool, &q);
    targets.get_mut(pose).unwrap().set_target(target);
    let query = pose_problem.with_targets(&targets).unwrap();
    let mut memory = DerivativeWorkspace::default();
    assert!(SolutionDerivative::resume(query, &mut memory).is_none());
    let first = SolutionDerivative::new(query, &q, &mut memory);
    let first = first.unwrap().by_target(0).unwrap();
    let mut on = SolutionDerivative::resume(query, &mut memory).unwrap();
    assert_eq!(on.by_target(0).unwrap(), first);
    let mut planar = Problem::builder(model);
    planar.add(Point::new(frame(ELBOW), [0.1, 0.2, 0.3]));
    let other = planar.build().unwrap();
    assert!(SolutionDerivative::resume(&other, &mut memory).is_none());
}
