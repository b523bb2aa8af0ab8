//! Reference pose of a subject, with z up: its rest pose, or its most upright captured pose.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::super::{BodyPart, Capture, UpAxis};
use kinopt_kinematics::spatial::Vector3;

/// Largest number of capture frames among which a reference pose is searched.
const MAX_SEARCHED_FRAMES: usize = 2000;
/// Smallest cosine of the angle of legs and spine with the vertical in a rest pose of a person who stands.
const MIN_UPRIGHT: f64 = 0.7;

/// Subject in a reference pose, and the rotation of its captures to z up.
#[derive(Clone, Debug)]
pub(super) struct ReferencePose {
    pub(super) up: UpAxis,
    /// Positions of the captured joints, in the capture's unit.
    pub(super) positions: Vec<DVec3>,
    /// Rotations from the joints to the capture's world; `None` for captures without rotations.
    pub(super) rotations: Option<Vec<DQuat>>,
}

/// Returns a vector of a capture with z up.
pub(super) fn upright(up: UpAxis, v: Vector3<f64>) -> DVec3 {
    DVec3::from_array(up.upright(v).to_array())
}

/// Returns a rotation of a capture's world in the world with z up.
pub(super) fn upright_rotation(up: UpAxis, q: DQuat) -> DQuat {
    let v = upright(up, Vector3::new(q.x, q.y, q.z));
    DQuat::from_xyzw(v.x, v.y, v.z, q.w)
}

impl ReferencePose {
    /// Selects the rest pose if the subject stands in it. Otherwise selects the captured pose that is most like
    /// standing, as for files whose bones at rest are all along one axis.
    pub(super) fn new(capture: &Capture, up: UpAxis, joints: &BTreeMap<BodyPart, usize>) -> Self {
        let upright_of = |positions: &[Vector3<f64>]| -> Vec<DVec3> {
            positions.iter().map(|at| upright(up, *at)).collect()
        };
        if let (Some(posed), Some(rest)) = (capture.posed(), capture.rest()) {
            let positions = upright_of(rest);
            if uprightness(&positions, joints) >= MIN_UPRIGHT {
                return Self {
                    up,
                    positions,
                    rotations: Some(posed.rest.clone()),
                };
            }
        }
        let step = capture.frames().div_ceil(MAX_SEARCHED_FRAMES).max(1);
        let frames = (0..capture.frames()).step_by(step);
        let scored = frames.filter_map(|frame| {
            let positions = upright_of(capture.frame(frame)?);
            Some((uprightness(&positions, joints), frame, positions))
        });
        // The first of equal poses.
        let best = scored.reduce(|best, next| match next.0 > best.0 {
            true => next,
            false => best,
        });
        let (_, frame, positions) = best.unwrap_or_default();
        let joints = capture.names().len();
        let rotations = capture.posed().map(|posed| {
            let rotations = posed.rotations.iter().skip(frame * joints).take(joints);
            rotations.copied().collect()
        });
        Self {
            up,
            positions,
            rotations,
        }
    }
}

/// Returns the smallest cosine of the angles between the vertical and the limbs of the legs and the trunk: 1 for a
/// person who stands upright.
fn uprightness(positions: &[DVec3], joints: &BTreeMap<BodyPart, usize>) -> f64 {
    use BodyPart::*;
    let at = |part: BodyPart| joints.get(&part).and_then(|joint| positions.get(*joint));
    let limbs = [
        (LeftHip, LeftKnee),
        (LeftKnee, LeftAnkle),
        (RightHip, RightKnee),
        (RightKnee, RightAnkle),
        (Chest, Pelvis),
        (Head, Pelvis),
    ];
    let cosines = limbs.iter().filter_map(|(from, to)| {
        let along = (*at(*to)? - *at(*from)?).try_normalize()?;
        Some(-along.z)
    });
    cosines.fold(1.0, f64::min)
}
