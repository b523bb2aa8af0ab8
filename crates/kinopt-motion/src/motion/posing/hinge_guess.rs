//! Guessed hinges of knees and elbows.

use std::f64::consts::PI;
use std::fmt;

use kinopt_kinematics::model::Limits;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::skeleton::{Hinge, Skeleton};
use kinopt_kinematics::spatial::Vector3;

use super::body_axes::{BodyAxes, unit};
use super::body_limb::{BodyLimb, BodyLimbKind, LimbSide, limbs};

/// Rest bend, radians, from which the axis is that of the rest bend alone.
const CLEAR_BEND: f64 = 10.0 * PI / 180.0;
/// Smallest rest bend, radians, that has an axis.
const MIN_BEND: f64 = 0.5 * PI / 180.0;
/// Smallest cosine between the axes of the rest bend and of the body for a bend of the anatomical kind.
const MIN_AGREEMENT: f64 = 0.5;
/// Largest angle between the two segments of a limb, radians: a straight limb has 0.
const MAX_FLEXION: f64 = 150.0 * PI / 180.0;

/// Source of a guessed axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HingeSource {
    /// The limb is bent at rest.
    RestBend,
    /// The limb is almost straight. The axis is across the limb and the direction in which the body faces.
    BodyDirection,
    /// The limb is almost straight. The axis is between those of its bend and of the direction of the body.
    Both,
    /// The axis is that of the limb on the other side, mirrored.
    OtherSide,
}

impl fmt::Display for HingeSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RestBend => "rest bend",
            Self::BodyDirection => "body direction",
            Self::Both => "rest bend and body direction",
            Self::OtherSide => "other side",
        })
    }
}

/// A guessed hinge of a bone.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GuessedHinge {
    /// Name of the bone, such as that of a shin or a forearm.
    pub bone: String,
    /// Guessed axis and limits. Positive angles bend the limb further. The limb is straight at the lower limit.
    pub hinge: Hinge,
    /// Angle between the two segments of the limb at rest, radians.
    pub rest_bend: f64,
    /// Source of the axis.
    pub source: HingeSource,
}

/// Guesses hinges for the knees and elbows of a skeleton.
///
/// Names of bones, else lengths and branches, identify limbs of two segments. A limb with a rest bend of 10° or more
/// keeps its plane. In limbs that are almost straight, knees bend backward and elbows forward: feet show where the body
/// faces, else the sides of names do. Both sides get mirrored axes. A limb bends from straight to 150°.
///
/// Locked bones, and limbs without a plane, have no hinge. [`Skeleton::with_hinges`] applies the hinges:
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::io::rig::Rig;
/// use kinopt::motion::posing::guess_hinges;
/// use kinopt::skeleton::Hinges;
///
/// let skeleton = Rig::read("models/humanoid/humanoid.json")?.skeleton;
/// let guessed = guess_hinges(&skeleton);
/// let mut hinges: Hinges = guessed.into_iter().map(|guess| (guess.bone, guess.hinge)).collect();
/// hinges.remove("left_forearm");
/// let hinged = skeleton.with_hinges(&hinges)?;
/// assert_eq!(hinged.hinges().len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn guess_hinges(skeleton: &Skeleton) -> Vec<GuessedHinge> {
    let all = limbs(skeleton);
    let axes = BodyAxes::of(&all);
    let mut found: Vec<Option<LimbAxis>> = all
        .iter()
        .map(|limb| limb_axis(limb, axes.as_ref()))
        .collect();
    if let Some(left) = axes.and_then(|axes| axes.left) {
        mirror_pairs(&all, &mut found, left);
    }
    let bones = skeleton.bones();
    let guesses = all.iter().zip(found).filter_map(|(limb, found)| {
        let LimbAxis { axis, source } = found?;
        let bone = &bones[limb.lower.index()];
        if bone.limits.iter().all(Limits::is_locked) {
            return None;
        }
        let [upper, lower] = segments(limb);
        let signed_bend = elementary::atan2(axis.dot(upper.cross(lower)), upper.dot(lower));
        // A difference, which is 0 and not -0 for a straight limb.
        let straight = 0.0 - signed_bend.max(0.0);
        Some(GuessedHinge {
            bone: bone.name.clone(),
            hinge: Hinge {
                axis: bone.model_from_rest.rotation.transpose_mul(axis),
                limits: Limits::new(straight, (MAX_FLEXION - signed_bend).max(straight)),
            },
            rest_bend: elementary::atan2(upper.cross(lower).norm(), upper.dot(lower)),
            source,
        })
    });
    guesses.collect()
}

/// Axis of a limb in model coordinates, a unit vector.
#[derive(Clone, Copy, Debug)]
struct LimbAxis {
    axis: Vector3<f64>,
    source: HingeSource,
}

fn segments(limb: &BodyLimb) -> [Vector3<f64>; 2] {
    let [upper, middle, end] = limb.joints;
    [middle - upper, end - middle]
}

fn limb_axis(limb: &BodyLimb, axes: Option<&BodyAxes>) -> Option<LimbAxis> {
    let [upper, lower] = segments(limb);
    let across = upper.cross(lower);
    let bend = elementary::atan2(across.norm(), upper.dot(lower));
    let bent = unit(across).filter(|_| bend >= MIN_BEND);
    let anatomical = axes.and_then(|axes| anatomical_axis(limb, axes));
    let with = |axis, source| Some(LimbAxis { axis, source });
    match (bent, anatomical) {
        (Some(bent), None) => with(bent, HingeSource::RestBend),
        (None, Some(anatomical)) => with(anatomical, HingeSource::BodyDirection),
        (None, None) => None,
        (Some(bent), Some(anatomical)) if bent.dot(anatomical) < MIN_AGREEMENT => {
            with(anatomical, HingeSource::BodyDirection)
        }
        (Some(bent), Some(_)) if bend >= CLEAR_BEND => with(bent, HingeSource::RestBend),
        (Some(bent), Some(anatomical)) => {
            let share = bend / CLEAR_BEND;
            let axis = unit(bent * share + anatomical * (1.0 - share))?;
            with(axis, HingeSource::Both)
        }
    }
}

/// Axis about which a knee moves the shin backward, and an elbow the forearm forward.
fn anatomical_axis(limb: &BodyLimb, axes: &BodyAxes) -> Option<Vector3<f64>> {
    let flexion = match limb.kind {
        BodyLimbKind::Leg => -axes.forward,
        BodyLimbKind::Arm => axes.forward,
        BodyLimbKind::Other => return None,
    };
    let along = unit(limb.joints[2] - limb.joints[0])?;
    let axis = along.cross(flexion);
    // A limb along the direction of the body has no such axis.
    unit(axis).filter(|_| axis.norm() >= MIN_AGREEMENT)
}

/// Gives the two limbs of a pair mirrored axes: their mean, or that of one limb if the other has none.
fn mirror_pairs(all: &[BodyLimb], found: &mut [Option<LimbAxis>], left: Vector3<f64>) {
    // The axis of a rotation is a pseudovector: its mirror image is reversed.
    let mirrored = |axis: Vector3<f64>| left * (2.0 * axis.dot(left)) - axis;
    for (a, limb) in all.iter().enumerate() {
        let is_partner =
            |other: &BodyLimb| other.kind == limb.kind && other.side == Some(LimbSide::Right);
        if limb.side != Some(LimbSide::Left) {
            continue;
        }
        let Some(b) = all.iter().position(is_partner) else {
            continue;
        };
        match (found[a], found[b]) {
            (Some(one), Some(other)) if one.axis.dot(mirrored(other.axis)) >= MIN_AGREEMENT => {
                if let Some(mean) = unit(one.axis + mirrored(other.axis)) {
                    found[a] = Some(LimbAxis { axis: mean, ..one });
                    found[b] = Some(LimbAxis {
                        axis: mirrored(mean),
                        ..other
                    });
                }
            }
            (Some(one), None) => found[b] = Some(of_other_side(mirrored(one.axis))),
            (None, Some(other)) => found[a] = Some(of_other_side(mirrored(other.axis))),
            _ => {}
        }
    }
}

fn of_other_side(axis: Vector3<f64>) -> LimbAxis {
    LimbAxis {
        axis,
        source: HingeSource::OtherSide,
    }
}
