//! Promise: a foot with a known shape is flat on its support in contact. No part of it is in the ground in any frame,
//! frame by frame and solved as a whole.

use kinopt::collision::{CollisionModel, CollisionObject, Shape};
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, FootShapes, RetargetOptions, RetargetReport, Retargeting,
};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};

use crate::retargeted_feet::{MAP, RATE, check_limits, legs, person};
use support::retargeted::mean_target_error;

/// Sole of 6 cm by 22 cm that extends beyond the heel.
pub(crate) const SOLE: &str = r#"<collision><origin xyz="0.06 0 -0.035"/><geometry><box size="0.22 0.06 0.01"/></geometry></collision>"#;
const CORNERS: [[f64; 3]; 4] = [
    [-0.05, -0.03, -0.04],
    [-0.05, 0.03, -0.04],
    [0.17, -0.03, -0.04],
    [0.17, 0.03, -0.04],
];

/// Heights of the corners of both feet, frame by frame.
fn heights(robot: &Robot, found: &Trajectory<RetargetReport>) -> Vec<[[f64; 4]; 2]> {
    let model = robot.model();
    let feet = ["left_foot", "right_foot"].map(|name| model.frame(name).unwrap().index());
    let mut kinematics = ForwardKinematics::new(model);
    let frames = found.rows();
    let of_frame = |q: &[f64]| {
        let placed = kinematics.place(q).unwrap();
        feet.map(|foot| CORNERS.map(|at| placed[foot].apply(Vector3::from(at)).z))
    };
    frames.map(of_frame).collect()
}

fn max_penetration(heights: &[[[f64; 4]; 2]]) -> f64 {
    let all = heights.iter().flatten().flatten();
    -all.fold(f64::INFINITY, |smallest, height| smallest.min(*height))
}

/// Leaning subject, so that a foot known by a line only would roll onto its edge.
fn leaning_subject() -> Vec<f64> {
    let mut numbers = person();
    for (k, frame) in numbers.chunks_mut(27).enumerate() {
        let aside = 0.12 * (0.05 * k as f64).sin();
        // Chest, and both hips and knees.
        for joint in [0, 1, 2, 5, 6] {
            frame[3 * joint + 1] += aside;
        }
    }
    numbers
}

#[test]
fn foot_in_contact_is_flat_and_above_the_ground() {
    let (shaped, bare) = (legs(SOLE), legs(""));
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &leaning_subject(), RATE).unwrap();
    let fitted =
        |robot| Retargeting::new(robot, &map, &capture, RetargetOptions::default()).unwrap();
    let bare_fitted = fitted(&bare);
    let without = bare_fitted.per_frame().unwrap();
    assert_eq!(without.report.ground_penetration, 0.0);
    // Without a shape the ground was at the toes' point, 1 cm above the sole. That much is no roll.
    let ground_penetration = max_penetration(&heights(&bare, &without)) - 0.01;
    assert!(
        ground_penetration > 2e-3,
        "without its shape it sinks by {ground_penetration} m"
    );

    let with = fitted(&shaped);
    for found in [with.per_frame().unwrap(), with.whole().unwrap()] {
        check_limits(&shaped, &found);
        let heights = heights(&shaped, &found);
        let deepest = max_penetration(&heights);
        assert!(deepest < 1.5e-3, "{deepest} m");
        // The reported depth is that of the sole's corners.
        assert!((deepest.max(0.0) - found.report.ground_penetration).abs() < 1e-12);
        assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
        assert!(
            found.report.lost_contacts.is_empty(),
            "{:?}",
            found.report.lost_contacts
        );
        assert!(
            mean_target_error(&with, &found) < 1.2 * mean_target_error(&bare_fitted, &without),
            "{} m",
            mean_target_error(&with, &found)
        );
        let mut standing = 0;
        for (heights, in_contact) in heights.iter().zip(found.report.contacts.chunks(2)) {
            for (foot, _) in heights
                .iter()
                .zip(in_contact)
                .filter(|(_, in_contact)| **in_contact)
            {
                standing += 1;
                assert!(foot.iter().all(|height| height.abs() < 8e-3), "{foot:?}");
            }
        }
        assert!(standing > 240, "{standing}");
    }
}

/// Legs known by their ankles only; no toe keeps the feet level.
const ANKLE_MAP: &str = r#"{
    "joints": ["chest", "l_hip", "l_knee", "l_ankle", "l_toe", "r_hip", "r_knee", "r_ankle", "r_toe"],
    "drives": {
        "chest": "pelvis",
        "l_hip": "left_thigh", "l_knee": "left_shank", "l_ankle": "left_foot",
        "r_hip": "right_thigh", "r_knee": "right_shank", "r_ankle": "right_foot"
    }
}"#;

/// Subject that goes down further than the ankles bend. Otherwise the heel would rise and the toes go into the ground,
/// by 9 mm solved as a whole.
#[test]
fn foot_at_its_ankle_limit_stays_above_the_ground() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(ANKLE_MAP, "legs").unwrap();
    let mut numbers = person();
    for (k, frame) in numbers.chunks_mut(27).enumerate() {
        let down = 0.15 * (1.0 - (0.05 * k as f64).cos());
        // The body moves down and forward, the knees forward; the feet are in contact.
        for joint in [0, 1, 5] {
            frame[3 * joint] += down;
            frame[3 * joint + 2] -= down;
        }
        for joint in [2, 6] {
            frame[3 * joint] += down;
        }
    }
    let capture = Capture::new(map.joints.clone(), &numbers, RATE).unwrap();
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    for found in [fitted.per_frame().unwrap(), fitted.whole().unwrap()] {
        check_limits(&robot, &found);
        assert!(
            found.report.ground_penetration < 1.5e-3,
            "{} m",
            found.report.ground_penetration
        );
        assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
        assert!(
            found.report.lost_contacts.is_empty(),
            "{:?}",
            found.report.lost_contacts
        );
    }
}

/// A foot that had to be locked firmly in one contact is locked as any other in its next contact.
#[test]
fn contacts_of_a_foot_are_independent() {
    let robot = legs(SOLE);
    let model = robot.model();
    let map = BodyMap::from_json(ANKLE_MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let stood = fitted.targets(0).unwrap();
    let driven = fitted.driven();
    let is = |k: usize, what: &str| model.frames()[driven[k].index()].name.ends_with(what);
    // Frames on the ground, in the air and on the ground again with a leaning body. During the first contact the body
    // moves down by `down` metres.
    let second_stance = |down: f64| {
        let mut follower = fitted.follower().unwrap();
        let mut rows = Vec::new();
        for frame in 0..400 {
            let share = f64::from(frame % 100) / 100.0;
            let wave = 0.5 * (1.0 - (std::f64::consts::TAU * share).cos());
            let (on_ground, down, aside) = match frame / 100 {
                0 => (true, down * wave, 0.0),
                3 => (true, 0.0, 0.25 * wave),
                _ => (false, 0.0, 0.0),
            };
            let places = stood.iter().enumerate().map(|(k, at)| {
                let by = match () {
                    () if is(k, "pelvis") || is(k, "thigh") => Vector3::new(down, aside, -down),
                    () if is(k, "shank") => Vector3::new(down, 0.5 * aside, 0.0),
                    () if !on_ground => Vector3::new(0.0, 0.0, 0.1),
                    () => Vector3::zero(),
                };
                *at + by
            });
            let places: Vec<_> = places.collect();
            let in_contact: Vec<f64> = (0..places.len())
                .map(|k| f64::from(on_ground && is(k, "foot")))
                .collect();
            let q = follower.advance(&places, &in_contact).unwrap();
            if frame >= 250 {
                rows.push(q.to_vec());
            }
        }
        rows
    };
    let (deep, level) = (second_stance(0.3), second_stance(0.0));
    let moves = deep.iter().flatten().zip(level.iter().flatten());
    let largest = moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest < 1e-5, "{largest} rad");
}

/// A small ball under each corner, and a larger one next to it that is 1.4 cm lower although its centre is higher.
const PADS: [([f64; 3], f64); 8] = [
    ([-0.05, -0.03, -0.03], 0.002),
    ([-0.05, 0.03, -0.03], 0.002),
    ([0.17, -0.03, -0.03], 0.002),
    ([0.17, 0.03, -0.03], 0.002),
    ([-0.046, -0.028, -0.026], 0.02),
    ([-0.046, 0.028, -0.026], 0.02),
    ([0.166, -0.028, -0.026], 0.02),
    ([0.166, 0.028, -0.026], 0.02),
];

#[test]
fn round_soles_are_in_contact_by_their_surface() {
    let pad = |([x, y, z], radius): ([f64; 3], f64)| {
        format!(
            r#"<collision><origin xyz="{x} {y} {z}"/><geometry><sphere radius="{radius}"/></geometry></collision>"#
        )
    };
    let robot = legs(&PADS.map(pad).concat());
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &leaning_subject(), RATE).unwrap();
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let feet = ["left_foot", "right_foot"].map(|name| robot.model().frame(name).unwrap());
    let mut kinematics = ForwardKinematics::new(robot.model());
    for found in [fitted.per_frame().unwrap(), fitted.whole().unwrap()] {
        let mut lowest = f64::INFINITY;
        for q in found.rows() {
            let placed = kinematics.place(q).unwrap();
            for foot in feet {
                let heights = PADS
                    .map(|(at, radius)| placed[foot.index()].apply(Vector3::from(at)).z - radius);
                lowest = heights.into_iter().fold(lowest, f64::min);
            }
        }
        assert!(lowest > -1.5e-3 && lowest < 1.5e-3, "{lowest} m");
    }
}

/// Balls under a foot give the same foot as a point cloud with radii.
#[test]
fn points_of_a_cloud_have_their_radius() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &leaning_subject(), RATE).unwrap();
    let model = robot.model();
    let under = [
        [-0.03, -0.03, -0.02],
        [-0.03, 0.03, -0.02],
        [0.15, 0.0, -0.02],
    ]
    .map(Vector3::from);
    let fitted = |as_cloud: bool| {
        let mut objects = Vec::new();
        for foot in ["left_foot", "right_foot"] {
            let link = model.frame(foot).unwrap();
            let mut add = |shape, at: Vector3<f64>| {
                objects.push(CollisionObject::new(
                    foot,
                    link,
                    Placement::translation(at),
                    shape,
                ));
            };
            match as_cloud {
                true => add(
                    Shape::points(under.to_vec(), 0.02).unwrap(),
                    Vector3::zero(),
                ),
                false => under
                    .map(|at| add(Shape::sphere(0.02).unwrap(), at))
                    .into_iter()
                    .collect(),
            }
        }
        let bodies = CollisionModel::new(model, objects).unwrap();
        let shapes = FootShapes::of_collision_model(&bodies);
        let options = RetargetOptions::default().with_shapes(shapes);
        let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
        retargeting.per_frame().unwrap()
    };
    let [balls, cloud] = [false, true].map(fitted);
    assert_eq!(balls.q, cloud.q);
}

/// A landing foot is levelled as firmly as it is locked in place. With five times the weight a foot on a leaning leg is
/// much less off level at the start of its contact. In the air it is equally off level.
#[test]
fn heavier_weight_lands_a_foot_flatter() {
    let robot = legs(SOLE);
    let model = robot.model();
    let mut map = BodyMap::from_json(MAP, "legs").unwrap();
    // Feet known by their ankles only, which define no orientation: no joint has the name of a toe.
    map.drives.retain(|drive| !drive.frame.ends_with("_toe"));
    for joint in &mut map.joints {
        *joint = joint.replace("toe", "marker");
    }
    for drive in &mut map.drives {
        drive.frame = drive.frame.replace("_heel_string", "_foot");
    }
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let foot = model.frame("left_foot").unwrap().index();
    let tilts = |landing_weight: f64| {
        let options = RetargetOptions::default().with_landing_weight(landing_weight);
        let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
        let found = retargeting.per_frame().unwrap();
        let names = &found.report.contact_frames;
        let left = names.iter().position(|name| name == "left_foot").unwrap();
        let in_contact = |frame: usize| found.report.contacts[frame * names.len() + left];
        let landing = (1..found.rows().len())
            .find(|&k| in_contact(k) && !in_contact(k - 1))
            .unwrap();
        let mut kinematics = ForwardKinematics::new(model);
        let mut tilt = |frame: usize| {
            let q = found.rows().nth(frame).unwrap();
            let turned = kinematics.place(q).unwrap()[foot].rotation;
            turned.x.z.hypot(turned.y.z)
        };
        [tilt(landing - 1), tilt(landing - 26)]
    };
    let [one, five] = [1.0, 5.0].map(tilts);
    assert!(one[0] > 1e-3 && five[0] < 0.1 * one[0], "{one:?} {five:?}");
    assert!(
        one[1] > 0.04 && (five[1] - one[1]).abs() < 0.4 * one[1],
        "{one:?} {five:?}"
    );
}

/// Two legs in MJCF with ellipsoids as feet.
fn on_ellipsoids(geom: &str) -> Robot {
    let leg = |side: &str, y: f64| {
        format!(
            r#"<body name="{side}_thigh" pos="0 {y} -0.1"><joint name="{side}_roll" axis="1 0 0" range="-0.5 0.5"/>
            <joint name="{side}_pitch" axis="0 1 0" range="-2 1"/>
            <body name="{side}_shank" pos="0 0 -0.3"><joint name="{side}_knee" axis="0 1 0" range="-0.09 2.6"/>
            <body name="{side}_foot" pos="0 0 -0.3"><joint name="{side}_ankle" axis="0 1 0" range="-0.87 0.52"/>
            <joint name="{side}_tilt" axis="1 0 0" range="-0.26 0.26"/><geom type="ellipsoid" {geom}/></body></body></body>"#
        )
    };
    let text = format!(
        r#"<mujoco><compiler angle="radian"/><worldbody><body name="pelvis"><freejoint/>{}{}</body></worldbody></mujoco>"#,
        leg("left", 0.1),
        leg("right", -0.1)
    );
    Robot::parse_mjcf(&text, "legs.xml").unwrap()
}

/// An ellipsoid gives the same foot as one with its first two axes swapped and a rotation by a quarter turn.
#[test]
fn ellipsoid_is_equal_under_swapped_axes() {
    let mut map = BodyMap::from_json(MAP, "legs").unwrap();
    map.drives.retain(|drive| !drive.frame.ends_with("_toe"));
    for drive in &mut map.drives {
        drive.frame = drive.frame.replace("_heel_string", "_foot");
    }
    let capture = Capture::new(map.joints.clone(), &leaning_subject(), RATE).unwrap();
    let found = [
        r#"size="0.12 0.04 0.03" pos="0.04 0 -0.03""#,
        r#"size="0.04 0.12 0.03" pos="0.04 0 -0.03" euler="0 0 1.5707963267948966""#,
    ]
    .map(|geom| {
        let robot = on_ellipsoids(geom);
        let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default());
        retargeting.unwrap().per_frame().unwrap()
    });
    let deviation = found[0]
        .q
        .iter()
        .zip(&found[1].q)
        .map(|(a, b)| (a - b).abs());
    let deviation = deviation.fold(0.0, f64::max);
    assert!(deviation < 1e-6, "{deviation}");
    assert!(
        found
            .iter()
            .all(|found| found.report.ground_penetration < 0.01),
        "{} m",
        found[0].report.ground_penetration
    );
}
