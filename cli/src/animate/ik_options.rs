//! Options of inverse kinematics over the written clip: reaching bones and foot locks.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, Clip, EulerClip};
use kinopt::glam::{DVec3, Vec3};
use kinopt::io::numpy::NumpyArray;
use kinopt::io::rig::Rig;
use kinopt::motion::clip_ik::{ClipIk, KeyframeIk, Reach, ground_speed};
use kinopt::motion::path::{CartesianPath, QuaternionOrder};
use kinopt::skeleton::{BoneId, Skeleton};
use kinopt::spatial::Vector3;
use kinopt::task::Axis;
use kinopt_bindings::clip_ik::reach_curve;
use kinopt_bindings::problem_file::number_list;

use super::ik_report::IkReport;
use crate::animated_armature::extension;
use crate::choices::{AXES, among, first_given};
use crate::failure::Outcome;
use crate::{file_access, world_file};

/// Inverse-kinematics requests for the clip.
#[derive(Args, Debug)]
#[command(next_help_heading = "Inverse kinematics over the clip")]
pub(super) struct IkOptions {
    /// Move a bone to a point in model coordinates, or along a curve. Repeatable.
    #[arg(long, value_name = "BONE=X,Y,Z|FILE", requires = "fps", value_parser = ReachArgument::parse)]
    reach: Vec<ReachArgument>,

    /// Time span of one or all --reach, in seconds. Default: the whole clip.
    #[arg(long, value_name = "FROM,TO", requires = "reach", allow_hyphen_values = true, value_parser = span)]
    span: Vec<[f64; 2]>,

    /// Blend into and out of the reach, in seconds. Default: 0.2.
    #[arg(long, value_name = "SECONDS", requires = "reach", value_parser = number_list::not_negative)]
    fade: Option<f64>,

    /// Lock a foot in place during its contacts. Repeatable.
    #[arg(long, value_name = "BONE", requires = "fps")]
    plant: Vec<String>,

    /// World file, the ground of planted feet. Default: level.
    #[arg(long, value_name = "FILE", requires = "plant")]
    ground: Option<PathBuf>,

    /// Root velocity of a walk on the spot; `feet`: from planted feet.
    #[arg(long, value_name = "X,Y,Z|feet", requires = "plant", allow_hyphen_values = true, value_parser = RootVelocity::parse)]
    root_velocity: Option<RootVelocity>,

    /// Bone that moves if a limb is too short. Default: the common ancestor.
    #[arg(long, value_name = "BONE", requires = "fps")]
    root: Option<String>,

    /// Up axis; a .glb file gets glTF's y. Default: y.
    #[arg(long, value_name = "AXIS", requires = "fps", hide_possible_values = true, value_parser = among(AXES))]
    up: Option<Axis>,
}

/// Parsed `--reach` value.
#[derive(Clone, Debug)]
struct ReachArgument {
    bone: String,
    target: Target,
}

#[derive(Clone, Debug)]
enum Target {
    Point([f64; 3]),
    File(PathBuf),
}

impl ReachArgument {
    fn parse(text: &str) -> Result<Self, String> {
        let (bone, target) = text
            .rsplit_once('=')
            .ok_or("expected BONE=X,Y,Z or BONE=FILE")?;
        let is_file = matches!(extension(Path::new(target)).as_str(), "csv" | "npy" | "txt");
        Ok(Self {
            bone: bone.to_owned(),
            target: match is_file {
                true => Target::File(target.into()),
                false => Target::Point(number_list::parse_exactly(target, "a point")?),
            },
        })
    }
}

#[derive(Clone, Copy, Debug)]
enum RootVelocity {
    By([f64; 3]),
    AsFeet,
}

impl RootVelocity {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "feet" => Ok(Self::AsFeet),
            _ => number_list::parse_exactly(text, "--root-velocity").map(Self::By),
        }
    }
}

fn span(text: &str) -> Result<[f64; 2], String> {
    number_list::parse_exactly(text, "--span")
}

impl IkOptions {
    /// Name of the first inverse-kinematics option that the user gave.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given([
            ("--reach", !self.reach.is_empty()),
            ("--plant", !self.plant.is_empty()),
            ("--root", self.root.is_some()),
            ("--up", self.up.is_some()),
        ])
    }

    /// Unit vector along the up axis.
    pub(super) fn up(&self) -> Vec3 {
        Vec3::AXES[self.up.unwrap_or(Axis::Y) as usize]
    }

    /// Solves the requests over a clip and reports the result. Without requests, returns the clip unchanged and
    /// `None`.
    pub(super) fn over(
        &self,
        clip: Clip,
        armature: &Armature,
        skeleton: Option<&Skeleton>,
        fps: f64,
    ) -> Outcome<(Clip, Option<IkReport>)> {
        if self.reach.is_empty() && self.plant.is_empty() {
            // `--up` of a rig also sets the rotation of the output file.
            let up = self.up.filter(|_| skeleton.is_none()).map(|_| "--up");
            return match self.root.as_ref().map(|_| "--root").or(up) {
                Some(option) => Err(usage!("{option} requires --reach or --plant")),
                None => Ok((clip, None)),
            };
        }
        let up = self.up();
        let mut ik = ClipIk::new(armature).with_up(up).with_keys_per_second(fps);
        if let Some(skeleton) = skeleton {
            ik = ik.with_joints_of(skeleton);
        }
        for (k, reach) in self.reach.iter().enumerate() {
            ik = ik.with_reach(self.reach(k, reach, armature, clip.span().map(f64::from))?);
        }
        let feet = self.plant.iter().map(|name| armature.bone(name));
        let feet = feet.collect::<Result<Vec<BoneId>, _>>()?;
        for &foot in &feet {
            ik = ik.with_planted(foot);
        }
        if let Some(root) = &self.root {
            ik = ik.with_root(armature.bone(root)?);
        }
        let root_velocity = match self.root_velocity {
            None => None,
            Some(RootVelocity::By(by)) => Some(DVec3::from(by).as_vec3()),
            Some(RootVelocity::AsFeet) => Some(ground_speed(armature, &clip, &feet, up, fps)?),
        };
        ik = ik.with_root_velocity(root_velocity.unwrap_or(Vec3::ZERO));
        if let Some(file) = &self.ground {
            let (world, up) = (world_file::read(Some(file))?, Vector3::from(up));
            ik = ik.with_ground(move |at| world.height_at(at, up).unwrap_or(0.0).max(0.0));
        }
        let edited = ik.solve(&clip)?;
        let report = IkReport::new(&edited.report, armature, None, root_velocity);
        Ok((edited.clip, Some(report)))
    }

    /// Solves the requests for a rig's keyframes. Returns the clip, a report and the number of changed keys.
    pub(super) fn of_keys(&self, rig: &Rig, fps: f64) -> Outcome<(EulerClip, IkReport, usize)> {
        let others = [
            ("--plant", !self.plant.is_empty()),
            ("--up", self.up.is_some()),
        ];
        if let Some(option) = first_given(others) {
            return Err(usage!(
                "{option} applies to clips written as .glb or .gltf, not to a rig's keys"
            ));
        }
        let armature = Armature::of_skeleton(&rig.skeleton);
        let span = rig.clip.time_span().unwrap_or([0.0; 2]);
        let mut ik = KeyframeIk::new(&rig.skeleton).with_moments_per_second(fps);
        for (k, reach) in self.reach.iter().enumerate() {
            ik = ik.with_reach(self.reach(k, reach, &armature, span)?);
        }
        if let Some(root) = &self.root {
            ik = ik.with_root(armature.bone(root)?);
        }
        let edited = ik.solve(&rig.clip)?;
        let report = IkReport::new(&edited.report, &armature, Some(&rig.skeleton), None);
        Ok((edited.clip, report, edited.keys_changed))
    }

    fn reach(
        &self,
        k: usize,
        argument: &ReachArgument,
        armature: &Armature,
        of_clip: [f64; 2],
    ) -> Outcome<Reach> {
        let span = match &self.span[..] {
            [] => None,
            [one] => Some(*one),
            all if all.len() == self.reach.len() => Some(all[k]),
            all => {
                return Err(usage!(
                    "{} values of --span for {} of --reach: give one for all, or one for each",
                    all.len(),
                    self.reach.len()
                ));
            }
        };
        let bone = armature.bone(&argument.bone)?;
        let mut reach = match &argument.target {
            Target::Point(point) => Reach::to(bone, *point)?,
            Target::File(file) => {
                let span = span.unwrap_or(of_clip);
                let curve = curve(file, span);
                Reach::along(bone, curve?)
            }
        };
        if let Some([from, to]) = span {
            reach = reach.with_span(from..=to);
        }
        if let Some(fade) = self.fade {
            reach = reach.with_fade(fade);
        }
        Ok(reach)
    }
}

/// Curve through the points of a file, at the file's times or evenly over the span, in seconds.
fn curve(file: &Path, span: [f64; 2]) -> Outcome<KeyedCurve<DVec3>> {
    let named = |problem: String| failure!("{}: {problem}", file.display());
    let (times, points): (Option<Vec<f64>>, Vec<DVec3>) = match extension(file).as_str() {
        "npy" => {
            let array = NumpyArray::from_bytes(
                &file_access::allowed().read(file)?,
                &file.display().to_string(),
            )?;
            let [_, columns @ (3 | 4)] = array.shape[..] else {
                return Err(named(format!(
                    "an array of shape {:?}: expected points × 3, or points × 4 with the times first",
                    array.shape
                )));
            };
            let rows = array.numbers.chunks_exact(columns);
            let times = rows.clone().map(|row| row[0]);
            let last = |row: &[f64]| DVec3::from_slice(&row[columns - 3..]);
            (
                (columns == 4).then(|| times.collect()),
                rows.map(last).collect(),
            )
        }
        _ => {
            let (path, _) = CartesianPath::read(file, QuaternionOrder::WFirst)?;
            let points = path.points().iter();
            let points = points.map(|at| DVec3::from(at.translation.to_array()));
            (path.times().map(<[f64]>::to_vec), points.collect())
        }
    };
    reach_curve(points, times, span).map_err(|error| named(error.to_string()))
}
