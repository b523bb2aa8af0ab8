//! Promise: fingertips of a robot hand follow those of a captured hand of any size and orientation, within the limits and
//! without jumps. A finger at the thumb closes on it.

use std::fmt::Write as _;

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{Capture, HandMap, HandRetargeting};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::fault_tables::ExpectedError;

const RATE: f64 = 60.0;
const FRAMES: usize = 121;

/// Palm with a thumb and three fingers of three hinges each, along x, that curl towards -z.
fn hand() -> Robot {
    let mut text = String::from(r#"<robot name="hand"><link name="palm"/>"#);
    for (finger, at, tilt) in [
        ("thumb", "0.02 0.05 -0.02", 0.9),
        ("index", "0.09 0.03 0", 0.0),
        ("middle", "0.095 0 0", 0.0),
        ("ring", "0.09 -0.03 0", 0.0),
    ] {
        let mut parent = "palm".to_owned();
        for (k, length) in [0.0, 0.04, 0.03].into_iter().enumerate() {
            let (origin, turn) = match k {
                0 => (at.to_owned(), tilt),
                _ => (format!("{length} 0 0"), 0.0),
            };
            write!(
                text,
                r#"<link name="{finger}_{k}"/><joint name="{finger}_joint_{k}" type="revolute"><parent link="{parent}"/>
                   <child link="{finger}_{k}"/><origin xyz="{origin}" rpy="0 0 -{turn}"/><axis xyz="0 1 0"/>
                   <limit lower="-0.1" upper="1.6" velocity="12" effort="1"/></joint>"#
            )
            .unwrap();
            parent = format!("{finger}_{k}");
        }
        write!(
            text,
            r#"<link name="{finger}_tip"/><joint name="{finger}_end" type="fixed"><parent link="{parent}"/>
               <child link="{finger}_tip"/><origin xyz="0.025 0 0"/></joint>"#
        )
        .unwrap();
    }
    text.push_str("</robot>");
    Robot::parse(&text, "hand.urdf").unwrap()
}

const FINGERS: [&str; 4] = ["thumb", "index", "middle", "ring"];

/// A capture of the robot hand itself while it opens and closes: twice as large, and turned by a fixed rotation.
fn capture(robot: &Robot) -> (Capture, Vec<Vec<Vector3<f64>>>) {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let turned = Matrix3::from_roll_pitch_yaw([0.4, -1.1, 2.0]);
    let subject = |point: Vector3<f64>| turned * point * 2.0 + Vector3::new(0.3, -0.2, 1.1);
    let mut names = vec!["wrist".to_owned()];
    for finger in FINGERS {
        names.extend([format!("{finger}_base"), format!("{finger}_tip")]);
    }
    let (mut numbers, mut tips) = (Vec::new(), Vec::new());
    for frame in 0..FRAMES {
        let closing = 0.5 - 0.5 * (frame as f64 * 0.1).cos();
        let q: Vec<f64> = (0..model.configuration_len())
            .map(|k| closing * (0.5 + 0.1 * (k % 5) as f64))
            .collect();
        let placed = kinematics.place(&q).unwrap();
        let at = |frame: &str| placed[model.frame(frame).unwrap().index()].translation;
        let mut points = vec![subject(Vector3::zero())];
        for finger in FINGERS {
            points.extend([
                subject(at(&format!("{finger}_0"))),
                subject(at(&format!("{finger}_tip"))),
            ]);
        }
        numbers.extend(points.iter().flat_map(|point| point.to_array()));
        tips.push(
            FINGERS
                .iter()
                .map(|finger| at(&format!("{finger}_tip")))
                .collect(),
        );
    }
    (Capture::new(names, &numbers, RATE).unwrap(), tips)
}

#[test]
fn captured_robot_hand_is_reproduced() {
    let robot = hand();
    let model = robot.model();
    let (capture, tips) = capture(&robot);
    let map = HandMap::guess(&capture, model, None).unwrap();
    assert_eq!(map.fingers.len(), 4);
    assert_eq!(HandMap::from_json(&map.to_json()).unwrap(), map);
    let motion = HandRetargeting::new(&robot, &map, &capture)
        .unwrap()
        .per_frame()
        .unwrap();
    for scale in &motion.report.scales {
        assert!((scale - 0.5).abs() < 0.02, "{scale}");
    }
    let frames: Vec<_> = FINGERS
        .iter()
        .map(|finger| model.frame(&format!("{finger}_tip")).unwrap())
        .collect();
    let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
    let mut last: Option<Vec<f64>> = None;
    for (q, tips) in motion.rows().zip(&tips) {
        assert!(model.is_within_limits(q));
        let placed: &[Placement<f64>] = kinematics.place(q).unwrap();
        for (placed, tip) in placed.iter().zip(tips) {
            let error = (placed.translation - *tip).norm();
            assert!(error < 0.006, "{error} m");
        }
        if let Some(last) = last.replace(q.to_vec()) {
            let step = q
                .iter()
                .zip(&last)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(step < 12.0 / RATE + 1e-9, "{step} rad");
        }
    }
}

#[test]
fn mirrored_hand_curls_to_its_own_palm() {
    let robot = hand();
    let (capture, _) = capture(&robot);
    let mirrored: Vec<f64> = (0..capture.frames())
        .flat_map(|frame| {
            capture
                .frame(frame)
                .unwrap()
                .iter()
                .flat_map(|at| [at.x, -at.y, at.z])
        })
        .collect();
    let other = Capture::new(capture.names().to_vec(), &mirrored, RATE).unwrap();
    let map = HandMap::guess(&capture, robot.model(), None).unwrap();
    let [own, other] = [&capture, &other].map(|capture| {
        HandRetargeting::new(&robot, &map, capture)
            .unwrap()
            .per_frame()
            .unwrap()
    });
    for (a, b) in own.q.iter().zip(&other.q) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn touching_fingertips_touch_on_the_robot() {
    let robot = hand();
    let (capture, _) = capture(&robot);
    // The index finger's tip is at the thumb's in the second half.
    let joint = |name: &str| capture.joint(name).unwrap();
    let (thumb, index) = (joint("thumb_tip"), joint("index_tip"));
    let numbers = (0..capture.frames()).flat_map(|frame| {
        let mut points = capture.frame(frame).unwrap().to_vec();
        if frame >= FRAMES / 2 {
            let middle = (points[thumb] + points[index]) * 0.5;
            (points[thumb], points[index]) = (middle, middle);
        }
        points.into_iter().flat_map(|point| point.to_array())
    });
    let numbers: Vec<f64> = numbers.collect();
    let pinching = Capture::new(capture.names().to_vec(), &numbers, RATE).unwrap();
    let map = HandMap::guess(&pinching, robot.model(), None).unwrap();
    let report = HandRetargeting::new(&robot, &map, &pinching)
        .unwrap()
        .per_frame()
        .unwrap()
        .report;
    assert!(report.pinch_distance < 0.03, "{} m", report.pinch_distance);
}

#[test]
fn incomplete_maps_are_rejected() {
    let robot = hand();
    let (capture, _) = capture(&robot);
    let map = HandMap::guess(&capture, robot.model(), None).unwrap();
    let mut without = map.clone();
    without.fingers.retain(|finger, _| finger.name() != "thumb");
    HandRetargeting::new(&robot, &without, &capture)
        .map(|_| ())
        .says("thumb");
    let mut unknown = map;
    unknown.wrist = "elbow".to_owned();
    HandRetargeting::new(&robot, &unknown, &capture)
        .map(|_| ())
        .says("elbow");
}
