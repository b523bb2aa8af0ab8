//! Reference pose of a subject, with z up: its rest pose, or its most upright captured pose.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::super::{BodyPart, Capture, UpAxis};
use kinopt_kinematics::spatial::Vector3;

/// Largest number of capture frames among which a reference pose is searched.
const MAX_SEARCHED_FRAMES: usize = 2000;
/// Smallest cosine of the angle of legs and spine with the vertical in an upright rest pose.
const MIN_UPRIGHT: f64 = 0.7;

/// Smallest cosine of the angle between equal directions.
const MIN_EQUAL: f64 = 0.995;

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
    /// Selects the rest pose if the subject is upright in it. Otherwise selects the most upright captured pose, as for
    /// files whose bones at rest are all along one axis. `character` are the positions of a character at rest: a subject
    /// with the same rest pose keeps its own.
    pub(super) fn new(
        capture: &Capture,
        up: UpAxis,
        joints: &BTreeMap<BodyPart, usize>,
        character: &dyn Fn(BodyPart) -> Option<DVec3>,
    ) -> Self {
        let upright_of = |positions: &[Vector3<f64>]| -> Vec<DVec3> {
            positions.iter().map(|at| upright(up, *at)).collect()
        };
        if let (Some(posed), Some(rest)) = (capture.posed(), capture.rest()) {
            let positions = upright_of(rest);
            let subject =
                |part: BodyPart| joints.get(&part).and_then(|joint| positions.get(*joint));
            let is_same = have_equal_directions(&|part| subject(part).copied(), character);
            if is_same || uprightness(&positions, joints) >= MIN_UPRIGHT {
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

/// Limbs of the legs and the trunk, downwards.
const LIMBS: [(BodyPart, BodyPart); 6] = [
    (BodyPart::LeftHip, BodyPart::LeftKnee),
    (BodyPart::LeftKnee, BodyPart::LeftAnkle),
    (BodyPart::RightHip, BodyPart::RightKnee),
    (BodyPart::RightKnee, BodyPart::RightAnkle),
    (BodyPart::Chest, BodyPart::Pelvis),
    (BodyPart::Head, BodyPart::Pelvis),
];

/// Returns whether the limbs of two bodies have equal directions.
fn have_equal_directions(
    first: &dyn Fn(BodyPart) -> Option<DVec3>,
    second: &dyn Fn(BodyPart) -> Option<DVec3>,
) -> bool {
    let direction =
        |at: &dyn Fn(BodyPart) -> Option<DVec3>, from, to| (at(to)? - at(from)?).try_normalize();
    LIMBS.iter().all(|(from, to)| {
        let directions = (direction(first, *from, *to), direction(second, *from, *to));
        matches!(directions, (Some(a), Some(b)) if a.dot(b) > MIN_EQUAL)
    })
}

/// Returns the smallest cosine of the angles between the vertical and the limbs of the legs and the trunk: 1 for an
/// upright person.
fn uprightness(positions: &[DVec3], joints: &BTreeMap<BodyPart, usize>) -> f64 {
    let at = |part: BodyPart| joints.get(&part).and_then(|joint| positions.get(*joint));
    let cosines = LIMBS.iter().filter_map(|(from, to)| {
        let along = (*at(*to)? - *at(*from)?).try_normalize()?;
        Some(-along.z)
    });
    cosines.fold(1.0, f64::min)
}
