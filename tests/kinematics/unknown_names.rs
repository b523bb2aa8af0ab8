//! Promise: an unknown name is reported with all names if they are few, and with similar ones if they are many.

use kinopt::Model;
use kinopt::model::{FrameRef, JointRef, Limits, UnknownName};
use kinopt::spatial::{Placement, Vector3};

const BONES: [&str; 14] = [
    "hips",
    "spine",
    "chest",
    "neck",
    "head",
    "left_upper_arm",
    "left_lower_arm",
    "left_hand",
    "right_upper_arm",
    "right_lower_arm",
    "right_hand",
    "LeftFoot",
    "RightFoot",
    "tail",
];

fn unknown_bone(name: &str) -> UnknownName {
    UnknownName::new("bone", name, BONES)
}

#[test]
fn few_names_are_listed_in_full() {
    let few = UnknownName::new("joint", "c", ["a", "b"]);
    let meant = UnknownName::new("joint", "elbw", ["elbow", "shoulder"]);
    assert_eq!(
        meant.to_string(),
        "no joint named `elbw`; did you mean `elbow`? valid names: elbow, shoulder"
    );
    // Of two equally similar names none is suggested; the list is enough.
    let either = UnknownName::new("joint", "joint9", ["joint1", "joint2"]);
    assert_eq!(
        either.to_string(),
        "no joint named `joint9`; valid names: joint1, joint2"
    );
    assert_eq!(few.to_string(), "no joint named `c`; valid names: a, b");
    let noted = few.with_note("each with /tip");
    let text = "no joint named `c`; valid names: a, b (each with /tip)";
    assert_eq!(noted.to_string(), text);
    let none = UnknownName::new("clip", "c", []);
    assert_eq!(none.to_string(), "no clip named `c`; there are no names");
}

#[test]
fn similar_names_are_suggested_of_many() {
    for (typed, meant) in [
        ("lefthand", "left_hand"),
        ("left_hnad", "left_hand"),
        ("Left_Hand", "left_hand"),
        ("left_foot", "LeftFoot"),
        ("hed", "head"),
        ("hip", "hips"),
        ("mixamorig:RightFoot", "RightFoot"),
        ("upper_arm", "left_upper_arm"),
    ] {
        let unknown = unknown_bone(typed);
        assert_eq!(unknown.suggestions().first(), Some(&meant), "{typed}");
        let text = unknown.to_string();
        let start = format!("no bone named `{typed}`; did you mean `{meant}`");
        assert!(text.starts_with(&start), "{text}");
        assert!(text.ends_with("? (14 names)"), "{text}");
    }
    let either = unknown_bone("hand").to_string();
    let text = "no bone named `hand`; did you mean `left_hand` or `right_hand`? (14 names)";
    assert_eq!(either, text);
    let noted = unknown_bone("hand")
        .with_note("`kinopt info` lists all")
        .to_string();
    assert!(
        noted.ends_with("(14 names; `kinopt info` lists all)"),
        "{noted}"
    );
}

#[test]
fn first_names_are_listed_if_none_is_similar() {
    for name in ["zzzzzz", "", "q"] {
        let text = unknown_bone(name).to_string();
        let end = "; no similar name; the first are `hips`, `spine`, `chest` (14 names)";
        assert!(text.ends_with(end), "{text}");
        assert!(unknown_bone(name).suggestions().is_empty(), "{name}");
    }
}

#[test]
fn names_of_any_length_are_compared() {
    let long = "ß漢".repeat(100_000);
    let mut names = vec![long.as_str(); 13];
    names.push("end");
    let unknown = UnknownName::new("frame", &long[..3 * long.len() / 5 / 5 * 5], names);
    assert!(unknown.suggestions().len() <= 3);
}

#[test]
fn model_errors_suggest_names() {
    let mut builder = Model::builder("long");
    let mut last = None;
    for index in 1..=20 {
        let name = format!("joint{index}");
        last = Some(builder.continuous(name, last, Placement::identity(), Vector3::UNITS[2]));
    }
    let Ok(model) = builder.build() else {
        return;
    };
    let text = model.joint("Joint_7").map_err(|error| error.to_string());
    let expected = "no joint named `Joint_7`; did you mean `joint7`";
    assert!(
        matches!(&text, Err(text) if text.starts_with(expected)),
        "{text:?}"
    );
    assert!(matches!(text, Err(text) if !text.contains("joint19")));
}

/// Of names that contain the query, the shortest is suggested first.
#[test]
fn shortest_containing_name_comes_first() {
    let names = ["the left hand's thumb", "left hand"];
    let found = UnknownName::new("bone", "hand", names);
    assert_eq!(found.suggestions(), ["left hand", "the left hand's thumb"]);
}

/// A name with all words of the query is suggested, also if further words separate them.
#[test]
fn names_with_all_words_are_suggested() {
    let links = [
        "pelvis",
        "left_hip_yaw_link",
        "left_rubber_hand_link",
        "right_rubber_hand_link",
        "left_ankle_roll_link",
    ];
    for (typed, meant) in [
        ("left_hand", "left_rubber_hand_link"),
        ("RightHand", "right_rubber_hand_link"),
        ("left ankle link", "left_ankle_roll_link"),
    ] {
        let found = UnknownName::new("frame", typed, links);
        assert_eq!(found.suggestions(), [meant], "{typed}");
    }
    let joints = ["arm_joint_1", "arm_joint_2", "arm_joint_12"];
    let found = UnknownName::new("joint", "joint2", joints);
    assert_eq!(found.suggestions().first(), Some(&"arm_joint_2"));
}

/// A different single-letter name is less similar than one with an added letter.
#[test]
fn other_single_letter_is_less_similar() {
    let found = UnknownName::new("joint", "a", ["b", "ab"]);
    assert_eq!(found.suggestions(), ["ab", "b"]);
}

/// An id of a larger model is unknown, also the first index beyond the last.
#[test]
fn ids_of_larger_models_are_unknown() {
    let chain = |joints: usize| {
        let mut builder = Model::builder("chain");
        let link = Placement::translation(Vector3::UNITS[0]);
        let mut last = None;
        for k in 0..joints {
            let (axis, limits) = (Vector3::UNITS[2], Limits::new(-1.0, 1.0));
            let joint = builder.revolute(format!("joint {k}"), last, link, axis, limits);
            builder.frame(format!("link {k}"), Some(joint), link);
            last = Some(joint);
        }
        builder.build().unwrap()
    };
    let (small, large) = (chain(3), chain(5));
    for k in 0..5 {
        let frame = large.frame(&format!("link {k}")).unwrap();
        let joint = large.joint(&format!("joint {k}")).unwrap();
        let is_frame = FrameRef::Id(frame).resolve(&small).is_ok();
        let is_joint = JointRef::Id(joint).resolve(&small).is_ok();
        assert_eq!((is_frame, is_joint), (k < 3, k < 3), "{k}");
    }
    // The index equals the number of frames.
    assert!(large.frame("link 3").unwrap().index() == small.frames().len());
}
