//! Objects in the hands of a subject: a box or a ball that moves with the capture.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::limbs::Limbs;
use super::map_guess::parts_of_capture;
use super::{BodyPart, Capture, RetargetError, Retargeting};
use crate::motion::contact::NOMINAL_LEG_LENGTH_M;
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};

/// Distance of a wrist from an object up to which the hand holds it, for legs of 0.9 m, metres.
const GRASP_DISTANCE_M: f64 = 0.15;
/// Deviation of the length of a quaternion from 1 that is allowed.
const NORM_TOLERANCE: f64 = 1e-3;

/// Shape of an object about its centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ObjectShape {
    /// Box with these edge lengths along its axes.
    Box([f64; 3]),
    /// Ball with this radius.
    Ball(f64),
}

impl ObjectShape {
    fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Box(size) => Self::Box(size.map(|length| length * factor)),
            Self::Ball(radius) => Self::Ball(radius * factor),
        }
    }

    fn half_extents(self) -> Vector3<f64> {
        match self {
            Self::Box([x, y, z]) => Vector3::new(x, y, z) * 0.5,
            Self::Ball(radius) => Vector3::new(radius, radius, radius),
        }
    }

    /// Returns the point of the shape that is nearest to a point, both relative to its centre.
    fn nearest(self, point: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Box(_) => {
                let half = self.half_extents().to_array();
                let clamped = point.to_array().into_iter().zip(half);
                let clamped: Vec<f64> = clamped.map(|(x, half)| x.clamp(-half, half)).collect();
                Vector3::new(clamped[0], clamped[1], clamped[2])
            }
            Self::Ball(radius) => point * (radius / point.norm().max(radius)),
        }
    }

    /// Returns the height of the centre above the lowest point of a rotated shape.
    fn height(self, pose: &Placement<f64>) -> f64 {
        match self {
            Self::Box(_) => {
                let half = self.half_extents();
                let up = pose.rotation.transpose_mul(Vector3::UNITS[2]);
                up.x.abs() * half.x + up.y.abs() * half.y + up.z.abs() * half.z
            }
            Self::Ball(radius) => radius,
        }
    }

    fn check(self) -> Result<(), BadOption> {
        let lengths = match self {
            Self::Box(size) => size.to_vec(),
            Self::Ball(radius) => vec![radius],
        };
        let mut lengths = lengths.into_iter();
        lengths.try_for_each(|length| BadOption::check("shape", length, POSITIVE))
    }
}

/// Box or ball that moves with a capture.
///
/// The hands of the model keep their places on it, also if the model's object has another size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldObject {
    /// Shape of the subject's object, in the capture's unit.
    pub shape: ObjectShape,
    /// Shape of the model's object, in the model's unit; `None` scales the subject's with the steps.
    #[serde(default)]
    pub model_shape: Option<ObjectShape>,
    /// Pose of the centre in each capture frame, in the capture's unit and axes: x, y, z and a quaternion w, x, y, z.
    pub poses: Vec<[f64; 7]>,
}

impl HeldObject {
    /// Parses an object from JSON: `{"shape": {"box": [0.3, 0.2, 0.2]}, "poses": [[0, 0, 1, 1, 0, 0, 0]]}`, with one pose
    /// a capture frame. `model_shape` is the shape of the model's object.
    ///
    /// # Errors
    /// Returns an error, with its position, if the text is malformed.
    pub fn from_json(text: &str) -> Result<Self, RetargetError> {
        serde_json::from_str(text).map_err(|error| RetargetError::Object(error.to_string()))
    }

    /// Returns the pose of the centre in each capture frame.
    fn placements(&self, frames: usize) -> Result<Vec<Placement<f64>>, RetargetError> {
        self.shape.check()?;
        self.model_shape.map_or(Ok(()), ObjectShape::check)?;
        if self.poses.len() != frames {
            let given = self.poses.len();
            let message = format!("{given} poses, but the capture has {frames} frames");
            return Err(RetargetError::Object(message));
        }
        let poses = self.poses.iter().enumerate().map(|(frame, pose)| {
            let [x, y, z, w, i, j, k] = *pose;
            let rotation = Quaternion { w, v: Vector3::new(i, j, k) };
            let length = (w * w + i * i + j * j + k * k).sqrt();
            let is_valid = [x, y, z].iter().all(|x| x.is_finite()) && (length - 1.0).abs() <= NORM_TOLERANCE;
            match is_valid {
                true => Ok(Placement::new(rotation.to_matrix(), Vector3::new(x, y, z))),
                false => Err(RetargetError::Object(format!(
                    "frame {frame}: a pose is x, y, z and a unit quaternion w, x, y, z, not {pose:?}"
                ))),
            }
        });
        poses.collect()
    }
}

impl Limbs {
    /// Returns the pose of the model's object for that of the subject's, and both shapes.
    fn object_pose(&self, subject: &Placement<f64>, shapes: [ObjectShape; 2]) -> Placement<f64> {
        let axes = self.up().turned_to_z();
        let upright = Placement::new(axes * subject.rotation, axes * subject.translation);
        let floor = self.all.iter().find(|limb| limb.makes_contact);
        let floor = floor.map_or(0.0, |limb| limb.ground - limb.clearance / self.stride);
        let centre = upright.translation;
        let bottom = centre.z - shapes[0].height(&upright) - floor;
        let height = bottom * self.stride + shapes[1].height(&upright);
        let position = Vector3::new(centre.x * self.stride, centre.y * self.stride, height);
        Placement::new(upright.rotation, position)
    }
}

impl Retargeting<'_> {
    /// Adds an object that the subject holds. Hands near it keep their places on the model's object.
    ///
    /// A place on the surface is scaled with the object. `capture` is the one that was retargeted.
    ///
    /// # Errors
    /// Returns an error if the number of poses is not that of the frames, a pose is invalid, or a length is not positive.
    /// Returns an error if no hands are driven.
    pub fn with_object(
        mut self,
        object: &HeldObject,
        capture: &Capture,
    ) -> Result<Self, RetargetError> {
        let placements = object.placements(self.frames())?;
        let parts = parts_of_capture(capture).joints;
        let hands = [BodyPart::LeftHand, BodyPart::RightHand]
            .into_iter()
            .filter_map(|part| {
                let joint = *parts.get(&part)?;
                self.limbs.all.iter().position(|limb| limb.joint == joint)
            });
        let hands: Vec<usize> = hands.collect();
        if hands.is_empty() {
            return Err(RetargetError::Object("the map drives no hand".to_owned()));
        }
        let stride = self.limbs.stride;
        let own = object
            .model_shape
            .map(|shape| shape.scaled(self.unit.scale()));
        let shapes = [object.shape, own.unwrap_or(object.shape.scaled(stride))];
        let [half, own_half] = shapes.map(ObjectShape::half_extents);
        let distance = GRASP_DISTANCE_M / NOMINAL_LEG_LENGTH_M * self.limbs.leg / stride;
        let n = self.limbs.all.len();
        let mut targets = self.targets.to_vec();
        let mut is_held = vec![false; targets.len()];
        let mut places = vec![Vector3::zero(); targets.len()];
        let mut poses = Vec::with_capacity(placements.len());
        for (frame, subject) in placements.iter().enumerate() {
            let captured = capture.frame(frame).unwrap_or_default();
            let model = self.limbs.object_pose(subject, shapes);
            for &hand in &hands {
                let Some(position) = captured.get(self.limbs.all[hand].joint) else {
                    continue;
                };
                let point = subject.inverse().apply(*position);
                let surface = object.shape.nearest(point);
                let place = Vector3::new(
                    surface.x * own_half.x / half.x,
                    surface.y * own_half.y / half.y,
                    surface.z * own_half.z / half.z,
                );
                is_held[frame * n + hand] = (point - surface).norm() <= distance;
                places[frame * n + hand] = model.apply(place + (point - surface) * stride);
            }
            let translation = model.translation * self.unit.inverse_scale();
            poses.push(Placement::new(model.rotation, translation));
        }
        let lead = self.options.contacts.lead_frames(self.frame_rate);
        let mut grasps = vec![0.0; targets.len()];
        for frame in 0..self.frames() {
            let window = frame.saturating_sub(lead)..(frame + lead + 1).min(self.frames());
            for &hand in &hands {
                let held = window
                    .clone()
                    .filter(|frame| is_held[frame * n + hand])
                    .count();
                let level = held as f64 / window.len() as f64;
                let index = frame * n + hand;
                grasps[index] = level;
                targets[index] = targets[index] + (places[index] - targets[index]) * level;
            }
        }
        let inverse_scale = self.unit.inverse_scale();
        self.model_targets = targets
            .iter()
            .map(|target| *target * inverse_scale)
            .collect();
        (self.targets, self.grasps) = (targets.into(), grasps.into());
        self.object_poses = Arc::from(poses);
        Ok(self)
    }

    /// Poses of the model's object in each capture frame, in the model's unit; empty without an object.
    #[must_use]
    pub fn object_poses(&self) -> &[Placement<f64>] {
        &self.object_poses
    }
}
