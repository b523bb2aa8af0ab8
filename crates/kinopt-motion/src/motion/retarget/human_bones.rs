//! Tables of human bones, as of VRM characters and Unity avatars.

use std::collections::BTreeMap;

use super::BodyPart;

/// Parts by the names of human bones in Unity (`LeftUpperArm`) and VRM (`leftUpperArm`), in lower case.
const HUMAN_BONES: [(&str, BodyPart); 18] = [
    ("hips", BodyPart::Pelvis),
    ("upperchest", BodyPart::Chest),
    ("chest", BodyPart::Chest),
    ("head", BodyPart::Head),
    ("leftupperleg", BodyPart::LeftHip),
    ("leftlowerleg", BodyPart::LeftKnee),
    ("leftfoot", BodyPart::LeftAnkle),
    ("lefttoes", BodyPart::LeftToe),
    ("leftupperarm", BodyPart::LeftShoulder),
    ("leftlowerarm", BodyPart::LeftElbow),
    ("lefthand", BodyPart::LeftHand),
    ("rightupperleg", BodyPart::RightHip),
    ("rightlowerleg", BodyPart::RightKnee),
    ("rightfoot", BodyPart::RightAnkle),
    ("righttoes", BodyPart::RightToe),
    ("rightupperarm", BodyPart::RightShoulder),
    ("rightlowerarm", BodyPart::RightElbow),
    ("righthand", BodyPart::RightHand),
];

/// Name of the bone of each human bone: `hips`, `LeftUpperArm` or `Left Upper Arm`, as in VRM and Unity.
pub type HumanBones = BTreeMap<String, String>;

/// Returns the indices of parts by a table of human bones, among names.
pub(super) fn parts_of_table(table: &HumanBones, names: &[String]) -> BTreeMap<BodyPart, usize> {
    let bare = |human: &str| -> String {
        let letters = human.chars().filter(|letter| letter.is_alphanumeric());
        letters.collect::<String>().to_lowercase()
    };
    let mut parts = BTreeMap::new();
    for (human, part) in HUMAN_BONES {
        let entry = table.iter().find(|(name, _)| bare(name) == human);
        let index = entry.and_then(|(_, bone)| names.iter().position(|name| name == bone));
        if let Some(index) = index {
            parts.entry(part).or_insert(index);
        }
    }
    parts
}
