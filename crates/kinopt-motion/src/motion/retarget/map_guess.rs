//! Guessed maps, from built-in maps and from names.

use std::collections::BTreeMap;

use glam::DVec3;

use super::anatomy::{Anatomy, JointTree, recognise};
use super::body_map::DriveText;
use super::body_structure::parts_of_structure;
use super::human_bones::{HumanBones, parts_of_table};
use super::known_maps::KnownBody;
use super::limb_tree::moving_joint;
use super::part_names::{parts_of, parts_where};
use super::proportions::Proportions;
use super::up_detection::upright_axis;
use super::{BodyMap, BodyPart, Capture, Drive, KnownSkeleton, RetargetError, UpAxis};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{LengthUnit, Model};
use kinopt_kinematics::spatial::Vector3;

/// Minimum number of parts of a body.
const MIN_PARTS: usize = 3;
/// Distance below which two frames coincide, relative to the model's reach.
const MIN_FRAME_DISTANCE: f64 = 0.01;

/// Guessed map, with its sources.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MapGuess {
    /// Guessed map.
    pub map: BodyMap,
    /// Built-in skeleton that matches the capture.
    pub skeleton: Option<&'static str>,
    /// Built-in body that matches the model.
    pub body: Option<&'static str>,
    /// True if the model's parts are those of its kinematic tree, independent of its names.
    pub from_tree: bool,
    /// Axis, y or z, along which the body is upright, if its parts determine it.
    pub up: Option<UpAxis>,
    /// Warnings: a map without assignments, parts missing on one side, and implausible proportions.
    pub notes: Vec<String>,
}

/// Parts without which a body is incomplete.
const REQUIRED_PARTS: [BodyPart; 14] = [
    BodyPart::Pelvis,
    BodyPart::Head,
    BodyPart::LeftShoulder,
    BodyPart::LeftElbow,
    BodyPart::LeftHand,
    BodyPart::RightShoulder,
    BodyPart::RightElbow,
    BodyPart::RightHand,
    BodyPart::LeftHip,
    BodyPart::LeftKnee,
    BodyPart::LeftAnkle,
    BodyPart::RightHip,
    BodyPart::RightKnee,
    BodyPart::RightAnkle,
];

/// Body parts among the joints of a capture.
#[derive(Clone, Debug)]
pub(in crate::motion) struct CaptureParts {
    pub(in crate::motion) joints: BTreeMap<BodyPart, usize>,
    /// Built-in skeleton that matches the names.
    pub(in crate::motion) skeleton: Option<&'static str>,
    /// Disagreements of names and tree.
    pub(in crate::motion) notes: Vec<String>,
}

/// Returns the joints of a capture that are parts of a body: by the bone tree, if the capture has one, and by names.
pub(in crate::motion) fn parts_of_capture(capture: &Capture) -> CaptureParts {
    let known = KnownSkeleton::of_joints(capture.names());
    let skeleton = known.as_ref().map(KnownSkeleton::name);
    let named = match known.and_then(|known| known.parts_in(capture.names())) {
        Some(parts) => parts,
        None => parts_of(capture.names().iter().map(String::as_str)),
    };
    let Some(tree) = JointTree::of_capture(capture) else {
        return CaptureParts {
            joints: named,
            skeleton,
            notes: Vec::new(),
        };
    };
    let posed = capture.frame(0).unwrap_or_default().iter();
    let posed: Vec<DVec3> = posed.map(|at| DVec3::from_array(at.to_array())).collect();
    let Anatomy { parts, notes } = recognise(&tree, &posed);
    CaptureParts {
        joints: tree_parts_or_named(parts, named),
        skeleton,
        notes,
    }
}

/// Returns the parts of a tree, or those by names if the tree lacks required parts that the names have.
pub(super) fn tree_parts_or_named<T>(
    of_tree: BTreeMap<BodyPart, T>,
    named: BTreeMap<BodyPart, T>,
) -> BTreeMap<BodyPart, T> {
    let missing = |parts: &BTreeMap<BodyPart, T>| {
        REQUIRED_PARTS
            .iter()
            .filter(|part| !parts.contains_key(part))
            .count()
    };
    match missing(&of_tree) <= missing(&named) {
        true => of_tree,
        false => named,
    }
}

/// Body parts among the bones of a character.
#[derive(Clone, Debug, Default)]
pub(super) struct CharacterParts {
    pub(super) bones: BTreeMap<BodyPart, DriveText>,
    /// Built-in body that matches the names.
    body: Option<&'static str>,
    /// Disagreements of names and tree.
    notes: Vec<String>,
}

/// Returns the bone of each part of a character, by a built-in body, the tree or names.
pub(super) fn parts_of_character(model: &Model) -> Result<CharacterParts, RetargetError> {
    if let Some(known) = KnownBody::of_model(model)? {
        return Ok(CharacterParts {
            bones: known.parts,
            body: Some(known.name),
            notes: Vec::new(),
        });
    }
    let Some((tree, _)) = JointTree::of_character(model) else {
        return Ok(CharacterParts::default());
    };
    let Anatomy { parts, notes } = recognise(&tree, &tree.positions);
    let named = parts_of(tree.names.iter().map(String::as_str));
    let parts = tree_parts_or_named(parts, named).into_iter();
    let bone = |joint: usize| DriveText::Frame(tree.names[joint].clone());
    Ok(CharacterParts {
        bones: parts.map(|(part, joint)| (part, bone(joint))).collect(),
        body: None,
        notes,
    })
}

/// Returns an error that lists the missing parts of an incomplete body.
fn check_complete<T>(
    parts: &BTreeMap<BodyPart, T>,
    of: &'static str,
    name: impl Fn(&T) -> String,
) -> Result<(), RetargetError> {
    let missing: Vec<&BodyPart> = REQUIRED_PARTS
        .iter()
        .filter(|part| !parts.contains_key(part))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let found = parts
        .iter()
        .map(|(part, found)| format!("{} = `{}`", part.name(), name(found)));
    let found: Vec<String> = found.collect();
    Err(RetargetError::IncompleteBody {
        of,
        missing: named(missing.into_iter()),
        found: match found.is_empty() {
            true => "none".to_owned(),
            false => found.join(", "),
        },
    })
}

/// Warning about a map without assignments.
const NO_DRIVES_NOTE: &str =
    "the map drives no frame of the target, so drives are guessed from names";

impl BodyMap {
    /// Guesses the assignment of captured joints to frames of a model.
    ///
    /// In a capture with a bone tree, and in a character, limbs are found by symmetry, lengths and names. The chest is the
    /// bone that arms and neck hang on. For other captures and for robots the guess uses built-in [skeletons](KnownSkeleton) and bodies if all their names exist, else the parts of names
    /// (`LeftUpLeg`, `l_thigh`, `left_hip_pitch_link`).
    ///
    /// # Errors
    /// Returns an error, with some of the names, if those of the capture or the model match no body. For a character,
    /// returns an error that lists missing parts, unless pelvis, head, arms and legs are found.
    pub fn guess(capture: &Capture, model: &Model) -> Result<MapGuess, RetargetError> {
        Self::default().guess_parts(capture, model)
    }

    /// Guesses assignments, by tables of human bones if the map has them.
    fn guess_parts(&self, capture: &Capture, model: &Model) -> Result<MapGuess, RetargetError> {
        let mut found = parts_of_capture(capture);
        found
            .joints
            .extend(parts_of_table(&self.source_human_bones, capture.names()));
        Self::of_parts(capture, found, model, &self.human_bones)
    }

    /// Completes a map without assignments by [guessed](Self::guess) ones. Otherwise only checks the proportions.
    ///
    /// # Errors
    /// Returns the errors of `guess` for a map without assignments.
    pub fn completed(self, capture: &Capture, model: &Model) -> Result<MapGuess, RetargetError> {
        if self.drives.is_empty() {
            let has_tables = !self.human_bones.is_empty() || !self.source_human_bones.is_empty();
            let guess = self.guess_parts(capture, model)?;
            let map = Self {
                drives: guess.map.drives,
                contacts: self.contacts.or(guess.map.contacts),
                human_bones: HumanBones::new(),
                source_human_bones: HumanBones::new(),
                ..self
            };
            let note = (!has_tables).then(|| NO_DRIVES_NOTE.to_owned());
            let notes = note.into_iter().chain(guess.notes).collect();
            return Ok(MapGuess {
                map,
                notes,
                ..guess
            });
        }
        let mut parts = parts_of_capture(capture).joints;
        let up = upright_axis(capture, &parts);
        let drives = |joint: &String| self.drives.iter().any(|drive| drive.joint == *joint);
        parts.retain(|_, joint| drives(&capture.names()[*joint]));
        Ok(MapGuess {
            map: self,
            skeleton: None,
            body: None,
            from_tree: false,
            up,
            notes: Proportions::of(capture, &parts).warnings(),
        })
    }

    /// Creates the map from a built-in skeleton to a model.
    ///
    /// # Errors
    /// Returns an error if the capture lacks a joint of the skeleton, or if the model's names match no body.
    pub fn from_skeleton(
        skeleton: &KnownSkeleton,
        capture: &Capture,
        model: &Model,
    ) -> Result<MapGuess, RetargetError> {
        let joints =
            skeleton
                .parts_in(capture.names())
                .ok_or_else(|| RetargetError::OtherSkeleton {
                    skeleton: skeleton.name(),
                    joints: first_names(capture.names().iter().map(String::as_str)),
                })?;
        let parts = CaptureParts {
            joints,
            skeleton: Some(skeleton.name()),
            notes: Vec::new(),
        };
        Self::of_parts(capture, parts, model, &HumanBones::new())
    }

    fn of_parts(
        capture: &Capture,
        parts: CaptureParts,
        model: &Model,
        human_bones: &HumanBones,
    ) -> Result<MapGuess, RetargetError> {
        let CaptureParts {
            joints,
            skeleton,
            mut notes,
        } = parts;
        if joints.len() < MIN_PARTS {
            return Err(RetargetError::NoBody {
                of: "the capture's joints",
                names: first_names(capture.names().iter().map(String::as_str)),
            });
        }
        let up = upright_axis(capture, &joints);
        let frames = || model.frames().iter().map(|frame| frame.name.as_str());
        let is_character = model.length_unit() == LengthUnit::Own;
        let known = KnownBody::of_model(model)?;
        let drives = match (&known, is_character) {
            (None, false) => parts_of_structure(model),
            _ => None,
        };
        let from_tree = drives.is_some();
        let (body, mut parts) = match (known, is_character, drives) {
            (Some(known), ..) => (Some(known.name), known.parts),
            (None, true, _) => {
                let found = parts_of_character(model)?;
                notes.extend(found.notes);
                (found.body, found.bones)
            }
            (None, false, Some(drives)) => {
                let drives = drives.iter();
                let parts = drives.map(|(part, drive)| (*part, DriveText::of(drive)));
                (None, parts.collect())
            }
            (None, false, None) => {
                let moving: Vec<_> = model
                    .frame_ids()
                    .map(|id| moving_joint(model, id))
                    .collect();
                let moves = |base: usize, frame: usize| moving[base] != moving[frame];
                let named_parts = parts_where(frames(), moves).into_iter();
                let frame = |index: usize| DriveText::Frame(model.frames()[index].name.clone());
                let named_parts = named_parts
                    .map(|(part, index)| (part, frame(index)))
                    .collect();
                (None, without_coincident(model, named_parts, &mut notes)?)
            }
        };
        if parts.len() < MIN_PARTS {
            return Err(RetargetError::NoBody {
                of: "the model's frames",
                names: first_names(frames()),
            });
        }
        let names: Vec<String> = model
            .frames()
            .iter()
            .map(|frame| frame.name.clone())
            .collect();
        for (part, frame) in parts_of_table(human_bones, &names) {
            parts.insert(part, DriveText::Frame(names[frame].clone()));
        }
        if is_character {
            let joint = |joint: &usize| capture.names()[*joint].clone();
            check_complete(&joints, "the capture's joints", joint)?;
            let frame = |text: &DriveText| text.frame().to_owned();
            check_complete(&parts, "the character's bones", frame)?;
        }
        let mut drives: Vec<Drive> = Vec::new();
        let mut contacts = Vec::new();
        let mut driving = BTreeMap::new();
        for (part, name) in BodyPart::ALL {
            match (joints.get(&part), parts.get(&part)) {
                (Some(&joint), Some(frame)) => {
                    let joint_name = &capture.names()[joint];
                    let frame = frame.clone().into_drive(joint_name.clone());
                    if part.stands() {
                        contacts.push(joint_name.clone());
                    }
                    driving.insert(part, joint);
                    drives.push(frame);
                }
                // A built-in body and a tree are complete, so missing parts need no warning.
                (Some(_), None) if body.is_some() || from_tree => {}
                (Some(_), None) => notes.push(format!("{name}: the model has none by its names")),
                (None, Some(_)) => notes.push(format!("{name}: the capture has none by its names")),
                (None, None) => {}
            }
        }
        if drives.len() < MIN_PARTS {
            return Err(RetargetError::NothingInCommon {
                capture: named(joints.keys()),
                model: named(parts.keys()),
            });
        }
        // The order of a map file, so that a written and read map gives equal results.
        drives.sort_by(|a, b| a.joint.cmp(&b.joint));
        notes.extend(Proportions::of(capture, &driving).warnings());
        let map = BodyMap {
            drives,
            contacts: Some(contacts),
            ..BodyMap::default()
        };
        Ok(MapGuess {
            map,
            skeleton,
            body,
            from_tree,
            up,
            notes,
        })
    }
}

/// Returns the parts without those at the position of an earlier part, which would compete with it.
fn without_coincident(
    model: &Model,
    mut parts: BTreeMap<BodyPart, DriveText>,
    notes: &mut Vec<String>,
) -> Result<BTreeMap<BodyPart, DriveText>, RetargetError> {
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral());
    let placed = placed.map_err(|error| RetargetError::Map(error.to_string()))?;
    let mut occupied: Vec<(Vector3<f64>, String)> = Vec::new();
    let min_distance = MIN_FRAME_DISTANCE * model.reach();
    for (part, name) in BodyPart::ALL {
        let Some(frame) = parts.get(&part).map(|text| text.frame().to_owned()) else {
            continue;
        };
        let position = placed[model.frame(&frame)?.index()].translation;
        match occupied
            .iter()
            .find(|(other, _)| (position - *other).norm() <= min_distance)
        {
            None => occupied.push((position, frame)),
            Some((_, other)) => {
                notes.push(format!(
                    "{name}: `{frame}` is where `{other}` is, so it is left out"
                ));
                parts.remove(&part);
            }
        }
    }
    Ok(parts)
}

/// The first of many names, for a message.
fn first_names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MAX_LISTED_NAMES: usize = 12;
    let all: Vec<&str> = names.collect();
    let listed = all.get(..MAX_LISTED_NAMES).unwrap_or(&all).join(", ");
    match all.len() > MAX_LISTED_NAMES {
        true => format!("{listed} and {} more", all.len() - MAX_LISTED_NAMES),
        false => listed,
    }
}

/// Returns the names of parts, separated by commas.
fn named<'p>(parts: impl Iterator<Item = &'p BodyPart>) -> String {
    let names: Vec<&str> = parts.map(|part| part.name()).collect();
    names.join(", ")
}
