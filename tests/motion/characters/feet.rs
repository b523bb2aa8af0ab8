//! Promise: feet of a character have the scaled places of the subject's feet, and stay where they are in contact.

use glam::{DQuat, DVec3};
use kinopt::model::Limits;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetOptions, RetargetReport, Retargeting, UpAxis,
};
use kinopt::skeleton::{Bone, Skeleton};

use super::person::{
    FRAMES, Person, RATE, dance, dance_root, direction_errors, figure_of, placements, retarget,
    retarget_capture,
};

fn per_frame(fitted: &Retargeting<'_>) -> Trajectory<RetargetReport> {
    fitted.per_frame().unwrap()
}

/// A squat: feet at one place, hips up and down. Thigh and shin are equally long, so the ankle stays below the hip.
fn squat(part: &str, frame: usize) -> DQuat {
    let bend = 30.0 - 25.0 * (0.15 * frame as f64).cos();
    let angle = match part {
        "Lth" | "Rth" => -bend,
        "Lsh" | "Rsh" => bend,
        _ => 0.0,
    };
    DQuat::from_axis_angle(DVec3::X, angle.to_radians())
}

/// Height of the hips that keeps the ankles of a squat at their height.
fn squat_root(frame: usize) -> DVec3 {
    let person = Person::named("Mixamo");
    let [hip, knee, ankle] =
        ["Lth", "Lsh", "Lf"].map(|part| person.bones[person.index(part)].position);
    let bent = squat("Lth", frame) * (knee - hip) + squat("Lsh", frame) * (ankle - knee);
    (ankle - hip) - bent
}

/// Angles of a run, radians: phase of a leg, of 24 frames.
fn run_phase(side: f64, frame: usize) -> f64 {
    std::f64::consts::TAU * frame as f64 / 24.0 + side
}

/// A run on the spot: each leg is straight in contact, then swings with a bent knee.
fn run(part: &str, frame: usize) -> DQuat {
    let side = if part.starts_with('R') {
        std::f64::consts::PI
    } else {
        0.0
    };
    // Legs swing in the upper half of their phase.
    let swing = run_phase(side, frame).sin().max(0.0);
    let angle = match part {
        "Lth" | "Rth" => -50.0 * swing,
        "Lsh" | "Rsh" => 70.0 * swing,
        _ => 0.0,
    };
    DQuat::from_axis_angle(DVec3::X, angle.to_radians())
}

fn run_root(_: usize) -> DVec3 {
    DVec3::ZERO
}

/// Another body: longer shins, wider hips and longer arms.
fn other_body() -> Person {
    let wide = Person::named("UE4")
        .with_segment("Lth", 1.5)
        .with_segment("Rth", 1.5);
    let legs = wide.with_segment("Lf", 1.2).with_segment("Rf", 1.2);
    legs.with_segment("Lfa", 0.8).with_segment("Rfa", 0.8)
}

#[test]
fn feet_in_contact_stay_at_their_places() {
    let source = Person::named("Mixamo");
    let clip = source.clip(&squat, &squat_root);
    let target = other_body();
    for solve in [per_frame, |fitted: &Retargeting<'_>| {
        fitted.whole().unwrap()
    }] {
        let found = retarget(&source, &clip, &target, solve);
        let report = &found.motion.report;
        assert!(
            report.contacts.iter().all(|contact| *contact),
            "{:?}",
            report.lost_contacts
        );
        assert!(report.slip < 1e-3, "{}", report.slip);
        for part in ["Lf", "Rf"] {
            let places: Vec<DVec3> = found
                .placed
                .iter()
                .map(|placed| placed[target.index(part)].1)
                .collect();
            let moved = places.iter().map(|place| place.distance(places[0]));
            assert!(moved.fold(0.0, f64::max) < 1e-3, "{part}");
        }
    }
}

#[test]
fn knees_keep_the_bend_plane_of_the_subject() {
    let source = Person::named("Mixamo");
    let clip = source.clip(&squat, &squat_root);
    let target = other_body();
    let found = retarget(&source, &clip, &target, per_frame);
    for placed in &found.placed {
        let at = |part: &str| placed[target.index(part)].1;
        for [hip, knee, ankle] in [["Lth", "Lsh", "Lf"], ["Rth", "Rsh", "Rf"]] {
            let along = (at(ankle) - at(hip)).normalize();
            let knee = at(knee) - at(hip);
            let bent = knee - along * knee.dot(along);
            assert!(bent.length() < 1e-3 || bent.normalize().z > 0.9, "{bent}");
        }
    }
}

/// Thighs of three quarters of their length: a deeply bent free leg keeps its directions, not the place of its foot.
#[test]
fn short_thighs_keep_directions_of_bent_legs() {
    let source = Person::named("Mixamo");
    let shortened = |person: Person| {
        let left = person.with_segment("Lsh", 0.75);
        left.with_segment("Rsh", 0.75)
    };
    let target = shortened(Person::named("UE4"));
    let clip = source.clip(&run, &run_root);
    let subject = placements(&source.armature(), &clip);
    let found = retarget(&source, &clip, &target, per_frame);
    for (part, mean, largest) in direction_errors((&source, &subject), (&target, &found.placed)) {
        assert!(mean < 3.0, "{part}: {mean} in the mean, {largest} at most");
    }
    let report = &found.motion.report;
    assert_eq!(report.lost_contacts, []);
}

#[test]
fn other_body_keeps_directions_and_does_not_jump() {
    let source = Person::named("Mixamo");
    let clip = source.clip(&dance, &dance_root);
    let subject = placements(&source.armature(), &clip);
    let target = other_body();
    let found = retarget(&source, &clip, &target, per_frame);
    for (part, mean, _) in direction_errors((&source, &subject), (&target, &found.placed)) {
        assert!(mean < 5.0, "{part}: {mean}");
    }
    let largest_step = |placed: &[Vec<(DQuat, DVec3)>]| {
        let steps = placed.windows(2).flat_map(|pair| {
            let bones = pair[0].iter().zip(&pair[1]);
            bones.map(|((a, _), (b, _))| {
                let step = (a.conjugate() * *b).normalize();
                2.0 * step.xyz().length().atan2(step.w.abs())
            })
        });
        steps.fold(0.0, f64::max)
    };
    let (source_step, step) = (largest_step(&subject), largest_step(&found.placed));
    // Feet of the dance slide, and blend to and from contacts.
    assert!(step < 2.5 * source_step, "{step} {source_step}");
}

/// Bones with limits: three angles of each bone, in the axes of the bone at rest.
#[test]
fn limits_of_the_character_hold() {
    let person = Person::named("UE4");
    let armature = person.armature();
    let skeleton = armature
        .turning_skeleton("limited", &armature.bone_ids().collect())
        .unwrap();
    let limited = |bone: &Bone| Bone {
        limits: [
            Limits::new(-0.3, 0.3),
            Limits::new(-0.4, 0.4),
            Limits::new(-0.3, 0.3),
        ],
        ..bone.clone()
    };
    let bones = skeleton.bones().iter().map(limited).collect();
    let limited_skeleton = Skeleton::new("limited", bones).unwrap();
    let figure = FigureTarget::new(&limited_skeleton, UpAxis::Y).unwrap();
    let source = Person::named("Mixamo");
    let capture = capture_of(&source);
    let model = figure.robot().model();
    let map = BodyMap::guess(&capture, model).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::onto_character(&figure, &map, &capture, options).unwrap();
    let motion = fitted.per_frame().unwrap();
    assert!(motion.rows().all(|q| model.is_within_limits(q)));
    assert!(!fitted.active_limits(&motion).is_empty());
}

fn capture_of(person: &Person) -> Capture {
    let clip = person.clip(&dance, &dance_root);
    Capture::of_clip(&person.armature(), &clip, RATE).unwrap()
}

/// A capture of positions only: rotations follow from limb directions and bend planes.
#[test]
fn positions_determine_directions() {
    let source = Person::named("Mixamo");
    let clip = source.clip(&dance, &dance_root);
    let subject = placements(&source.armature(), &clip);
    let posed = capture_of(&source);
    let numbers: Vec<f64> = (0..FRAMES)
        .flat_map(|frame| {
            posed
                .frame(frame)
                .unwrap()
                .iter()
                .flat_map(|at| at.to_array())
        })
        .collect();
    let positions = Capture::new(posed.names().to_vec(), &numbers, RATE).unwrap();
    assert!(posed.has_rotations() && !positions.has_rotations());
    let target = Person::named("VRoid").in_a_pose(40.0);
    let found = retarget_capture(&positions, &target, per_frame);
    for (part, mean, _) in direction_errors((&source, &subject), (&target, &found.placed)) {
        let tolerance = if part == "head" || part == "neck" {
            12.0
        } else {
            5.0
        };
        assert!(mean < tolerance, "{part}: {mean}");
    }
}

/// Online, each frame with its rotations gives the recorded result of the own skeleton.
#[test]
fn online_frames_equal_the_recorded_motion() {
    let person = Person::named("Mixamo");
    let capture = capture_of(&person);
    let figure = figure_of(&person);
    let map = BodyMap::guess(&capture, figure.robot().model())
        .unwrap()
        .map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::onto_character(&figure, &map, &capture, options).unwrap();
    let recorded = fitted.per_frame().unwrap();
    let rotations = capture.rotations().unwrap().rotations;
    let joints = capture.names().len();
    let mut live = fitted.live().unwrap();
    for (frame, expected) in recorded.rows().enumerate() {
        let of_frame = &rotations[frame * joints..(frame + 1) * joints];
        let q = live
            .step_with_rotations(capture.frame(frame).unwrap(), of_frame)
            .unwrap();
        let difference = q.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(difference.fold(0.0, f64::max) < 1e-9, "frame {frame}");
    }
    assert!(
        live.step_with_rotations(capture.frame(0).unwrap(), &[])
            .is_err()
    );
    // Positions alone: the character stays near the subject.
    let mut live = fitted.live().unwrap();
    let q = live.step(capture.frame(0).unwrap()).unwrap();
    assert!((q[0] - recorded.q[0]).abs() < 0.05 && (q[2] - recorded.q[2]).abs() < 0.05);
}
