//! A map where none is given: from known names, and from what names tell.

use std::collections::BTreeMap;

use super::body_map::DriveText;
use super::known_maps::KnownBody;
use super::limb_tree::moving_joint;
use super::part_names::{parts_of, parts_where};
use super::proportions::Proportions;
use super::up_detection::stands_along;
use super::{BodyMap, BodyPart, Capture, Drive, KnownSkeleton, RetargetError, UpAxis};
use crate::kinematics::ForwardKinematics;
use crate::model::Model;
use crate::spatial::Vector3;

/// With fewer parts there is no body.
const FEWEST: usize = 3;
/// Frames so near to each other, as a share of the model's reach, are at one place.
const NEAR: f64 = 0.01;

/// A map that was guessed, and by what.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MapGuess {
    /// The map.
    pub map: BodyMap,
    /// The known skeleton whose names the capture has.
    pub skeleton: Option<&'static str>,
    /// The known body whose frames the model has.
    pub body: Option<&'static str>,
    /// The axis along which the body stands, of y and z, where its parts tell, whether they drive anything or not.
    pub up: Option<UpAxis>,
    /// What is to be looked at: a map that drives nothing of the model, parts that one of both has not by its names, and proportions
    /// that are no body's.
    pub notes: Vec<String>,
}

/// The joints of a capture that are parts of a body by their names, and the known skeleton that they are of.
pub(super) fn parts_of_capture(
    capture: &Capture,
) -> (BTreeMap<BodyPart, usize>, Option<&'static str>) {
    let known = KnownSkeleton::of_joints(capture.names());
    let skeleton = known.as_ref().map(KnownSkeleton::name);
    let parts = match known.and_then(|known| known.parts_in(capture.names())) {
        Some(parts) => parts,
        None => parts_of(capture.names().iter().map(String::as_str)),
    };
    (parts, skeleton)
}

/// What is told of a map without drives.
const LACKING: &str = "the map drives nothing of the target, so names tell what";

impl BodyMap {
    /// Guesses which joint of a capture drives which frame of a model: by the [known](KnownSkeleton) skeletons and bodies
    /// where all their names are there, else by what names tell (`LeftUpLeg`, `l_thigh`, `left_hip_pitch_link`).
    ///
    /// # Errors
    /// A capture or a model whose names tell of no body; the error lists some of them.
    pub fn guess(capture: &Capture, model: &Model) -> Result<MapGuess, RetargetError> {
        let (joints, skeleton) = parts_of_capture(capture);
        Self::of_parts(capture, joints, skeleton, model)
    }

    /// The map with drives [as names tell](Self::guess) where it has none, and what is to be looked at of the joints that drive.
    ///
    /// # Errors
    /// Without drives what `guess` refuses.
    pub fn completed(self, capture: &Capture, model: &Model) -> Result<MapGuess, RetargetError> {
        if self.drives.is_empty() {
            let guess = Self::guess(capture, model)?;
            let map = Self {
                drives: guess.map.drives,
                contacts: self.contacts.or(guess.map.contacts),
                ..self
            };
            let lacking = LACKING.to_owned();
            let notes = std::iter::once(lacking).chain(guess.notes).collect();
            return Ok(MapGuess {
                map,
                notes,
                ..guess
            });
        }
        let (mut parts, _) = parts_of_capture(capture);
        let up = stands_along(capture, &parts);
        let drives = |joint: &String| self.drives.iter().any(|drive| drive.joint == *joint);
        parts.retain(|_, joint| drives(&capture.names()[*joint]));
        Ok(MapGuess {
            map: self,
            skeleton: None,
            body: None,
            up,
            notes: Proportions::of(capture, &parts).faults(),
        })
    }

    /// The map from a known skeleton to a model, which may be known as well.
    ///
    /// # Errors
    /// A joint of the skeleton that the capture has not, and a model whose names tell of no body.
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
                    joints: some_of(capture.names().iter().map(String::as_str)),
                })?;
        Self::of_parts(capture, joints, Some(skeleton.name()), model)
    }

    fn of_parts(
        capture: &Capture,
        joints: BTreeMap<BodyPart, usize>,
        skeleton: Option<&'static str>,
        model: &Model,
    ) -> Result<MapGuess, RetargetError> {
        if joints.len() < FEWEST {
            return Err(RetargetError::NoBody {
                of: "the capture's joints",
                names: some_of(capture.names().iter().map(String::as_str)),
            });
        }
        let up = stands_along(capture, &joints);
        let frames = || model.frames().iter().map(|frame| frame.name.as_str());
        let mut notes = Vec::new();
        let (body, parts) = match KnownBody::of_model(model)? {
            Some(known) => (Some(known.name), known.parts),
            None => {
                let moving: Vec<_> = model
                    .frame_ids()
                    .map(|id| moving_joint(model, id))
                    .collect();
                let moves = |on: usize, frame: usize| moving[on] != moving[frame];
                let told = parts_where(frames(), moves).into_iter();
                let frame = |at: usize| DriveText::Frame(model.frames()[at].name.clone());
                let told = told.map(|(part, at)| (part, frame(at))).collect();
                (None, apart(model, told, &mut notes)?)
            }
        };
        if parts.len() < FEWEST {
            return Err(RetargetError::NoBody {
                of: "the model's frames",
                names: some_of(frames()),
            });
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
                // What a known body has none of, it has none of.
                (Some(_), None) if body.is_some() => {}
                (Some(_), None) => notes.push(format!("{name}: the model has none by its names")),
                (None, Some(_)) => notes.push(format!("{name}: the capture has none by its names")),
                (None, None) => {}
            }
        }
        if drives.len() < FEWEST {
            return Err(RetargetError::NothingInCommon {
                capture: named(joints.keys()),
                model: named(parts.keys()),
            });
        }
        // As they are read from a file, so that what is written and read again answers the same.
        drives.sort_by(|a, b| a.joint.cmp(&b.joint));
        notes.extend(Proportions::of(capture, &driving).faults());
        let map = BodyMap {
            drives,
            contacts: Some(contacts),
            ..BodyMap::default()
        };
        Ok(MapGuess {
            map,
            skeleton,
            body,
            up,
            notes,
        })
    }
}

/// The parts whose frames are at places of their own: two joints that drive one place would pull at it both.
fn apart(
    model: &Model,
    mut parts: BTreeMap<BodyPart, DriveText>,
    notes: &mut Vec<String>,
) -> Result<BTreeMap<BodyPart, DriveText>, RetargetError> {
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral());
    let placed = placed.map_err(|error| RetargetError::Map(error.to_string()))?;
    let mut taken: Vec<(Vector3<f64>, String)> = Vec::new();
    let near = NEAR * model.reach();
    for (part, name) in BodyPart::ALL {
        let Some(frame) = parts.get(&part).map(|own| own.frame().to_owned()) else {
            continue;
        };
        let at = placed[model.frame(&frame)?.index()].translation;
        match taken.iter().find(|(other, _)| (at - *other).norm() <= near) {
            None => taken.push((at, frame)),
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
fn some_of<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const LISTED: usize = 12;
    let all: Vec<&str> = names.collect();
    let listed = all.get(..LISTED).unwrap_or(&all).join(", ");
    match all.len() > LISTED {
        true => format!("{listed} and {} more", all.len() - LISTED),
        false => listed,
    }
}

/// Names of parts, one after another.
fn named<'p>(parts: impl Iterator<Item = &'p BodyPart>) -> String {
    let names: Vec<&str> = parts.map(|part| part.name()).collect();
    names.join(", ")
}
