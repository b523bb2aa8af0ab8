//! Target positions of a model from captured joint positions.

use glam::DQuat;

use super::limb::DrivenLimb;
use super::limb_lengths::{capture_positions, lengths, model_positions, quantile, rest_length};
use super::limb_tree::{hips, leg_limbs, moving_joint, order};
use super::orientations::Orientations;
use super::pelvis_heading::HipLine;
use super::sole::{Sole, ends_on_ground, soles};
use super::subject_pose::SubjectPose;
use super::up_detection::upward;
use super::{BodyMap, Capture, FootShapes, RetargetError, UpAxis};
use crate::motion::contact::mean_position;
use kinopt_kinematics::kinematics::{ForwardKinematics, KinematicsError};
use kinopt_kinematics::model::{Model, UnknownName};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Limb length, relative to the body, below which a limb counts as missing and is not scaled.
const MIN_LIMB_RATIO: f64 = 1e-6;
/// Quantile of the heights of a contact point that counts as the ground.
const GROUND_QUANTILE: f64 = 0.05;

/// All driven frames, parents first, with the conversion of captured positions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limbs {
    pub(super) all: Vec<DrivenLimb>,
    /// Indices of the limbs between the root and the legs.
    pub(super) hips: Vec<usize>,
    /// Task of the pelvis heading.
    pub(super) hip_line: Option<HipLine>,
    /// Orientations of feet and hands.
    pub(super) orientations: Orientations,
    /// Contact geometry of feet with shapes.
    pub(super) soles: Vec<Sole>,
    up: UpAxis,
    /// Ratio of the model's steps to the subject's.
    pub(super) stride: f64,
    /// Leg length of the model, metres; 0 without contact points.
    pub(super) leg: f64,
    /// Axis along which the model's root is above its feet.
    pub(super) model_up: Option<UpAxis>,
}

impl Limbs {
    /// Returns the largest weight of a point.
    pub(super) fn max_weight(&self) -> f64 {
        let weights = self.all.iter().map(|limb| limb.weight);
        weights.fold(f64::MIN_POSITIVE, f64::max)
    }

    pub(super) fn new(
        model: &Model,
        map: &BodyMap,
        capture: &Capture,
        up: UpAxis,
        stance: &[f64],
        shapes: &FootShapes,
    ) -> Result<Self, RetargetError> {
        let mut all = mapped_limbs(model, map, capture)?;
        order(model, &mut all);
        let mut model_lengths = lengths(&all, &model_positions(model, &all)?);
        let mut kinematics = ForwardKinematics::new(model);
        let map_error = |error: KinematicsError| RetargetError::Map(error.to_string());
        let rest = kinematics.place(&model.neutral()).map_err(map_error)?;
        for (length, limb) in model_lengths.iter_mut().zip(&all) {
            *length = rest_length(model, &all, limb, rest).unwrap_or(*length);
        }
        let captured = capture_positions(capture, &all, up);
        let subject_lengths = lengths(&all, &captured);
        let size: f64 = subject_lengths.iter().sum();
        for (limb, (model_length, subject_length)) in all
            .iter_mut()
            .zip(model_lengths.iter().zip(&subject_lengths))
        {
            if limb.scale == 0.0 {
                let is_measurable = *subject_length > MIN_LIMB_RATIO * size;
                limb.scale = if is_measurable {
                    model_length / subject_length
                } else {
                    1.0
                };
            }
        }
        // Ratio of leg lengths, so that steps and obstacles fit the legs.
        let has_contacts = all.iter().any(|limb| limb.makes_contact);
        let legs = leg_limbs(&all, has_contacts);
        let total = |lengths: &[f64]| -> f64 { legs.iter().map(|&limb| lengths[limb]).sum() };
        let (model_leg, subject_leg) = (total(&model_lengths), total(&subject_lengths));
        let stride = if subject_leg > 0.0 && model_leg > 0.0 {
            model_leg / subject_leg
        } else {
            1.0
        };
        let count = all.len();
        for (k, limb) in all.iter_mut().enumerate() {
            let positions = captured.iter().skip(k).step_by(count);
            let mut heights: Vec<f64> = positions.map(|position| position.z).collect();
            limb.ground = quantile(&mut heights, GROUND_QUANTILE);
        }
        let placed = kinematics.place(stance).map_err(map_error)?;
        let stance_positions = all
            .iter()
            .map(|limb| placed[limb.frame.index()].apply(limb.offset));
        let stance_positions: Vec<_> = stance_positions.collect();
        move_heels_to_feet(model, &mut all, shapes, placed);
        let orientations = Orientations::new(model, &all, capture, up, placed);
        let soles = soles(model, &all, shapes, placed);
        let ground = ground_of_stance(&soles, &stance_positions, placed);
        for (limb, position) in all.iter_mut().zip(&stance_positions) {
            limb.clearance = position.z - ground;
            limb.stance = *position;
        }
        let feet = all
            .iter()
            .zip(&stance_positions)
            .filter(|(limb, _)| limb.makes_contact);
        let feet: Vec<_> = feet.map(|(_, position)| *position).collect();
        let root_above_feet = match (stance_positions.first(), feet.len()) {
            (Some(root), 1..) => *root - mean_position(&feet),
            _ => Vector3::zero(),
        };
        let top_limbs = legs.iter().filter(|&&limb| {
            let parent = all[limb].parent;
            parent.is_none_or(|parent| !legs.contains(&parent))
        });
        let leg = if has_contacts {
            model_leg / top_limbs.count().max(1) as f64
        } else {
            0.0
        };
        // The root has the subject's height above contact points.
        let contact_limbs = all
            .iter()
            .filter(|limb| limb.makes_contact || !has_contacts);
        let lowest = contact_limbs.min_by(|a, b| a.ground.total_cmp(&b.ground));
        let (ground, sole_height) = lowest.map_or((0.0, 0.0), |limb| (limb.ground, limb.clearance));
        if let Some(root) = all.first_mut().filter(|root| !root.makes_contact) {
            (root.ground, root.clearance) = (ground, sole_height);
        }
        let mut limbs = Self {
            hips: hips(&all),
            hip_line: None,
            orientations,
            soles,
            all,
            up,
            stride,
            leg,
            model_up: upward(root_above_feet),
        };
        limbs.hip_line = HipLine::new(&limbs, &stance_positions);
        Ok(limbs)
    }

    /// Returns whether a limb's target is in world coordinates, as for the root and feet, instead of relative to its
    /// parent.
    fn is_in_world(&self, limb: &DrivenLimb) -> bool {
        limb.parent
            .is_none_or(|parent| limb.makes_contact && !self.all[parent].makes_contact)
    }

    /// Writes the target positions of the driven points, metres.
    ///
    /// The root and feet are scaled by the leg ratio in the world. Other limbs follow their parents with scaled
    /// lengths.
    pub(super) fn write_targets(
        &self,
        captured: &[Vector3<f64>],
        rotations: Option<&[DQuat]>,
        to: &mut Vec<Vector3<f64>>,
    ) {
        to.clear();
        let upright_position = |limb: &DrivenLimb| self.up.upright(captured[limb.joint]);
        for (k, limb) in self.all.iter().enumerate() {
            let position = upright_position(limb);
            if let (Some(foot), Some(ankle)) = (self.orientations.foot_of_toe(k), limb.parent) {
                let axes = foot.axes(&SubjectPose::new(self.up, captured, rotations));
                to.push(to[ankle] + foot.toe_offset(&axes));
                continue;
            }
            to.push(match limb.parent {
                Some(parent) if !self.is_in_world(limb) => {
                    to[parent] + (position - upright_position(&self.all[parent])) * limb.scale
                }
                Some(_) => self.in_world(limb, position),
                // The root is placed relative to the hips, by the ratio of their limb lengths.
                None => {
                    let offset = |hip: &usize| position - upright_position(&self.all[*hip]);
                    let scaled_offset = |hip: &usize| offset(hip) * self.all[*hip].scale;
                    let mean = |sum: Vector3<f64>| sum * (1.0 / self.hips.len().max(1) as f64);
                    let subject_offset = mean(
                        self.hips
                            .iter()
                            .map(offset)
                            .fold(Vector3::zero(), |a, b| a + b),
                    );
                    let model = mean(
                        self.hips
                            .iter()
                            .map(scaled_offset)
                            .fold(Vector3::zero(), |a, b| a + b),
                    );
                    self.in_world(limb, position - subject_offset) + model
                }
            });
        }
    }

    /// Upward axis of the capture.
    pub(super) fn up(&self) -> UpAxis {
        self.up
    }

    /// Returns whether the foot of a sole has the subject's orientation.
    pub(super) fn orients(&self, sole: &Sole) -> bool {
        let mut limbs = sole.balls.iter().map(|(_, limb)| *limb);
        limbs.any(|limb| self.orientations.has_foot(limb))
    }

    /// Writes the directions of the driven axes of feet and hands.
    pub(super) fn write_directions(
        &self,
        captured: &[Vector3<f64>],
        rotations: Option<&[DQuat]>,
        to: &mut Vec<Vector3<f64>>,
    ) {
        let pose = SubjectPose::new(self.up, captured, rotations);
        self.orientations.write_directions(&pose, to);
    }

    /// Converts a position to the model's world.
    fn in_world(&self, limb: &DrivenLimb, position: Vector3<f64>) -> Vector3<f64> {
        let relative = Vector3::new(position.x, position.y, position.z - limb.ground);
        relative * self.stride + Vector3::new(0.0, 0.0, limb.clearance)
    }
}

/// Returns the ground height in a stance: that of the lowest contact geometry, or else of the lowest frame or driven
/// point.
fn ground_of_stance(
    soles: &[Sole],
    stance_positions: &[Vector3<f64>],
    placed: &[Placement<f64>],
) -> f64 {
    let lowest = |heights: &mut dyn Iterator<Item = f64>| heights.fold(f64::INFINITY, f64::min);
    let sole_heights = soles
        .iter()
        .map(|sole| sole.lowest(&placed[sole.frame.index()]));
    match lowest(&mut sole_heights.into_iter()) {
        f64::INFINITY => {
            let frames = placed.iter().map(|frame| frame.translation.z);
            lowest(&mut frames.chain(stance_positions.iter().map(|position| position.z)))
        }
        height => height,
    }
}

/// Moves the contact point of an ankle to the foot if a toe beyond it is in contact too.
///
/// The frame of an ankle is often on the shin, which would be locked with the foot. An ankle whose body reaches the
/// ground with a heel keeps its frame. `placed` are the frames of the model in a configuration.
fn move_heels_to_feet(
    model: &Model,
    all: &mut [DrivenLimb],
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) {
    for ankle in 0..all.len() {
        let is_toe_beyond = |toe: &&DrivenLimb| {
            let moving = [&all[ankle], *toe].map(|limb| moving_joint(model, limb.frame));
            toe.parent == Some(ankle) && toe.makes_contact && moving[0] != moving[1]
        };
        let foot = all.iter().find(is_toe_beyond).map(|toe| toe.frame);
        let foot = foot.filter(|_| !ends_on_ground(model, &all[ankle], shapes, placed));
        let limb = &mut all[ankle];
        if let Some(foot) = foot.filter(|_| limb.makes_contact) {
            let world_position = placed[limb.frame.index()].apply(limb.offset);
            limb.offset = placed[foot.index()].inverse().apply(world_position);
            (limb.frame, limb.is_heel) = (foot, true);
        }
    }
}

/// Returns the driven frames in the order of the map, without parents and lengths.
fn mapped_limbs(
    model: &Model,
    map: &BodyMap,
    capture: &Capture,
) -> Result<Vec<DrivenLimb>, RetargetError> {
    let mut all: Vec<DrivenLimb> = Vec::with_capacity(map.drives.len());
    for drive in &map.drives {
        drive.check()?;
        let frame = model.frame(&drive.frame)?;
        if let Some(other) = all
            .iter()
            .find(|limb| limb.frame == frame && limb.offset == drive.offset)
        {
            return Err(RetargetError::DrivenTwice {
                frame: drive.frame.clone(),
                first: capture.names()[other.joint].clone(),
                second: drive.joint.clone(),
            });
        }
        all.push(DrivenLimb {
            joint: capture.joint(&drive.joint)?,
            frame,
            offset: drive.offset,
            weight: drive.weight,
            parent: None,
            scale: drive.scale.unwrap_or(0.0),
            makes_contact: match &map.contacts {
                Some(contacts) => contacts.contains(&drive.joint),
                None => drive.names_foot_part(),
            },
            is_heel: false,
            stance: Vector3::zero(),
            clearance: 0.0,
            ground: 0.0,
        });
    }
    for contact in map.contacts.iter().flatten() {
        let driving = map.drives.iter().map(|drive| drive.joint.as_str());
        if !map.drives.iter().any(|drive| drive.joint == *contact) {
            return Err(UnknownName::new("driving joint", contact, driving).into());
        }
    }
    match all.is_empty() {
        true => Err(RetargetError::NoDrives {
            model: model.name().to_owned(),
        }),
        false => Ok(all),
    }
}
