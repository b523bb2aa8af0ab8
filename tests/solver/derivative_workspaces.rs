//! Promise: a derivative does not depend on earlier derivatives of its workspace, and a resumed derivative equals the
//! factorised one.

use kinopt::Solver;
use kinopt::ik::{DerivativeWorkspace, SolutionDerivative};
use kinopt::problem::{Problem, ProblemBuilder, TaskId};
use kinopt::spatial::Placement;
use kinopt::task::{FramePose, Point, PoseBounds, Posture};
use support::arms::panda;
use support::random::{Random, cases};
use support::trees::configuration_of;

use crate::soft_task_fixtures::placement_of;

/// Pose of the tool, and the tasks that `more` adds.
fn problem(
    goal: PoseBounds,
    more: impl Fn(&mut ProblemBuilder<'_>),
) -> (Problem, TaskId<FramePose>) {
    let (robot, _, tool) = panda();
    let mut builder = Problem::builder(robot.model());
    builder.parameters(robot.map().clone());
    let tool = robot.model().frame(tool).unwrap();
    let pose = builder.add(FramePose::new(tool, Placement::identity()).with_goal(goal));
    more(&mut builder);
    (builder.build().unwrap(), pose)
}

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
    planar.add(Point::new(model.frame("link4").unwrap(), [0.1, 0.2, 0.3]));
    let other = planar.build().unwrap();
    assert!(SolutionDerivative::resume(&other, &mut memory).is_none());
}
