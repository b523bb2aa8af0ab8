//! Promise: an online retargeter solves frame by frame within position and velocity limits.
//!
//! It locks contacts once they are detected, keeps its configuration while positions are missing, and rejects other
//! joints. It reports active limits and errors correctly.

use kinopt::collision::{Checker, CollisionModel};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model};
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};
use kinopt::motion::trajectory::MotionBound;
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::{Placement, Vector3};
use support::fault_tables::ExpectedError;

const MAP: &str = r#"{"joints": ["hips", "left", "right"], "contacts": ["left", "right"],
    "drives": {"hips": "torso", "left": "left_sole", "right": "right_sole"}}"#;

fn nao() -> Robot {
    // The file has no velocity limits.
    let text = std::fs::read_to_string("../models/aldebaran_nao.urdf").unwrap();
    let text = text.replace("velocity=\"0\"", "velocity=\"3\"");
    let nao = Robot::reader().parse(&text, "nao.urdf").unwrap();
    nao.with_base_joint(BaseJoint::FREE).unwrap()
}

/// Hips that sway over two feet, and jump sideways at a frame.
fn sway(frames: usize, jump_frame: usize) -> Capture {
    let places = (0..frames).flat_map(|frame| {
        let leapt = if frame < jump_frame { 0.0 } else { 0.3 };
        let aside = leapt + 0.05 * (frame as f64 * 0.2).sin();
        [0.0, aside, 0.9, 0.0, 0.15, 0.0, 0.0, -0.15, 0.0]
    });
    let names = BodyMap::from_json(MAP, "").unwrap().joints;
    Capture::new(names, &places.collect::<Vec<_>>(), 30.0).unwrap()
}

#[test]
fn online_retargeter_locks_contacts_of_the_subject() {
    let (robot, capture) = (nao(), sway(60, 60));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let mut live = retargeting.live().unwrap();
    let known = retargeting.per_frame().unwrap();
    let model = robot.model();
    let soles = ["left_sole", "right_sole"].map(|sole| model.frame(sole).unwrap());
    let torso = model.frame("torso").unwrap();
    let mut kinematics = ForwardKinematics::new(model);
    let mut anchor: Option<[Vector3<f64>; 2]> = None;
    let max_moves = robot.moves_within(1.0 / 30.0);
    let mut before: Option<Vec<f64>> = None;
    for frame in 0..capture.frames() {
        let q = live.step(capture.frame(frame).unwrap()).unwrap().to_vec();
        assert!(model.is_within_limits(&q));
        for (k, (now, then)) in q.iter().zip(before.iter().flatten()).enumerate() {
            assert!(
                (now - then).abs() <= max_moves[k],
                "number {k} of frame {frame}"
            );
        }
        let placed = kinematics.place(&q).unwrap();
        let at = soles.map(|sole| placed[sole.index()].translation);
        let actual = placed[torso.index()].translation;
        if frame >= 10 {
            let anchor = anchor.get_or_insert(at);
            assert!(
                (0..2).all(|k| (at[k] - anchor[k]).norm() < 1e-3),
                "frame {frame}"
            );
            let q = &known.q[frame * known.nq..][..known.nq];
            let expected = kinematics.place(q).unwrap()[torso.index()].translation;
            assert!((actual - expected).norm() < 0.02, "frame {frame}");
        }
        before = Some(q);
    }
    let lost = [Vector3::new(f64::NAN, 0.0, 0.0); 3];
    assert_eq!(live.step(&lost).unwrap(), before.unwrap());
    assert!(live.step(&lost[..2]).is_err());
}

/// A frame with missing positions changes nothing, even where a contact begins or ends. The next frame is solved as
/// without it.
#[test]
fn frame_with_missing_positions_changes_nothing() {
    let (robot, capture) = (nao(), sway(16, 16));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let options = RetargetOptions::default();
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let checker = Checker::new(CollisionModel::new(robot.model(), Vec::new()).unwrap());
    for retargeting in [retargeting.clone(), retargeting.keep_clear(&checker)] {
        let mut follower = retargeting.follower().unwrap();
        for frame in 0..capture.frames() {
            let places = retargeting.targets(frame).unwrap();
            let in_contact = [4..10, 8..13].map(|span| f64::from(u8::from(span.contains(&frame))));
            let in_contact = [0.0, in_contact[0], in_contact[1]];
            let mut interrupted = follower.clone();
            for k in 0..3 {
                let mut lost = places.to_vec();
                lost[k].y = f64::NAN;
                let held_q = interrupted.advance(&lost, &in_contact).unwrap();
                assert_eq!(held_q, follower.q(), "frame {frame}");
            }
            let held_q = interrupted.advance(places, &[0.0, f64::NAN, 0.0]);
            assert_eq!(held_q.unwrap(), follower.q(), "frame {frame}");
            let uninterrupted = follower.advance(places, &in_contact).unwrap();
            let after = interrupted.advance(places, &in_contact).unwrap();
            assert_eq!(uninterrupted, after, "frame {frame}");
        }
    }
}

/// The firmness of a contact is clamped to the range from 0 to 1.
#[test]
fn contact_firmness_is_clamped() {
    let (robot, capture) = (nao(), sway(20, 20));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let options = RetargetOptions::default();
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let follow = |none: f64, all: f64| -> Vec<f64> {
        let mut follower = retargeting.follower().unwrap();
        let mut rows = Vec::new();
        for frame in 0..capture.frames() {
            let in_contact = if frame < 10 {
                [none, none, all]
            } else {
                [none, all, none]
            };
            let places = retargeting.targets(frame).unwrap();
            rows.extend_from_slice(follower.advance(places, &in_contact).unwrap());
        }
        rows
    };
    assert_eq!(follow(-3.0, 4.0), follow(0.0, 1.0));
}

#[test]
fn velocity_limit_of_a_ball_joint_is_rejected() {
    let limits =
        "joint_limits:\n  root_joint/rotation: {has_velocity_limits: true, max_velocity: 2.0}";
    let robot = nao()
        .with_joint_limits_of(limits.as_bytes(), "limits")
        .unwrap();
    let (map, capture) = (BodyMap::from_json(MAP, "").unwrap(), sway(4, 4));
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    retargeting.follower().says("root_joint/rotation");
}

#[test]
fn limits_and_errors_are_reported_correctly() {
    let (robot, capture) = (nao(), sway(20, 10));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = retargeting.per_frame().unwrap();
    let errors = retargeting.errors(&found).unwrap();
    assert_eq!(errors.len(), 20 * map.drives.len());
    let met = retargeting.active_limits(&found);
    let model = robot.model();
    let max_moves = robot.moves_within(1.0 / 30.0);
    assert!(
        met.iter()
            .any(|met| met.bound == MotionBound::Speed && met.frames.contains(&10))
    );
    for met in met {
        let id = model.joint(&met.joint).unwrap();
        let at = model.coordinate(id).unwrap();
        let value = |frame: usize| found.q[frame * found.nq + at];
        for frame in met.frames {
            let deviation = match met.bound {
                MotionBound::Speed => (value(frame) - value(frame - 1)).abs() - max_moves[at],
                _ => {
                    let limits = model.joints()[id.index()].limits;
                    (value(frame) - limits.lower)
                        .abs()
                        .min((value(frame) - limits.upper).abs())
                }
            };
            assert!(
                deviation.abs() < 1e-8,
                "{} in frame {frame}: {deviation}",
                met.joint
            );
        }
    }
}

/// A slow foot on the ground is in contact. An equally slow foot in the air is not, and follows its target.
#[test]
fn slow_foot_is_in_contact_only_on_the_ground() {
    let (robot, frames) = (nao(), 40);
    let map = BodyMap::from_json(MAP, "").unwrap();
    // Both feet move forward at about half the speed limit of contacts for legs of a third of a metre. The right one is
    // in the air.
    let places = (0..frames).flat_map(|frame| {
        let ahead = 0.005 * frame as f64;
        let hips = 0.3 * ahead;
        // It is lifted from the ground first.
        let up = 0.3 * ((frame as f64 - 5.0) / 8.0).clamp(0.0, 1.0);
        [hips, 0.0, 0.9, ahead, 0.15, 0.0, ahead, -0.15, up]
    });
    let names = map.joints.clone();
    let capture = Capture::new(names, &places.collect::<Vec<_>>(), 30.0).unwrap();
    let mut options = RetargetOptions::default();
    options.contacts.height = 0.02;
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let mut live = retargeting.live().unwrap();
    let model = robot.model();
    let soles = ["left_sole", "right_sole"].map(|sole| model.frame(sole).unwrap());
    let mut kinematics = ForwardKinematics::new(model);
    let mut at = Vec::new();
    for frame in 0..frames {
        let q = live.step(capture.frame(frame).unwrap()).unwrap();
        let placed = kinematics.place(q).unwrap();
        at.push(soles.map(|sole| placed[sole.index()].translation));
    }
    let moved = |foot: usize| (at[39][foot] - at[18][foot]).norm();
    assert!(moved(0) < 1e-3, "the left foot slipped by {}", moved(0));
    assert!(moved(1) > 0.02, "the right foot moved by {}", moved(1));
}

/// A robot with an arm that rotates at its middle: by itself, or as a mimic joint of another joint that carries
/// nothing.
fn one_armed(ratio: Option<f64>) -> Robot {
    let turns = |name: &str, child: &str, end: f64, more: &str| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"revolute\"><parent link=\"torso\"/>\
             <child link=\"{child}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-{end}\" upper=\"{end}\" effort=\"1\" velocity=\"50\"/>{more}</joint>"
        )
    };
    let arm = match ratio {
        None => turns("arm", "upper", 2.0, ""),
        Some(ratio) => {
            let assert_follows = format!("<mimic joint=\"lever\" multiplier=\"{ratio}\"/>");
            let lever = turns("lever", "crank", 2.0 / ratio.abs(), "");
            lever + &turns("arm", "upper", 2.0, &assert_follows)
        }
    };
    let text = format!(
        "<robot name=\"one armed\"><link name=\"torso\"/>{arm}<link name=\"hand\"/>\
         <joint name=\"wrist\" type=\"fixed\"><parent link=\"upper\"/><child link=\"hand\"/>\
         <origin xyz=\"0.5 0 0\"/></joint></robot>"
    );
    let robot = Robot::parse(&text, "one_armed.urdf").unwrap();
    robot.with_base_joint(BaseJoint::FREE).unwrap()
}

/// Asserts that a robot reaches the positions of a subject of its own size.
fn assert_follows(robot: &Robot, map: &str, places: &[f64]) {
    let map = BodyMap::from_json(map, "").unwrap();
    let capture = Capture::new(map.joints.clone(), places, 30.0).unwrap();
    let options = RetargetOptions::default();
    let retargeting = Retargeting::new(robot, &map, &capture, options).unwrap();
    let found = retargeting.per_frame().unwrap();
    let errors = retargeting.errors(&found).unwrap();
    assert!(errors.iter().all(|error| *error < 2e-3), "{errors:?}");
}

/// An arm on a ball joint, which has no nominal posture, follows its target.
#[test]
fn limb_on_a_ball_joint_follows_its_target() {
    let mut builder = Model::builder("ball armed");
    let [x, _, z] = Vector3::UNITS;
    builder.frame("torso", None, Placement::identity());
    let shoulder = builder.ball("shoulder", None, Placement::identity(), x, None);
    let elbow = Placement::translation(x * 0.3);
    let elbow = builder.revolute("elbow", Some(shoulder), elbow, z, Limits::new(-2.0, 2.0));
    builder.frame("hand", Some(elbow), Placement::translation(x * 0.2));
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let map = r#"{"joints": ["hips", "hand"], "drives": {"hips": "torso", "hand": "hand"}}"#;
    let places = (0..60).flat_map(|frame| {
        let angle = 0.1 * f64::from(frame);
        let hand = Vector3::new(0.2, 0.3 * angle.cos(), 0.3 * angle.sin());
        [0.0, 0.0, 0.9, hand.x, hand.y, 0.9 + hand.z]
    });
    assert_follows(&robot, map, &places.collect::<Vec<f64>>());
}

/// A limb without length on the robot ends at its start, however long the subject's limb is.
#[test]
fn limb_without_length_pulls_at_nothing() {
    let mut builder = Model::builder("one armed");
    let [x, _, z] = Vector3::UNITS;
    builder.frame("torso", None, Placement::identity());
    let turns = Limits::new(-2.0, 2.0);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, turns);
    let hand = builder.fixed("wrist", Some(shoulder), Placement::translation(x * 0.5));
    builder.frame("hand", Some(hand), Placement::identity());
    let grip = builder.revolute("grip", Some(hand), Placement::identity(), x, turns);
    builder.frame("fingers", Some(grip), Placement::identity());
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let map = r#"{"joints": ["hips", "hand", "fingers"],
        "drives": {"hips": "torso", "hand": "hand", "fingers": "fingers"}}"#;
    let places = (0..20).flat_map(|frame| {
        let (sin, cos) = (0.05 * f64::from(frame)).sin_cos();
        let at = |distance: f64| [distance * cos, distance * sin, 0.9];
        [[0.0, 0.0, 0.9], at(0.5), at(0.7)].concat()
    });
    assert_follows(&robot, map, &places.collect::<Vec<f64>>());
}

/// A mimic joint whose source joint moves no other driven frame moves as it would by itself.
#[test]
fn limb_on_a_mimic_joint_follows_equally() {
    let map = r#"{"joints": ["hips", "hand"], "drives": {"hips": "torso", "hand": "hand"}}"#;
    let map = BodyMap::from_json(map, "").unwrap();
    let places = (0..40).flat_map(|frame| {
        let angle = 1.2 * (0.15 * f64::from(frame)).sin();
        [0.0, 0.0, 0.9, 0.5 * angle.cos(), 0.5 * angle.sin(), 0.9]
    });
    let places: Vec<f64> = places.collect();
    let capture = Capture::new(map.joints.clone(), &places, 30.0).unwrap();
    let hands = |ratio: Option<f64>| -> Vec<Vector3<f64>> {
        let robot = one_armed(ratio);
        let options = RetargetOptions::default();
        let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
        let mut live = retargeting.live().unwrap();
        let mut kinematics = ForwardKinematics::new(robot.model());
        let hand = robot.model().frame("hand").unwrap();
        let frames = (0..capture.frames()).map(|frame| {
            let q = live.step(capture.frame(frame).unwrap()).unwrap();
            kinematics.place(q).unwrap()[hand.index()].translation
        });
        frames.collect()
    };
    let alone = hands(None);
    for ratio in [0.05, -0.5, 2.0, -20.0] {
        for (frame, (actual, alone)) in hands(Some(ratio)).iter().zip(&alone).enumerate() {
            let deviation = (*actual - *alone).norm();
            assert!(deviation < 2e-8, "{ratio}, frame {frame}: {deviation}");
        }
    }
}

/// The reported slip is the largest distance of any foot from the start of its contact, not the final one.
#[test]
fn reported_slip_is_the_largest() {
    let (robot, capture) = (nao(), sway(90, 45));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = retargeting.per_frame().unwrap();
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let feet: Vec<_> = found
        .report
        .contact_frames
        .iter()
        .map(|name| model.frame(name).unwrap())
        .collect();
    let mut stood: Vec<Option<Vector3<f64>>> = vec![None; feet.len()];
    let mut largest = 0.0_f64;
    for frame in 0..found.rows().len() {
        let q = &found.q[frame * found.nq..][..found.nq];
        let placed = kinematics.place(q).unwrap();
        for (k, foot) in feet.iter().enumerate() {
            let at = placed[foot.index()].translation;
            match found.report.contacts[frame * feet.len() + k] {
                true => largest = largest.max((at - *stood[k].get_or_insert(at)).norm()),
                false => stood[k] = None,
            }
        }
    }
    assert!(found.report.lost_contacts.is_empty() && largest > 0.0);
    assert!(
        (found.report.slip - largest).abs() <= 1e-9,
        "{} {largest}",
        found.report.slip
    );
}

/// Driving joints and driven frames are reported, and y is rotated to z as the up axis.
#[test]
fn driving_joints_and_up_axis_are_reported() {
    use kinopt::motion::retarget::UpAxis;
    let (robot, capture) = (nao(), sway(20, 20));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let names = retargeting
        .driving()
        .into_iter()
        .map(|joint| capture.names()[joint].as_str());
    let frames = retargeting.driven().into_iter();
    let frames = frames.map(|frame| robot.model().frames()[frame.index()].name.as_str());
    let mut pairs: Vec<_> = names.zip(frames).collect();
    pairs.sort_unstable();
    assert_eq!(
        pairs,
        [
            ("hips", "torso"),
            ("left", "left_sole"),
            ("right", "right_sole")
        ]
    );
    let [x, y, z] = Vector3::UNITS;
    let turn = UpAxis::Y.turned_to_z();
    assert_eq!([turn * x, turn * y, turn * z], [x, z, -y]);
    assert_eq!(UpAxis::Z.turned_to_z() * y, y);
}

/// A higher cost of accelerations lowers them in a motion solved as a whole.
#[test]
fn acceleration_cost_lowers_accelerations() {
    let (robot, capture) = (nao(), sway(16, 8));
    let map = BodyMap::from_json(MAP, "").unwrap();
    let bends = [1e-5, 1e-2].map(|cost| {
        let options = RetargetOptions::default().with_acceleration(cost);
        let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
        let found = retargeting.whole().unwrap();
        let n = found.nq;
        let rows: Vec<&[f64]> = found.q.chunks_exact(n).collect();
        let bend = rows.windows(3).flat_map(|rows| {
            // Position and quaternion of a free base come first.
            (7..n).map(|k| (rows[0][k] - 2.0 * rows[1][k] + rows[2][k]).powi(2))
        });
        bend.sum::<f64>()
    });
    assert!(bends[0] > 1.1 * bends[1], "{bends:?}");
}
