//! Promise: dragged characters bend knees and elbows anatomically, and stay balanced on their feet.

use kinopt::Skeleton;
use kinopt::io::rig::Rig;
use kinopt::model::Limits;
use kinopt::motion::posing::{HingeSource, StandingDrag, guess_hinges};
use kinopt::skeleton::{Bone, BoneId};
use kinopt::spatial::{Matrix3, Placement, Vector3};

/// Bones of a human in metres, y up, facing z, its left at positive x: name, parent, position at rest.
/// Knees are forward and elbows backward, so that limbs have a bend of some degrees.
fn human(degrees: f64) -> Vec<(String, Option<usize>, [f64; 3])> {
    let [knee_bend, elbow_bend] =
        [[0.45, 0.42], [0.28, 0.26]].map(|segments| offset(degrees, segments));
    let mut bones = vec![
        ("Hips".to_owned(), None, [0.0, 1.0, 0.0]),
        ("Spine".to_owned(), Some(0), [0.0, 1.1, 0.0]),
        ("Chest".to_owned(), Some(1), [0.0, 1.3, 0.0]),
        ("Head".to_owned(), Some(2), [0.0, 1.55, 0.0]),
        // A tail and a lip: bones that no drag should pin.
        ("Tail1".to_owned(), Some(0), [0.0, 0.95, -0.15]),
        ("Tail2".to_owned(), Some(4), [0.0, 0.9, -0.4]),
        ("Tail3".to_owned(), Some(5), [0.0, 0.85, -0.7]),
        ("Lip".to_owned(), Some(3), [0.0, 1.55, 0.1]),
    ];
    for (side, sign) in [("Left", 1.0), ("Right", -1.0)] {
        let mut add = |name: &str, parent: usize, at: [f64; 3]| {
            bones.push((
                format!("{side}{name}"),
                Some(parent),
                [sign * at[0], at[1], at[2]],
            ));
            bones.len() - 1
        };
        let hip = add("UpLeg", 0, [0.1, 0.95, 0.0]);
        let knee = add("Leg", hip, [0.1, 0.5, knee_bend]);
        let ankle = add("Foot", knee, [0.1, 0.08, 0.0]);
        add("ToeBase", ankle, [0.1, 0.0, 0.15]);
        let clavicle = add("Shoulder", 2, [0.05, 1.4, 0.0]);
        let shoulder = add("Arm", clavicle, [0.18, 1.42, 0.0]);
        let elbow = add("ForeArm", shoulder, [0.46, 1.42, -elbow_bend]);
        add("Hand", elbow, [0.72, 1.42, 0.0]);
    }
    bones
}

/// Rotations of the bones' axes: no hinge axis is parallel to a bone's axis.
fn axes(index: usize) -> Matrix3<f64> {
    let angle = 0.7 * index as f64;
    let (s, c) = (angle.sin(), angle.cos());
    Matrix3::from_columns(
        Vector3::new(c, s, 0.0),
        Vector3::new(-s, c, 0.0),
        Vector3::new(0.0, 0.0, 1.0),
    )
}

fn skeleton(degrees: f64) -> Skeleton {
    let mut builder = Skeleton::builder("human");
    let mut ids: Vec<BoneId> = Vec::new();
    for (index, (name, parent, at)) in human(degrees).into_iter().enumerate() {
        ids.push(builder.add(Bone {
            name,
            parent: parent.map(|parent| ids[parent]),
            length: 0.0,
            model_from_rest: Placement::new(axes(index), Vector3::from(at)),
            limits: [Limits::UNBOUNDED; 3],
        }));
    }
    builder.build().unwrap()
}

/// Offset of the middle joint of two segments, metres, for a bend of some degrees.
fn offset(degrees: f64, [upper, lower]: [f64; 2]) -> f64 {
    degrees.to_radians() / (1.0 / upper + 1.0 / lower)
}

/// Position of a bone in the drag's configuration.
fn at(drag: &StandingDrag, bone: &str) -> Vector3<f64> {
    let skeleton = drag.skeleton();
    let pose = skeleton.pose(drag.drag().q()).unwrap();
    pose.tail(skeleton.bone(bone).unwrap()).unwrap()
}

/// Distance of a middle joint from the line between both ends, along `direction` of the model, metres.
fn bulge(drag: &StandingDrag, [upper, middle, end]: [&str; 3], direction: [f64; 3]) -> f64 {
    let [a, b, c] = [upper, middle, end].map(|bone| at(drag, bone));
    let along = (c - a) * (1.0 / (c - a).norm());
    let out = (b - a) - along * (b - a).dot(along);
    out.dot(Vector3::from(direction))
}

/// Targets of drags: bone and offset from rest.
const DRAGS: [(&str, [f64; 3]); 10] = [
    ("LeftHand", [-0.3, -0.3, 0.3]),
    ("RightHand", [0.2, -0.6, 0.3]),
    ("LeftHand", [-0.2, 0.3, 0.2]),
    ("RightHand", [0.4, 0.1, 0.35]),
    ("LeftFoot", [0.05, 0.3, 0.2]),
    ("RightFoot", [0.0, 0.15, -0.25]),
    ("Hips", [0.0, -0.25, 0.0]),
    ("Hips", [0.08, -0.1, 0.0]),
    ("Head", [0.0, -0.3, 0.1]),
    ("LeftHand", [-0.4, -0.9, 1.5]),
];

#[test]
fn knees_and_elbows_bend_anatomically() {
    for degrees in [0.0, 2.0, 20.0] {
        let skeleton = skeleton(degrees);
        for (bone, move_by) in DRAGS {
            let mut drag = StandingDrag::builder(&skeleton)
                .dragged([bone])
                .build()
                .unwrap();
            let start = at(&drag, bone);
            drag.set_target(bone, start + Vector3::from(move_by))
                .unwrap();
            drag.settle(80);
            let case = format!(
                "{degrees}°, {bone} {move_by:?}: {}",
                drag.drag().solution().explain()
            );
            for side in ["Left", "Right"] {
                let named = |part: &str| format!("{side}{part}");
                let [hip, knee, ankle] = ["UpLeg", "Leg", "Foot"].map(named);
                let leg = bulge(&drag, [&hip, &knee, &ankle], [0.0, 0.0, 1.0]);
                assert!(leg > -1e-4, "{case}: {knee} {leg}");
            }
            assert!(
                drag.balance_margin() > -1e-4,
                "{case}: {}",
                drag.balance_margin()
            );
            for foot in drag.feet() {
                let name = &skeleton.bones()[foot.index()].name;
                let moved = (at(&drag, name) - skeleton.bones()[foot.index()].rest_tail()).norm();
                assert!(moved < 1e-4, "{case}: {name} moved by {moved}");
            }
        }
    }
}

#[test]
fn reachable_targets_of_straight_limbs_are_reached() {
    let skeleton = skeleton(0.0);
    for (bone, move_by) in &DRAGS[..8] {
        let mut drag = StandingDrag::builder(&skeleton)
            .dragged([*bone])
            .build()
            .unwrap();
        let target = at(&drag, bone) + Vector3::from(*move_by);
        drag.set_target(bone, target).unwrap();
        let solution = drag.settle(300);
        assert!(
            solution.reached,
            "{bone} {move_by:?}: {}",
            solution.explain()
        );
    }
}

#[test]
fn hinges_are_mirrored_and_perpendicular_to_limbs() {
    for degrees in [0.0, 2.0, 30.0] {
        let skeleton = skeleton(degrees);
        let guesses = guess_hinges(&skeleton);
        assert_eq!(guesses.len(), 4);
        for guess in &guesses {
            let expected = match degrees {
                0.0 => HingeSource::BodyDirection,
                2.0 => HingeSource::Both,
                _ => HingeSource::RestBend,
            };
            assert_eq!(guess.source, expected, "{}", guess.bone);
            let bone = &skeleton.bones()[skeleton.bone(&guess.bone).unwrap().index()];
            let axis = bone.model_from_rest.apply(guess.hinge.axis) - bone.rest_tail();
            // Knees rotate about x, elbows about y.
            let (axis, sign) = match guess.bone.contains("Leg") {
                true => (axis.x, 1.0),
                false => (
                    axis.y,
                    if guess.bone.contains("Left") {
                        -1.0
                    } else {
                        1.0
                    },
                ),
            };
            assert!((axis - sign).abs() < 1e-9, "{} {axis}", guess.bone);
            assert!((guess.rest_bend.to_degrees() - degrees).abs() < 0.1 * degrees + 1e-6);
        }
    }
}

#[test]
fn hinges_are_editable() {
    let skeleton = skeleton(0.0);
    let guesses = guess_hinges(&skeleton);
    let mut hinges: kinopt::skeleton::Hinges = guesses
        .into_iter()
        .map(|guess| (guess.bone, guess.hinge))
        .collect();
    hinges.remove("LeftForeArm");
    hinges.get_mut("LeftLeg").unwrap().limits = Limits::new(0.0, 0.2);
    let drag = StandingDrag::builder(&skeleton)
        .with_hinges(hinges.clone())
        .dragged(["Hips"])
        .build()
        .unwrap();
    assert_eq!(drag.skeleton().skeleton().hinges(), hinges);
    let error = skeleton.with_hinges(&[("Knee".to_owned(), hinges["LeftLeg"])].into());
    assert!(error.unwrap_err().to_string().contains("Knee"));
    hinges.get_mut("LeftLeg").unwrap().axis = Vector3::zero();
    let error = skeleton.with_hinges(&hinges).unwrap_err().to_string();
    assert!(
        error.contains("LeftLeg") && error.contains("axis"),
        "{error}"
    );
    // Without hinges, the bones have their own limits again.
    let hinged = skeleton.with_hinges(&Default::default()).unwrap();
    assert_eq!(hinged.bones(), skeleton.bones());
}

#[test]
fn extra_bones_are_not_held() {
    let skeleton = skeleton(3.0);
    let mut drag = StandingDrag::builder(&skeleton)
        .dragged(["Hips"])
        .build()
        .unwrap();
    let before = at(&drag, "Tail3") - at(&drag, "Hips");
    drag.set_target("Hips", [0.0, 0.8, 0.0]).unwrap();
    assert!(drag.settle(200).reached);
    let after = at(&drag, "Tail3") - at(&drag, "Hips");
    assert!((before.norm() - after.norm()).abs() < 1e-9);
    assert!((at(&drag, "Tail3").y - 0.85).abs() > 0.1);
    let holds = skeleton.holds(&[skeleton.bone("LeftHand").unwrap()]);
    let ends = holds
        .ends
        .iter()
        .map(|end| skeleton.bones()[end.index()].name.as_str());
    assert_eq!(
        ends.collect::<Vec<_>>(),
        ["LeftToeBase", "RightToeBase", "RightHand"]
    );
}

#[test]
fn shipped_humanoid_stays_on_its_feet() {
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let masses = rig.masses(1000.0).unwrap();
    for (bone, target) in [
        ("left_hand", [0.6, 0.5, 1.1]),
        ("left_hand", [0.3, 0.4, 0.6]),
        ("right_hand", [0.6, -0.2, 1.5]),
        ("pelvis", [0.0, 0.0, 0.7]),
    ] {
        let mut drag = StandingDrag::builder(&rig.skeleton)
            .with_masses(masses.points().to_vec())
            .dragged([bone])
            .build()
            .unwrap();
        assert_eq!(drag.feet().len(), 2);
        drag.set_target(bone, target).unwrap();
        drag.settle(200);
        assert!(
            drag.balance_margin() > -1e-4,
            "{bone} {}",
            drag.balance_margin()
        );
    }
}
