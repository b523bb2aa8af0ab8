//! Promise: a motion of other proportions is transferred to a body exactly within its limits of position and velocity,
//! and feet in contact are motionless. Solved as a whole, it is smoother.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetError, RetargetOptions, RetargetReport, Retargeting,
};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;
use support::retargeted::mean_target_error;

const RATE: f64 = 60.0;
const MAP: &str = r#"{
    "joints": ["hips", "left_foot", "right_foot", "left_hand", "right_hand", "unused"],
    "fps": 60,
    "drives": {
        "hips": "torso", "left_foot": "left_sole", "right_foot": "right_sole",
        "left_hand": {"frame": "left_hand", "weight": 0.5}, "right_hand": {"frame": "right_hand", "weight": 0.5}
    }
}"#;

/// Subject four times as large that shifts its weight, lifts its left foot, moves it forward, and trembles.
fn steps(robot: &Robot, frames: usize) -> Vec<f64> {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral()).unwrap();
    let at = |name: &str| placed[model.frame(name).unwrap().index()].translation;
    let names = [
        "torso",
        "left_sole",
        "right_sole",
        "left_hand",
        "right_hand",
    ];
    let stood = names.map(at);
    let mut numbers = Vec::new();
    for frame in 0..frames {
        let phase = frame as f64 / frames as f64;
        // The foot moves in the middle third.
        let step = ((phase - 1.0 / 3.0) * 3.0).clamp(0.0, 1.0);
        let step = step * step * (3.0 - 2.0 * step);
        for (k, rest) in stood.iter().enumerate() {
            let tremble = 2e-4 * ((frame * (7 + k)) as f64).sin();
            let mut position = *rest + Vector3::new(tremble, -tremble, tremble);
            let sway = 0.01 * (phase * 6.0).sin();
            match k {
                0 => position += Vector3::new(0.02 * phase, sway, -0.02),
                1 => position += Vector3::new(0.12 * step, 0.0, 0.15 * step * (1.0 - step)),
                2 => {}
                _ => {
                    position +=
                        Vector3::new(0.05 * (phase * 9.0).sin(), sway, 0.03 * (phase * 5.0).sin())
                }
            }
            numbers.extend((position * 4.0).to_array());
        }
        numbers.extend([0.0; 3]);
    }
    numbers
}

fn check_limits(robot: &Robot, found: &Trajectory<RetargetReport>) {
    let model = robot.model();
    let speeds = robot.moves_within(1.0);
    let frames: Vec<&[f64]> = found.rows().collect();
    assert!(frames.iter().all(|q| model.is_within_limits(q)));
    for pair in frames.windows(2) {
        for (k, speed) in speeds.iter().enumerate() {
            let moved = (pair[1][k] - pair[0][k]).abs();
            assert!(moved * RATE <= *speed && moved / (1.0 / RATE) <= *speed);
        }
    }
}

/// Root mean square of the third differences of all revolute joints.
fn jerk(found: &Trajectory<RetargetReport>) -> f64 {
    let frames: Vec<&[f64]> = found.rows().collect();
    let mut sum = 0.0;
    for four in frames.windows(4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|frame| four[frame].iter().skip(7));
        for (((a, b), c), d) in a.zip(b).zip(c).zip(d) {
            let third = d - 3.0 * c + 3.0 * b - a;
            sum += third * third;
        }
    }
    sum.sqrt()
}

#[test]
fn large_subject_is_retargeted_to_a_small_humanoid() {
    let robot = floating_nao();
    let map = BodyMap::from_json(MAP, "aldebaran_nao.urdf").unwrap();
    let capture = Capture::new(map.joints.clone(), &steps(&robot, 90), RATE).unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    assert!(
        (retargeting.stride() - 0.25).abs() < 0.05,
        "{}",
        retargeting.stride()
    );
    let live = retargeting.per_frame().unwrap();
    let whole = retargeting.whole().unwrap();
    for (found, most) in [(&live, 1e-3), (&whole, 1e-3)] {
        check_limits(&robot, found);
        let json = serde_json::to_string(found).unwrap();
        assert_eq!(
            serde_json::from_str::<Trajectory<RetargetReport>>(&json).unwrap(),
            *found
        );
        assert_eq!(found.rows().len(), 90);
        assert_eq!(found.report.contact_frames, ["left_sole", "right_sole"]);
        assert!(found.report.slip < most, "{} m", found.report.slip);
        assert!(
            mean_target_error(&retargeting, found) < 0.03,
            "{} m",
            mean_target_error(&retargeting, found)
        );
        // The right foot is in contact all the time, the left one before and after its step.
        let in_contact = |frame: usize| &found.report.contacts[2 * frame..2 * frame + 2];
        assert!((0..90).all(|frame| in_contact(frame)[1]));
        assert_eq!(
            [10, 45, 80].map(|frame| in_contact(frame)[0]),
            [true, false, true]
        );
    }
    assert!(
        2.0 * jerk(&whole) < jerk(&live),
        "{} for {}",
        jerk(&whole),
        jerk(&live)
    );
}

#[test]
fn invalid_maps_and_captures_are_named() {
    let robot = floating_nao();
    let parsed = |text: &str| {
        let map = BodyMap::from_json(text, "nao.urdf")?;
        let capture = Capture::new(vec!["hips".to_owned()], &[0.0; 6], RATE)?;
        Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).map(drop)
    };
    for (text, words) in [
        (r#"{"drives": {"hips": "pelvis"}}"#, &["pelvis"][..]),
        (r#"{"drives": {"spine": "torso"}}"#, &["spine"]),
        (
            r#"{"drives": {"g1.urdf": {"hips": "pelvis"}}}"#,
            &["drives no frame of `aldebaran_nao`"],
        ),
        (r#"{"drives": {}}"#, &["drives no frame"]),
        (
            r#"{"drives": {"hips": {"frame": "torso", "weight": -1}}}"#,
            &["weight", "-1"],
        ),
        (
            r#"{"drives": {"hips": {"frame": "torso", "height": 1}}}"#,
            &["hips", "`height`", "`weight`"],
        ),
        (
            r#"{"drives": {"hips": {"frame": "torso", "weight": "much"}}}"#,
            &["hips", "\"much\"", "f64"],
        ),
        (r#"{"drives": {"hips": 3}}"#, &["hips", "3"]),
        (
            r#"{"drives": {"hips": "torso"}, "contacts": ["feet"]}"#,
            &["feet"],
        ),
        (r#"{"drive": {}}"#, &["drive"]),
        ("{", &["line 1"]),
        ("[]", &["`drives`", "not a list"]),
    ] {
        let message = parsed(text).unwrap_err().to_string();
        assert!(
            words.iter().all(|word| message.contains(word)),
            "{text}: {message}"
        );
    }
    let names = vec!["a".to_owned(), "b".to_owned()];
    let wrong = |numbers: &[f64]| Capture::new(names.clone(), numbers, RATE).unwrap_err();
    assert_eq!(wrong(&[]), RetargetError::NoFrames);
    assert_eq!(
        wrong(&[0.0; 7]),
        RetargetError::NotFrames {
            numbers: 7,
            joints: 2
        }
    );
    let mut numbers = [0.0; 12];
    numbers[10] = f64::NAN;
    assert_eq!(
        wrong(&numbers),
        RetargetError::NotFinite {
            frame: 1,
            joint: "b".to_owned()
        }
    );
    let twice = Capture::new(vec!["a".to_owned(), "a".to_owned()], &[0.0; 6], RATE);
    assert_eq!(
        twice.unwrap_err(),
        RetargetError::NamedTwice {
            joint: "a".to_owned()
        }
    );
}

#[test]
fn single_frame_and_limbs_without_length_work() {
    let robot = floating_nao();
    let map = BodyMap::from_json(MAP, "").unwrap();
    for frames in [1, 2, 3] {
        let capture = Capture::new(map.joints.clone(), &vec![0.5; 18 * frames], RATE).unwrap();
        let retargeting =
            Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
        for found in [
            retargeting.per_frame().unwrap(),
            retargeting.whole().unwrap(),
        ] {
            assert_eq!(found.rows().len(), frames);
            check_limits(&robot, &found);
        }
    }
}

/// Numbers that would make positions or costs infinite are errors, also in a handwritten map.
#[test]
fn map_numbers_out_of_range_are_rejected() {
    for (number, word) in [
        (r#""weight": 1e308"#, "weight"),
        (r#""weight": -1"#, "weight"),
        (r#""scale": 1e308"#, "scale"),
        (r#""scale": 1e-308"#, "scale"),
        (r#""offset": [0, 1e308, 0]"#, "offset"),
    ] {
        let text = format!(r#"{{"drives": {{"hips": {{"frame": "torso", {number}}}}}}}"#);
        let error = BodyMap::from_json(&text, "").unwrap_err();
        assert!(error.is_of_map(), "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
    for rate in ["1e308", "1e-308", "0", "-1"] {
        BodyMap::from_json(&format!(r#"{{"fps": {rate}}}"#), "").says("frames a second");
    }
}
