//! Sections of a problem; their keys are named like options.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use kinopt::arm::Search;
use kinopt::motion::path::QuaternionOrder;
use kinopt::problem::Derivatives;
use kinopt::robot::BaseJoint;
use kinopt::skinning::SkinningMethod;
use kinopt::spatial::Placement;
use kinopt::task::Axis;
use serde::de::{Deserialize, Deserializer, Error};

use super::body::{Centre, Foot, FrameWeight, Lock, NamedLevel};
use super::interval::Interval;
use super::methods;
use super::number_list::{self, Numbers, above_zero, checked, from_zero, limited};
use super::start::{self, Start};
use super::target::{RayTarget, Target, placement};
use super::text::{text, texts};

/// Reading of a model's file, and its joints.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ModelSettings {
    pub(crate) lenient: bool,
    pub(crate) soft_limits: bool,
    pub(crate) mimic_limits: Option<MimicLimits>,
    pub(crate) joint_limits: Option<PathBuf>,
    #[serde(deserialize_with = "base_kind")]
    pub(crate) base_joint: Option<String>,
    /// Lower and upper bound by axis, in metres (`yaw`: radians).
    pub(crate) base_bounds: BTreeMap<String, [f64; 2]>,
    pub(crate) connect: Vec<ClosedLoop>,
    pub(crate) weld: Vec<ClosedLoop>,
    pub(crate) passive: Vec<String>,
    pub(crate) without_loops: bool,
    pub(crate) joints: Option<BoneJoints>,
    pub(crate) cones: Option<PathBuf>,
    pub(crate) without_scale: bool,
    pub(crate) srdf: Option<PathBuf>,
    pub(crate) group: Option<String>,
    #[serde(deserialize_with = "texts")]
    pub(crate) lock: Vec<Lock>,
    pub(crate) only: Vec<String>,
    pub(crate) time: Option<f64>,
    pub(crate) clip: Option<String>,
}

/// Limits of the source joint of mimic joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MimicLimits {
    Source,
    Both,
}

/// Joint type of bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum BoneJoints {
    TwistBendTwist,
    Ball,
}

/// Two frames of a loop, with placements on them.
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClosedLoop {
    pub(crate) frames: [String; 2],
    #[serde(default = "origins", deserialize_with = "placements")]
    pub(crate) placements: [Placement<f64>; 2],
}

fn origins() -> [Placement<f64>; 2] {
    [Placement::identity(), Placement::identity()]
}

/// Files that the command may open.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FileSettings {
    pub(crate) allow_folder: Vec<PathBuf>,
    pub(crate) max_file_bytes: Option<u64>,
    pub(crate) confine: bool,
}

/// Obstacles and collision shapes.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CollisionSettings {
    pub(crate) world: Option<PathBuf>,
    #[serde(deserialize_with = "not_negative")]
    pub(crate) margin: Option<f64>,
    pub(crate) allow_collision: Vec<[String; 2]>,
    pub(crate) package: Vec<PathBuf>,
    pub(crate) meshes: MeshChoice,
    pub(crate) leave_out_meshes: bool,
    pub(crate) sphere_model: Option<PathBuf>,
}

/// Collision shapes of meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MeshChoice {
    #[default]
    Hull,
    Parts,
    Pieces,
    Triangles,
}

/// Targets of frames.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct GoalSettings {
    #[serde(deserialize_with = "texts")]
    pub(crate) target: Vec<Target>,
    #[serde(deserialize_with = "texts")]
    pub(crate) ray: Vec<RayTarget>,
    pub(crate) tip: Option<String>,
    pub(crate) base: Option<String>,
    pub(crate) position_only: bool,
    #[serde(deserialize_with = "texts")]
    pub(crate) interval: Vec<Interval>,
    #[serde(deserialize_with = "optional_placement")]
    pub(crate) tool: Option<Placement<f64>>,
}

/// Held frames, centre of mass, weights and priorities.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct BodySettings {
    pub(crate) hold: Vec<String>,
    #[serde(deserialize_with = "text")]
    pub(crate) center_of_mass: Option<Centre>,
    #[serde(deserialize_with = "texts")]
    pub(crate) balance: Vec<Foot>,
    #[serde(deserialize_with = "not_negative")]
    pub(crate) balance_margin: Option<f64>,
    #[serde(deserialize_with = "axis")]
    pub(crate) up: Option<Axis>,
    #[serde(deserialize_with = "texts")]
    pub(crate) weight: Vec<FrameWeight>,
    #[serde(deserialize_with = "texts")]
    pub(crate) level: Vec<NamedLevel>,
    pub(crate) no_priorities: bool,
}

/// Search for a solution.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SolveSettings {
    #[serde(deserialize_with = "start")]
    pub(crate) start: Start,
    #[serde(deserialize_with = "search")]
    pub(crate) search: Option<Search>,
    pub(crate) max_move: Option<Numbers>,
    pub(crate) posture: Option<Numbers>,
    pub(crate) joint_weights: Option<Numbers>,
    #[serde(deserialize_with = "positive")]
    pub(crate) metres_per_radian: Option<f64>,
    pub(crate) global_search_on_miss: bool,
    #[serde(deserialize_with = "method")]
    pub(crate) solver: Option<String>,
    #[serde(deserialize_with = "derivatives")]
    pub(crate) jacobian: Option<Derivatives>,
    pub(crate) rng_seed: u64,
    /// From a number of milliseconds.
    #[serde(deserialize_with = "milliseconds")]
    pub(crate) time_limit: Option<Duration>,
    #[serde(deserialize_with = "not_negative")]
    pub(crate) tolerance: Option<f64>,
    pub(crate) attempts: Option<std::num::NonZeroU32>,
    pub(crate) max_iterations: Option<u32>,
}

/// Additional content of reports and written files.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputSettings {
    pub(crate) derivative: bool,
    #[serde(deserialize_with = "skinning")]
    pub(crate) skinning: Option<SkinningMethod>,
    pub(crate) skin_weights: Option<WeightsChoice>,
    pub(crate) clip_name: Option<String>,
}

/// Methods of automatic skin weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum WeightsChoice {
    /// Bone heat weighting along the skin.
    #[default]
    Heat,
    /// Distance from the bones.
    Distance,
}

/// Cartesian paths.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PathSettings {
    #[serde(deserialize_with = "order")]
    pub(crate) order: QuaternionOrder,
    pub(crate) samples: Option<usize>,
    #[serde(deserialize_with = "more_placements")]
    pub(crate) add_tool: Vec<Placement<f64>>,
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

fn search<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Search>, D::Error> {
    let text = String::deserialize(deserializer)?;
    start::search(&text).map(Some).map_err(Error::custom)
}

fn base_kind<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    among(deserializer, BaseJoint::KINDS).map(|kind| Some(kind.to_owned()))
}

fn method<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    among(deserializer, methods::names()).map(|name| Some(name.to_owned()))
}

fn derivatives<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Derivatives>, D::Error> {
    named(deserializer, methods::DERIVATIVES).map(Some)
}

fn axis<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Axis>, D::Error> {
    let axes = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
    named(deserializer, axes).map(Some)
}

fn skinning<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<SkinningMethod>, D::Error> {
    let methods = SkinningMethod::ALL.map(|method| (method.name(), method));
    named(deserializer, methods).map(Some)
}

fn order<'de, D: Deserializer<'de>>(deserializer: D) -> Result<QuaternionOrder, D::Error> {
    let orders = [
        ("w-first", QuaternionOrder::WFirst),
        ("w-last", QuaternionOrder::WLast),
    ];
    named(deserializer, orders)
}

/// Reads one of some names, and returns its value.
fn named<'de, D: Deserializer<'de>, T: Copy, const N: usize>(
    deserializer: D,
    values: [(&'static str, T); N],
) -> Result<T, D::Error> {
    let name = among(deserializer, values.map(|(name, _)| name))?;
    let mut found = values.into_iter().filter(|(other, _)| *other == name);
    let value = found.next().map(|(_, value)| value);
    value.ok_or_else(|| Error::custom("unknown name"))
}

/// Reads one of some names.
fn among<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
    names: [&'static str; N],
) -> Result<&'static str, D::Error> {
    let given = String::deserialize(deserializer)?;
    let found = names.into_iter().find(|name| *name == given);
    found.ok_or_else(|| {
        let listed = names.join(", ");
        Error::custom(format!("unknown name `{given}`; expected one of {listed}"))
    })
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
    Ok(placement(&numbers)?.0)
}
