//! Promise: near targets of a whole robot are solved by the attempt from the start whenever it reaches them, also from
//! joint limits.
#![allow(clippy::print_stdout)]

use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::Model;
use kinopt::problem::Problem;
use kinopt::robot::BaseJoint;
use kinopt::task::{FramePose, Point};
use kinopt::{Solver, Workspace};
use support::arms::robot;
use support::random::{Random, case_count};

/// Largest joint displacement that a target is taken from, radians.
const JOINT_STEP: f64 = 0.1;

/// Random configuration with every third joint on a limit, and one near it.
fn on_limits(model: &Model, random: &mut Random) -> [Vec<f64>; 2] {
    let mut start = model.random_configuration(random.bits());
    let mut nearby = start.clone();
    for id in model.joint_ids() {
        let joint = &model.joints()[id.index()];
        let turns = joint.kind.moves() && !joint.kind.is_ball() && !joint.kind.slides();
        let Some(at) = model.coordinate(id).filter(|_| turns) else {
            continue;
        };
        let limits = joint.limits;
        let limit = [limits.lower, limits.upper][random.below(2)];
        if random.below(3) == 0 && limit.is_finite() {
            start[at] = limit;
        }
        nearby[at] = limits.clamp(start[at] + random.within(-JOINT_STEP, JOINT_STEP));
    }
    [start, nearby]
}

/// Poses of the feet and points of the hands at a configuration.
fn problem(model: &Model, target_q: &[f64]) -> Problem {
    let mut kinematics = ForwardKinematics::new(model);
    let places = kinematics.place(target_q).unwrap();
    let mut tasks = Problem::builder(model);
    for foot in ["left_sole", "right_sole"] {
        let frame = model.frame(foot).unwrap();
        tasks.add(FramePose::new(frame, places[frame.index()]));
    }
    for hand in ["left_hand", "right_hand"] {
        let frame = model.frame(hand).unwrap();
        tasks.add(Point::new(frame, places[frame.index()].translation));
    }
    tasks.build().unwrap()
}

#[test]
fn near_targets_keep_the_first_attempt() {
    let cases = case_count(400, 100);
    for free in [false, true] {
        let mut robot = robot("aldebaran_nao");
        if free {
            robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
        }
        let model = robot.model();
        let mut random = Random::new(71);
        let [mut all, mut alone] = [Workspace::new(), Workspace::new()];
        let first = Solver::default().with_restarts(Restarts::none());
        let (mut reached, mut differ) = (0, 0);
        for _ in 0..cases {
            let [start, nearby] = on_limits(model, &mut random);
            let problem = problem(model, &nearby);
            let first = first.solve(&problem, &start, &mut alone).unwrap();
            let found = Solver::default().solve(&problem, &start, &mut all).unwrap();
            reached += usize::from(first.reached);
            differ += usize::from(first.reached && found.q != first.q);
        }
        println!("free base {free}: the first attempt reaches {reached} of {cases}");
        assert!(reached * 10 > cases * 9, "{reached}");
        assert_eq!(differ, 0, "of {reached}");
    }
}
