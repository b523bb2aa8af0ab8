//! Options and entry point of inverse kinematics over a clip.

use std::fmt;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::posed_bones::BoneHinges;
use super::root_bone::{ancestors, branching_above};
use super::{ClipIkError, Reach};
use crate::motion::ContactDetection;
use crate::motion::contact::NOMINAL_LEG_LENGTH_M;
use kinopt_animation::animation::{Armature, Clip, ClipError};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::Vector3;

/// Height of the ground at a position in the model, along the up axis.
type Height = Arc<dyn Fn(Vector3<f64>) -> f64 + Send + Sync>;

/// Converts a vector to single precision, the precision of clips.
pub(super) fn single(vector: impl Into<Vector3<f64>>) -> Vec3 {
    DVec3::from(vector.into()).as_vec3()
}

/// Inverse kinematics over an animation clip.
///
/// Each frame is one solve:
///
/// - A bone [reaches](Self::with_reach) for a point, or follows a curve, over a span of the clip.
/// - [Planted](Self::with_planted) feet are locked while the clip has them in contact with the ground.
/// - All other joints stay as near to the clip as these tasks allow.
/// - The root moves only as far as needed to bring a target within the length of its limb. On an uneven
///   [ground](Self::with_ground) it follows the height of the feet.
///
/// Bones outside these limbs keep their channels.
///
/// ```no_run
/// use kinopt::io::gltf::SceneFile;
/// use kinopt::motion::clip_ik::{ClipIk, Reach};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let file = SceneFile::read("character.glb")?;
/// let (scene, armature) = (file.scene(), &file.scene().armature);
/// let hand = Reach::to(armature.bone("hand.r")?, [0.4, 1.2, 0.3])?.with_span(0.5..=1.5).with_fade(0.3);
/// let edited = ClipIk::new(armature)
///     .with_planted(armature.bone("foot.l")?)
///     .with_planted(armature.bone("foot.r")?)
///     .with_reach(hand)
///     .solve(scene.clip("Walk")?)?;
/// assert!(edited.report.stances.iter().all(|stance| stance.slide < 1e-3));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct ClipIk<'a> {
    pub(super) armature: &'a Armature,
    skeleton: Option<&'a Skeleton>,
    pub(super) reaches: Vec<Reach>,
    pub(super) planted: Vec<BoneId>,
    root: Option<BoneId>,
    up: Vec3,
    pub(super) rate: f64,
    detection: Option<ContactDetection>,
    pub(super) ground: Option<Height>,
    root_velocity: Vec3,
}

impl fmt::Debug for ClipIk<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClipIk")
            .field("reaches", &self.reaches)
            .field("planted", &self.planted)
            .field("root", &self.root)
            .finish_non_exhaustive()
    }
}

/// Largest height of a foot in contact above its lowest position, as a fraction of the limb's length.
const MAX_HEIGHT_RATIO: f64 = 0.125;

/// Largest speed of a foot in contact, as a fraction of its mean speed. Feet in game clips rarely stop completely.
const MAX_SPEED_RATIO: f64 = 0.5;

/// Validated request to solve a clip.
pub(super) struct ClipRequest {
    /// Planted bones first, in the order they were added, then the bones of the reaches.
    pub(super) bones: Vec<BoneId>,
    pub(super) root: Option<BoneId>,
    /// First and last time of the clip, seconds.
    pub(super) span: [f64; 2],
    pub(super) up: Vector3<f64>,
    /// Displacement per second, in the armature's unit of length.
    pub(super) root_velocity: DVec3,
}

impl<'a> ClipIk<'a> {
    /// Creates a solver without tasks for clips of an armature. Every bone is a ball joint without limits. The default
    /// rate is 60 frames per second, and the default up axis is y.
    #[must_use]
    pub fn new(armature: &'a Armature) -> Self {
        Self {
            armature,
            skeleton: None,
            reaches: Vec::new(),
            planted: Vec::new(),
            root: None,
            up: Vec3::Y,
            rate: 60.0,
            detection: None,
            ground: None,
            root_velocity: Vec3::ZERO,
        }
    }

    /// Uses the joints of a skeleton, within their limits. The tips of its bones, not their origins, are then the
    /// end effectors.
    ///
    /// The armature must be [built from this skeleton](Armature::of_skeleton). It may have more bones after those
    /// of the skeleton.
    #[must_use]
    pub fn with_joints_of(mut self, skeleton: &'a Skeleton) -> Self {
        self.skeleton = Some(skeleton);
        self
    }

    /// Adds a reach.
    #[must_use]
    pub fn with_reach(mut self, reach: Reach) -> Self {
        self.reaches.push(reach);
        self
    }

    /// Adds a planted bone, most often a foot or its toes. Its origin is locked while the bone is in contact by the
    /// [criteria](Self::with_detection). The bone keeps its orientation of the clip in the model.
    #[must_use]
    pub fn with_planted(mut self, bone: BoneId) -> Self {
        self.planted.push(bone);
        self
    }

    /// Sets the root: the bone that is translated if a limb is too short. Only bones below it rotate.
    ///
    /// Default: the topmost bone that carries all requested bones and has more than one child. Children without
    /// children of their own, such as mesh nodes, count only if the clip moves them. If no bone has several such
    /// children, all children count. If no bone has several children, all bones rotate.
    #[must_use]
    pub fn with_root(mut self, bone: BoneId) -> Self {
        self.root = Some(bone);
        self
    }

    /// Sets the up axis in the model. Default: y, as in glTF.
    #[must_use]
    pub fn with_up(mut self, axis: impl Into<Vector3<f64>>) -> Self {
        self.up = single(axis);
        self
    }

    /// Sets the number of solved frames and of keys per second. Keys are denser where a foot in contact would
    /// otherwise drift by more than a thousandth of its limb's length.
    #[must_use]
    pub fn with_keys_per_second(mut self, rate: f64) -> Self {
        self.rate = rate;
        self
    }

    /// Sets the criteria of foot contact, in the armature's unit of length.
    ///
    /// Defaults, with the length L of the limb:
    ///
    /// - The speed is at most 0.28 L per second, or half of the foot's mean speed in the clip if that is larger.
    /// - The height above the foot's lowest position is at most L/8.
    /// - The contact lasts at least 0.1 s.
    #[must_use]
    pub fn with_detection(mut self, detection: ContactDetection) -> Self {
        self.detection = Some(detection);
        self
    }

    /// Sets the velocity of the root, in the armature's unit of length per second, for a clip that walks in place.
    /// The root moves with it, and foot contacts are detected along the displaced motion. Without it the feet of
    /// such a clip slide, so no contact is detected. [`ground_speed`](super::ground_speed) measures it.
    #[must_use]
    pub fn with_root_velocity(mut self, per_second: impl Into<Vector3<f64>>) -> Self {
        self.root_velocity = single(per_second);
        self
    }

    /// Sets the height of the ground as a function of position, for a clip that walks on ground of height 0. Feet
    /// in contact are on this ground, and the root follows its height.
    #[must_use]
    pub fn with_ground(
        mut self,
        height: impl Fn(Vector3<f64>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.ground = Some(Arc::new(height));
        self
    }

    /// Checks the tasks and options against a clip.
    pub(super) fn check(&self, clip: &Clip) -> Result<ClipRequest, ClipIkError> {
        SizeMismatch::check("bones in the clip", clip.bones(), self.armature.bones())?;
        for (index, bone) in self
            .skeleton
            .iter()
            .flat_map(|skeleton| skeleton.bones().iter().enumerate())
        {
            if self.armature.names().get(index) != Some(&bone.name) {
                return Err(ClipIkError::OtherSkeleton {
                    bone: bone.name.clone(),
                });
            }
        }
        if let Some(detection) = &self.detection {
            detection.check()?;
        }
        let up = self.up.try_normalize();
        let up = up.ok_or(ClipError::BadUp {
            up: self.up.to_array(),
        })?;
        let span = clip.span().map(f64::from);
        let mut bones: Vec<BoneId> = Vec::new();
        for &bone in &self.planted {
            if bones.contains(&bone) {
                return Err(self.duplicate_target(bone)?);
            }
            bones.push(bone);
        }
        for (k, reach) in self.reaches.iter().enumerate() {
            reach.check(span)?;
            let mut before = self.reaches[..k].iter();
            let is_planted = self.planted.contains(&reach.bone);
            if is_planted || before.any(|other| reach.clashes(other, span)) {
                return Err(self.duplicate_target(reach.bone)?);
            }
            if !bones.contains(&reach.bone) {
                bones.push(reach.bone);
            }
        }
        if bones.is_empty() {
            return Err(ClipIkError::Nothing);
        }
        for &bone in bones.iter().chain(&self.root) {
            self.name(bone)?;
        }
        let root = match self.root {
            Some(root) => Some(root),
            None => self.default_root(clip, &bones)?,
        };
        for (&bone, &root) in bones
            .iter()
            .flat_map(|bone| root.iter().map(move |root| (bone, root)))
        {
            if !ancestors(self.armature, bone).contains(&root) {
                return Err(ClipIkError::NotBelowRoot {
                    bone: self.name(bone)?.to_owned(),
                    root: self.name(root)?.to_owned(),
                });
            }
        }
        if !self.root_velocity.is_finite() || (self.root_velocity != Vec3::ZERO && root.is_none()) {
            return Err(ClipIkError::RootVelocity {
                root_velocity: self.root_velocity.to_array(),
            });
        }
        Ok(ClipRequest {
            bones,
            root,
            root_velocity: self.root_velocity.as_dvec3(),
            span,
            up: Vector3::from(up.as_dvec3().to_array()),
        })
    }

    /// Returns the topmost branch of the armature above some bones.
    fn default_root(&self, clip: &Clip, bones: &[BoneId]) -> Result<Option<BoneId>, ClipIkError> {
        let jointed = self.skeleton.map_or(0, |skeleton| skeleton.bones().len());
        let mut is_bone: Vec<bool> = (0..self.armature.bones()).map(|k| k < jointed).collect();
        for (bone, _) in clip.channels(self.armature)? {
            is_bone[bone.index()] = true;
        }
        Ok(branching_above(self.armature, bones, |bone| {
            is_bone[bone.index()]
        }))
    }

    fn duplicate_target(&self, bone: BoneId) -> Result<ClipIkError, ClipIkError> {
        let bone = self.name(bone)?.to_owned();
        Ok(ClipIkError::Twice { bone })
    }

    fn name(&self, bone: BoneId) -> Result<&str, ClipIkError> {
        let names = self.armature.names();
        let name = names.get(bone.index()).map(String::as_str);
        name.ok_or(ClipIkError::UnknownBone {
            bone: bone.index(),
            bones: names.len(),
        })
    }

    /// Returns the joints of a skeleton's bone. `None` without a skeleton.
    #[doc(hidden)]
    pub fn hinges(&self, bone: BoneId) -> Option<BoneHinges> {
        let skeleton_bone = self.skeleton?.bones().get(bone.index())?;
        let rest = self
            .armature
            .rest()
            .local_of(bone)
            .rotation
            .as_dquat()
            .normalize();
        Some(BoneHinges {
            rest,
            limits: skeleton_bone.limits,
            length: skeleton_bone.length,
        })
    }

    /// Returns the contact criteria of a foot that moves along `positions`, at the end of a limb of the given length.
    pub(super) fn detection_of(
        &self,
        positions: &[Vector3<f64>],
        length: f64,
        rate: f64,
    ) -> ContactDetection {
        let defaults = ContactDetection::default();
        let path_length: f64 = positions
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        let mean = path_length * rate / positions.len().saturating_sub(1).max(1) as f64;
        self.detection.unwrap_or(ContactDetection {
            speed: (defaults.speed * length / NOMINAL_LEG_LENGTH_M).max(MAX_SPEED_RATIO * mean),
            height: MAX_HEIGHT_RATIO * length,
            ..defaults
        })
    }
}
