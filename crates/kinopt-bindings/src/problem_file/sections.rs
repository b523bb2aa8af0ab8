//! Sections of a problem; their keys are named like options.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use kinopt::collision::MeshUse;
use kinopt::mesh::TriangleMesh;
use kinopt::motion::path::QuaternionOrder;
use kinopt::problem::Derivatives;
use kinopt::robot::BaseJoint;
use kinopt::skeleton::Skeleton;
use kinopt::skinning::{AutomaticWeights, HeatWeights, SkinWeights, SkinningError, SkinningMethod};
use kinopt::spatial::Placement;
use kinopt::task::Axis;
use serde::de::{Deserialize, Deserializer, Error};

use super::body::{Centre, Foot, FrameWeight, Lock, NamedLevel};
use super::interval::Interval;
use super::methods;
use super::number_list::{self, Numbers, above_zero, checked, from_zero, limited};
use super::start::{self, SolutionChoice, Start};
use super::target::{FrameTarget, RayTarget};
use super::text::{text, texts};
use crate::names::{self, AXES, MIMIC_LIMITS, Names};
use crate::placement::PoseTarget;

/// Reading of a model's file, and its joints.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ModelSettings {
    /// True to repair damaged robot and SRDF files where no guess is needed.
    pub lenient: bool,
    /// True to apply the soft limits of a robot's file too.
    pub soft_limits: bool,
    /// True if mimic joints restrict their source joints.
    #[serde(deserialize_with = "mimic_limits")]
    pub mimic_limits: bool,
    /// File of joint limits, as MoveIt's joint_limits.yaml.
    pub joint_limits: Option<PathBuf>,
    /// Kind of the joint between root and world; `None` for a fixed root.
    #[serde(deserialize_with = "base_kind")]
    pub base_joint: Option<String>,
    /// Lower and upper bound by axis, in metres (`yaw`: radians).
    pub base_bounds: BTreeMap<String, [f64; 2]>,
    /// Closed loops in which two points coincide.
    pub connect: Vec<ClosedLoop>,
    /// Closed loops as `connect`, with equal orientation.
    pub weld: Vec<ClosedLoop>,
    /// Names of joints that move to close loops.
    pub passive: Vec<String>,
    /// True to ignore the loops of the robot's file.
    pub without_loops: bool,
    /// Joint type of bones.
    pub joints: Option<BoneJoints>,
    /// File of swing and twist limits.
    pub cones: Option<PathBuf>,
    /// Hinges of a scene or a capture; `None` for guessed ones.
    pub hinges: Option<BoneHinges>,
    /// True to set the rest scales of a scene's bones to 1.
    pub without_scale: bool,
    /// SRDF file.
    pub srdf: Option<PathBuf>,
    /// Group of the SRDF file with the only free joints.
    pub group: Option<String>,
    /// Locked joints.
    #[serde(deserialize_with = "texts")]
    pub lock: Vec<Lock>,
    /// Names of the only free joints or bones.
    pub only: Vec<String>,
    /// Time of the clip whose pose is the rest pose, seconds.
    pub time: Option<f64>,
    /// Name of that clip; `None` for the first.
    pub clip: Option<String>,
}

impl ModelSettings {
    /// True if a setting gives joints to a scene or a capture.
    #[must_use]
    pub fn makes_figure(&self) -> bool {
        self.joints.is_some() || self.cones.is_some()
    }

    /// True if bones have ball joints.
    #[must_use]
    pub fn are_balls(&self) -> bool {
        self.joints == Some(BoneJoints::Ball) || self.cones.is_some()
    }

    /// True if a setting locks joints.
    #[must_use]
    pub fn locks(&self) -> bool {
        !(self.lock.is_empty() && self.only.is_empty() && self.srdf.is_none())
    }
}

/// Joint type of bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoneJoints {
    /// Three angles.
    TwistBendTwist,
    /// A ball joint.
    Ball,
}

/// Hinges of bones.
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(untagged)]
pub enum BoneHinges {
    /// A choice by name.
    Choice(HingeChoice),
    /// Hinges by bone.
    ByBone(BTreeMap<String, BoneHinge>),
}

/// Choice of hinges by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HingeChoice {
    /// Guessed for knees and elbows.
    Guessed,
    /// No hinges.
    None,
}

/// Hinge of a bone.
#[derive(Clone, Copy, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoneHinge {
    /// Axis in the axes of the bone.
    pub axis: [f64; 3],
    /// Lower and upper bound from rest, degrees.
    pub range: [f64; 2],
}

/// Two frames of a loop, with placements on them.
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClosedLoop {
    /// Names of the frames.
    pub frames: [String; 2],
    /// Placements of the loop in the frames.
    #[serde(default = "origins", deserialize_with = "placements")]
    pub placements: [Placement<f64>; 2],
}

fn origins() -> [Placement<f64>; 2] {
    [Placement::identity(), Placement::identity()]
}

/// Files that the command may open.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FileSettings {
    /// Folders with files that others may name.
    pub allow_folder: Vec<PathBuf>,
    /// Largest size of a file, bytes.
    pub max_file_bytes: Option<u64>,
    /// True to open referenced files only below the robot's folder.
    pub confine: bool,
}

/// Obstacles and collision shapes.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CollisionSettings {
    /// File of obstacles.
    pub world: Option<PathBuf>,
    /// Required distance, metres.
    #[serde(deserialize_with = "not_negative")]
    pub margin: Option<f64>,
    /// Names of pairs whose collision is allowed.
    pub allow_collision: Vec<[String; 2]>,
    /// Folders of ROS packages.
    pub package: Vec<PathBuf>,
    /// Collision shapes of meshes.
    #[serde(deserialize_with = "meshes")]
    pub meshes: MeshUse,
    /// True to omit meshes that are not found.
    pub leave_out_meshes: bool,
    /// File of a sphere model.
    pub sphere_model: Option<PathBuf>,
}

/// Collision shapes of meshes.
const MESHES: Names<MeshUse, 4> = [
    ("hull", MeshUse::Hull),
    ("parts", MeshUse::Parts),
    ("pieces", MeshUse::Pieces(16)),
    ("triangles", MeshUse::Triangles),
];

/// Targets of frames.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GoalSettings {
    /// Targets of frames.
    #[serde(deserialize_with = "texts")]
    pub target: Vec<FrameTarget>,
    /// Rays of frames.
    #[serde(deserialize_with = "texts")]
    pub ray: Vec<RayTarget>,
    /// Frame of targets without a name; `None` for the robot's only tip.
    pub tip: Option<String>,
    /// Frame in which targets are given; `None` for the world.
    pub base: Option<String>,
    /// True to ignore the orientation of targets.
    pub position_only: bool,
    /// Goal bounds along the target's axes.
    #[serde(deserialize_with = "texts")]
    pub interval: Vec<Interval>,
    /// Placement of the tool in the frame of the targets.
    #[serde(deserialize_with = "optional_placement")]
    pub tool: Option<Placement<f64>>,
}

/// Held frames, centre of mass, weights and priorities.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BodySettings {
    /// Names of frames that keep their poses.
    pub hold: Vec<String>,
    /// Target of the centre of mass.
    #[serde(deserialize_with = "text")]
    pub center_of_mass: Option<Centre>,
    /// Feet below the centre of mass.
    #[serde(deserialize_with = "texts")]
    pub balance: Vec<Foot>,
    /// Distance from the edges of the support polygon, metres.
    #[serde(deserialize_with = "not_negative")]
    pub balance_margin: Option<f64>,
    /// Up axis of the world.
    #[serde(deserialize_with = "axis")]
    pub up: Option<Axis>,
    /// Factors of errors by frame.
    #[serde(deserialize_with = "texts")]
    pub weight: Vec<FrameWeight>,
    /// Priority levels by name.
    #[serde(deserialize_with = "texts")]
    pub level: Vec<NamedLevel>,
    /// True for level 0 of all tasks without their own.
    pub no_priorities: bool,
}

impl BodySettings {
    /// True if there is a task for the centre of mass.
    #[must_use]
    pub fn has_centre_of_mass(&self) -> bool {
        self.center_of_mass.is_some() || !self.balance.is_empty()
    }
}

/// Search for a solution.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SolveSettings {
    /// Start configuration.
    #[serde(deserialize_with = "start")]
    pub start: Start,
    /// Choice among solutions.
    #[serde(deserialize_with = "search")]
    pub search: Option<SolutionChoice>,
    /// Largest displacement of each joint from the start.
    pub max_move: Option<Numbers>,
    /// Nominal posture.
    pub posture: Option<Numbers>,
    /// Weight of each joint in distances.
    pub joint_weights: Option<Numbers>,
    /// Distance that weighs as much as a radian, metres.
    #[serde(deserialize_with = "positive")]
    pub metres_per_radian: Option<f64>,
    /// True to return the closest pose of any branch on a miss.
    pub global_search_on_miss: bool,
    /// Method of the general solver.
    #[serde(deserialize_with = "method")]
    pub solver: Option<String>,
    /// Derivatives of the general solver.
    #[serde(deserialize_with = "derivatives")]
    pub jacobian: Option<Derivatives>,
    /// Seed of the random generator.
    pub rng_seed: u64,
    /// From a number of milliseconds.
    #[serde(deserialize_with = "milliseconds")]
    pub time_limit: Option<Duration>,
    /// Tolerance, metres and radians.
    #[serde(deserialize_with = "not_negative")]
    pub tolerance: Option<f64>,
    /// Largest number of attempts for a target.
    pub attempts: Option<std::num::NonZeroU32>,
    /// Largest number of iterations of an attempt of the general solver.
    pub max_iterations: Option<u32>,
}

/// Additional content of reports and written files.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OutputSettings {
    /// True to report the derivative of the solution by each target.
    pub derivative: bool,
    /// Skinning method.
    #[serde(deserialize_with = "skinning")]
    pub skinning: Option<SkinningMethod>,
    /// Method of a rig's skin weights.
    pub skin_weights: Option<WeightsChoice>,
    /// Name of a written clip.
    pub clip_name: Option<String>,
}

/// Methods of automatic skin weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WeightsChoice {
    /// Bone heat weighting along the skin.
    #[default]
    Heat,
    /// Distance from the bones.
    Distance,
}

impl WeightsChoice {
    /// Skin weights of a mesh by the bones of a skeleton.
    ///
    /// # Errors
    /// Those of the method.
    pub fn weights(
        self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, SkinningError> {
        match self {
            Self::Heat => HeatWeights::default().for_skeleton(mesh, skeleton),
            Self::Distance => AutomaticWeights::default().for_skeleton(mesh, skeleton),
        }
    }

    /// Rule of the method, which completes "each vertex follows …".
    #[must_use]
    pub fn rule(self) -> &'static str {
        match self {
            Self::Heat => "the bones that heat it along the skin",
            Self::Distance => "the bones nearest to it",
        }
    }
}

/// Cartesian paths.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PathSettings {
    /// Order of quaternions in a table without header.
    #[serde(deserialize_with = "order")]
    pub order: QuaternionOrder,
    /// Number of samples of a path.
    pub samples: Option<usize>,
    /// True to count steps above velocity limits as reconfigurations.
    pub keep_times: bool,
    /// Placements of further tools in the frame of the path.
    #[serde(deserialize_with = "more_placements")]
    pub add_tool: Vec<Placement<f64>>,
}

fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    checked(deserializer, above_zero)
}

fn not_negative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    checked(deserializer, from_zero)
}

fn milliseconds<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Duration>, D::Error> {
    let milliseconds = f64::deserialize(deserializer)?;
    let duration = number_list::duration(milliseconds);
    duration.map(Some).map_err(Error::custom)
}

fn start<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Start, D::Error> {
    #[derive(serde::Deserialize)]
    #[serde(untagged, expecting = "expected a word or a list of numbers")]
    enum WordOrNumbers {
        Word(String),
        Numbers(Vec<f64>),
    }
    match WordOrNumbers::deserialize(deserializer)? {
        WordOrNumbers::Word(word) => word.parse(),
        WordOrNumbers::Numbers(numbers) => Numbers::try_from(numbers).map(Start::Numbers),
    }
    .map_err(Error::custom)
}

fn search<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<SolutionChoice>, D::Error> {
    let text = String::deserialize(deserializer)?;
    start::search(&text).map(Some).map_err(Error::custom)
}

fn base_kind<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    let kinds = BaseJoint::KINDS.map(|kind| (kind, kind.to_owned()));
    named(deserializer, "base joint", &kinds).map(Some)
}

fn method<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    let methods = methods::names().map(|name| (name, name.to_owned()));
    named(deserializer, "solver", &methods).map(Some)
}

fn derivatives<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Derivatives>, D::Error> {
    named(deserializer, "jacobian", &methods::DERIVATIVES).map(Some)
}

fn mimic_limits<'de, D: Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
    named(deserializer, "mimic_limits", &MIMIC_LIMITS)
}

fn axis<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Axis>, D::Error> {
    named(deserializer, "axis", &AXES).map(Some)
}

fn meshes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<MeshUse, D::Error> {
    named(deserializer, "use of meshes", &MESHES)
}

fn skinning<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<SkinningMethod>, D::Error> {
    let methods = SkinningMethod::ALL.map(|method| (method.name(), method));
    named(deserializer, "skinning", &methods).map(Some)
}

fn order<'de, D: Deserializer<'de>>(deserializer: D) -> Result<QuaternionOrder, D::Error> {
    let orders = [
        ("w-first", QuaternionOrder::WFirst),
        ("w-last", QuaternionOrder::WLast),
    ];
    named(deserializer, "order", &orders)
}

/// Reads one of some names, and returns its value.
fn named<'de, D: Deserializer<'de>, T: Clone>(
    deserializer: D,
    kind: &'static str,
    values: &[(&'static str, T)],
) -> Result<T, D::Error> {
    let name = String::deserialize(deserializer)?;
    names::named(kind, &name, values).map_err(Error::custom)
}

fn optional_placement<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Placement<f64>>, D::Error> {
    let numbers = Vec::<f64>::deserialize(deserializer)?;
    placed(numbers).map(Some).map_err(Error::custom)
}

fn more_placements<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<Placement<f64>>, D::Error> {
    let rows = Vec::<Vec<f64>>::deserialize(deserializer)?.into_iter();
    let placements = rows.map(placed).collect::<Result<_, _>>();
    placements.map_err(Error::custom)
}

fn placements<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[Placement<f64>; 2], D::Error> {
    let placements = more_placements(deserializer)?;
    let given = placements.len();
    let wrong = |_| Error::custom(format!("a loop has 2 placements, not {given}"));
    placements.try_into().map_err(wrong)
}

fn placed(numbers: Vec<f64>) -> Result<Placement<f64>, String> {
    let numbers = numbers.into_iter().map(limited);
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    Ok(PoseTarget::of_numbers(&numbers)?.placement)
}
