//! Body parts from names of joints and frames.

use std::collections::BTreeMap;

use super::BodyPart;

/// Names of parts, without side, case and separators, in order of preference. Many rigs call a collarbone `shoulder`
/// and an upper arm `arm`.
const CENTRAL_NAMES: [(BodyPart, &[&str]); 3] = [
    (
        BodyPart::Pelvis,
        &[
            "pelvis", "hips", "hip", "root", "base", "trunk", "body", "torso",
        ],
    ),
    (
        BodyPart::Chest,
        &[
            "upperchest",
            "chest2",
            "spine3",
            "spine2",
            "chest",
            "thorax",
            "upperback",
            "torso",
            "spine1",
            "spine",
        ],
    ),
    (BodyPart::Head, &["head", "skull"]),
];

/// Names of paired parts, in order of preference.
const PAIRED_NAMES: [([BodyPart; 2], &[&str]); 7] = [
    (
        [BodyPart::LeftKnee, BodyPart::RightKnee],
        &[
            "knee",
            "shin",
            "calf",
            "lowerleg",
            "lowleg",
            "tibia",
            "shank",
            "kneepitch",
            "leg",
        ],
    ),
    (
        [BodyPart::LeftHip, BodyPart::RightHip],
        &[
            "upleg", "upperleg", "thigh", "femur", "hip", "hiproll", "hippitch", "hipyaw",
            "hipjoint", "leg",
        ],
    ),
    (
        [BodyPart::LeftAnkle, BodyPart::RightAnkle],
        &["ankle", "ankleroll", "foot", "anklepitch", "sole", "heel"],
    ),
    (
        [BodyPart::LeftToe, BodyPart::RightToe],
        &[
            "toebase",
            "toe",
            "toes",
            "ball",
            "balloffoot",
            "foot",
            "foottip",
            "toeend",
        ],
    ),
    (
        [BodyPart::LeftElbow, BodyPart::RightElbow],
        &[
            "elbow",
            "forearm",
            "lowerarm",
            "lowarm",
            "elbowpitch",
            "elbowroll",
        ],
    ),
    (
        [BodyPart::LeftHand, BodyPart::RightHand],
        &[
            "wrist",
            "hand",
            "rubberhand",
            "palm",
            "wristyaw",
            "wristroll",
            "gripper",
            "handsphere",
            "forearmtip",
        ],
    ),
    (
        [BodyPart::LeftShoulder, BodyPart::RightShoulder],
        &[
            "upperarm",
            "uparm",
            "arm",
            "humerus",
            "shoulderroll",
            "shoulder",
            "shoulderpitch",
            "bicep",
        ],
    ),
];

/// Words that are ignored in names.
const IGNORED_WORDS: [&str; 9] = [
    "link", "joint", "bone", "jnt", "def", "bip", "j", "b", "frame",
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodySide {
    Left,
    Right,
}

/// Side of a name, and its other words joined.
#[derive(Clone, Debug, PartialEq, Eq)]
struct NameParts {
    side: Option<BodySide>,
    rest: String,
}

/// Returns the index of each part among names. The first of several matches counts.
pub(in crate::motion) fn parts_of<'a>(
    names: impl Iterator<Item = &'a str>,
) -> BTreeMap<BodyPart, usize> {
    parts_where(names, |_, _| true)
}

/// Returns the index of each part among names.
///
/// `moves(a, b)` returns whether name `b` moves relative to name `a`. Of several matches for an ankle, the first that
/// moves relative to the knee counts, or else the first.
pub(super) fn parts_where<'a>(
    names: impl Iterator<Item = &'a str>,
    moves: impl Fn(usize, usize) -> bool,
) -> BTreeMap<BodyPart, usize> {
    let parsed: Vec<NameParts> = names.map(name_parts).collect();
    let mut indices: BTreeMap<BodyPart, usize> = BTreeMap::new();
    let mut find_part = |part: BodyPart, side: Option<BodySide>, aliases: &[&str]| {
        let is_free = |index: &usize| !indices.values().any(|other| other == index);
        let knee = match part {
            BodyPart::LeftAnkle => indices.get(&BodyPart::LeftKnee),
            BodyPart::RightAnkle => indices.get(&BodyPart::RightKnee),
            _ => None,
        };
        let knee = knee.copied();
        let first_of = |base: Option<usize>| {
            aliases.iter().find_map(|word| {
                let fits = |(index, name): &(usize, &NameParts)| {
                    let is_match = name.side == side && name.rest == *word;
                    is_match && base.is_none_or(|knee| moves(knee, *index))
                };
                let first = parsed.iter().enumerate().find(fits);
                first.map(|(index, _)| index).filter(is_free)
            })
        };
        let first = knee
            .and_then(|knee| first_of(Some(knee)))
            .or_else(|| first_of(None));
        if let Some(index) = first {
            indices.insert(part, index);
        }
    };
    for (part, aliases) in CENTRAL_NAMES {
        find_part(part, None, aliases);
    }
    for (parts, aliases) in PAIRED_NAMES {
        for (part, side) in parts.into_iter().zip([BodySide::Left, BodySide::Right]) {
            find_part(part, Some(side), aliases);
        }
    }
    indices
}

/// Returns a name in lower case, without namespace prefixes of Mixamo, Maya and similar tools, and without separators.
pub(in crate::motion) fn bare(name: &str) -> String {
    words(name).concat()
}

fn name_parts(name: &str) -> NameParts {
    let mut side = None;
    let mut rest = String::new();
    for word in words(name) {
        match word.as_str() {
            "left" | "l" | "lft" => side = side.or(Some(BodySide::Left)),
            "right" | "r" | "rgt" => side = side.or(Some(BodySide::Right)),
            word if is_ignored(word) => {}
            word => rest.push_str(word),
        }
    }
    // Lower-case names such as `leftupleg`.
    if side.is_none() {
        for (start, named_side) in [("left", BodySide::Left), ("right", BodySide::Right)] {
            if let Some(after) = rest.strip_prefix(start).filter(|after| !after.is_empty()) {
                (side, rest) = (Some(named_side), after.to_owned());
                break;
            }
        }
    }
    NameParts { side, rest }
}

/// Returns whether a word is ignored, such as `Bip01` at the start of names.
fn is_ignored(word: &str) -> bool {
    IGNORED_WORDS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()))
}

/// Splits a name into lower-case words at changes of case and at separators.
///
/// Numbers between separators are dropped. Numbers at the end of a word are kept, as in `Spine1`.
pub(super) fn words(name: &str) -> Vec<String> {
    let after = name.rsplit([':', '|']).next().unwrap_or(name);
    let after = match after.strip_prefix("mixamorig") {
        Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '_'),
        None => after,
    };
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<char> = None;
    let mut letters = after.chars().peekable();
    while let Some(letter) = letters.next() {
        let begins = match before {
            None => true,
            Some(before) if !before.is_alphanumeric() => true,
            // A word begins at A in `LeftArm`, and at H in `LHip`.
            Some(before) => {
                letter.is_uppercase()
                    && (before.is_lowercase()
                        || before.is_ascii_digit()
                        || letters.peek().is_some_and(|next| next.is_lowercase()))
            }
        };
        before = Some(letter);
        if !letter.is_alphanumeric() {
            continue;
        }
        let lower = letter.to_lowercase();
        match words.last_mut() {
            Some(word) if !begins => word.extend(lower),
            _ => words.push(lower.collect()),
        }
    }
    let is_number = |word: &String| word.chars().all(|c| c.is_ascii_digit());
    words.retain(|word| !is_number(word));
    words
}
