//! Which part of a body a joint's or frame's name tells of.

use std::collections::BTreeMap;

use super::BodyPart;

/// What parts are called, without side, case and what stands between words; what is said first is looked for first, as
/// many rigs call a collarbone `shoulder` and an upper arm `arm`.
const MIDDLE: [(BodyPart, &[&str]); 3] = [
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

/// As above, of what there is on either side.
const SIDES: [([BodyPart; 2], &[&str]); 7] = [
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

/// Words that say nothing of the part.
const NOISE: [&str; 9] = [
    "link", "joint", "bone", "jnt", "def", "bip", "j", "b", "frame",
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// What a name says: the side, and its other words as one.
#[derive(Clone, Debug, PartialEq, Eq)]
struct NameParts {
    side: Option<Side>,
    rest: String,
}

/// The place of each part among names: of several that tell of the same, the first.
pub(super) fn parts_of<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<BodyPart, usize> {
    parts_where(names, |_, _| true)
}

/// The index of each part among names. `moves` says whether the second of two names moves on the first: of several names of an
/// ankle, the first that moves on the knee counts, or the first of all if none does.
pub(super) fn parts_where<'a>(
    names: impl Iterator<Item = &'a str>,
    moves: impl Fn(usize, usize) -> bool,
) -> BTreeMap<BodyPart, usize> {
    let told: Vec<NameParts> = names.map(name_parts).collect();
    let mut found: BTreeMap<BodyPart, usize> = BTreeMap::new();
    let mut look = |part: BodyPart, side: Option<Side>, called: &[&str]| {
        let free = |at: &usize| !found.values().any(|other| other == at);
        let knee = match part {
            BodyPart::LeftAnkle => found.get(&BodyPart::LeftKnee),
            BodyPart::RightAnkle => found.get(&BodyPart::RightKnee),
            _ => None,
        };
        let knee = knee.copied();
        let first_of = |on: Option<usize>| {
            called.iter().find_map(|word| {
                let fits = |(at, own): &(usize, &NameParts)| {
                    let is_called = own.side == side && own.rest == *word;
                    is_called && on.is_none_or(|knee| moves(knee, *at))
                };
                let first = told.iter().enumerate().find(fits);
                first.map(|(at, _)| at).filter(free)
            })
        };
        let first = knee
            .and_then(|knee| first_of(Some(knee)))
            .or_else(|| first_of(None));
        if let Some(at) = first {
            found.insert(part, at);
        }
    };
    for (part, called) in MIDDLE {
        look(part, None, called);
    }
    for (parts, called) in SIDES {
        for (part, side) in parts.into_iter().zip([Side::Left, Side::Right]) {
            look(part, Some(side), called);
        }
    }
    found
}

/// A name without what stands before it in files of Mixamo, Maya and their like, in small letters and without anything
/// between words: by which the joints of known skeletons are told.
pub(super) fn bare(name: &str) -> String {
    words(name).concat()
}

fn name_parts(name: &str) -> NameParts {
    let mut side = None;
    let mut rest = String::new();
    for word in words(name) {
        match word.as_str() {
            "left" | "l" | "lft" => side = side.or(Some(Side::Left)),
            "right" | "r" | "rgt" => side = side.or(Some(Side::Right)),
            word if is_noise(word) => {}
            word => rest.push_str(word),
        }
    }
    // All in small letters: `leftupleg`.
    if side.is_none() {
        for (start, own) in [("left", Side::Left), ("right", Side::Right)] {
            if let Some(after) = rest.strip_prefix(start).filter(|after| !after.is_empty()) {
                (side, rest) = (Some(own), after.to_owned());
                break;
            }
        }
    }
    NameParts { side, rest }
}

/// Whether a word says nothing of a part, as the `Bip01` before all names of a file does.
fn is_noise(word: &str) -> bool {
    NOISE.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()))
}

/// A name's words in small letters, split where their case rises and at whatever is no letter or digit. A number that stands
/// by itself is none, unless it ends a word, as of `Spine1`.
fn words(name: &str) -> Vec<String> {
    let after = name.rsplit([':', '|']).next().unwrap_or(name);
    let after = match after.strip_prefix("mixamorig") {
        Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '_'),
        None => after,
    };
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<char> = None;
    let mut letters = after.chars().peekable();
    while let Some(own) = letters.next() {
        let begins = match before {
            None => true,
            Some(before) if !before.is_alphanumeric() => true,
            // `LeftArm` at A, `LHip` at H.
            Some(before) => {
                own.is_uppercase()
                    && (before.is_lowercase()
                        || before.is_ascii_digit()
                        || letters.peek().is_some_and(|next| next.is_lowercase()))
            }
        };
        before = Some(own);
        if !own.is_alphanumeric() {
            continue;
        }
        let small = own.to_lowercase();
        match words.last_mut() {
            Some(word) if !begins => word.extend(small),
            _ => words.push(small.collect()),
        }
    }
    let is_number = |word: &String| word.chars().all(|c| c.is_ascii_digit());
    words.retain(|word| !is_number(word));
    words
}
