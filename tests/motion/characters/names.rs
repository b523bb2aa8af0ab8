//! Promise: the parts of a skeleton are found under the names of all conventions, as source and as target.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetError};

use super::person::{Person, RATE, dance, dance_root, figure_of, skeleton_names};

/// Parts of the body, with those of the shared skeleton.
const PARTS: [&str; 17] = [
    "hips", "chest", "head", "Lth", "Lsh", "Lf", "Lt", "Lua", "Lfa", "Lh", "Rth", "Rsh", "Rf",
    "Rt", "Rua", "Rfa", "Rh",
];

fn capture(person: &Person) -> Capture {
    let clip = person.clip(&dance, &dance_root);
    Capture::of_clip(&person.armature(), &clip, RATE).unwrap()
}

/// Pairs of joint and frame that a map drives.
fn drives(map: &BodyMap) -> Vec<(String, String)> {
    let drives = map.drives.iter();
    drives
        .map(|drive| (drive.joint.clone(), drive.frame.clone()))
        .collect()
}

#[test]
fn conventions_are_recognised_as_source_and_target() {
    let reference = "SMPL";
    for convention in skeleton_names().conventions.keys() {
        for (source, target) in [
            (convention.as_str(), reference),
            (reference, convention.as_str()),
        ] {
            let (source_person, target_person) = (Person::named(source), Person::named(target));
            let figure = figure_of(&target_person);
            let guess = BodyMap::guess(&capture(&source_person), figure.robot().model()).unwrap();
            let found = drives(&guess.map);
            for part in PARTS {
                let names = [&source_person, &target_person]
                    .map(|person| person.bones[person.index(part)].name.clone());
                let [joint, frame] = names;
                assert!(
                    found.contains(&(joint.clone(), frame.clone())),
                    "{source} to {target}: {joint} to {frame} of {found:?}"
                );
            }
            assert_eq!(guess.notes, [""; 0], "{source} to {target}");
        }
    }
}

/// Structure alone: names without meaning.
#[test]
fn parts_are_found_without_names() {
    let person = Person::named("Mixamo");
    let mut nameless = person.clone();
    for (index, bone) in nameless.bones.iter_mut().enumerate() {
        bone.name = format!("x{index}q");
    }
    let figure = figure_of(&nameless);
    let guess = BodyMap::guess(&capture(&person), figure.robot().model()).unwrap();
    let found = drives(&guess.map);
    for part in PARTS {
        let (joint, frame) = (
            person.bones[person.index(part)].name.clone(),
            nameless.bones[nameless.index(part)].name.clone(),
        );
        assert!(
            found.contains(&(joint.clone(), frame)),
            "{joint}: {found:?}"
        );
    }
}

#[test]
fn incomplete_body_is_an_error_that_lists_parts() {
    let person = Person::named("Mixamo");
    let mut without_arm = person.clone();
    without_arm
        .bones
        .retain(|bone| !["Lua", "Lfa", "Lh"].contains(&bone.part.as_str()));
    for index in 0..without_arm.bones.len() {
        let parent = person.bones[person.index(&without_arm.bones[index].part)].parent;
        let parent = parent.map(|parent| person.bones[parent].part.clone());
        without_arm.bones[index].parent = parent.map(|part| without_arm.index(&part));
    }
    let figure = figure_of(&without_arm);
    let error = BodyMap::guess(&capture(&person), figure.robot().model()).unwrap_err();
    assert!(
        matches!(error, RetargetError::IncompleteBody { .. }),
        "{error}"
    );
    let message = error.to_string();
    for words in ["left_elbow, left_hand", "pelvis = `mixamorig:Hips`"] {
        assert!(message.contains(words), "{message}");
    }
}

/// Bones by a table of human bones, for a target whose names and tree mean nothing.
#[test]
fn table_of_human_bones_is_used() {
    let person = Person::named("Mixamo");
    let source = capture(&person);
    let target = Person::named("Unity/Godot humanoid");
    let mut nameless = target.clone();
    for (index, bone) in nameless.bones.iter_mut().enumerate() {
        bone.name = format!("x{index}q");
    }
    let figure = figure_of(&nameless);
    let named = target.bones.iter().zip(&nameless.bones);
    // Left and right exchanged, so that the table differs from the tree.
    let table = named.map(|(human, bone)| {
        let exchanged = match human.name.strip_prefix("Left") {
            Some(rest) => format!("Right{rest}"),
            None => human.name.replacen("Right", "Left", 1),
        };
        format!("\"{exchanged}\": \"{}\"", bone.name)
    });
    let table: Vec<String> = table.collect();
    let text = format!("{{\"human_bones\": {{{}}}}}", table.join(", "));
    let map = BodyMap::from_json(&text, "").unwrap();
    let guess = map.completed(&source, figure.robot().model()).unwrap();
    let left_hand = person.bones[person.index("Lh")].name.clone();
    let right_bone = nameless.bones[nameless.index("Rh")].name.clone();
    assert!(drives(&guess.map).contains(&(left_hand, right_bone)));
    // A completed map has drives in place of the table, and is read again.
    let again = BodyMap::from_json(&guess.map.to_json(), "").unwrap();
    assert_eq!(again, guess.map);
}
