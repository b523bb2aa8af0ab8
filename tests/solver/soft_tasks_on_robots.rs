//! Promise: soft tasks of a whole robot are stationary within the freedom of required tasks and limits. A Newton step
//! with all second derivatives is zero there.

use kinopt::ik::{DerivativeWorkspace, SolutionDerivative};
use kinopt::kinematics::ForwardKinematics;
use kinopt::task::{FramePose, Posture};
use kinopt::{Problem, Solver, Workspace};
use support::arms::floating_nao;
use support::random::{Random, case_count};

/// Hands and feet at a random configuration, and a posture far from it, so that joints reach limits.
#[test]
fn robot_postures_on_limits_are_stationary() {
    let robot = floating_nao();
    let model = robot.model();
    let ends = ["left_sole", "right_sole", "left_hand", "right_hand"];
    let ends = ends.map(|name| model.frame(name).unwrap());
    let mut kinematics = ForwardKinematics::of_frames(model, &ends).unwrap();
    let mut random = Random::new(21);
    let (solver, mut workspace) = (Solver::default(), Workspace::new());
    let mut limits = 0;
    let cases = case_count(40, 12);
    let neutral = model.neutral();
    for case in 0..cases {
        let mut nearby = |by: f64, share: f64| -> Vec<f64> {
            let values = neutral.iter().zip(model.limits());
            values
                .map(|(value, limits)| limits.clamp(value + random.within(-by, by)) * share)
                .collect()
        };
        let (target_q, posture) = (nearby(0.8, 0.95), nearby(1.2, 0.9));
        let mut tasks = Problem::builder(model);
        for (&end, &at) in ends.iter().zip(kinematics.place(&target_q).unwrap()) {
            tasks.add(FramePose::new(end, at));
        }
        tasks.add(Posture::new(model, &posture));
        let problem = tasks.build().unwrap();
        let solution = solver.solve(&problem, &target_q, &mut workspace).unwrap();
        assert!(solution.reached, "{case}: {}", solution.explain());
        let on_limits = solution.q.iter().zip(model.limits());
        limits += on_limits
            .filter(|(value, limits)| {
                **value == limits.clamp(**value + 1.0) || **value == limits.clamp(**value - 1.0)
            })
            .count();
        let mut memory = DerivativeWorkspace::default();
        let derivative = SolutionDerivative::new(&problem, &solution.q, &mut memory).unwrap();
        let differentiability = derivative.differentiability();
        assert!(differentiability.is_unique(), "{case}: {differentiability}");
    }
    assert!(limits > cases, "{limits} joints on limits in {cases}");
}
