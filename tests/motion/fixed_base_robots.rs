//! Promise: a robot without a free base follows as well, and joints not determined by the targets approach the nominal
//! posture.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};
use kinopt::robot::Robot;

/// At the final position of the hand no motion within the null space brings the joints nearer to zero.
#[test]
fn arm_on_a_table_rests_near_its_nominal_posture() {
    let joint = |name: &str, parent: &str, child: &str, out: f64| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/>\
             <child link=\"{child}\"/><origin xyz=\"{out} 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"50\"/></joint>"
        )
    };
    let text = format!(
        "<robot name=\"arm\"><link name=\"base\"/>{}{}{}{}<link name=\"hand\"/><joint name=\"end\" type=\"fixed\">\
         <parent link=\"fourth\"/><child link=\"hand\"/><origin xyz=\"0.3 0 0\"/></joint></robot>",
        joint("1", "base", "first", 0.0),
        joint("2", "first", "second", 0.3),
        joint("3", "second", "third", 0.3),
        joint("4", "third", "fourth", 0.3),
    );
    let robot = Robot::parse(&text, "arm.urdf").unwrap();
    let map = r#"{"joints": ["base", "hand"], "drives": {"base": "base", "hand": "hand"}}"#;
    let map = BodyMap::from_json(map, "").unwrap();
    // Sideways and back to its position of rest.
    let places = (0..300).flat_map(|frame| {
        let share = 0.05 * f64::from(frame.min(40));
        let (sin, cos) = (std::f64::consts::PI * share).sin_cos();
        [0.0, 0.0, 0.0, 0.8 - 0.1 * (1.0 - cos), 0.4 * sin, 0.0]
    });
    let places: Vec<f64> = places.collect();
    let capture = Capture::new(map.joints.clone(), &places, 30.0).unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = retargeting.per_frame().unwrap();
    let q = nalgebra::DVector::from_column_slice(&found.q[4 * 299..]);
    // Derivative of the hand's position by each joint: perpendicular to the line from the joint to the hand.
    let angles = (0..4).map(|link| q.rows(0, link + 1).sum());
    let links: Vec<f64> = angles.collect();
    let slopes = nalgebra::DMatrix::from_fn(2, 4, |axis, joint| {
        let beyond = links[joint..].iter();
        let derivatives = beyond.map(|angle| if axis == 0 { -angle.sin() } else { angle.cos() });
        0.3 * derivatives.sum::<f64>()
    });
    let reported = slopes.transpose() * slopes.clone().pseudo_inverse(1e-9).unwrap().transpose();
    let free = &q - reported * &q;
    assert!(
        free.norm() < 0.01 * q.norm(),
        "{} of {}",
        free.norm(),
        q.norm()
    );
}
