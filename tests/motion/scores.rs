//! Promise: a score measures a motion next to the person. Limb angles are those of forward kinematics, spoiled motions
//! have larger totals, and a motion without a subject has only the figures that need none.

use std::f64::consts::{FRAC_PI_2, PI};

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use kinopt::motion::score::{Heading, MotionScore, MotionScorer, ScoreWeights};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;
use support::random::Random;

const RATE: f64 = 30.0;
/// Numbers of the base: position and quaternion.
const BASE: usize = 7;

struct Steps {
    robot: Robot,
    capture: Capture,
    map: BodyMap,
    q: Vec<f64>,
}

/// The capture of `models/`, retargeted to the NAO.
fn steps() -> Steps {
    let robot = floating_nao();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, RATE).unwrap();
    let map = BodyMap::guess(&capture, robot.model()).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let q = retargeting.per_frame().unwrap().q;
    Steps {
        robot,
        capture,
        map,
        q,
    }
}

impl Steps {
    fn scorer(&self) -> MotionScorer<'_> {
        MotionScorer::of_subject(&self.robot, &self.capture, &self.map, UpAxis::Y).unwrap()
    }

    fn width(&self) -> usize {
        self.robot.model().configuration_len()
    }

    /// The motion with a change of each frame's configuration.
    fn changed(&self, mut change: impl FnMut(usize, &mut [f64])) -> Vec<f64> {
        let mut q = self.q.clone();
        for (frame, q) in q.chunks_exact_mut(self.width()).enumerate() {
            change(frame, q);
        }
        q
    }

    fn score(&self, q: &[f64]) -> MotionScore {
        self.scorer().score(q, RATE).unwrap()
    }
}

fn value(score: &MotionScore, term: &str) -> f64 {
    let found = score.terms.iter().find(|found| found.name == term);
    found.unwrap().value
}

#[test]
fn limb_angle_is_that_of_forward_kinematics() {
    let steps = steps();
    let scorer = steps.scorer().with_heading(Heading::Fixed(0.0));
    let limbs = scorer.limbs();
    let angles = scorer.limb_angles(&steps.q, RATE).unwrap();
    let frame_of = |joint: &str| {
        let drive = steps
            .map
            .drives
            .iter()
            .find(|drive| drive.joint == joint)
            .unwrap();
        (
            steps.robot.model().frame(&drive.frame).unwrap(),
            drive.offset,
        )
    };
    let mut kinematics = ForwardKinematics::new(steps.robot.model());
    for (limb, joints) in [
        ("left_forearm", ["LeftForeArm", "LeftHand"]),
        ("right_thigh", ["RightUpLeg", "RightLeg"]),
    ] {
        let index = limbs.iter().position(|name| *name == limb).unwrap();
        for frame in [0, 60, 180] {
            let q = &steps.q[frame * steps.width()..(frame + 1) * steps.width()];
            let placed = kinematics.place(q).unwrap();
            let [a, b] = joints.map(|joint| {
                let (frame, offset) = frame_of(joint);
                placed[frame.index()].apply(offset)
            });
            let captured = steps.capture.frame(frame).unwrap();
            let [c, d] = joints.map(|joint| captured[steps.capture.joint(joint).unwrap()]);
            // The capture has y up: (x, y, z) is (x, -z, y) with z up.
            let subject = Vector3::new(d.x - c.x, c.z - d.z, d.y - c.y);
            let cosine = subject.dot(b - a) / (subject.norm() * (b - a).norm());
            let expected = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            let found = angles[frame * limbs.len() + index];
            assert!(
                (found - expected).abs() < 1e-4,
                "{limb} {frame}: {found} {expected}"
            );
        }
    }
}

#[test]
fn own_capture_as_motion_has_no_errors() {
    // The driven points of a robot, captured, are a subject that the robot equals.
    let steps = steps();
    let points: Vec<_> = steps.map.drives.iter().collect();
    let names = points.iter().map(|drive| drive.joint.clone()).collect();
    let mut kinematics = ForwardKinematics::new(steps.robot.model());
    let mut numbers = Vec::new();
    for q in steps.q.chunks_exact(steps.width()) {
        let placed = kinematics.place(q).unwrap();
        for drive in &points {
            let frame = steps.robot.model().frame(&drive.frame).unwrap();
            numbers.extend(placed[frame.index()].apply(drive.offset).to_array());
        }
    }
    let capture = Capture::new(names, &numbers, RATE).unwrap();
    let scorer = MotionScorer::of_subject(&steps.robot, &capture, &steps.map, UpAxis::Z).unwrap();
    let score = scorer.score(&steps.q, RATE).unwrap();
    assert!(score.limbs.len() >= 8 && score.ends.len() == 4);
    assert!(
        score.limbs.iter().all(|limb| limb.angle.max < 1e-5),
        "{:?}",
        score.limbs
    );
    assert!(
        score.ends.iter().all(|end| end.error.max < 1e-9),
        "{:?}",
        score.ends
    );
    let subject = score.jerk.subject_ends.unwrap();
    assert!((subject.mean - score.jerk.ends.mean).abs() < 1e-6 * subject.mean);
    // Half as large, and half the frames: the figures of the remaining frames do not change.
    let half: Vec<f64> = numbers.iter().map(|number| 0.5 * number).collect();
    let half = &half[..half.len() / 2 / (3 * points.len()) * 3 * points.len()];
    let names = points.iter().map(|drive| drive.joint.clone()).collect();
    let capture = Capture::new(names, half, RATE).unwrap();
    let scorer = MotionScorer::of_subject(&steps.robot, &capture, &steps.map, UpAxis::Z).unwrap();
    let score = scorer.score(&steps.q, RATE).unwrap();
    assert!(score.limbs.iter().all(|limb| limb.angle.max < 1e-5));
    assert!(
        score.ends.iter().all(|end| end.error.max < 1e-3),
        "{:?}",
        score.ends
    );
}

#[test]
fn spoiled_motions_have_larger_totals() {
    let steps = steps();
    let good = steps.score(&steps.q);
    let mut random = Random::new(7);
    let spoiled = [
        // The robot slides sideways by 0.1 m/s.
        (
            "sliding",
            steps.changed(|frame, q| q[1] += 0.1 * frame as f64 / RATE),
        ),
        (
            "jerk",
            steps.changed(|_, q| {
                for angle in &mut q[BASE..] {
                    *angle += random.within(-0.03, 0.03);
                }
            }),
        ),
        ("limbs", shifted(&steps, 20)),
        (
            "limbs",
            steps.changed(|_, q| {
                for angle in &mut q[BASE..] {
                    *angle *= 0.5;
                }
            }),
        ),
        ("penetration", steps.changed(|_, q| q[2] -= 0.02)),
        (
            "limits",
            steps.changed(|frame, q| {
                if frame == 90 {
                    q[BASE] += 2.0 * PI;
                }
            }),
        ),
    ];
    for (term, q) in spoiled {
        let score = steps.score(&q);
        assert!(
            score.total > good.total,
            "{term}: {} {}",
            score.total,
            good.total
        );
        assert!(value(&score, term) > value(&good, term), "{term}");
    }
}

/// The motion without its first frames, which end it a second time.
fn shifted(steps: &Steps, frames: usize) -> Vec<f64> {
    let mut q = steps.q[frames * steps.width()..].to_vec();
    let last = q[q.len() - steps.width()..].to_vec();
    q.extend(last.repeat(frames));
    q
}

#[test]
fn start_undoes_a_shift_in_time() {
    let steps = steps();
    let late = &steps.q[20 * steps.width()..];
    let scorer = steps.scorer().with_start(20.0 / RATE);
    let (late, good) = (scorer.score(late, RATE).unwrap(), steps.score(&steps.q));
    assert!((value(&late, "limbs") - value(&good, "limbs")).abs() < 0.2);
    steps
        .scorer()
        .with_start(7.0)
        .score(&steps.q, RATE)
        .says("the capture ends at 6");
}

#[test]
fn quarter_turns_of_the_world_are_found() {
    let steps = steps();
    let (s, c) = (0.25 * PI).sin_cos();
    let q = steps.changed(|_, q| {
        // A rotation by 90° about z: (x, y) is (-y, x), and the quaternion is multiplied from the left.
        (q[0], q[1]) = (-q[1], q[0]);
        let (w, x, y, z) = (q[3], q[4], q[5], q[6]);
        (q[3], q[4], q[5], q[6]) = (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w);
    });
    let (good, found) = (steps.score(&steps.q), steps.score(&q));
    assert_eq!((good.heading, found.heading), (0.0, FRAC_PI_2.to_degrees()));
    assert!(
        (found.total - good.total).abs() < 1e-6,
        "{} {}",
        found.total,
        good.total
    );
    let fixed = steps
        .scorer()
        .with_heading(Heading::Fixed(0.0))
        .score(&q, RATE)
        .unwrap();
    assert!(value(&fixed, "limbs") > value(&good, "limbs") + 10.0);
}

#[test]
fn figures_without_subject_need_none() {
    let steps = steps();
    let score = MotionScorer::new(&steps.robot)
        .score(&steps.q, RATE)
        .unwrap();
    assert!(score.limbs.is_empty() && score.ends.is_empty());
    let names: Vec<&str> = score.terms.iter().map(|term| &*term.name).collect();
    assert_eq!(names, ["sliding", "penetration", "jerk", "limits"]);
    assert!(!score.feet.unwrap().of_subject);
    // Jerk of one joint: a cubic 10 t³ has the jerk 60 rad/s³ everywhere.
    let mut q = Vec::new();
    for frame in 0..20 {
        let time = f64::from(frame) / RATE;
        let mut row = steps.robot.neutral();
        row[BASE] = 10.0 * time.powi(3);
        q.extend(row);
    }
    let jerk = MotionScorer::new(&steps.robot)
        .score(&q, RATE)
        .unwrap()
        .jerk;
    assert!((jerk.joints.max - 60.0).abs() < 1e-6, "{jerk:?}");
}

#[test]
fn reports_of_retargeting_have_the_score() {
    let steps = steps();
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let retargeting = Retargeting::new(&steps.robot, &steps.map, &steps.capture, options).unwrap();
    let found = retargeting.per_frame().unwrap();
    let score = steps.scorer().with_heading(Heading::Fixed(0.0));
    assert_eq!(found.report.score, score.score(&found.q, RATE).unwrap());
}

#[test]
fn weights_and_motions_are_checked() {
    let steps = steps();
    let mut weights = ScoreWeights::default();
    weights.set("limb", 1.0).says("did you mean `limbs`");
    weights.set("jerk", -1.0).says("option jerk is -1");
    weights.set("jerk", 0.0).unwrap();
    let score = steps
        .scorer()
        .with_weights(weights)
        .score(&steps.q, RATE)
        .unwrap();
    let sum: f64 = score
        .terms
        .iter()
        .map(|term| term.value * term.weight)
        .sum();
    assert!((score.total - sum).abs() < 1e-9);
    let jerk = score.terms.iter().find(|term| term.name == "jerk").unwrap();
    assert_eq!(jerk.points, 0.0);
    steps
        .scorer()
        .score(&steps.q[1..], RATE)
        .says("expected a multiple of");
    steps
        .scorer()
        .score(&[], RATE)
        .says("at least one configuration");
    steps.scorer().score(&steps.q, 0.0).says("frames a second");
}
