//! Promise: bones keep the rotations of the subject relative to the aligned rest pose.

use glam::{DQuat, DVec3};
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{RetargetReport, Retargeting};
use support::random::Random;

use super::person::{
    Person, dance, dance_root, direction_errors, largest_rotation_error, placements, retarget,
    skeleton_names,
};

fn per_frame(fitted: &Retargeting<'_>) -> Trajectory<RetargetReport> {
    fitted.per_frame().unwrap()
}

/// Largest mean error of the directions of a dance on a target, in degrees.
fn dance_errors(target: &Person) -> Vec<(&'static str, f64, f64)> {
    let source = Person::named("Mixamo");
    let clip = source.clip(&dance, &dance_root);
    let subject = placements(&source.armature(), &clip);
    let found = retarget(&source, &clip, target, per_frame);
    direction_errors((&source, &subject), (target, &found.placed))
}

fn assert_directions(target: &Person, tolerance: f64, what: &str) {
    for (part, mean, largest) in dance_errors(target) {
        assert!(
            mean < tolerance,
            "{what}: {part} {mean:.3} deg in the mean, {largest:.3} at most"
        );
    }
}

#[test]
fn own_skeleton_gets_the_identity() {
    for unit in [1.0, 100.0] {
        let person = Person::named("Mixamo").scaled(unit);
        let clip = person.clip(&dance, &|frame| dance_root(frame) * unit);
        let subject = placements(&person.armature(), &clip);
        for solve in [per_frame, |fitted: &Retargeting<'_>| {
            fitted.whole().unwrap()
        }] {
            let found = retarget(&person, &clip, &person, solve);
            let (angle, bone) = largest_rotation_error(&subject, &found.placed);
            assert!(
                angle < 1e-3,
                "unit {unit}: {} {angle} deg",
                person.bones[bone].name
            );
            let error = found.target_error;
            assert!(error < 1e-4 * unit, "unit {unit}: {error}");
        }
    }
}

#[test]
fn other_names_get_the_identity() {
    let source = Person::named("Mixamo");
    for convention in skeleton_names().conventions.keys() {
        // One bone of the spine less is no identity.
        let target = Person::named(convention);
        let is_complete = target.bones.len() == source.bones.len();
        assert_directions(&target, if is_complete { 1e-3 } else { 1.0 }, convention);
    }
}

#[test]
fn a_pose_and_t_pose_get_equal_directions() {
    let a_pose = Person::named("UE4").in_a_pose(45.0);
    assert_directions(&a_pose, 0.5, "A-pose");
    let source = a_pose.clone();
    let clip = source.clip(&dance, &dance_root);
    let subject = placements(&source.armature(), &clip);
    let target = Person::named("VRoid");
    let found = retarget(&source, &clip, &target, per_frame);
    for (part, mean, _) in direction_errors((&source, &subject), (&target, &found.placed)) {
        assert!(mean < 0.5, "{part}: {mean}");
    }
}

/// Axes of bones do not change the motion.
#[test]
fn rolled_bones_get_equal_directions() {
    let mut random = Random::new(7);
    for _ in 0..5 {
        let rolled = Person::named("Rigify DEF").rolled(&mut random);
        assert_directions(&rolled, 1e-2, "rolled");
    }
}

#[test]
fn spines_of_any_count_get_the_direction_of_the_trunk() {
    for count in [0, 1, 3, 5, 6] {
        let target = Person::named("UE4").with_spine(count);
        // Without bones the trunk is rigid with the hips.
        let tolerance = if count == 0 { 20.0 } else { 3.0 };
        assert_directions(&target, tolerance, &format!("{count} spine bones"));
        // The bend is spread: no bone of a long spine bends more than two thirds of it.
        if count < 3 {
            continue;
        }
        let source = Person::named("Mixamo");
        let clip = source.clip(&dance, &dance_root);
        let found = retarget(&source, &clip, &target, per_frame);
        let spine: Vec<usize> = std::iter::once(target.index("hips"))
            .chain((0..target.bones.len()).filter(|bone| target.bones[*bone].part == "spine"))
            .chain([target.index("chest")])
            .collect();
        for placed in &found.placed {
            let angle = |a: usize, b: usize| {
                let q = (placed[a].0.conjugate() * placed[b].0).normalize();
                2.0 * q.xyz().length().atan2(q.w.abs())
            };
            let whole = angle(spine[0], spine[spine.len() - 1]);
            for pair in spine.windows(2) {
                let part = angle(pair[0], pair[1]);
                assert!(part < 0.67 * whole + 0.03, "{count}: {part} of {whole}");
            }
        }
    }
}

type Direction<'a> = &'a dyn Fn(&Person, &[(DQuat, DVec3)]) -> DVec3;

/// Joints of the pelvis lie elsewhere in each skeleton: CMU's is 6 cm behind the hips.
#[test]
fn trunk_and_neck_have_directions_between_limbs() {
    let source = Person::named("Mixamo").with_legs_moved(DVec3::Z * 0.06);
    let clip = source.clip(&dance, &dance_root);
    let subject = placements(&source.armature(), &clip);
    let target = Person::named("UE4").with_spine(3);
    let found = retarget(&source, &clip, &target, per_frame);
    let trunk = |person: &Person, placed: &[(DQuat, DVec3)]| {
        let middle = |a, b| placed[person.index(a)].1 + placed[person.index(b)].1;
        (middle("Lua", "Rua") - middle("Lth", "Rth")).normalize()
    };
    let neck = |person: &Person, placed: &[(DQuat, DVec3)]| {
        let shoulders = placed[person.index("Lua")].1 + placed[person.index("Rua")].1;
        (placed[person.index("head")].1 - 0.5 * shoulders).normalize()
    };
    for (frame, (from, to)) in subject.iter().zip(&found.placed).enumerate() {
        for (part, direction) in [("trunk", &trunk as Direction<'_>), ("neck", &neck)] {
            let angle = direction(&source, from).angle_between(direction(&target, to));
            assert!(angle.to_degrees() < 0.5, "{part}, frame {frame}: {angle}");
        }
    }
}

#[test]
fn twist_bones_share_the_twist_of_the_hand() {
    let source = Person::named("Mixamo");
    // The left hand rolls about the forearm, which is along x at rest.
    let roll = |part: &str, frame: usize| {
        let angle = if part == "Lh" {
            0.02 * frame as f64
        } else {
            0.0
        };
        DQuat::from_axis_angle(DVec3::X, angle)
    };
    let clip = source.clip(&roll, &|_| DVec3::ZERO);
    for in_line in [true, false] {
        let target = Person::named("UE4");
        let target = target.with_twist_bone("lowerarm_twist_01_l", "Lfa", "Lh", in_line);
        let found = retarget(&source, &clip, &target, per_frame);
        let twist = target.index("Lfa twist");
        for (frame, placed) in found.placed.iter().enumerate() {
            let expected = 0.5 * 0.02 * frame as f64;
            let about_x = 2.0 * placed[twist].0.x.atan2(placed[twist].0.w);
            assert!(
                (about_x - expected).abs() < 1e-3,
                "{in_line} {frame}: {about_x} {expected}"
            );
        }
    }
}
