//! Promise: clips within position and velocity limits reach the costs found by CasADi and IPOPT
//! (notebooks-ref/motions.py).

use kinopt::model::Model;
use kinopt::motion::trajectory::{MotionProblem, MotionSolver, MotionTermination, RateCost};
use kinopt::robot::Robot;
use kinopt::task::Point;
use serde::Deserialize;

/// Relative difference at which two costs are equal.
const COST_TOLERANCE: f64 = 1e-7;

#[derive(Deserialize)]
struct Reference {
    provenance: Provenance,
    problems: Vec<Clip>,
}

#[derive(Deserialize)]
struct Provenance {
    tool: String,
    script: String,
}

#[derive(Deserialize)]
struct Clip {
    robot: String,
    tips: Vec<String>,
    variables: Vec<String>,
    time_step_s: f64,
    order: usize,
    rate: f64,
    max_speeds: Vec<f64>,
    /// By frame and tip.
    targets: Vec<Vec<[f64; 3]>>,
    weights: Vec<Vec<f64>>,
    first: Option<Vec<f64>>,
    last: Option<Vec<f64>>,
    /// By frame.
    near: Vec<Vec<f64>>,
    cost: f64,
    moves_at_their_limit: usize,
}

impl Clip {
    /// Configuration from variables.
    fn configuration(&self, robot: &Robot, x: &[f64]) -> Vec<f64> {
        let mut q = vec![0.0; robot.model().configuration_len()];
        robot.map().expand(x, &mut q).unwrap();
        q
    }

    fn problem(&self, robot: &Robot) -> MotionProblem {
        let model: &Model = robot.model();
        let mut motion = MotionProblem::builder(model, self.targets.len(), self.time_step_s);
        motion.parameters(robot.map().clone());
        for (tip, name) in self.tips.iter().enumerate() {
            let places: Vec<[f64; 3]> = self.targets.iter().map(|frame| frame[tip]).collect();
            let weights: Vec<f64> = self.weights.iter().map(|frame| frame[tip]).collect();
            let point = motion.add(Point::new(model.frame(name).unwrap(), places[0]));
            motion.follow(point, move |frame, point| point.set_target(places[frame]));
            motion.weights(point, &weights);
        }
        motion.rate_cost(match self.order {
            1 => RateCost::velocity(self.rate),
            2 => RateCost::acceleration(self.rate),
            _ => RateCost::jerk(self.rate),
        });
        for (joint, &speed) in self.variables.iter().zip(&self.max_speeds) {
            motion.max_speed(joint, speed);
        }
        for (fixed, is_first) in [(&self.first, true), (&self.last, false)] {
            if let Some(x) = fixed {
                let q = self.configuration(robot, x);
                match is_first {
                    true => motion.first(&q),
                    false => motion.last(&q),
                };
            }
        }
        motion.build().unwrap()
    }
}

#[test]
fn short_clips_reach_the_costs_of_ipopt() {
    let text = include_str!("../reference/motions.json");
    let reference: Reference = serde_json::from_str(text).unwrap();
    assert_eq!(reference.provenance.tool, "CasADi + IPOPT");
    assert_eq!(reference.provenance.script, "notebooks-ref/motions.py");
    assert_eq!(reference.problems.len(), 20);
    let solver = MotionSolver::default().with_tolerance(1e-9);
    let mut bound = 0;
    for (number, clip) in reference.problems.iter().enumerate() {
        let robot = Robot::read(format!("../{}", clip.robot)).unwrap();
        let motion = clip.problem(&robot);
        let near = clip.near.iter();
        let near: Vec<f64> = near.flat_map(|x| clip.configuration(&robot, x)).collect();
        let solved = solver.solve_near(&motion, &near).unwrap();
        let deviation = solved.report.cost() / clip.cost - 1.0;
        let message = || {
            format!(
                "clip {number}: {} for {}, {deviation:e}",
                solved.report.cost(),
                clip.cost
            )
        };
        assert_eq!(
            solved.report.termination(),
            MotionTermination::Stationary,
            "{}",
            message()
        );
        assert!(deviation.abs() <= COST_TOLERANCE, "{}", message());
        bound += usize::from(clip.moves_at_their_limit > 0);
        check_limits(&robot, clip, &solved.q);
    }
    assert!(bound >= 15, "limits of speed bind in {bound} clips");
}

/// Positions and velocities exceed no limit by a single bit, however a velocity is computed.
fn check_limits(robot: &Robot, clip: &Clip, q: &[f64]) {
    let model = robot.model();
    let n = model.configuration_len();
    for (before, after) in q.chunks(n).zip(q[n..].chunks(n)) {
        assert!(model.is_within_limits(before) && model.is_within_limits(after));
        for (joint, &speed) in clip.variables.iter().zip(&clip.max_speeds) {
            let k = model.coordinate(model.joint(joint).unwrap()).unwrap();
            let moved = (after[k] - before[k]).abs();
            assert!(moved / clip.time_step_s <= speed && moved <= speed * clip.time_step_s);
            assert!(moved * (1.0 / clip.time_step_s) <= speed);
        }
    }
}
