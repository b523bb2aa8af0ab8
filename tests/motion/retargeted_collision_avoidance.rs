//! Promise: a body with self-collision avoidance touches itself in no frame, whatever the targets are. Limits of
//! position and velocity hold exactly. If nothing would touch, it moves as without avoidance.

use kinopt::collision::{Checker, CollisionModel};
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, RetargetReport, Retargeting};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::arms::floating_nao;

const RATE: f64 = 20.0;
const FRAMES: usize = 40;
const MARGIN: f64 = 2e-3;
const MAP: &str = r#"{
    "joints": ["hips", "left_foot", "right_foot", "left_hand", "right_hand"],
    "drives": {
        "hips": "torso", "left_foot": "left_sole", "right_foot": "right_sole",
        "left_hand": "left_hand", "right_hand": "right_hand"
    }
}"#;

/// Subject with its feet apart that brings both hands towards its centre by a fraction of the distance, and back.
fn clasp(robot: &Robot, share: f64) -> Capture {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral()).unwrap();
    let at = |name: &str| placed[model.frame(name).unwrap().index()].translation;
    let links = [
        "torso",
        "left_sole",
        "right_sole",
        "left_hand",
        "right_hand",
    ];
    let mut places = Vec::new();
    for frame in 0..FRAMES {
        let phase = share * (std::f64::consts::PI * frame as f64 / FRAMES as f64).sin();
        for link in links {
            let hand = link.ends_with("hand");
            let displacement = at("torso") - at(link);
            let apart = match link {
                "left_sole" => Vector3::new(0.0, 0.03, 0.0),
                "right_sole" => Vector3::new(0.0, -0.03, 0.0),
                _ => Vector3::zero(),
            };
            let displacement = if hand { displacement * phase } else { apart };
            places.extend((at(link) + displacement).to_array());
        }
    }
    Capture::new(links_of_map(), &places, RATE).unwrap()
}

fn links_of_map() -> Vec<String> {
    let map = BodyMap::from_json(MAP, "").unwrap();
    map.joints
}

fn both_ways(
    robot: &Robot,
    checker: &Checker,
    share: f64,
) -> (
    [Trajectory<RetargetReport>; 2],
    [Trajectory<RetargetReport>; 2],
) {
    let map = BodyMap::from_json(MAP, "").unwrap();
    let capture = clasp(robot, share);
    let fitted = Retargeting::new(robot, &map, &capture, RetargetOptions::default()).unwrap();
    let clear = fitted.clone().keep_clear(checker);
    let solve = |retargeting: &Retargeting<'_>| {
        [
            retargeting.per_frame().unwrap(),
            retargeting.whole().unwrap(),
        ]
    };
    (solve(&fitted), solve(&clear))
}

/// Mean direction error of the limbs, degrees.
fn mean_angle(found: &Trajectory<RetargetReport>) -> f64 {
    let limbs = &found.report.score.limbs;
    limbs.iter().map(|limb| limb.angle.mean).sum::<f64>() / limbs.len() as f64
}

fn frames(found: &Trajectory<RetargetReport>) -> impl Iterator<Item = &[f64]> {
    found.rows()
}

fn checker(robot: &Robot) -> Checker {
    let shapes = CollisionModel::of(robot).unwrap();
    let shapes = shapes.with_touching_ignored(&robot.model().neutral());
    Checker::covered(shapes.unwrap())
        .with_margin(MARGIN)
        .unwrap()
}

/// Number of frames in which links are nearer than the margin.
fn touching(checker: &Checker, found: &Trajectory<RetargetReport>) -> usize {
    let touches = |q: &&[f64]| !checker.collisions(q).unwrap().is_empty();
    frames(found).filter(touches).count()
}

fn keeps_limits(robot: &Robot, found: &Trajectory<RetargetReport>) -> bool {
    let moves = robot.moves_within(1.0 / RATE);
    let mut pairs = frames(found).zip(frames(found).skip(1));
    frames(found).all(|q| robot.model().is_within_limits(q))
        && pairs.all(|(from, to)| {
            let mut numbers = from.iter().zip(to).zip(&moves);
            numbers.all(|((from, to), most)| (to - from).abs() <= *most)
        })
}

#[test]
fn hands_pulled_into_the_chest_stay_collision_free() {
    let robot = floating_nao();
    let checker = checker(&robot);
    let (plain, clear) = both_ways(&robot, &checker, 1.0);
    for (plain, clear) in plain.iter().zip(&clear) {
        assert!(
            touching(&checker, plain) > 10,
            "{}",
            touching(&checker, plain)
        );
        assert_eq!(touching(&checker, clear), 0);
        assert!(clear.report.touching.is_empty());
        assert!(keeps_limits(&robot, clear));
        assert!(clear.report.slip < 1e-3, "{} m", clear.report.slip);
        // The avoidance does not keep the hands away: they come nearly as near.
        assert!(
            mean_angle(clear) < mean_angle(plain) + 3.0,
            "{} degrees",
            mean_angle(clear)
        );
    }
}

#[test]
fn collision_free_motion_is_unchanged() {
    let robot = floating_nao();
    let checker = checker(&robot);
    let (plain, clear) = both_ways(&robot, &checker, -0.2);
    assert_eq!(touching(&checker, &plain[0]), 0);
    assert_eq!(plain[0].q, clear[0].q);
    assert_eq!(plain[1].q, clear[1].q);
}

#[test]
fn initial_contact_is_reported_or_resolved() {
    let robot = floating_nao();
    let map = BodyMap::from_json(MAP, "").unwrap();
    let capture = clasp(&robot, 1.0);
    // The middle of the motion, where both hands would be in the chest.
    let middle: Vec<f64> = (FRAMES / 2..FRAMES)
        .filter_map(|frame| capture.frame(frame))
        .flatten()
        .flat_map(|at| at.to_array())
        .collect();
    let capture = Capture::new(links_of_map(), &middle, RATE).unwrap();
    let checker = checker(&robot);
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = fitted.keep_clear(&checker).per_frame().unwrap();
    assert_eq!(found.report.touching.len(), touching(&checker, &found));
    assert_eq!(
        found.report.touching.len(),
        0,
        "{:?}",
        found.report.touching.first()
    );
}

/// A motion solved as a whole avoids collisions from the first iteration in the frames around those that came near to
/// contact frame by frame. Contacts found later are removed at once.
#[test]
fn smooth_motion_becomes_collision_free_quickly() {
    let robot = floating_nao();
    let checker = checker(&robot);
    let map = BodyMap::from_json(MAP, "").unwrap();
    for share in [0.85, 0.95] {
        let capture = clasp(&robot, share);
        let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
        let mut rounds = 0;
        let found = fitted
            .keep_clear(&checker)
            .whole_with_progress(&mut |done| rounds += usize::from(done == FRAMES));
        assert!(found.unwrap().report.touching.is_empty());
        assert!(rounds <= 2, "{share}: solved {rounds} times");
    }
}
