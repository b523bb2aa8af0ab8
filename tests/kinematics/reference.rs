//! Promise: kinematics equal those of independent programs.
//!
//! - Jacobians of robots equal Pinocchio's to 1e-10, and those of rigs equal CasADi's automatic differentiation, by
//!   both exact derivative routes.
//! - Placements of rigs equal the recursion of their source, evaluated by CasADi, to 1e-12.
//! - Gradient and second derivative of a cost of five tips equal CasADi's.
//!
//! `tests/robot/urdf/kinematics.rs` compares placements of robots. The references were written by
//! `notebooks-ref/1-kinematics.ipynb`.

use std::collections::BTreeMap;
use std::path::Path;

use kinopt::Model;
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation, Problem};
use kinopt::robot::Robot;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, Quantity, Task};
use nalgebra::DMatrix;
use serde::Deserialize;

const PLACEMENT_TOLERANCE: f64 = 1e-12;
const JACOBIAN_TOLERANCE: f64 = 1e-10;

/// Six rows, linear then angular, with one number for each variable.
type RowBlock = Vec<Vec<f64>>;

#[derive(Deserialize)]
struct Robots {
    robots: Vec<ReferenceRobot>,
}

#[derive(Deserialize)]
struct ReferenceRobot {
    file: String,
    variables: Vec<String>,
    cases: Vec<RobotCase>,
}

#[derive(Deserialize)]
struct RobotCase {
    /// All moving joints, including mimic joints.
    q: Vec<f64>,
    jacobians: BTreeMap<String, RowBlock>,
}

#[derive(Deserialize)]
struct Rigs {
    rigs: Vec<ReferenceRig>,
}

#[derive(Deserialize)]
struct ReferenceRig {
    file: String,
    variables: Vec<String>,
    cases: Vec<RigCase>,
}

#[derive(Deserialize)]
struct RigCase {
    x: Vec<f64>,
    /// x, y, z, then the rotation by rows.
    frames: BTreeMap<String, [f64; 12]>,
    jacobians: BTreeMap<String, RowBlock>,
    /// One for each of [`tips`].
    targets: Vec<[f64; 3]>,
    cost: f64,
    gradient: Vec<f64>,
    hessian: Vec<Vec<f64>>,
}

/// Tips in the cost, in the order of their targets.
fn tips(file: &str) -> &'static [&'static str] {
    match file {
        "models/humanoid/humanoid.json" => &[
            "head/tip",
            "left_hand/tip",
            "right_hand/tip",
            "left_foot/tip",
            "right_foot/tip",
        ],
        _ => &["gripper/tip"],
    }
}

fn path(file: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

fn rigs() -> Vec<(ReferenceRig, Model, ParameterMap)> {
    let text = include_str!("../reference/rig_kinematics.json");
    let rigs = serde_json::from_str::<Rigs>(text).unwrap().rigs;
    assert_eq!(rigs.len(), 2);
    let load = |rig: ReferenceRig| {
        let read = Rig::read(path(&rig.file)).unwrap();
        let model = read.skeleton.model().clone();
        let map = ParameterMap::free(&model);
        assert_eq!(variable_names(&model, &map), rig.variables);
        (rig, model, map)
    };
    rigs.into_iter().map(load).collect()
}

fn variable_names(model: &Model, map: &ParameterMap) -> Vec<String> {
    let joint = |&c: &usize| &model.joints()[model.moving_joints()[c].index()];
    map.leaders()
        .iter()
        .map(|c| joint(c).name.clone())
        .collect()
}

/// Derivative of the twist of `frame` by the variables. A pose task whose target is the frame's own placement gives it:
/// there the derivative of its rotation vector is the identity.
fn twists(
    model: &Model,
    map: &ParameterMap,
    frame: FrameId,
    x: &[f64],
    route: Derivatives,
) -> DMatrix<f64> {
    let mut kinematics = ForwardKinematics::under(model, map, &[frame]).unwrap();
    let frame_pose = kinematics.place(x).unwrap()[0];
    let mut builder = Problem::builder(model);
    builder.parameters(map.clone());
    let task = Task::new(FramePose::new(frame, frame_pose));
    builder.add(
        task.weight(Quantity::Metres, 1.0)
            .weight(Quantity::Radians, 1.0),
    );
    builder.derivatives(route);
    let problem = builder.build().unwrap();
    let mut scratch = problem.scratch();
    let mut jacobian = DMatrix::zeros(6, x.len());
    Evaluation::new(&problem, &mut scratch).jacobian(x, &mut jacobian);
    jacobian
}

fn assert_jacobian(ours: &DMatrix<f64>, theirs: &RowBlock, what: &str) {
    assert_eq!(theirs.len(), 6, "{what}");
    for (row, theirs) in theirs.iter().enumerate() {
        assert_eq!(theirs.len(), ours.ncols(), "{what}");
        for (column, expected) in theirs.iter().enumerate() {
            let deviation = (ours[(row, column)] - expected).abs();
            assert!(
                deviation <= JACOBIAN_TOLERANCE,
                "{what}, row {row}, column {column}: off by {deviation:e}"
            );
        }
    }
}

#[test]
fn jacobians_of_robots_equal_pinocchio() {
    let text = include_str!("../reference/urdf_jacobians.json");
    let robots = serde_json::from_str::<Robots>(text).unwrap().robots;
    assert_eq!(robots.len(), 9);
    for ReferenceRobot {
        file,
        variables,
        cases,
    } in &robots
    {
        let robot = Robot::read(path(file)).unwrap();
        let (model, map) = (robot.model(), robot.map());
        assert_eq!(&variable_names(model, map), variables, "{file}");
        for case in cases {
            let mut x = vec![0.0; map.variables()];
            map.reduce(&case.q, &mut x).unwrap();
            assert!(!case.jacobians.is_empty());
            for (link, theirs) in &case.jacobians {
                let frame = model.frame(link).unwrap();
                for route in [Derivatives::Analytic, Derivatives::Dual] {
                    let ours = twists(model, map, frame, &x, route);
                    assert_jacobian(&ours, theirs, &format!("{file}, {link}, {route:?}"));
                }
            }
        }
    }
}

fn placement(numbers: &[f64; 12]) -> Placement<f64> {
    let row = |k: usize| Vector3::new(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
    let rows = kinopt::spatial::Matrix3::from_columns(row(1), row(2), row(3));
    Placement::new(rows.transpose(), row(0))
}

#[test]
fn placements_of_rigs_equal_the_recursion() {
    for (rig, model, map) in rigs() {
        for case in &rig.cases {
            assert_eq!(case.frames.len(), model.frames().len());
            for (name, numbers) in &case.frames {
                let frame = model.frame(name).unwrap();
                let mut kinematics = ForwardKinematics::under(&model, &map, &[frame]).unwrap();
                let ours = kinematics.place(&case.x).unwrap()[0];
                let theirs = placement(numbers);
                let columns = |p: &Placement<f64>| {
                    [p.rotation.x, p.rotation.y, p.rotation.z, p.translation].map(Vector3::to_array)
                };
                let pairs = columns(&ours).into_iter().zip(columns(&theirs));
                for (ours, theirs) in pairs.flat_map(|(a, b)| a.into_iter().zip(b)) {
                    let deviation = (ours - theirs).abs();
                    assert!(
                        deviation <= PLACEMENT_TOLERANCE,
                        "{}, {name}: off by {deviation:e}",
                        rig.file
                    );
                }
            }
        }
    }
}

#[test]
fn jacobians_of_rigs_equal_automatic_differentiation() {
    for (rig, model, map) in rigs() {
        for case in &rig.cases {
            assert_eq!(case.jacobians.len(), tips(&rig.file).len());
            for (name, theirs) in &case.jacobians {
                let frame = model.frame(name).unwrap();
                for route in [Derivatives::Analytic, Derivatives::Dual] {
                    let ours = twists(&model, &map, frame, &case.x, route);
                    assert_jacobian(&ours, theirs, &format!("{}, {name}, {route:?}", rig.file));
                }
            }
        }
    }
}

/// Cost ½ Σ ‖tip − target‖² over a rig's tips, with its gradient by the reverse sweep.
struct Reaching {
    problem: Problem,
}

impl Reaching {
    fn new(model: &Model, map: &ParameterMap, file: &str, targets: &[[f64; 3]]) -> Self {
        let mut builder = Problem::builder(model);
        builder.parameters(map.clone());
        assert_eq!(tips(file).len(), targets.len());
        for (tip, target) in tips(file).iter().zip(targets) {
            builder.add(Point::new(model.frame(tip).unwrap(), *target));
        }
        let problem = builder.build().unwrap();
        Self { problem }
    }

    fn cost_and_gradient(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let mut scratch = self.problem.scratch();
        let mut evaluation = Evaluation::new(&self.problem, &mut scratch);
        let mut r = vec![0.0; self.problem.rows()];
        let mut gradient = vec![0.0; x.len()];
        let mut unused = DMatrix::zeros(r.len(), x.len());
        evaluation.residual(x, &mut r);
        evaluation.gradient(x, &r, &mut gradient, &mut unused);
        (0.5 * r.iter().map(|v| v * v).sum::<f64>(), gradient)
    }

    /// One column of the second derivative, by central differences of the exact gradient. Two steps are combined so
    /// that the error is of fourth order (Richardson extrapolation).
    fn hessian_column(&self, x: &[f64], column: usize) -> Vec<f64> {
        let central = |step: f64| -> Vec<f64> {
            let at = |shift: f64| {
                let mut moved = x.to_vec();
                moved[column] += shift;
                self.cost_and_gradient(&moved).1
            };
            let pairs = at(step).into_iter().zip(at(-step));
            pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let pairs = central(5e-4).into_iter().zip(central(1e-3));
        pairs
            .map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0)
            .collect()
    }
}

#[test]
fn cost_derivatives_of_rigs_equal_casadi() {
    for (rig, model, map) in rigs() {
        for case in &rig.cases {
            let reaching = Reaching::new(&model, &map, &rig.file, &case.targets);
            let (cost, gradient) = reaching.cost_and_gradient(&case.x);
            assert!(
                (cost - case.cost).abs() <= PLACEMENT_TOLERANCE,
                "{}",
                rig.file
            );
            assert_eq!(gradient.len(), case.gradient.len());
            for (ours, theirs) in gradient.iter().zip(&case.gradient) {
                assert!((ours - theirs).abs() <= PLACEMENT_TOLERANCE, "{}", rig.file);
            }
            assert_eq!(case.hessian.len(), case.x.len());
            for (column, theirs) in case.hessian.iter().enumerate() {
                let ours = reaching.hessian_column(&case.x, column);
                for (ours, theirs) in ours.iter().zip(theirs) {
                    let deviation = (ours - theirs).abs();
                    assert!(
                        deviation <= JACOBIAN_TOLERANCE,
                        "{}, column {column}: off by {deviation:e}",
                        rig.file
                    );
                }
            }
        }
    }
}
