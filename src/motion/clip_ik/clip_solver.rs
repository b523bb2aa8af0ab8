//! What is asked over a clip, and how it is solved.

use std::fmt;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::edited::EditedClip;
use super::posed_bones::Hinges;
use super::root_bone::{above, branching_above};
use super::solving::solve;
use super::{ClipIkError, Reach};
use crate::SizeMismatch;
use crate::animation::{Armature, ChannelError, Clip};
use crate::motion::ContactDetection;
use crate::motion::contact_detection::USUAL_LEG_M;
use crate::skeleton::{BoneId, Skeleton};
use crate::spatial::Vector3;

/// The height of a place in the model, along the axis up.
type Height = Arc<dyn Fn(Vector3<f64>) -> f64 + Send + Sync>;

/// In single precision, as clips are.
pub(super) fn single(vector: impl Into<Vector3<f64>>) -> Vec3 {
    DVec3::from(vector.into()).as_vec3()
}

/// Inverse kinematics over a clip.
///
/// A bone [reaches](Self::with_reach) for a point or along a curve over a span; feet are [planted](Self::with_planted) where they hardly
/// move. Each frame keeps as near to the clip as that allows. The root, and with it the whole character, moves only where
/// a limb would be too short, and as little as it must; on a [ground](Self::with_ground) that is not level it goes up and down with
/// the feet. What hangs on neither is as the clip has it.
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
/// assert!(edited.stances.iter().all(|stance| stance.slide < 1e-3));
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

/// A foot that is further up than this share of its limb over where it is lowest does not stand.
const RAISED: f64 = 0.125;

/// What stands moves at no more than this share of the foot's mean speed: clips of games hardly stop a foot.
const SLOW: f64 = 0.5;

/// What a clip is to do, checked.
pub(super) struct ClipRequest {
    /// Those that are planted first, in their order.
    pub(super) bones: Vec<BoneId>,
    pub(super) root: Option<BoneId>,
    /// The clip's, in seconds.
    pub(super) span: [f64; 2],
    pub(super) up: Vector3<f64>,
    /// A second.
    pub(super) root_velocity: DVec3,
}

impl<'a> ClipIk<'a> {
    /// Over clips of an armature, whose bones turn any way. At 60 frames a second, up is y.
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

    setters! {
        /// Bones turn about the joints of a skeleton, within its limits, and it is their tips that reach and stand: of the
        /// one that the armature [is of](Armature::of_skeleton), behind whose bones it may have others.
        pub fn with_joints_of(mut self, skeleton: &'a Skeleton) { self.skeleton = Some(skeleton) }
        /// Something to reach for.
        pub fn with_reach(mut self, reach: Reach) { self.reaches.push(reach) }
        /// A bone, most often a foot or its toes, whose origin stands still where it hardly moves in the clip. It keeps how
        /// it is turned in the model.
        pub fn with_planted(mut self, bone: BoneId) { self.planted.push(bone) }
        /// The bone that moves where limbs are too short, and below which bones turn. Unless set, the first from the top
        /// that carries all bones asked for and at which the armature branches; without one, all bones turn.
        pub fn with_root(mut self, bone: BoneId) { self.root = Some(bone) }
        /// Which way is up in the model: y unless set, as in glTF.
        pub fn with_up(mut self, axis: impl Into<Vector3<f64>>) { self.up = single(axis) }
        /// How many frames a second are solved, and keys made: more where a foot that stands would stray by more than a
        /// thousandth of its limb between two.
        pub fn with_keys_per_second(mut self, rate: f64) { self.rate = rate }
        /// When a foot stands, in the armature's unit of length. Unless set, as long as it moves by less than 0.28 lengths of
        /// its limb a second or half of its mean speed in the clip, and is no higher than an eighth of its limb over where
        /// it is lowest, for a tenth of a second.
        pub fn with_detection(mut self, detection: ContactDetection) { self.detection = Some(detection) }
        /// The clip walks on the spot, and the character travels by so much a second: the root carries it, and contacts are
        /// those on the way. [`ground_speed`](super::ground_speed) tells it from the feet.
        pub fn with_root_velocity(mut self, per_second: impl Into<Vector3<f64>>) {
            self.root_velocity = single(per_second);
        }
        /// How high the ground is at a place, in a model whose clip walks on a ground of height 0. Feet stand on it, and the
        /// root follows it.
        pub fn with_ground(mut self, height: impl Fn(Vector3<f64>) -> f64 + Send + Sync + 'static) {
            self.ground = Some(Arc::new(height));
        }
    }

    /// Solves over a clip.
    ///
    /// # Errors
    /// Nothing is asked; a bone of another armature, asked for twice at one time, or not below the root; a span or fade that
    /// is not within the clip; settings out of range. What cannot be reached is no error: [`EditedClip::led`] says by how much.
    pub fn solve(&self, clip: &Clip) -> Result<EditedClip, ClipIkError> {
        let request = self.check(clip)?;
        solve(self, &request, clip)
    }

    /// Checks what is asked of a clip.
    fn check(&self, clip: &Clip) -> Result<ClipRequest, ClipIkError> {
        SizeMismatch::check("bones in the clip", clip.bones(), self.armature.bones())?;
        for (index, bone) in self
            .skeleton
            .iter()
            .flat_map(|own| own.bones().iter().enumerate())
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
        let up = up.ok_or(ChannelError::BadUp {
            up: self.up.to_array(),
        })?;
        let span = clip.span().map(f64::from);
        let mut bones: Vec<BoneId> = Vec::new();
        for &bone in &self.planted {
            if bones.contains(&bone) {
                return Err(self.twice(bone)?);
            }
            bones.push(bone);
        }
        for (k, reach) in self.reaches.iter().enumerate() {
            reach.check(span)?;
            let mut before = self.reaches[..k].iter();
            let taken = self.planted.contains(&reach.bone);
            if taken || before.any(|other| reach.clashes(other, span)) {
                return Err(self.twice(reach.bone)?);
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
        let root = self.root.or_else(|| branching_above(self.armature, &bones));
        for (&bone, &root) in bones
            .iter()
            .flat_map(|bone| root.iter().map(move |root| (bone, root)))
        {
            if !above(self.armature, bone).contains(&root) {
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

    fn twice(&self, bone: BoneId) -> Result<ClipIkError, ClipIkError> {
        let bone = self.name(bone)?.to_owned();
        Ok(ClipIkError::Twice { bone })
    }

    fn name(&self, bone: BoneId) -> Result<&str, ClipIkError> {
        let names = self.armature.names();
        let own = names.get(bone.index()).map(String::as_str);
        own.ok_or(ClipIkError::UnknownBone {
            bone: bone.index(),
            bones: names.len(),
        })
    }

    /// How a rig's bone turns.
    pub(super) fn hinges(&self, bone: BoneId) -> Option<Hinges> {
        let own = self.skeleton?.bones().get(bone.index())?;
        let rest = self
            .armature
            .rest()
            .local_of(bone)
            .rotation
            .as_dquat()
            .normalize();
        Some(Hinges {
            rest,
            limits: own.limits,
            length: own.length,
        })
    }

    /// When a foot stands that goes along `way`, on a limb of some length.
    pub(super) fn detection_of(
        &self,
        way: &[Vector3<f64>],
        length: f64,
        rate: f64,
    ) -> ContactDetection {
        let usual = ContactDetection::default();
        let gone: f64 = way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let mean = gone * rate / way.len().saturating_sub(1).max(1) as f64;
        self.detection.unwrap_or(ContactDetection {
            speed: (usual.speed * length / USUAL_LEG_M).max(SLOW * mean),
            height: RAISED * length,
            ..usual
        })
    }
}
