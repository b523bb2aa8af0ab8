//! Promise: body maps are guessed from names.
//!
//! - Known skeletons are recognised with any prefix before their joints' names, and others by the words in the names.
//! - A guess lists what it omits, survives a round trip through JSON, and is an error if the names describe no body.
//! - A map without drives of a model is completed by names. One with drives gets the same notes about its joints.

use kinopt::Model;
use kinopt::model::{JointId, Limits, ModelBuilder};
use kinopt::motion::retarget::{BodyMap, BodyPart, Capture, KnownSkeleton, RetargetError, UpAxis};
use kinopt::spatial::{Placement, Vector3};
use support::fault_tables::ExpectedError;

/// A model that consists of named frames only.
fn model(frames: &[&str]) -> Model {
    let mut builder = ModelBuilder::new("body");
    let limits = Limits::new(-1.0, 1.0);
    let mut on: Option<JointId> = None;
    for (k, frame) in frames.iter().enumerate() {
        let up = Placement::translation(Vector3::new(0.0, 0.0, 0.1));
        on = Some(builder.revolute(format!("joint{k}"), on, up, Vector3::UNITS[k % 3], limits));
        builder.frame(*frame, on, Placement::identity());
    }
    builder.build().unwrap()
}

/// A capture of a single frame with all joints at distinct positions.
fn capture(joints: &[String]) -> Capture {
    let places: Vec<f64> = (0..3 * joints.len()).map(|k| 0.1 * k as f64).collect();
    Capture::new(joints.to_vec(), &places, 30.0).unwrap()
}

fn drives(map: &BodyMap) -> Vec<(String, String)> {
    let pairs = map.drives.iter();
    pairs
        .map(|drive| (drive.joint.clone(), drive.frame.clone()))
        .collect()
}

const HUMANOID: &str = "pelvis upper_chest head left_thigh left_shin left_foot left_toes left_upper_arm left_forearm \
    left_hand right_thigh right_shin right_foot right_toes right_upper_arm right_forearm right_hand";

fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

#[test]
fn known_skeletons_drive_the_whole_humanoid() {
    let humanoid = model(&words(HUMANOID));
    for name in KnownSkeleton::names() {
        let known = KnownSkeleton::named(name).unwrap();
        let mixamo = "Hips Spine2 Head LeftUpLeg LeftLeg LeftFoot LeftToeBase LeftArm LeftForeArm LeftHand \
            RightUpLeg RightLeg RightFoot RightToeBase RightArm RightForeArm RightHand";
        let joints = match known.joints() {
            [] => words(mixamo).into_iter().map(str::to_owned).collect(),
            joints => joints.to_vec(),
        };
        for before in ["", "mixamorig:", "mixamorig1:", "someone:"] {
            let called: Vec<String> = joints
                .iter()
                .map(|joint| format!("{before}{joint}"))
                .collect();
            let source = capture(&called);
            let guess = BodyMap::guess(&source, &humanoid).unwrap();
            assert_eq!((guess.skeleton, guess.body), (Some(name), Some("humanoid")));
            assert_eq!(guess.map.drives.len(), BodyPart::ALL.len());
            assert!(
                guess
                    .map
                    .drives
                    .iter()
                    .all(|drive| called.contains(&drive.joint))
            );
            let by_skeleton = BodyMap::from_skeleton(&known, &source, &humanoid).unwrap();
            assert_eq!(by_skeleton.map, guess.map);
            assert_eq!(
                BodyMap::from_json(&guess.map.to_json(), "").unwrap(),
                guess.map
            );
            // Joints of each side drive frames of the same side.
            for (joint, frame) in drives(&guess.map) {
                for side in ["left", "right"] {
                    let is_same_side = joint.to_lowercase().contains(side);
                    assert_eq!(
                        is_same_side,
                        frame.starts_with(side),
                        "{joint} drives {frame}"
                    );
                }
            }
        }
    }
}

/// If a file has several subjects, the first one is used.
#[test]
fn first_of_two_subjects_is_used() {
    let humanoid = model(&words(HUMANOID));
    let one = KnownSkeleton::names().find_map(|name| {
        let joints = KnownSkeleton::named(name).ok()?.joints().to_vec();
        (!joints.is_empty()).then_some(joints)
    });
    let one = one.unwrap();
    let both =
        ["anna", "berta"].map(|person| one.iter().map(move |joint| format!("{person}:{joint}")));
    let both: Vec<String> = both.into_iter().flatten().collect();
    let guess = BodyMap::guess(&capture(&both), &humanoid).unwrap();
    assert_eq!(guess.map.drives.len(), BodyPart::ALL.len());
    let mut drives = guess.map.drives.iter();
    assert!(drives.all(|drive| drive.joint.starts_with("anna:")));
}

#[test]
fn naming_conventions_are_recognised() {
    let humanoid = model(&words(HUMANOID));
    let conventions = [
        // Exporters that do not allow a colon omit it.
        "mixamorigHips, mixamorigLeftUpLeg, mixamorig_LeftLeg, mixamorig1LeftFoot, \
         mixamorig10_LeftToe, mixamorigLeftArm, mixamorigLeftForeArm, mixamorigLeftHand, \
         mixamorigRightUpLeg, mixamorigHead",
        "hips, thighL, shinL, footL, toeL, upperArmL, forearmL, handL, thighR, head",
        "pelvis, thigh_01_l, calf_01_l, foot_01_l, ball_01_l, upperarm_01_l, lowerarm_01_l, \
         hand_01_l, thigh_01_r, head_01",
        "hips, thigh.L, shin.L, foot.L, toe.L, upper_arm.L, forearm.L, hand.L, thigh.R, head",
        "pelvis, thigh_l, calf_l, foot_l, ball_l, upperarm_l, lowerarm_l, hand_l, thigh_r, head",
        "Hips, LeftUpLeg, LeftLeg, LeftFoot, LeftToe, LeftArm, LeftForeArm, LeftHand, \
         RightUpLeg, Head",
        "Bip01 Pelvis, Bip01 L Thigh, Bip01 L Calf, Bip01 L Foot, Bip01 L Toe, Bip01 L UpperArm, \
         Bip01 L Forearm, Bip01 L Hand, Bip01 R Thigh, Bip01 Head",
        "pelvis, leftUpperLeg, leftLowerLeg, leftFoot, leftToes, leftUpperArm, leftLowerArm, \
         leftHand, rightUpperLeg, head",
        "Pelvis, LHip, LKnee, LAnkle, LFoot, LShoulder, LElbow, LWrist, RHip, Head",
        "Pelvis, L_Hip, L_Knee, L_Ankle, L_Foot, L_Shoulder, L_Elbow, L_Wrist, R_Hip, Head",
    ];
    let driven = "pelvis left_thigh left_shin left_foot left_toes left_upper_arm left_forearm left_hand \
        right_thigh head";
    let driven = words(driven);
    for names in conventions {
        let names: Vec<&str> = names.split(", ").collect();
        let joints: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        let guess = BodyMap::guess(&capture(&joints), &humanoid).unwrap();
        let reported = drives(&guess.map);
        for (joint, frame) in names.iter().zip(&driven) {
            let found = reported.iter().find(|(driving, _)| driving == joint);
            assert_eq!(
                found.map(|(_, frame)| frame.as_str()),
                Some(*frame),
                "{joint} of {names:?}"
            );
        }
        assert!(
            guess
                .notes
                .iter()
                .any(|note| note.starts_with("right_knee: the capture"))
        );
    }
}

#[test]
fn links_of_an_unknown_robot_are_recognised() {
    let links = "base_link left_hip_roll_link left_hip_pitch_link left_knee_link left_ankle_roll_link \
        left_shoulder_pitch_link left_elbow_link left_wrist_yaw_link head_link";
    let known = KnownSkeleton::named("lafan1").unwrap();
    let guess = BodyMap::guess(&capture(known.joints()), &model(&words(links))).unwrap();
    assert_eq!(guess.body, None);
    let reported = drives(&guess.map);
    for (joint, frame) in [
        ("Hips", "base_link"),
        ("LeftUpLeg", "left_hip_roll_link"),
        ("LeftLeg", "left_knee_link"),
        ("LeftFoot", "left_ankle_roll_link"),
        ("LeftArm", "left_shoulder_pitch_link"),
        ("LeftForeArm", "left_elbow_link"),
        ("LeftHand", "left_wrist_yaw_link"),
        ("Head", "head_link"),
    ] {
        assert!(
            reported.contains(&(joint.to_owned(), frame.to_owned())),
            "{joint}: {reported:?}"
        );
    }
    assert_eq!(guess.map.contacts, Some(vec!["LeftFoot".to_owned()]));
    assert!(
        guess
            .notes
            .iter()
            .any(|note| note.starts_with("left_toe: the model"))
    );
}

/// Hips and both legs downwards from them.
const LEGS: &str = "hips left_thigh left_shin left_foot right_thigh right_shin right_foot";

fn legs(numbers: &[f64]) -> Capture {
    Capture::new(
        words(LEGS).into_iter().map(str::to_owned).collect(),
        numbers,
        30.0,
    )
    .unwrap()
}

#[test]
fn limbs_of_implausible_length_are_noted() {
    let rest_positions = [
        [0.0, 0.0, 1.0],
        [0.0, 0.1, 0.9],
        [0.0, 0.1, 0.5],
        [0.0, 0.1, 0.5],
        [0.0, -0.1, 0.9],
        [0.0, -0.1, 0.7],
        [0.0, -0.1, 0.1],
    ];
    let mut numbers = rest_positions.concat();
    let mut second = rest_positions;
    second[5][2] = 0.8;
    numbers.extend(second.concat());
    let guess = BodyMap::guess(&legs(&numbers), &model(&words(HUMANOID))).unwrap();
    let message = guess.notes.join("\n");
    for words in [
        "the left shin has no length",
        "the right thigh is between 0.100 and 0.200",
        "the left thigh is 0.400 long",
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
}

/// Each of the four limbs on both sides in turn, without length and with half the length of the other side.
#[test]
fn short_limb_is_noted_with_its_side() {
    let chains = [("thigh", "shin", "foot"), ("upper_arm", "forearm", "hand")];
    let mut joints = vec!["hips".to_owned()];
    for (side, (upper, lower, end)) in ["left", "right"]
        .into_iter()
        .flat_map(|side| chains.map(|chain| (side, chain)))
    {
        joints.extend([upper, lower, end].map(|part| format!("{side}_{part}")));
    }
    let humanoid = model(&words(HUMANOID));
    // Each chain extends downwards next to the hips, with the lengths of its two limbs.
    let reported = |lengths: &[[f64; 2]; 4]| {
        let mut places = vec![[0.0, 0.0, 1.0]];
        for (chain, [upper, lower]) in lengths.iter().enumerate() {
            let y = [0.1, 0.3, -0.1, -0.3][chain];
            places.extend([0.0, *upper, upper + lower].map(|down| [0.0, y, 0.9 - down]));
        }
        let capture = Capture::new(joints.clone(), &places.concat(), 30.0).unwrap();
        BodyMap::guess(&capture, &humanoid).unwrap().notes
    };
    let of_limbs = |notes: Vec<String>| -> Vec<String> {
        let limbs = notes.into_iter().filter(|note| note.starts_with("the "));
        limbs.collect()
    };
    assert_eq!(of_limbs(reported(&[[0.4, 0.3]; 4])), [""; 0]);
    for (chain, side) in ["left", "left", "right", "right"].into_iter().enumerate() {
        for (limb, name) in [["thigh", "shin"], ["upper arm", "forearm"]][chain % 2]
            .into_iter()
            .enumerate()
        {
            let mut lengths = [[0.4, 0.3]; 4];
            lengths[chain][limb] = 0.0;
            let none = format!("the {side} {name} has no length: its ends are at one position");
            assert_eq!(of_limbs(reported(&lengths)), [none]);
            let whole = [0.4, 0.3][limb];
            lengths[chain][limb] = 0.5 * whole;
            let mut by_side = [whole; 2];
            by_side[chain / 2] = 0.5 * whole;
            let [left, right] = by_side;
            let short = format!("the left {name} is {left:.3} long and the right one {right:.3}");
            assert_eq!(of_limbs(reported(&lengths)), [short]);
        }
    }
}

#[test]
fn map_of_another_robot_is_completed_by_names() {
    let humanoid = model(&words(HUMANOID));
    let lafan = KnownSkeleton::named("lafan1").unwrap();
    let capture = capture(lafan.joints());
    let guess = BodyMap::guess(&capture, &humanoid).unwrap();
    for text in [
        r#"{"fps": 60, "up": "y", "drives": {"g1.urdf": {"Hips": "pelvis_link"}}}"#,
        r#"{"fps": 60, "up": "y"}"#,
    ] {
        let map = BodyMap::from_json(text, "body.urdf").unwrap();
        let completed = map.completed(&capture, &humanoid).unwrap();
        assert_eq!(
            (completed.skeleton, completed.map.frame_rate),
            (guess.skeleton, Some(60.0))
        );
        assert_eq!(completed.map.up, Some(UpAxis::Y));
        assert_eq!(drives(&completed.map), drives(&guess.map));
        assert_eq!(completed.map.contacts, guess.map.contacts);
        // The completion is noted first, followed by the guess's notes.
        let lacking = "the map drives no frame of the target, so drives are guessed from names";
        assert_eq!(completed.notes[0], lacking);
        assert_eq!(completed.notes[1..], guess.notes[..]);
    }
    // Contacts in the map are kept.
    let text = r#"{"contacts": ["LeftFoot"]}"#;
    let map = BodyMap::from_json(text, "body.urdf").unwrap();
    let completed = map.completed(&capture, &humanoid).unwrap().map;
    assert_eq!(completed.contacts, Some(vec!["LeftFoot".to_owned()]));
    // Drives in the map are kept.
    let text =
        r#"{"drives": {"g1.urdf": {"Hips": "pelvis_link"}, "body.urdf": {"Hips": "pelvis"}}}"#;
    let map = BodyMap::from_json(text, "body.urdf").unwrap();
    let completed = map.completed(&capture, &humanoid).unwrap();
    let expected = [("Hips".to_owned(), "pelvis".to_owned())];
    assert_eq!(drives(&completed.map), expected);
}

#[test]
fn only_driving_joints_of_a_given_map_are_checked() {
    // Lying along y, with a left thigh without length.
    let places = [
        [0.0, 1.0, 0.0],
        [0.1, 0.9, 0.0],
        [0.1, 0.9, 0.0],
        [0.1, 0.1, 0.0],
        [-0.1, 0.9, 0.0],
        [-0.1, 0.5, 0.0],
        [-0.1, 0.1, 0.0],
    ];
    let capture = legs(&places.concat());
    let humanoid = model(&words(HUMANOID));
    let looked_at = |text: &str| {
        let map = BodyMap::from_json(text, "body.urdf").unwrap();
        map.completed(&capture, &humanoid).unwrap()
    };
    let drives = LEGS.split(' ').map(|joint| {
        let frame = if joint == "hips" { "pelvis" } else { joint };
        format!("\"{joint}\": \"{frame}\"")
    });
    let drives: Vec<String> = drives.collect();
    let all = looked_at(&format!("{{\"drives\": {{{}}}}}", drives.join(", ")));
    assert!(
        all.notes
            .iter()
            .any(|note| note.contains("left thigh has no length")),
        "{:?}",
        all.notes
    );
    assert_eq!(all.up, Some(UpAxis::Y));
    let right: Vec<&str> = drives
        .iter()
        .map(String::as_str)
        .filter(|drive| !drive.contains("left"))
        .collect();
    let right = looked_at(&format!("{{\"drives\": {{{}}}}}", right.join(", ")));
    assert_eq!(right.notes, Vec::<String>::new());
    // The capture defines the up axis, whatever the drives are.
    assert_eq!(right.up, Some(UpAxis::Y));
}

#[test]
fn names_without_a_body_are_rejected() {
    let humanoid = model(&words(HUMANOID));
    let strangers = ["a", "b", "c"].map(str::to_owned);
    let refused = BodyMap::guess(&capture(&strangers), &humanoid).unwrap_err();
    assert!(matches!(refused, RetargetError::NoBody { .. }));
    assert!(refused.to_string().contains("a, b, c"), "{refused}");
    let lafan = KnownSkeleton::named("lafan1").unwrap();
    BodyMap::guess(&capture(lafan.joints()), &model(&["one", "two"])).says("one, two");
    let smpl = KnownSkeleton::named("smpl").unwrap();
    BodyMap::from_skeleton(&smpl, &capture(lafan.joints()), &humanoid).says("smpl");
    BodyMap::guess(
        &capture(lafan.joints()),
        &model(&["tail", "head", "jaw", "neck"]),
    )
    .says("match no body parts");
    KnownSkeleton::named("cmy").says("did you mean `cmu`");
    assert_eq!(smpl.joints_of_array(22).map(<[String]>::len), Some(22));
    assert_eq!(smpl.joints_of_array(21), None);
    assert_eq!(smpl.joints_of_array(53), None);
}

/// A map's JSON contains all its numbers.
#[test]
fn map_survives_a_round_trip() {
    let text = r#"{"joints": ["Hips", "Hand"], "fps": 60, "up": "y", "contacts": ["Hips"], "drives": {
        "Hand": {"frame": "hand", "offset": [0.1, -0.2, 0.3], "weight": 2.5, "scale": 0.75},
        "Hips": "pelvis"}}"#;
    let map = BodyMap::from_json(text, "body.urdf").unwrap();
    let hand = &map.drives[0];
    assert_eq!((&*hand.joint, &*hand.frame), ("Hand", "hand"));
    assert_eq!(hand.offset.to_array(), [0.1, -0.2, 0.3]);
    assert_eq!((hand.weight, hand.scale), (2.5, Some(0.75)));
    let hips = &map.drives[1];
    assert_eq!((&*hips.joint, &*hips.frame), ("Hips", "pelvis"));
    assert_eq!(hips.offset.to_array(), [0.0; 3]);
    assert_eq!((hips.weight, hips.scale), (1.0, None));
    assert_eq!((map.frame_rate, map.up), (Some(60.0), Some(UpAxis::Y)));
    assert_eq!(map.joints, ["Hips", "Hand"]);
    assert_eq!(map.contacts, Some(vec!["Hips".to_owned()]));
    assert_eq!(BodyMap::from_json(&map.to_json(), "").unwrap(), map);
}

/// A motor of the ankle is fixed to the shank and comes first, as in the Unitree R1.
#[test]
fn ankle_is_a_link_that_moves_on_the_shank() {
    let mut builder = ModelBuilder::new("biped");
    let (limits, [x, y, _]) = (Limits::new(-1.0, 1.0), Vector3::UNITS);
    let below = |z: f64| Placement::translation(Vector3::new(0.0, 0.0, z));
    builder.frame("pelvis_link", None, below(0.0));
    for side in ["left", "right"] {
        let aside = Placement::translation(Vector3::new(
            0.0,
            if side == "left" { 0.1 } else { -0.1 },
            0.0,
        ));
        let hip = builder.revolute(format!("{side}_hip"), None, aside, y, limits);
        builder.frame(format!("{side}_hip_pitch_link"), Some(hip), below(0.0));
        let knee = builder.revolute(format!("{side}_knee"), Some(hip), below(-0.3), y, limits);
        builder.frame(format!("{side}_knee_link"), Some(knee), below(0.0));
        builder.frame(format!("{side}_ankle_B_link"), Some(knee), below(-0.16));
        let pitch = builder.revolute(format!("{side}_pitch"), Some(knee), below(-0.31), y, limits);
        builder.frame(format!("{side}_ankle_pitch_link"), Some(pitch), below(0.0));
        let roll = builder.revolute(format!("{side}_roll"), Some(pitch), below(0.0), x, limits);
        builder.frame(format!("{side}_ankle_roll_link"), Some(roll), below(0.0));
    }
    let smpl = KnownSkeleton::named("smpl").unwrap();
    let names = smpl.joints();
    let map = BodyMap::guess(&capture(names), &builder.build().unwrap())
        .unwrap()
        .map;
    for side in ["left", "right"] {
        let expected = (format!("{side}_ankle"), format!("{side}_ankle_roll_link"));
        assert!(drives(&map).contains(&expected), "{:?}", drives(&map));
    }
}
