//! Promise: the rows of an inequality are zero where all its slacks are nonnegative, and only there.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Masses, PointMass};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Bounded, CentreOfMass, FramePose, Gaze, InequalityResidual, Manipulability, Point, PoseBounds,
    SupportPolygon,
};
use support::arms::panda;
use support::random::Random;
use support::trees::configuration_of;

/// Counts of random configurations of an arm with all inequalities satisfied, and with one violated.
fn evaluations_inside_and_outside<R: InequalityResidual>(make: impl Fn(&Robot) -> R) -> [usize; 2] {
    let (robot, ..) = panda();
    let model = robot.model();
    let residual = make(&robot);
    let inputs = residual.inputs();
    let (rooms, rows) = (residual.inequalities(), residual.rows());
    let mut values = vec![0.0; rows.iter().map(|rows| rows.count).sum()];
    let mut depths = vec![0.0; rooms.iter().map(kinopt::task::Inequality::edges).sum()];
    let mut kinematics = ForwardKinematics::new(model);
    let mut random = Random::new(5);
    let mut met = [0; 2];
    for _ in 0..400 {
        let q = configuration_of(model, &mut random);
        let placed = kinematics.place(&q).unwrap();
        let placements: Vec<Placement<f64>> = inputs
            .frame_ids()
            .iter()
            .map(|id| placed[id.index()])
            .collect();
        let turned: Vec<f64> = inputs
            .joint_ids()
            .iter()
            .map(|id| q[model.coordinate(*id).unwrap()])
            .collect();
        residual.evaluate(&placements, &turned, &mut values);
        residual.slacks(&placements, &turned, &mut depths);
        let mut edge = 0;
        for inequality in &rooms {
            let least = depths[edge..edge + inequality.edges()].iter().copied();
            let smallest = least.fold(f64::INFINITY, f64::min);
            edge += inequality.edges();
            let vanishes = values[inequality.rows()].iter().all(|value| *value == 0.0);
            if smallest.abs() > 1e-9 {
                assert_eq!(vanishes, smallest > 0.0, "{values:?} {depths:?} at {q:?}");
                met[usize::from(!vanishes)] += 1;
            }
        }
    }
    met
}

/// Asserts that both occur often enough.
fn assert_reported(met: [usize; 2]) {
    assert!(met.iter().all(|&times| times >= 10), "{met:?}");
}

#[test]
fn interval_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let tip = robot.model().frame("flange").unwrap();
        Bounded::new(Point::new(tip, [0.3, 0.0, 0.5]), 0.3)
    }));
}

#[test]
fn half_open_interval_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let tip = robot.model().frame("flange").unwrap();
        Bounded::at_most(Point::new(tip, [0.3, 0.0, 0.5]), 0.1)
    }));
}

#[test]
fn bounded_goal_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let tip = robot.model().frame("flange").unwrap();
        let target = Placement::translation(Vector3::new(0.3, 0.0, 0.5));
        FramePose::new(tip, target).with_goal(PoseBounds::within([0.3, 0.3, 0.0, 0.8, 0.8, 0.8]))
    }));
}

#[test]
fn gaze_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let tip = robot.model().frame("flange").unwrap();
        Gaze::at(tip, [0.0, 0.0, 0.7], [1.0, 0.5, 0.2], 1.1)
    }));
}

#[test]
fn manipulability_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let tip = robot.model().frame("flange").unwrap();
        Manipulability::new(robot.model(), None, tip, 0.05)
    }));
}

#[test]
fn polygon_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let model = robot.model();
        let masses = ["link4", "flange"].map(|name| PointMass {
            frame: model.frame(name).unwrap(),
            at: Vector3::zero(),
            mass: 1.0,
        });
        let masses = Masses::new(model, masses).unwrap();
        let corners = [
            [-0.1, -0.2, 0.0],
            [0.5, -0.3, 0.2],
            [0.4, 0.3, 0.0],
            [-0.2, 0.2, 0.0],
        ];
        SupportPolygon::new(&masses)
            .with_points(corners.map(Vector3::from))
            .with_margin(0.02)
    }));
}

#[test]
fn bounded_centre_rows_match_their_slacks() {
    assert_reported(evaluations_inside_and_outside(|robot| {
        let model = robot.model();
        let masses = [PointMass {
            frame: model.frame("flange").unwrap(),
            at: Vector3::zero(),
            mass: 2.0,
        }];
        let masses = Masses::new(model, masses).unwrap();
        Bounded::new(CentreOfMass::new(&masses, [0.2, 0.1, 0.4]), 0.3)
    }));
}

/// The slack of a rotation in its bounds uses the quaternion with w ≥ 0, for any rotation.
#[test]
fn slacks_of_large_rotations_use_the_shorter_angle() {
    use kinopt::spatial::rotation_exp;
    use nalgebra as na;
    let mut builder = kinopt::Model::builder("frame");
    let frame = builder.frame("hand", None, Placement::identity());
    builder.build().unwrap();
    let bands = [0.0, 0.0, f64::INFINITY, 0.4, 1.0, 2.9];
    let task = FramePose::new(frame, Placement::identity()).with_goal(PoseBounds::within(bands));
    let mut random = Random::new(5);
    for _ in 0..300 {
        let turn = random.direction().into_inner() * random.within(0.1, 3.1);
        let rotation = rotation_exp(support::vector(turn));
        let placed = [Placement::new(rotation, [0.1, 0.2, 0.3].into())];
        let mut depths = [f64::NAN; 6];
        task.slacks(&placed, &[], &mut depths);
        let half = na::UnitQuaternion::new(turn).quaternion().imag();
        for (k, depths) in depths.chunks(2).enumerate() {
            let band = 2.0 * (0.5 * bands[3 + k]).sin();
            let expected = [band + 2.0 * half[k], band - 2.0 * half[k]];
            for (actual, expected) in depths.iter().zip(expected) {
                assert!((actual - expected).abs() < 1e-12, "{turn:?}: {depths:?}");
            }
        }
    }
}
