//! Promise: for unreachable targets loops stay closed. The result is as close as the minimum of CasADi and IPOPT with
//! loops as equality constraints.
//!
//! `notebooks-ref/loops.py` writes the file. Two arms of seven joints have about a dozen minima from random starts;
//! from near the smallest one the solver ends there. Of the other mechanisms it finds the smallest from its own start.

use kinopt::ik::Restarts;
use kinopt::model::{Loop, Model, ParameterMap};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, Point, Quantity, Task};
use kinopt::{Problem, Solution, Solver};
use serde::Deserialize;

use crate::loops::mechanisms::{FourBar, Gripper, Stewart};

#[derive(Deserialize)]
struct Reference {
    provenance: Provenance,
    problems: Vec<Statement>,
}

#[derive(Deserialize)]
struct Provenance {
    tool: String,
    script: String,
}

#[derive(Deserialize)]
struct Statement {
    mechanism: String,
    target: Vec<f64>,
    /// Sorted, the smallest first.
    minima: Vec<Minimum>,
    /// A configuration near the smallest minimum.
    near: Vec<f64>,
}

#[derive(Deserialize)]
struct Minimum {
    cost: f64,
}

/// Largest relative difference of equal costs.
const COST_TOLERANCE: f64 = 1e-6;

fn vector(numbers: &[f64]) -> Vector3<f64> {
    Vector3::new(numbers[0], numbers[1], numbers[2])
}

/// The model, its parameter map and its start.
fn mechanism(statement: &Statement) -> (Model, Option<ParameterMap>, Vec<f64>) {
    let file = |path| format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    match statement.mechanism.as_str() {
        "four-bar" => (FourBar::CRANK_ROCKER.model(), None, vec![0.5, 0.5, 1.5]),
        "gripper" => {
            let model = Gripper::model();
            let start = crate::loops::grippers::begin(&model);
            (model, None, start)
        }
        "stewart" => {
            let stewart = Stewart::new();
            let start = crate::loops::stewart_platforms::begin(&stewart);
            (stewart.model, None, start)
        }
        "knee" => {
            let robot = Robot::read_mjcf(file("solver/loops/files/knee.xml")).unwrap();
            let model = robot.model().clone();
            let mut start = vec![0.0; model.configuration_len()];
            for (segment, value) in model.neutral().iter().enumerate().skip(3) {
                start[segment] = *value;
            }
            let joints = [
                "hip",
                "knee_motor",
                "knee_rod",
                "knee",
                "ankle_motor",
                "ankle_rod",
                "ankle",
            ];
            let map =
                ParameterMap::builder(&model).with_only(&robot.joints(&joints).unwrap(), &start);
            let map = map.build().unwrap();
            (model, Some(map), start)
        }
        "hands" => {
            let model = crate::loops::two_hands::robot().model().clone();
            let start = statement.near.clone();
            (model, None, start)
        }
        other => panic!("{other}"),
    }
}

fn solve(statement: &Statement) -> Solution {
    let (model, map, start) = mechanism(statement);
    let mut problem = Problem::builder(&model);
    if let Some(map) = map {
        problem.parameters(map);
    }
    let frame = |name| model.frame(name).unwrap();
    let target = &statement.target;
    match statement.mechanism.as_str() {
        "four-bar" => {
            problem.add(Point::new(frame("pen"), [target[0], target[1], 0.0]));
        }
        "gripper" => {
            // The left side is mirrored.
            problem.add(Point::new(frame("left tip"), [-target[0], target[1], 0.0]));
            problem.add(Point::new(frame("right tip"), [target[2], target[3], 0.0]));
        }
        "stewart" => {
            let turn = rotation_exp(vector(&target[3..]));
            let pose = FramePose::new(frame("platform"), Placement::new(turn, vector(target)));
            problem.add(Task::new(pose).weight(Quantity::Radians, 0.4));
        }
        "knee" => {
            let across = 0.1;
            problem.add(Point::new(frame("toe"), [target[0], across, target[1]]));
            problem.add(Point::new(frame("heel"), [target[2], across, target[3]]));
        }
        _ => {
            let columns = [3, 6, 9].map(|at| vector(&target[at..]));
            let turn = Matrix3::from_columns(columns[0], columns[1], columns[2]);
            let pose = FramePose::new(frame("left_tool"), Placement::new(turn, vector(target)));
            let pose = pose.with_tool(crate::loops::two_hands::grips()[0]);
            problem.add(Task::new(pose).weight(Quantity::Radians, 0.3));
        }
    }
    let problem = problem.build().unwrap();
    let restarts = match statement.mechanism.as_str() {
        "hands" => Restarts::none(),
        _ => Restarts::default(),
    };
    let solver = Solver::default().with_restarts(restarts);
    solver.solve_once(&problem, &start).unwrap()
}

#[test]
fn misses_with_closed_loops_are_minimal() {
    let text = include_str!("../../reference/loops.json");
    let reference: Reference = serde_json::from_str(text).unwrap();
    assert_eq!(reference.provenance.tool, "CasADi + IPOPT");
    assert_eq!(reference.provenance.script, "notebooks-ref/loops.py");
    let (mut best, mut others) = (0, Vec::new());
    for (number, statement) in reference.problems.iter().enumerate() {
        let solution = solve(statement);
        let explanation = || format!("{number} ({}): {}", statement.mechanism, solution.explain());
        assert!(
            !solution.reached && solution.loops_closed(),
            "{}",
            explanation()
        );
        for task in solution.tasks().filter(|task| task.is_loop) {
            assert!(task.position_error().unwrap() <= Loop::TOLERANCE);
        }
        let same = |minimum: &&Minimum| {
            (solution.cost - minimum.cost).abs() <= COST_TOLERANCE * minimum.cost
        };
        let found = statement.minima.iter().position(|minimum| same(&minimum));
        match found {
            Some(0) => best += 1,
            Some(_) => others.push(number),
            None => panic!("{} is none of them: {}", solution.cost, explanation()),
        }
    }
    assert_eq!(reference.problems.len(), 50);
    assert!(best >= 48, "{best} of 50 are the least; not {others:?}");
}
