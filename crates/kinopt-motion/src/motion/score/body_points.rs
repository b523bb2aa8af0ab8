//! Points of a body: driven points of a model, and the captured joints that drive them.

use std::collections::BTreeMap;

use super::ScoreError;
use super::definitions::{ENDS, EndDefinition};
use super::spread::{Spread, median};
use crate::motion::retarget::{BodyMap, Capture, Drive};
use crate::motion::retarget::{bare, parts_of, parts_of_capture, stick_person};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, Model};
use kinopt_kinematics::spatial::Vector3;

/// Names of a finger's first joint without its side, in the conventions of Mixamo, SMPL, VRM, SOMA and CMU.
const FINGER_NAMES: [&str; 9] = [
    "handmiddle1",
    "middle1",
    "middleproximal",
    "middle01",
    "fingermiddle1",
    "handindex1",
    "index1",
    "indexproximal",
    "fingerbase",
];

/// Point of a model, with its captured joint if there is a subject.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BodyPoint {
    /// Name of the captured joint; without a subject, name of the body part.
    pub(super) joint_name: String,
    /// Index of the captured joint.
    pub(super) joint: usize,
    pub(super) frame: FrameId,
    /// Position in the frame's coordinates, metres.
    pub(super) offset: Vector3<f64>,
    /// True if the point makes contact with the ground.
    pub(super) makes_contact: bool,
}

/// Points of a body, and their indices by name of body part.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BodyPoints {
    pub(super) points: Vec<BodyPoint>,
    names: BTreeMap<&'static str, usize>,
}

impl BodyPoints {
    /// Points of a map.
    pub(super) fn of_map(
        model: &Model,
        map: &BodyMap,
        capture: &Capture,
    ) -> Result<Self, ScoreError> {
        let mut points = Vec::with_capacity(map.drives.len());
        for drive in &map.drives {
            points.push(BodyPoint {
                joint_name: drive.joint.clone(),
                joint: capture.joint(&drive.joint)?,
                frame: model.frame(&drive.frame)?,
                offset: drive.offset,
                makes_contact: match &map.contacts {
                    Some(contacts) => contacts.contains(&drive.joint),
                    None => drive.names_foot_part(),
                },
            });
        }
        let names = point_names(&map.drives, capture);
        Ok(Self { points, names })
    }

    /// Points of a model that its frames' names, or built-in maps, determine. Empty if there are too few.
    pub(super) fn of_model(model: &Model) -> Self {
        let points = stick_person().and_then(|person| {
            let guess = BodyMap::guess(&person, model).ok()?;
            Self::of_map(model, &guess.map, &person).ok()
        });
        points.unwrap_or_default()
    }

    /// Index of the point of a body part.
    pub(super) fn index(&self, name: &str) -> Option<usize> {
        self.names.get(name).copied()
    }

    /// Indices of the first alternative whose points all exist.
    pub(super) fn first_of(&self, alternatives: &[&[&str]]) -> Option<Vec<usize>> {
        let indices = |names: &&[&str]| names.iter().map(|name| self.index(name)).collect();
        alternatives.iter().find_map(indices)
    }

    /// Positions of all points of a model, sample by sample.
    pub(super) fn model_track(&self, model: &Model, q: &[f64]) -> Result<PointTrack, ScoreError> {
        let frames: Vec<FrameId> = self.points.iter().map(|point| point.frame).collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames)?;
        let mut positions = Vec::new();
        let width = model.configuration_len().max(1);
        for q in q.chunks_exact(width) {
            let placed = kinematics.place(q)?;
            let points = self.points.iter().zip(placed);
            positions.extend(points.map(|(point, placed)| placed.apply(point.offset)));
        }
        Ok(PointTrack {
            samples: q.len() / width,
            width: self.points.len(),
            positions,
        })
    }
}

/// Indices of drives by name of body part: by the captured joints' names, else by the frames' names.
fn point_names(drives: &[Drive], capture: &Capture) -> BTreeMap<&'static str, usize> {
    let joints = parts_of_capture(capture).joints;
    let by_joint = joints.iter().filter_map(|(part, joint)| {
        let name = capture.names().get(*joint)?;
        let drive = drives.iter().position(|drive| drive.joint == *name)?;
        Some((part.name(), drive))
    });
    let mut names: BTreeMap<&'static str, usize> = by_joint.collect();
    for (part, drive) in parts_of(drives.iter().map(|drive| drive.frame.as_str())) {
        let is_named = names.values().any(|known| *known == drive);
        if !is_named {
            names.entry(part.name()).or_insert(drive);
        }
    }
    for (drive, joint) in drives.iter().map(|drive| bare(&drive.joint)).enumerate() {
        if let Some(side) = finger_side(&joint) {
            names.entry(side).or_insert(drive);
        }
    }
    names
}

/// Name of the point of a finger's first joint, if the name is of one.
fn finger_side(bare_name: &str) -> Option<&'static str> {
    let sides = [
        ("left", "left_finger"),
        ("right", "right_finger"),
        ("l", "left_finger"),
        ("r", "right_finger"),
    ];
    sides.into_iter().find_map(|(side, point)| {
        let is_finger = |rest: &str| FINGER_NAMES.contains(&rest);
        let before = bare_name.strip_prefix(side).is_some_and(is_finger);
        let after = bare_name.strip_suffix(side).is_some_and(is_finger);
        (before || after).then_some(point)
    })
}

/// Positions of points, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PointTrack {
    pub(super) samples: usize,
    pub(super) width: usize,
    pub(super) positions: Vec<Vector3<f64>>,
}

impl PointTrack {
    pub(super) fn at(&self, sample: usize, point: usize) -> Vector3<f64> {
        self.positions[sample * self.width + point]
    }

    /// Mean position of points at a sample.
    pub(super) fn mean(&self, sample: usize, points: &[usize]) -> Vector3<f64> {
        let sum = points
            .iter()
            .fold(Vector3::zero(), |sum: Vector3<f64>, &point| {
                sum + self.at(sample, point)
            });
        sum * (1.0 / points.len().max(1) as f64)
    }

    /// Positions of one point.
    pub(super) fn of_point(&self, point: usize) -> Vec<Vector3<f64>> {
        (0..self.samples)
            .map(|sample| self.at(sample, point))
            .collect()
    }

    /// Length of an arm or a leg: the sum of its median segments, or without a middle joint the 95th percentile of the
    /// distance between its ends.
    pub(super) fn chain_length(&self, base: &[usize], middle: Option<usize>, end: usize) -> f64 {
        let distances = |from: &[usize], to: usize| -> Vec<f64> {
            let samples = 0..self.samples;
            samples
                .map(|sample| (self.at(sample, to) - self.mean(sample, from)).norm())
                .collect()
        };
        match middle {
            Some(middle) => median(distances(base, middle)) + median(distances(&[middle], end)),
            None => Spread::of(distances(base, end)).p95,
        }
    }

    /// Mean length of the legs; 0 without legs.
    pub(super) fn leg_length(&self, points: &BodyPoints) -> f64 {
        let legs = ENDS.iter().filter(|end| end.is_leg);
        let lengths: Vec<f64> = legs
            .filter_map(|leg| {
                let chain = ScoredChain::of(leg, points)?;
                Some(self.chain_length(&chain.base, chain.middle, chain.end))
            })
            .collect();
        lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
    }
}

/// Point indices of an arm or a leg.
#[derive(Clone, Debug)]
pub(super) struct ScoredChain {
    pub(super) base: Vec<usize>,
    pub(super) middle: Option<usize>,
    pub(super) end: usize,
}

impl ScoredChain {
    pub(super) fn of(definition: &EndDefinition, points: &BodyPoints) -> Option<Self> {
        Some(Self {
            base: points.first_of(definition.base)?,
            middle: points.index(definition.middle),
            end: points.index(definition.end)?,
        })
    }
}
