//! Drags of a character on its feet.

use std::collections::BTreeSet;

use kinopt_kinematics::kinematics::centre_of_mass;
use kinopt_kinematics::model::{JointId, Masses, ModelError, ParameterMap, PointMass, UnknownName};
use kinopt_kinematics::skeleton::{BallSkeleton, BoneId, Cones, Hinges, Skeleton, SkeletonRoot};
use kinopt_kinematics::spatial::Vector3;
use kinopt_solver::ik::{Drag, Solution, SolveError};
use kinopt_solver::problem::{Problem, ProblemError, TaskId};
use kinopt_solver::task::{Bounded, FramePose, Plane, Point, Posture, SupportPolygon, Task};

use super::body_limb::{BodyLimb, BodyLimbKind, limbs};
use super::hinge_guess::guess_hinges;
use super::leg_cones::add_leg_cones;
use super::segment_masses::segment_masses;
use super::support::{Stance, StandingFoot};

/// Priority level of pinned feet.
const FEET_LEVEL: usize = 0;
/// Priority level of balance and ground.
const BALANCE_LEVEL: usize = 1;
/// Priority level of dragged bones.
const TARGET_LEVEL: usize = 2;
/// Distance of the centre of mass from the edges of the support polygon, relative to the size of the skeleton.
const RELATIVE_MARGIN: f64 = 0.005;

/// Name of a dragged bone, and the task of its target.
type DragTarget = (String, TaskId<Point>);

/// Error of a drag of a standing character.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StandingDragError {
    /// A bone that does not exist, or a target of a bone that is not dragged.
    #[error(transparent)]
    UnknownBone(#[from] UnknownName),
    /// Hinges, cones or masses that do not match the skeleton.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An invalid problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// An invalid configuration.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The bones have no legs.
    #[error(
        "skeleton `{skeleton}` has no legs to stand on: neither names nor lengths of its bones show any"
    )]
    NoLegs {
        /// Name of the skeleton.
        skeleton: String,
    },
}

/// A drag of some bones of a character on a free base.
///
/// The feet keep their pose at rest, unless their leg is dragged. The centre of mass stays above the support polygon of
/// the pinned feet, and elbows, hands, knees and hips above the ground. Knees and elbows rotate about hinges, all other
/// bones between a limb's end and the root on ball joints. Fingers, faces and tails move with their parents.
///
/// Feet come first, then balance and ground, then the dragged bones. In their null space the body stays upright and
/// near its rest pose.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::io::rig::Rig;
/// use kinopt::motion::posing::StandingDrag;
///
/// let rig = Rig::read("models/humanoid/humanoid.json")?;
/// let masses = rig.masses(1000.0)?;
/// let mut drag = StandingDrag::builder(&rig.skeleton)
///     .with_masses(masses.points().to_vec())
///     .dragged(["left_hand"])
///     .build()?;
/// drag.set_target("left_hand", [0.6, 0.5, 1.1])?;
/// let solution = drag.settle(100);
/// assert!(solution.reached, "{}", solution.explain());
/// assert!(drag.balance_margin() >= 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct StandingDrag {
    skeleton: BallSkeleton,
    drag: Drag,
    targets: Vec<DragTarget>,
    masses: Masses,
    stance: Stance,
}

/// Options of a [`StandingDrag`].
#[derive(Clone, Debug)]
pub struct StandingDragBuilder<'s> {
    skeleton: &'s Skeleton,
    hinges: Option<Hinges>,
    cones: Cones,
    masses: Vec<PointMass>,
    up: Option<Vector3<f64>>,
    dragged: Vec<String>,
}

impl StandingDragBuilder<'_> {
    /// Replaces the hinges. The default are those of the skeleton, or [guessed](guess_hinges) ones if it has none.
    /// Bones with a cone get no guessed hinge.
    #[must_use]
    pub fn with_hinges(mut self, hinges: Hinges) -> Self {
        self.hinges = Some(hinges);
        self
    }

    /// Sets the cones of ball joints. Hips and ankles without a cone get one, so that knees stay above their feet: hips
    /// swing by 130° and twist by 40°, ankles by 60° and 20°.
    #[must_use]
    pub fn with_cones(mut self, cones: Cones) -> Self {
        self.cones = cones;
        self
    }

    /// Sets point masses on frames of the skeleton, such as those of a rig's or scene's mesh. The default are the
    /// segments of a human body.
    #[must_use]
    pub fn with_masses(mut self, masses: Vec<PointMass>) -> Self {
        self.masses = masses;
        self
    }

    /// Sets the vertical in the model; by default the axis of the model that is nearest to the legs.
    #[must_use]
    pub fn with_up(mut self, up: impl Into<Vector3<f64>>) -> Self {
        self.up = Some(up.into());
        self
    }

    /// Adds dragged bones by name. Targets are positions of their tips.
    #[must_use]
    pub fn dragged<N: Into<String>>(mut self, bones: impl IntoIterator<Item = N>) -> Self {
        self.dragged.extend(bones.into_iter().map(Into::into));
        self
    }

    /// Creates the drag, at rest.
    ///
    /// # Errors
    /// Unknown bones, hinges, cones or masses that do not match the skeleton, or a skeleton without legs.
    pub fn build(self) -> Result<StandingDrag, StandingDragError> {
        let limbs = limbs(self.skeleton);
        let hinges = self.hinges.unwrap_or_else(|| match self.skeleton.hinges() {
            given if !given.is_empty() => given,
            _ => {
                let guessed = guess_hinges(self.skeleton).into_iter();
                let guessed = guessed.filter(|guess| !self.cones.contains_key(&guess.bone));
                guessed.map(|guess| (guess.bone, guess.hinge)).collect()
            }
        });
        let hinged = self.skeleton.with_hinges(&hinges)?;
        let mut cones = self.cones;
        add_leg_cones(&hinged, &limbs, &mut cones);
        let skeleton = BallSkeleton::new(hinged, &cones, SkeletonRoot::FREE)?;
        let stance = Stance::of(self.skeleton, &limbs, self.up);
        let mut stance = stance.ok_or_else(|| StandingDragError::NoLegs {
            skeleton: self.skeleton.model().name().to_owned(),
        })?;
        let dragged = self.dragged.iter().map(|name| skeleton.bone(name));
        let dragged = dragged.collect::<Result<Vec<BoneId>, _>>()?;
        let is_lifted = |foot: &StandingFoot| dragged.iter().any(|bone| foot.leg.contains(bone));
        stance.feet.retain(|foot| !is_lifted(foot));
        let masses = match self.masses.is_empty() {
            false => self.masses,
            true => segment_masses(&skeleton, &limbs, trunk(self.skeleton, &limbs)),
        };
        let masses = Masses::new(skeleton.model(), masses)?;
        let parts = ProblemParts {
            skeleton: &skeleton,
            limbs: &limbs,
            stance: &stance,
            masses: &masses,
        };
        let named = self
            .dragged
            .iter()
            .cloned()
            .zip(dragged.iter().copied())
            .collect();
        let (problem, targets) = parts.problem(named)?;
        let drag = Drag::new(problem, &skeleton.model().neutral())?;
        Ok(StandingDrag {
            skeleton,
            drag,
            targets,
            masses,
            stance,
        })
    }
}

impl StandingDrag {
    /// Starts a drag of the bones of `skeleton`.
    #[must_use]
    pub fn builder(skeleton: &Skeleton) -> StandingDragBuilder<'_> {
        StandingDragBuilder {
            skeleton,
            hinges: None,
            cones: Cones::new(),
            masses: Vec::new(),
            up: None,
            dragged: Vec::new(),
        }
    }

    /// Sets the target of a dragged bone, in model coordinates.
    ///
    /// # Errors
    /// A bone that is not dragged, or a target that is not finite.
    pub fn set_target(
        &mut self,
        bone: &str,
        target: impl Into<Vector3<f64>>,
    ) -> Result<(), StandingDragError> {
        let task = self.targets.iter().find(|(name, _)| name == bone);
        let Some(&(_, task)) = task else {
            let names = self.targets.iter().map(|(name, _)| name.as_str());
            return Err(UnknownName::new("dragged bone", bone, names).into());
        };
        self.drag.target_mut(task)?.set_target(target);
        Ok(())
    }

    /// Moves the body by one frame towards the targets: see [`Drag::advance`].
    pub fn advance(&mut self) -> &Solution {
        self.drag.advance()
    }

    /// Moves the body until it is at rest, in at most `frames` frames: see [`Drag::settle`].
    pub fn settle(&mut self, frames: usize) -> &Solution {
        self.drag.settle(frames)
    }

    /// The bones on ball joints and hinges.
    #[must_use]
    pub fn skeleton(&self) -> &BallSkeleton {
        &self.skeleton
    }

    /// The drag, for its configuration and its settings.
    #[must_use]
    pub fn drag(&self) -> &Drag {
        &self.drag
    }

    /// As [`drag`](Self::drag), to change settings.
    pub fn drag_mut(&mut self) -> &mut Drag {
        &mut self.drag
    }

    /// The pinned bones.
    #[must_use]
    pub fn feet(&self) -> Vec<BoneId> {
        self.stance.feet.iter().map(|foot| foot.bone).collect()
    }

    /// Corners of the pinned feet, in model coordinates. The support polygon is their convex hull, seen along the
    /// vertical.
    #[must_use]
    pub fn support_points(&self) -> Vec<Vector3<f64>> {
        self.stance.support_points()
    }

    /// Position of the centre of mass, in model coordinates.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vector3<f64> {
        let centre = centre_of_mass(self.skeleton.model(), &self.masses, self.drag.q());
        // The drag's own configuration is valid.
        centre.unwrap_or_else(|_| Vector3::zero())
    }

    /// Distance of the centre of mass from the edges of the support polygon, seen along the vertical, in the skeleton's
    /// unit. Negative outside the polygon, and without pinned feet.
    #[must_use]
    pub fn balance_margin(&self) -> f64 {
        self.stance.margin(self.centre_of_mass())
    }
}

/// Bone that carries the limbs: the nearest common ancestor of two limbs of different kinds, else the root.
fn trunk(skeleton: &Skeleton, limbs: &[BodyLimb]) -> BoneId {
    let parent = |bone: &BoneId| skeleton.bones().get(bone.index())?.parent;
    let leg = limbs.iter().find(|limb| limb.kind != BodyLimbKind::Arm);
    let hips = leg.and_then(|leg| parent(&leg.upper));
    hips.unwrap_or_else(|| BoneId::new(0))
}

/// ProblemParts of the problem of a drag.
struct ProblemParts<'a> {
    skeleton: &'a BallSkeleton,
    limbs: &'a [BodyLimb],
    stance: &'a Stance,
    masses: &'a Masses,
}

impl ProblemParts<'_> {
    fn problem(
        &self,
        dragged: Vec<(String, BoneId)>,
    ) -> Result<(Problem, Vec<DragTarget>), StandingDragError> {
        let (skeleton, stance) = (self.skeleton, self.stance);
        let model = skeleton.model();
        let bones = skeleton.skeleton().bones();
        let start = model.neutral();
        let active = self.active_joints(&dragged);
        let mut problem = Problem::builder(model);
        problem.parameters(
            ParameterMap::builder(model)
                .with_only(&active, &start)
                .build()?,
        );
        for foot in &stance.feet {
            let bone = &bones[foot.bone.index()];
            let pose = FramePose::new(skeleton.tail(foot.bone), bone.model_from_rest);
            problem.add(
                Task::new(pose)
                    .named(bone.name.as_str())
                    .at_level(FEET_LEVEL),
            );
        }
        if !stance.feet.is_empty() {
            let polygon = SupportPolygon::new(self.masses)
                .with_up(stance.up)
                .with_points(stance.support_points())
                .with_margin(RELATIVE_MARGIN * skeleton.skeleton().size());
            problem.add(Task::new(polygon).named("balance").at_level(BALANCE_LEVEL));
        }
        let ground = stance.up * stance.ground;
        for bone in self.bones_above_ground(&dragged) {
            let plane = Plane::new(skeleton.tip(bone), ground, stance.up);
            let name = format!("{} above the ground", bones[bone.index()].name);
            let task = Task::new(Bounded::at_least(plane, 0.0)).named(name);
            problem.add(task.at_level(BALANCE_LEVEL));
        }
        let targets = dragged.into_iter().map(|(name, bone)| {
            let point = Point::new(skeleton.tip(bone), bones[bone.index()].rest_tip());
            let task = Task::new(point).named(name.as_str()).at_level(TARGET_LEVEL);
            (name, problem.add(task))
        });
        let targets = targets.collect();
        let posture = Posture::new(model, &start).upright(model);
        problem.add(Task::new(posture).named("posture"));
        Ok((problem.build()?, targets))
    }

    /// Joints from the ends of limbs and the dragged bones up to the root.
    fn active_joints(&self, dragged: &[(String, BoneId)]) -> Vec<JointId> {
        let bones = self.skeleton.skeleton().bones();
        let parent = |bone: &BoneId| bones.get(bone.index())?.parent;
        let limb_bones = self.limbs.iter().map(|limb| match limb.kind {
            BodyLimbKind::Arm => limb.lower,
            BodyLimbKind::Leg | BodyLimbKind::Other => limb.end.unwrap_or(limb.lower),
        });
        let ends = limb_bones.chain(dragged.iter().map(|(_, bone)| *bone));
        let active: BTreeSet<BoneId> = ends
            .flat_map(|bone| std::iter::successors(Some(bone), parent))
            .collect();
        active
            .into_iter()
            .flat_map(|bone| self.skeleton.joints(bone))
            .collect()
    }

    /// Ends and middle joints of limbs, the hips, and dragged bones. Pinned feet are on the ground.
    fn bones_above_ground(&self, dragged: &[(String, BoneId)]) -> BTreeSet<BoneId> {
        let pinned: Vec<BoneId> = self.stance.feet.iter().map(|foot| foot.bone).collect();
        let limb_bones = self.limbs.iter().flat_map(|limb| {
            let toe = limb.toe.filter(|_| limb.kind == BodyLimbKind::Leg);
            [Some(limb.upper), Some(limb.lower), limb.end, toe]
                .into_iter()
                .flatten()
        });
        let all = limb_bones.chain(dragged.iter().map(|(_, bone)| *bone));
        let above = all.filter(|bone| {
            let is_on_foot = self.stance.feet.iter().any(|foot| foot.leg.contains(bone));
            let is_pinned_toe = is_on_foot && self.is_toe(*bone);
            !pinned.contains(bone) && !is_pinned_toe
        });
        above.collect()
    }

    fn is_toe(&self, bone: BoneId) -> bool {
        self.limbs.iter().any(|limb| limb.toe == Some(bone))
    }
}
