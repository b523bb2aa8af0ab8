//! Orientations of feet and hands: those of the subject, and the axes of the model that follow them.
//!
//! The axes of a foot are forward and left in a flat stance. The axes of a hand are along the fingers and towards the
//! thumb. They come from joint positions, so that rest poses of subject and model do not matter.

use std::collections::BTreeMap;

use super::capture::Capture;
use super::limb::DrivenLimb;
use super::limb_lengths::quantile;
use super::limb_tree::joints_above;
use super::map_guess::parts_of_capture;
use super::subject_pose::SubjectPose;
use super::{BodyPart, UpAxis};
use kinopt_kinematics::model::{FrameId, Model};
use kinopt_kinematics::spatial::{Matrix3, Placement, Polar, Vector3};

/// Weight of the heading of a foot, in metres of position per radian.
const FOOT_WEIGHT: f64 = 0.1;
/// Weights of the axes of a hand with one, two, and three or more joints of the wrist, in metres of position per radian.
/// With fewer than three joints, they turn the arm too.
const HAND_WEIGHTS: [f64; 3] = [0.03, 0.1, 0.3];
/// Share of the capture frames, the slowest ones, in which a foot counts as flat.
const REST_SHARE: f64 = 0.25;
/// Sine of the largest slope from ankle to toe of a flat foot.
const MAX_SLOPE: f64 = 0.9;
/// Weight of the hip line in the lateral direction of a foot, which a vertical foot does not determine.
const LATERAL_REGULARISATION: f64 = 1e-3;
/// Cosine of the largest angle at which a direction of a hand counts as an axis of its frame: 15°.
const MIN_SNAP_COSINE: f64 = 0.966;
/// Sine of the bend of an elbow below which its side is undetermined: 3°.
const MIN_BEND_SINE: f64 = 0.05;
/// Length of a direction below which it is undetermined.
const MIN_LENGTH: f64 = 1e-9;

/// Axis of a model's frame, with its weight in metres of position per radian.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrivenAxis {
    pub(super) frame: FrameId,
    pub(super) axis: Vector3<f64>,
    pub(super) weight: f64,
}

/// Foot of the subject and of the model.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FootAxes {
    ankle: usize,
    toe: usize,
    /// Sine and cosine of the slope from ankle to toe of a flat foot.
    slope: (f64, f64),
    hips: Option<[usize; 2]>,
    /// Rotation from the axes of the foot to the captured joint, if the source has rotations.
    bone: Option<Matrix3<f64>>,
    /// Indices of the limbs of ankle and toe; `None` for a toe that is not driven.
    limbs: (usize, Option<usize>),
    /// Direction of the model's foot in its stance.
    forward: Vector3<f64>,
    /// Vector from ankle to toe in the model's stance, forward, left and upward, metres.
    toe_offset: Vector3<f64>,
    /// Forward and left axis of the model's foot.
    driven: [DrivenAxis; 2],
}

/// Hand of the subject and of the model.
#[derive(Clone, Debug, PartialEq)]
struct HandAxes {
    wrist: usize,
    /// Rotation from the axes of the hand to the captured joint, if the source has rotations.
    bone: Option<Matrix3<f64>>,
    /// Base of the middle finger, and bases of index and little finger.
    fingers: Option<[usize; 3]>,
    elbow: usize,
    along: Option<DrivenAxis>,
    thumb: Option<DrivenAxis>,
}

/// Orientations of all feet and hands that names of the capture determine.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Orientations {
    feet: Vec<FootAxes>,
    hands: Vec<HandAxes>,
}

impl Orientations {
    pub(super) fn new(
        model: &Model,
        all: &[DrivenLimb],
        capture: &Capture,
        up: UpAxis,
        stance: &[Placement<f64>],
    ) -> Self {
        let parts = parts_of_capture(capture).joints;
        let positions: Vec<_> = all
            .iter()
            .map(|limb| stance[limb.frame.index()].apply(limb.offset))
            .collect();
        let forward = model_forward(all, &parts, &positions);
        let feet = [
            [BodyPart::LeftAnkle, BodyPart::LeftToe],
            [BodyPart::RightAnkle, BodyPart::RightToe],
        ];
        let feet = feet.iter().filter_map(|[ankle, toe]| {
            let (ankle, toe) = (*parts.get(ankle)?, *parts.get(toe)?);
            let is_ankle = |limb: &DrivenLimb| limb.joint == ankle && limb.makes_contact;
            let ankle_limb = all.iter().position(is_ankle)?;
            let toe_limb = all
                .iter()
                .position(|limb| limb.joint == toe && limb.parent == Some(ankle_limb));
            let offset = toe_limb.map(|toe| positions[toe] - positions[ankle_limb]);
            let forward = offset
                .and_then(|offset| direction(horizontal(offset)))
                .or(forward)?;
            let left = Vector3::UNITS[2].cross(forward);
            let offset = offset.unwrap_or(Vector3::zero());
            let frame = toe_limb.map_or(all[ankle_limb].frame, |toe| all[toe].frame);
            let mut axes = FootAxes {
                ankle,
                toe,
                slope: flat_slope(capture, up, ankle, toe),
                hips: hips(&parts),
                bone: None,
                limbs: (ankle_limb, toe_limb),
                forward,
                toe_offset: Vector3::new(offset.dot(forward), offset.dot(left), offset.z),
                driven: [forward, left].map(|axis| DrivenAxis {
                    frame,
                    axis: stance[frame.index()].rotation.transpose_mul(axis),
                    weight: FOOT_WEIGHT,
                }),
            };
            axes.bone = axes.bone_offset(capture, up);
            Some(axes)
        });
        let feet = feet.collect();
        let hands = [
            (
                [
                    BodyPart::LeftShoulder,
                    BodyPart::LeftElbow,
                    BodyPart::LeftHand,
                ],
                ["left", "right"],
            ),
            (
                [
                    BodyPart::RightShoulder,
                    BodyPart::RightElbow,
                    BodyPart::RightHand,
                ],
                ["right", "left"],
            ),
        ];
        let hands = hands
            .iter()
            .filter_map(|([shoulder, elbow, wrist], [side, other_side])| {
                let (elbow, wrist) = (*parts.get(elbow)?, *parts.get(wrist)?);
                let limb = all.iter().position(|limb| limb.joint == wrist)?;
                let parent = all[limb]
                    .parent
                    .filter(|&parent| all[parent].joint == elbow)?;
                let along = direction(positions[limb] - positions[parent])?;
                let thumb = thumb_direction(along, forward?)?;
                let frame = all[limb].frame;
                let rotation = stance[frame.index()].rotation;
                let wrist_joints = wrist_joints(model, all[parent].frame, frame);
                let driven = |axis: Vector3<f64>| DrivenAxis {
                    frame,
                    axis: snapped(rotation.transpose_mul(axis)),
                    weight: HAND_WEIGHTS[wrist_joints.clamp(1, 3) - 1],
                };
                let fingers = finger_bases(capture.names(), side, other_side);
                let shoulder = parts.get(shoulder).filter(|_| fingers.is_none());
                let bone = shoulder
                    .and_then(|&shoulder| hand_offset(capture, up, [shoulder, elbow, wrist]));
                let has_thumb = fingers.is_some() || bone.is_some();
                Some(HandAxes {
                    wrist,
                    bone,
                    elbow,
                    along: (wrist_joints >= 2).then(|| driven(along)),
                    thumb: (wrist_joints >= 1 && has_thumb).then(|| driven(thumb)),
                    fingers,
                })
            });
        Self {
            feet,
            hands: hands.collect(),
        }
    }

    /// Returns whether a limb is the ankle or toe of a foot whose orientation is known.
    pub(super) fn has_foot(&self, limb: usize) -> bool {
        let mut feet = self.feet.iter().map(|foot| foot.limbs);
        feet.any(|(ankle, toe)| ankle == limb || toe == Some(limb))
    }

    /// Limb of the ankle of each foot, and the direction of the foot in the model's stance.
    pub(super) fn feet(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        self.feet.iter().map(|foot| (foot.limbs.0, foot.forward))
    }

    /// Feet, in the order of their directions.
    pub(super) fn foot_axes(&self) -> impl Iterator<Item = &FootAxes> {
        self.feet.iter()
    }

    /// Returns the foot whose toe a limb is.
    pub(super) fn foot_of_toe(&self, limb: usize) -> Option<&FootAxes> {
        self.feet.iter().find(|foot| foot.limbs.1 == Some(limb))
    }

    /// Axes of the model, in the order of [`write_directions`](Self::write_directions).
    pub(super) fn driven(&self) -> impl Iterator<Item = &DrivenAxis> {
        let feet = self.feet.iter().flat_map(|foot| &foot.driven);
        let hands = self
            .hands
            .iter()
            .flat_map(|hand| [&hand.along, &hand.thumb].into_iter().flatten());
        feet.chain(hands)
    }

    /// Appends the subject's direction of each driven axis.
    pub(super) fn write_directions(&self, pose: &SubjectPose<'_>, to: &mut Vec<Vector3<f64>>) {
        for foot in &self.feet {
            let [forward, left, _] = foot.axes(pose);
            to.extend([forward, left]);
        }
        for hand in &self.hands {
            let [along, thumb] = hand.axes(pose);
            to.extend(hand.along.as_ref().map(|_| along));
            to.extend(hand.thumb.as_ref().map(|_| thumb));
        }
    }
}

impl HandAxes {
    /// Returns the subject's directions along the fingers and towards the thumb.
    fn axes(&self, pose: &SubjectPose<'_>) -> [Vector3<f64>; 2] {
        let at = |joint: usize| pose.position(joint);
        if let (Some(bone), Some(rotation)) = (self.bone, pose.rotation(self.wrist)) {
            let axes = rotation * bone;
            return [axes.x, axes.z];
        }
        let along = match self.fingers {
            Some([middle, _, _]) => at(middle) - at(self.wrist),
            None => at(self.wrist) - at(self.elbow),
        };
        let along = direction(along).unwrap_or(Vector3::UNITS[0]);
        let across = self
            .fingers
            .map_or(Vector3::UNITS[2], |[_, index, little]| {
                at(index) - at(little)
            });
        let across = across - along * across.dot(along);
        [along, direction(across).unwrap_or(Vector3::UNITS[2])]
    }
}

impl FootAxes {
    /// Forward axis of the model's foot.
    pub(super) fn axis(&self) -> &DrivenAxis {
        &self.driven[0]
    }

    /// Indices of the limbs of ankle and toe.
    pub(super) fn limbs(&self) -> (usize, Option<usize>) {
        self.limbs
    }

    /// Returns the subject's axes: forward, left and upward on a flat foot.
    pub(super) fn axes(&self, pose: &SubjectPose<'_>) -> [Vector3<f64>; 3] {
        match (self.bone, pose.rotation(self.ankle)) {
            (Some(bone), Some(rotation)) => {
                let axes = rotation * bone;
                [axes.x, axes.y, axes.z]
            }
            _ => self.axes_of_positions(pose),
        }
    }

    /// Returns the axes that ankle and toe determine: the foot does not roll.
    fn axes_of_positions(&self, pose: &SubjectPose<'_>) -> [Vector3<f64>; 3] {
        let [_, y, z] = Vector3::UNITS;
        let at = |joint: usize| pose.position(joint);
        let along = direction(at(self.toe) - at(self.ankle)).unwrap_or(Vector3::UNITS[0]);
        let hips = self.hips.map_or(y, |[left, right]| at(left) - at(right));
        let left = z.cross(along) + horizontal(hips) * LATERAL_REGULARISATION;
        let left = direction(left).unwrap_or(y);
        let (sine, cosine) = self.slope;
        let forward = direction(along * cosine + along.cross(left) * sine).unwrap_or(along);
        [forward, left, forward.cross(left)]
    }

    /// Returns the rotation from the axes of the foot to those of its captured joint: the mean over frames at rest, in
    /// which the foot is flat.
    fn bone_offset(&self, capture: &Capture, up: UpAxis) -> Option<Matrix3<f64>> {
        let z = Vector3::UNITS[2];
        let frames = frames_at_rest(capture, [self.ankle, self.toe]).into_iter();
        let offsets = frames.filter_map(|frame| {
            let pose = SubjectPose::of_frame(capture, frame, up)?;
            let forward = direction(horizontal(self.axes_of_positions(&pose)[0]))?;
            let axes = Matrix3::from_columns(forward, z.cross(forward), z);
            Some(pose.rotation(self.ankle)?.transpose() * axes)
        });
        mean_rotation(offsets)
    }

    /// Returns the vector from the model's ankle to its toe of a flat foot that points in a horizontal direction, metres.
    pub(super) fn flat_toe_offset(&self, forward: Vector3<f64>) -> Vector3<f64> {
        let up = Vector3::UNITS[2];
        self.toe_offset(&[forward, up.cross(forward), up])
    }

    /// Returns the vector from the model's ankle to its toe for the subject's axes, metres.
    pub(super) fn toe_offset(&self, axes: &[Vector3<f64>; 3]) -> Vector3<f64> {
        let offset = self.toe_offset;
        axes[0] * offset.x + axes[1] * offset.y + axes[2] * offset.z
    }
}

pub(super) fn horizontal(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, v.y, 0.0)
}

/// Returns a vector with unit length, or `None` for one without direction.
pub(super) fn direction(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > MIN_LENGTH).then(|| v * (1.0 / length))
}

fn hips(parts: &BTreeMap<BodyPart, usize>) -> Option<[usize; 2]> {
    Some([
        *parts.get(&BodyPart::LeftHip)?,
        *parts.get(&BodyPart::RightHip)?,
    ])
}

/// Returns the horizontal direction in which the model looks in a stance, from a line across its body.
fn model_forward(
    all: &[DrivenLimb],
    parts: &BTreeMap<BodyPart, usize>,
    positions: &[Vector3<f64>],
) -> Option<Vector3<f64>> {
    let pairs = [
        [BodyPart::LeftHip, BodyPart::RightHip],
        [BodyPart::LeftShoulder, BodyPart::RightShoulder],
        [BodyPart::LeftAnkle, BodyPart::RightAnkle],
    ];
    pairs.iter().find_map(|pair| {
        let position = |part: &BodyPart| {
            let joint = parts.get(part)?;
            let limb = all.iter().position(|limb| limb.joint == *joint)?;
            Some(positions[limb])
        };
        let across = position(&pair[0])? - position(&pair[1])?;
        direction(across.cross(Vector3::UNITS[2]))
    })
}

/// Returns the direction towards the thumb of a hand at rest: forward if the arm hangs, otherwise turned with the arm by
/// the smallest rotation.
fn thumb_direction(along: Vector3<f64>, forward: Vector3<f64>) -> Option<Vector3<f64>> {
    let down = -Vector3::UNITS[2];
    let (axis, cosine) = (down.cross(along), down.dot(along));
    // Rodrigues' formula for the smallest rotation of `down` to `along`.
    let turned = forward
        + axis.cross(forward)
        + axis.cross(axis.cross(forward)) * (1.0 / (1.0 + cosine).max(1e-3));
    direction(turned - along * turned.dot(along))
}

/// Returns the axis of the frame that a direction nearly is, or else the direction. Links of hands have axes along their
/// fingers, and origins of forearms are often off their middle.
fn snapped(direction: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = Vector3::UNITS;
    let axes = [x, y, z, -x, -y, -z];
    let nearest = axes
        .into_iter()
        .find(|axis| axis.dot(direction) > MIN_SNAP_COSINE);
    nearest.unwrap_or(direction)
}

/// Returns the number of joints that rotate a hand relative to the forearm.
fn wrist_joints(model: &Model, elbow: FrameId, hand: FrameId) -> usize {
    let above = joints_above(model, elbow);
    let turns = |id: &kinopt_kinematics::model::JointId| {
        let joint = &model.joints()[id.index()];
        !above.contains(id) && joint.moves() && joint.kind.turns()
    };
    joints_above(model, hand)
        .iter()
        .filter(|id| turns(id))
        .count()
}

/// Returns the bases of middle, index and little finger of a side, by names such as `LeftHandIndex1` and `l_index1`.
fn finger_bases(names: &[String], side: &str, other_side: &str) -> Option<[usize; 3]> {
    let base = |words: &[&str]| {
        names.iter().position(|name| {
            let bare = name.chars().filter(|c| c.is_alphanumeric());
            let bare: String = bare.flat_map(char::to_lowercase).collect();
            let is_initial = bare.starts_with(&side[..1]) && !bare.contains(other_side);
            let is_on_side = bare.contains(side) || is_initial;
            is_on_side && bare.ends_with('1') && words.iter().any(|word| bare.contains(word))
        })
    };
    Some([
        base(&["middle"])?,
        base(&["index"])?,
        base(&["pinky", "little"])?,
    ])
}

/// Returns the rotation from the axes of a hand to those of its captured joint. In the mean over all frames, a hand is
/// along the forearm, with the thumb on the side to which the elbow bends.
/// `None` if no frame has a bent elbow.
fn hand_offset(
    capture: &Capture,
    up: UpAxis,
    [shoulder, elbow, wrist]: [usize; 3],
) -> Option<Matrix3<f64>> {
    let offsets = (0..capture.frames()).filter_map(|frame| {
        let pose = SubjectPose::of_frame(capture, frame, up)?;
        let [shoulder, elbow, hand] = [shoulder, elbow, wrist].map(|joint| pose.position(joint));
        let along = direction(hand - elbow)?;
        let upper = direction(shoulder - elbow)?;
        // Short for a straight arm, whose rounding errors determine no side.
        let thumb = upper - along * upper.dot(along);
        let bend = thumb.norm();
        let side = direction(thumb).filter(|_| bend > MIN_BEND_SINE)?;
        let columns = [along, side.cross(along), side].map(|axis| axis * bend);
        let axes = Matrix3::from_columns(columns[0], columns[1], columns[2]);
        Some(pose.rotation(wrist)?.transpose() * axes)
    });
    mean_rotation(offsets)
}

/// Returns the rotation nearest to the sum of some matrices, or `None` without any.
fn mean_rotation(matrices: impl Iterator<Item = Matrix3<f64>>) -> Option<Matrix3<f64>> {
    let mut sum = nalgebra::Matrix3::zeros();
    for Matrix3 { x, y, z } in matrices {
        let columns = [x, y, z].map(|column| nalgebra::Vector3::from(column.to_array()));
        sum += nalgebra::Matrix3::from_columns(&columns);
    }
    let rotation = Polar::new(&sum).filter(|_| sum.amax() > 0.0)?.rotation;
    let column = |k: usize| Vector3::new(rotation[(0, k)], rotation[(1, k)], rotation[(2, k)]);
    Some(Matrix3::from_columns(column(0), column(1), column(2)))
}

/// Returns the capture frames in which two joints are slowest.
fn frames_at_rest(capture: &Capture, joints: [usize; 2]) -> Vec<usize> {
    let moved = |frame: usize| {
        let (now, last) = (capture.frame(frame)?, capture.frame(frame - 1)?);
        let moved = joints.map(|joint| (now[joint] - last[joint]).norm());
        Some((moved[0].max(moved[1]), frame))
    };
    let mut frames: Vec<(f64, usize)> = (1..capture.frames()).filter_map(moved).collect();
    frames.sort_by(|a, b| a.0.total_cmp(&b.0));
    frames.truncate((REST_SHARE * frames.len() as f64).ceil() as usize);
    frames.into_iter().map(|(_, frame)| frame).collect()
}

/// Returns sine and cosine of the slope from ankle to toe while the foot is flat: the median over frames at rest.
fn flat_slope(capture: &Capture, up: UpAxis, ankle: usize, toe: usize) -> (f64, f64) {
    let frames = frames_at_rest(capture, [ankle, toe]).into_iter();
    let sines = frames.filter_map(|frame| {
        let pose = SubjectPose::of_frame(capture, frame, up)?;
        Some(-direction(pose.position(toe) - pose.position(ankle))?.z)
    });
    let mut sines: Vec<f64> = sines.collect();
    let sine = quantile(&mut sines, 0.5).clamp(-MAX_SLOPE, MAX_SLOPE);
    (sine, (1.0 - sine * sine).sqrt())
}
