//! Roles of bones by the words of their names.

use std::collections::BTreeMap;

use super::super::part_names::words;

/// Side of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum BoneSide {
    Left,
    Right,
}

/// Joint of a limb or of the trunk, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum BoneRole {
    Pelvis,
    Head,
    Hip,
    Knee,
    Ankle,
    Toe,
    Shoulder,
    Elbow,
    Wrist,
}

/// Finger of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in super::super) enum FingerName {
    Thumb,
    Index,
    Middle,
    Ring,
    Little,
}

/// Words of each role with their scores. Words of two roles, as `leg` and `hip`, are decided by the chain of joints.
const ROLE_WORDS: [(BoneRole, &[(&str, f64)]); 9] = [
    (
        BoneRole::Pelvis,
        &[
            ("pelvis", 1.0),
            ("hips", 1.0),
            ("hip", 0.9),
            ("lowertorso", 0.9),
            ("下半身", 1.0),
            ("root", 0.3),
            ("body", 0.2),
        ],
    ),
    (
        BoneRole::Head,
        &[("head", 1.0), ("skull", 0.9), ("頭", 1.0)],
    ),
    (
        BoneRole::Hip,
        &[
            ("thigh", 1.0),
            ("upleg", 1.0),
            ("upperleg", 1.0),
            ("legupper", 1.0),
            ("femur", 1.0),
            ("uleg", 0.9),
            ("hip", 0.8),
            ("hipjoint", 0.3),
            ("leg", 0.5),
            ("足", 1.0),
        ],
    ),
    (
        BoneRole::Knee,
        &[
            ("shin", 1.0),
            ("calf", 1.0),
            ("lowerleg", 1.0),
            ("lowleg", 1.0),
            ("leglower", 1.0),
            ("knee", 1.0),
            ("tibia", 1.0),
            ("shank", 1.0),
            ("lleg", 0.8),
            ("leg", 0.7),
            ("ひざ", 1.0),
            ("膝", 1.0),
        ],
    ),
    (
        BoneRole::Ankle,
        &[
            ("ankle", 1.1),
            ("foot", 1.0),
            ("足首", 1.1),
            ("tarsal", 0.5),
        ],
    ),
    (
        BoneRole::Toe,
        &[
            ("toebase", 1.1),
            ("toe", 1.0),
            ("toes", 1.0),
            ("ball", 1.0),
            ("balloffoot", 1.0),
            ("foot", 0.8),
            ("つま先", 1.0),
        ],
    ),
    (
        BoneRole::Shoulder,
        &[
            ("upperarm", 1.0),
            ("uparm", 1.0),
            ("armupper", 1.0),
            ("uarm", 1.0),
            ("humerus", 1.0),
            ("shldr", 1.0),
            ("arm", 0.9),
            ("bicep", 0.8),
            ("shoulder", 0.6),
            ("腕", 1.0),
        ],
    ),
    (
        BoneRole::Elbow,
        &[
            ("forearm", 1.0),
            ("lowerarm", 1.0),
            ("lowarm", 1.0),
            ("armlower", 1.0),
            ("farm", 0.9),
            ("elbow", 1.0),
            ("radius", 1.0),
            ("ulna", 0.8),
            ("ひじ", 1.0),
            ("肘", 1.0),
        ],
    ),
    (
        BoneRole::Wrist,
        &[("wrist", 1.1), ("hand", 1.0), ("手首", 1.1), ("palm", 0.6)],
    ),
];

/// Words of fingers.
const FINGER_WORDS: [(FingerName, &[&str]); 5] = [
    (FingerName::Thumb, &["thumb", "親指"]),
    (
        FingerName::Index,
        &["index", "pointer", "forefinger", "人指", "人差指"],
    ),
    (FingerName::Middle, &["middle", "mid", "中指"]),
    (FingerName::Ring, &["ring", "薬指"]),
    (FingerName::Little, &["pinky", "little", "pinkie", "小指"]),
];

/// Words that only say that something is a bone, or name a bone's part that carries the limb.
const NEUTRAL_WORDS: [&str; 18] = [
    "link", "joint", "bone", "jnt", "def", "bip", "bn", "bind", "skin", "b", "j", "c", "bend",
    "base", "cc", "sk", "main", "d",
];

/// Parts of names of bones that are no joints of a limb: controls, helpers, ends and accessories.
const HELPER_WORDS: [&str; 38] = [
    "ik",
    "pole",
    "ctrl",
    "control",
    "target",
    "mch",
    "socket",
    "weapon",
    "prop",
    "end",
    "nub",
    "tip",
    "effector",
    "helper",
    "corrective",
    "breast",
    "pec",
    "eye",
    "jaw",
    "tongue",
    "hair",
    "skirt",
    "tail",
    "cloth",
    "ear",
    "twist",
    "roll",
    "share",
    "muscle",
    "top",
    "site",
    "offset",
    "attach",
    "metacarpal",
    "org",
    "bck",
    "fwd",
    "slide",
];

/// Parts of names of bones that share the twist of a limb.
const TWIST_WORDS: [&str; 5] = ["twist", "roll", "捩", "sharebone", "twst"];

/// Meaning of a bone's name.
#[derive(Clone, Debug)]
pub(super) struct BoneName {
    pub(super) side: Option<BoneSide>,
    /// Words without side, joined.
    pub(super) rest: String,
    /// True for a control, a helper, an end or an accessory.
    pub(super) is_helper: bool,
}

impl BoneName {
    /// Score of the name for a role, from 0 to 1.1.
    pub(super) fn score(&self, role: BoneRole) -> f64 {
        let words = ROLE_WORDS.iter().find(|(known, _)| *known == role);
        let score = words.map_or(0.0, |(_, words)| {
            let exact = words.iter().find(|(word, _)| self.rest == *word);
            let contained = words
                .iter()
                .filter(|(word, _)| word.chars().count() > 2 && self.rest.contains(word))
                .map(|(word, score)| 0.6 * score * word.len() as f64 / self.rest.len() as f64)
                .fold(0.0, f64::max);
            exact.map_or(contained, |(_, score)| *score)
        });
        match self.is_helper {
            true => 0.3 * score - 0.4,
            false => score,
        }
    }

    /// Finger of the name.
    pub(super) fn finger(&self) -> Option<FingerName> {
        let named = |words: &&[&str]| words.iter().any(|word| self.rest.contains(word));
        let finger = FINGER_WORDS.iter().find(|(_, words)| named(words));
        finger.map(|(finger, _)| *finger)
    }
}

/// Returns whether a name is that of a bone that shares the twist of a limb.
pub(in super::super) fn is_twist(name: &str) -> bool {
    let lower = name.to_lowercase();
    TWIST_WORDS.iter().any(|word| lower.contains(word))
}

/// Returns whether a name is that of the end of a chain, without a joint.
pub(in super::super) fn is_chain_end(name: &str) -> bool {
    let words = split(name);
    words
        .iter()
        .any(|word| matches!(word.as_str(), "end" | "nub" | "tip" | "top" | "site"))
}

/// Returns the meanings of the names of a skeleton. Words that most names begin or end with are ignored.
pub(super) fn bone_names(names: &[String]) -> Vec<BoneName> {
    let split_names: Vec<Vec<String>> = names.iter().map(|name| split(name)).collect();
    let common = |word_of: &dyn Fn(&Vec<String>) -> Option<&String>| {
        let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
        for word in split_names.iter().filter_map(word_of) {
            *counts.entry(word).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        most.filter(|(word, count)| 5 * count > 3 * names.len().max(5) && side_of(word).is_none())
            .map(|(word, _)| word.clone())
    };
    let prefix = common(&|words| words.first());
    let suffix = common(&|words| words.last());
    let parsed = split_names.iter().map(|words| {
        let mut words: &[String] = words;
        if words.len() > 1 && words.first() == prefix.as_ref() {
            words = &words[1..];
        }
        if words.len() > 1 && words.last() == suffix.as_ref() {
            words = &words[..words.len() - 1];
        }
        bone_name(words)
    });
    parsed.collect()
}

fn bone_name(words: &[String]) -> BoneName {
    let mut side = None;
    let mut rest = String::new();
    let mut is_helper = false;
    for word in words {
        let bare = word.trim_end_matches(|c: char| c.is_ascii_digit());
        if let Some(named) = side_of(word) {
            side = side.or(Some(named));
            continue;
        }
        is_helper |=
            HELPER_WORDS.contains(&bare) || TWIST_WORDS.iter().any(|twist| bare.contains(twist));
        if !NEUTRAL_WORDS.contains(&bare) {
            rest.push_str(bare);
        }
    }
    // CMU's `LHipJoint` is between the pelvis and the hip.
    if rest == "hip" && side.is_some() && words.iter().any(|word| word == "joint") {
        rest.push_str("joint");
    }
    // Sides without a separator: `lthigh`, `leftupleg`, `左腕`.
    if side.is_none() {
        for (start, named) in [
            ("left", BoneSide::Left),
            ("right", BoneSide::Right),
            ("左", BoneSide::Left),
            ("右", BoneSide::Right),
            ("l", BoneSide::Left),
            ("r", BoneSide::Right),
        ] {
            let after = rest.strip_prefix(start).filter(|after| !after.is_empty());
            let Some(after) = after else { continue };
            if start.chars().count() > 1 || !start.is_ascii() || is_known_word(after) {
                (side, rest) = (Some(named), after.to_owned());
                break;
            }
        }
    }
    BoneName {
        side,
        rest,
        is_helper,
    }
}

fn side_of(word: &str) -> Option<BoneSide> {
    match word {
        "left" | "l" | "lft" | "lt" => Some(BoneSide::Left),
        "right" | "r" | "rgt" | "rt" => Some(BoneSide::Right),
        _ => None,
    }
}

/// Returns whether a word is that of a role or finger, so that a letter before it is a side.
fn is_known_word(word: &str) -> bool {
    let roles = ROLE_WORDS.iter().flat_map(|(_, words)| words.iter());
    let fingers = FINGER_WORDS.iter().flat_map(|(_, words)| words.iter());
    roles.map(|(word, _)| *word).any(|known| known == word)
        || fingers.copied().any(|known| word.starts_with(known))
        || [
            "collar", "clavicle", "clav", "eye", "fingers", "handend", "toeend",
        ]
        .contains(&word)
}

/// Splits a name into words, as [`words`], also at letters of other scripts.
fn split(name: &str) -> Vec<String> {
    let split_words = words(name).into_iter();
    split_words
        .map(|word| match word.strip_prefix("valve") {
            Some("biped") => String::new(),
            _ => word,
        })
        .filter(|word| !word.is_empty() && word != "valve" && word != "biped")
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{BoneRole, BoneSide, bone_names};

    #[test]
    fn sides_and_roles_are_read_from_names() {
        let names = [
            ("lShldr", BoneSide::Left, BoneRole::Shoulder),
            ("rshin", BoneSide::Right, BoneRole::Knee),
            ("LUArm", BoneSide::Left, BoneRole::Shoulder),
            ("upperarm_r", BoneSide::Right, BoneRole::Shoulder),
            ("ValveBiped.Bip01_L_Calf", BoneSide::Left, BoneRole::Knee),
            ("左足首", BoneSide::Left, BoneRole::Ankle),
            ("thigh.L", BoneSide::Left, BoneRole::Hip),
            ("CC_Base_R_Hand", BoneSide::Right, BoneRole::Wrist),
            ("DEF-forearm.L", BoneSide::Left, BoneRole::Elbow),
            ("l_arm_JNT", BoneSide::Left, BoneRole::Shoulder),
            ("rfemur", BoneSide::Right, BoneRole::Hip),
        ];
        for (name, side, role) in names {
            let parsed = &bone_names(&[name.to_owned()])[0];
            assert_eq!(parsed.side, Some(side), "{name}: {parsed:?}");
            assert!(parsed.score(role) > 0.5, "{name}: {parsed:?}");
        }
    }
}
