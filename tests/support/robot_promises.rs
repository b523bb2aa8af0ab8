//! Promises that hold for every robot that a reader accepts, however unusual its file is.

use std::f64::consts::PI;

use kinopt::ik::{LoopClosure, Restarts};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointKind, Limits, Model};
use kinopt::problem::Problem;
use kinopt::robot::{BaseJoint, Robot};
use kinopt::solver::Stopping;
use kinopt::task::{CentreOfMass, Point};
use kinopt::{Solution, Solver};

use crate::configuration_rules::{Cone, Rule, broken, cross};

/// Rules of a model's joints in configuration order.
fn rules(model: &Model) -> Vec<Rule> {
    let mut joints = model.moving_joints().to_vec();
    joints.dedup();
    let rule = |joint: &kinopt::model::Joint| match (joint.kind, joint.ball) {
        (JointKind::Ball, None) => Rule::Ball(None),
        (JointKind::Ball, Some(limits)) => {
            let axis = joint.axis.to_array();
            let about = limits
                .about
                .map_or_else(|| across(axis), |about| about.to_array());
            Rule::Ball(Some(Cone {
                axis,
                about,
                swing: limits.swing,
                twist: limits.twist,
                angle: limits.angle.unwrap_or(PI),
            }))
        }
        _ => Rule::Number(joint.limits),
    };
    joints
        .iter()
        .map(|id| rule(&model.joints()[id.index()]))
        .collect()
}

/// Unit vector perpendicular to an axis.
fn across(axis: [f64; 3]) -> [f64; 3] {
    let smallest = (0..3)
        .min_by(|a, b| axis[*a].abs().total_cmp(&axis[*b].abs()))
        .unwrap();
    let mut other = [0.0; 3];
    other[smallest] = 1.0;
    let side = cross(axis, other);
    let length = side.iter().map(|c| c * c).sum::<f64>().sqrt();
    side.map(|c| c / length)
}

/// Checks all promises at random configurations of the seed.
pub fn check(robot: &Robot, seed: u64) {
    let model = robot.model();
    for joint in model.joints() {
        let [x, y, z] = joint.axis.to_array();
        assert!(
            ((x * x + y * y + z * z).sqrt() - 1.0).abs() < 1e-12,
            "{}",
            joint.name
        );
        assert!(joint.limits.is_valid(), "{}", joint.name);
    }
    let rules = rules(model);
    let mut kinematics = ForwardKinematics::new(model);
    for q in [model.random_configuration(seed), model.neutral()] {
        let placed = kinematics.place(&q).unwrap();
        for (frame, placed) in model.frames().iter().zip(placed) {
            let columns = [placed.rotation.x, placed.rotation.y, placed.rotation.z];
            let unit = columns.iter().all(|c| (c.norm() - 1.0).abs() < 1e-9);
            assert!(unit, "{}", frame.name);
        }
    }
    let q = model.random_configuration(seed);
    assert_eq!(broken(&rules, &[], &q), None);
    assert!(model.is_within_limits(&q));
    let small = q.iter().all(|value| value.abs() < 1e3);
    if small {
        let (mut v, mut moved_q, mut velocity_back) = (
            vec![0.1; model.degrees_of_freedom()],
            q.clone(),
            vec![0.0; model.degrees_of_freedom()],
        );
        v.iter_mut()
            .step_by(2)
            .for_each(|velocity| *velocity = -0.2);
        model.integrate(&q, &v, &mut moved_q).unwrap();
        model.difference(&q, &moved_q, &mut velocity_back).unwrap();
        let off = v
            .iter()
            .zip(&velocity_back)
            .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-9, "integrate and difference: {off:e}");
    }
    match robot.masses() {
        Ok(masses) => assert!(masses.total() > 0.0),
        Err(error) => assert!(error.to_string().contains('`'), "{error}"),
    }
    for base in [BaseJoint::FREE, BaseJoint::PLANAR] {
        match robot.clone().with_base_joint(base) {
            Ok(based) => assert!(based.model().configuration_len() >= model.configuration_len()),
            Err(error) => assert!(error.to_string().contains('`'), "{error}"),
        }
    }
    check_solutions(robot, &rules, &q);
}

/// Solutions are within limits, and report whether loops are closed, reached or not.
fn check_solutions(robot: &Robot, rules: &[Rule], target_q: &[f64]) {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let mut problem = Problem::builder(model);
    problem.parameters(robot.map().clone());
    if let Some(frame) = model.frame_ids().last() {
        let target = kinematics.place(target_q).unwrap()[frame.index()].translation;
        problem.add(Point::new(frame, target));
    }
    if let Ok(masses) = robot.masses() {
        problem.add(CentreOfMass::new(&masses, [0.1, 0.2, 0.3]));
    }
    let stopping = Stopping::default().with_max_iterations(15);
    let solver = Solver::default().with_stopping(stopping);
    let solver = solver.with_restarts(Restarts::default().with_attempts(2));
    let problem = match problem.build() {
        Ok(problem) => problem,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let start = model.neutral();
    let solution = solver.solve_once(&problem, &start).unwrap();
    assert_eq!(
        broken(rules, &[], &solution.q),
        None,
        "{}",
        solution.explain()
    );
    for ((q, limits), joint) in solution
        .q
        .iter()
        .zip(model.limits())
        .zip(model.moving_joints())
    {
        let name = &model.joints()[joint.index()].name;
        assert!(
            limits == Limits::UNBOUNDED || limits.contains(*q),
            "{name}: {q}"
        );
    }
    assert!(!solution.reached || solution.loops_closed());
    check_loops(robot, &solution);
}

fn check_loops(robot: &Robot, solution: &Solution) {
    let model = robot.model();
    let mut moving = model.moving_joints().to_vec();
    moving.dedup();
    // Joints that are not mimic joints and move a loop.
    let free = |id: &kinopt::model::JointId| {
        model.moves_a_loop(*id) && !robot.mimics().iter().any(|mimic| mimic.joint == *id)
    };
    moving.retain(free);
    if moving.is_empty() {
        return;
    }
    let Ok(closure) = LoopClosure::new(robot.parameters(), &moving) else {
        return;
    };
    let open = closure.gaps(&solution.q).unwrap();
    let open = open.iter().filter(|gap| !gap.is_closed()).count();
    assert_eq!(open == 0, solution.loops_closed(), "{}", solution.explain());
}
