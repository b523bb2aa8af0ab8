//! Promise: forward kinematics of every URDF file here equals Pinocchio's to 1e-12.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::ParameterMap;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Quaternion, Vector3};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

const TOLERANCE: f64 = 1e-12;

#[derive(Deserialize)]
struct Reference {
    robots: Vec<ReferenceRobot>,
}

#[derive(Deserialize)]
struct ReferenceRobot {
    file: String,
    /// The moving joints in the order of `q`.
    joints: Vec<String>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    q: Vec<f64>,
    /// x, y, z and quaternion w, x, y, z of every link.
    links: BTreeMap<String, [f64; 7]>,
}

fn reference() -> Vec<ReferenceRobot> {
    let text = include_str!("../../reference/urdf_fk.json");
    serde_json::from_str::<Reference>(text).unwrap().robots
}

fn placed(robot: &Robot, map: &ParameterMap, x: &[f64]) -> Vec<Placement<f64>> {
    let frames: Vec<_> = robot.model().frame_ids().collect();
    let mut kinematics = ForwardKinematics::under(robot.model(), map, &frames).unwrap();
    kinematics.place(x).unwrap().to_vec()
}

fn expected([x, y, z, qw, qx, qy, qz]: [f64; 7]) -> Placement<f64> {
    let quaternion = Quaternion {
        w: qw,
        v: Vector3::new(qx, qy, qz),
    };
    Placement::new(quaternion.to_matrix(), Vector3::new(x, y, z))
}

fn entries(placement: &Placement<f64>) -> [f64; 12] {
    let Placement {
        rotation: r,
        translation: t,
    } = placement;
    let columns = [r.x, r.y, r.z, *t].map(Vector3::to_array);
    std::array::from_fn(|i| columns[i / 3][i % 3])
}

fn assert_links(robot: &Robot, placed: &[Placement<f64>], case: &Case, file: &str) {
    let names: BTreeSet<&str> = (robot.model().frames().iter())
        .map(|frame| frame.name.as_str())
        .collect();
    assert_eq!(names, case.links.keys().map(String::as_str).collect());
    for (frame, placement) in robot.model().frames().iter().zip(placed) {
        let expected = expected(case.links[&frame.name]);
        for (actual, expected) in entries(placement).into_iter().zip(entries(&expected)) {
            let deviation = (actual - expected).abs();
            assert!(
                deviation <= TOLERANCE,
                "{file}, link {}: off by {deviation:e}",
                frame.name
            );
        }
    }
}

#[test]
fn link_placements_equal_pinocchio() {
    let robots = reference();
    assert_eq!(robots.len(), 9);
    for ReferenceRobot {
        file,
        joints,
        cases,
    } in &robots
    {
        let robot = Robot::read(format!("../{file}")).unwrap();
        let model = robot.model();
        let order: Vec<&str> = (model.moving_joints().iter())
            .map(|id| model.joints()[id.index()].name.as_str())
            .collect();
        assert_eq!(order, *joints, "{file}: a configuration is in file order");
        for case in cases {
            let identity = ParameterMap::identity(model);
            assert_links(&robot, &placed(&robot, &identity, &case.q), case, file);
        }
    }
}

#[test]
fn mimic_joints_follow_as_in_pinocchio() {
    let mut followers = 0;
    for ReferenceRobot { file, cases, .. } in &reference() {
        let robot = Robot::read(format!("../{file}")).unwrap();
        followers += robot.mimics().len();
        let map = robot.map();
        assert_eq!(
            map.variables() + robot.mimics().len(),
            robot.model().degrees_of_freedom()
        );
        for case in cases {
            // Mimic values are dropped and recomputed by the map.
            let x: Vec<f64> = map.leaders().iter().map(|&c| case.q[c]).collect();
            assert_links(&robot, &placed(&robot, map, &x), case, file);
            let mut q = vec![f64::NAN; case.q.len()];
            map.expand(&x, &mut q).unwrap();
            for (actual, expected) in q.iter().zip(&case.q) {
                assert!((actual - expected).abs() <= TOLERANCE, "{file}");
            }
        }
    }
    assert_eq!(followers, 4);
}
