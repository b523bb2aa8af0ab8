//! Sources of motion: arrays, motion capture, clips of scenes and keyframes of rigs.

use std::path::Path;

use clap::{Args, ValueEnum};
use kinopt::animation::Playback;
use kinopt::io::c3d;
use kinopt::io::numpy::NumpyArray;
use kinopt::io::smpl::{self, RestJoints};
use kinopt::motion::retarget::{
    BodyMap, Capture, JointRotations, KnownSkeleton, RetargetError, UpAxis,
};
use kinopt::skeleton::Bone;
use kinopt::spatial::{Matrix3, Quaternion};
use kinopt_bindings::problem_file::{ModelSettings, number_list};
use kinopt_bindings::retarget_folder::FolderSettings;

use crate::animated_armature::{AnimatedArmature, extension, is_scene};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::{file_access, output};

/// Default frame rate of arrays, per second.
const ARRAY_RATE: f64 = 120.0;
/// Default frame rate of clips, per second.
const CLIP_RATE: f64 = 60.0;

/// Options of reading a movement.
#[derive(Args, Debug)]
pub(crate) struct SourceOptions {
    /// Frames per second. Default: file or map, else .npy 120, clips 60.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    pub(crate) fps: Option<f64>,

    /// Clip of a scene. Default: the first.
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,

    /// Up axis of the source, y or z. Default: the map's, else detected.
    #[arg(long, value_enum, value_name = "AXIS", hide_possible_values = true)]
    pub(crate) up: Option<Up>,

    #[command(flatten)]
    pub(crate) body: BodyOptions,
}

/// Rest joints of a motion of the SMPL family.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct BodyOptions {
    /// SMPL motions: body model .npz, or height in m. Default: of the file, else 1.7.
    #[arg(long, value_name = "FILE|M")]
    body_model: Option<String>,
}

impl BodyOptions {
    fn rest_joints(&self) -> Outcome<RestJoints> {
        let Some(given) = &self.body_model else {
            return Ok(RestJoints::Default);
        };
        Ok(match given.parse() {
            Ok(height) => RestJoints::Height(height),
            Err(_) => RestJoints::BodyModel(smpl::read_body_model(given)?),
        })
    }

    /// The options in words, if one is given.
    fn text(&self) -> Option<String> {
        let given = self.body_model.as_ref();
        given.map(|given| format!("body model {given}"))
    }
}

/// Up axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    Y,
    Z,
}

impl From<Up> for UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

/// Movement and its up axis.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) capture: Capture,
    pub(crate) up: UpAxis,
}

impl SourceOptions {
    /// Adds the reading options to a folder query.
    pub(super) fn add_to_query<'a>(&'a self, query: &mut FolderSettings<'a>) {
        query.frame_rate = self.fps;
        query.clip = self.clip.as_deref();
        query.up = self.up.map(UpAxis::from);
        query.more.extend(self.body.text());
    }

    /// Reads a movement. `map` or `skeleton` supplies the joint names of an array.
    pub(crate) fn read(
        &self,
        path: &Path,
        map: Option<&BodyMap>,
        skeleton: Option<&KnownSkeleton>,
    ) -> Outcome<Source> {
        let file = path.display();
        let with_file = |error: RetargetError| failure!("{file}: {error}");
        let kind = extension(path);
        if self.clip.is_some() && !is_scene(path) {
            return Err(usage!(
                "{file}: --clip applies to scenes (.glb, .gltf, .vrm)"
            ));
        }
        let given_rate = self.fps.or(map.and_then(|map| map.frame_rate));
        let (capture, up) = match kind.as_str() {
            "npz" => {
                let motion = smpl::read(path, &self.body.rest_joints()?)?;
                for note in &motion.notes {
                    output::message(&format!("note: {file}: {note}"));
                }
                let rate = given_rate.unwrap_or(motion.frame_rate);
                let capture = Capture::of_clip(&motion.armature, &motion.clip, rate);
                (capture.map_err(with_file)?, UpAxis::Z)
            }
            "c3d" => {
                let markers = c3d::read(path)?;
                (Capture::of_markers(&markers).map_err(with_file)?, UpAxis::Z)
            }
            _ if AnimatedArmature::is_at(path) => {
                let animated = AnimatedArmature::read(path)?;
                for note in &animated.notes {
                    output::message(&format!("note: {file}: {note}"));
                }
                let file_rate = animated.frames.as_ref().map(|frames| 1.0 / frames.time);
                let rate = given_rate.or(file_rate).unwrap_or(CLIP_RATE);
                let clip = animated.clip(self.clip.as_deref())?;
                let capture = Capture::of_clip(&animated.armature, clip, rate);
                (capture.map_err(with_file)?, UpAxis::Y)
            }
            "json" => (of_rig(path, given_rate.unwrap_or(CLIP_RATE))?, UpAxis::Z),
            "npy" => {
                let array =
                    NumpyArray::from_bytes(&file_access::allowed().read(path)?, &file.to_string())?;
                let names = names(&file.to_string(), &array.shape, map, skeleton)?;
                if given_rate.is_none() {
                    output::message(&format!(
                        "note: {file}: no frame rate given, {ARRAY_RATE} frames per second assumed; --fps changes it"
                    ));
                }
                let rate = given_rate.unwrap_or(ARRAY_RATE);
                let capture = Capture::new(names, &array.numbers, rate);
                (capture.map_err(with_file)?, UpAxis::Z)
            }
            _ => {
                return Err(usage!(
                    "{file}: unsupported extension; expected .npz, .npy, .c3d, .bvh, .glb, .gltf, .vrm or a rig's .json"
                ));
            }
        };
        let given_up = self.up.map(UpAxis::from).or(map.and_then(|map| map.up));
        let detected = capture.up_axis();
        if let Some(along) = detected.filter(|along| given_up.is_none() && *along != up) {
            let (along, other) = (along.name(), up.name());
            output::message(&format!(
                "note: {file}: up axis {along}, detected from the body; --up {other} selects the other axis"
            ));
        }
        let up = given_up.or(detected).unwrap_or(up);
        Ok(Source { capture, up })
    }
}

/// Joint names of an array. Checks that its shape fits them.
fn names(
    file: &str,
    shape: &[usize],
    map: Option<&BodyMap>,
    skeleton: Option<&KnownSkeleton>,
) -> Outcome<Vec<String>> {
    let shape_text = || {
        let axes: Vec<String> = shape.iter().map(ToString::to_string).collect();
        axes.join(", ")
    };
    let [_, joints, 3] = *shape else {
        return Err(failure!(
            "{file}: an array of shape ({}); expected (frames, joints, 3)",
            shape_text()
        ));
    };
    let named = map.map(|map| &map.joints).filter(|names| !names.is_empty());
    if let Some(names) = named {
        return match names.len() == joints {
            true => Ok(names.clone()),
            false => Err(failure!(
                "{file}: an array of shape ({}); the map names {count} joints, so expected (frames, {count}, 3)",
                shape_text(),
                count = names.len()
            )),
        };
    }
    let Some(skeleton) = skeleton else {
        let known: Vec<&str> = KnownSkeleton::names().collect();
        return Err(failure!(
            "{file}: names of its {joints} joints are missing: give \"joints\" in a map, or --map NAME with a skeleton of: {}",
            known.join(", ")
        ));
    };
    let names = skeleton.joints_of_array(joints);
    names.map(<[String]>::to_vec).ok_or_else(|| {
        failure!(
            "{file}: an array of shape ({}) does not fit the skeleton {}",
            shape_text(),
            skeleton.name()
        )
    })
}

/// Bone tails of a rig over its keyframes, sampled at `rate` per second.
fn of_rig(path: &Path, rate: f64) -> Outcome<Capture> {
    let loaded = LoadedModel::read(path, &ModelSettings::default())?;
    let clip = loaded.keyframes("retarget")?;
    let lacks = || failure!("{}: the file is not a rig", loaded.file);
    let skeleton = &loaded.rig.as_ref().ok_or_else(lacks)?.skeleton;
    let [start, end] = clip.time_span().unwrap_or([0.0; 2]);
    let frames = ((end - start) * rate + 0.5).floor() as usize + 1;
    let mut q = vec![0.0; skeleton.angles()];
    let mut numbers = Vec::with_capacity(3 * frames * skeleton.bones().len());
    let rest = skeleton
        .bones()
        .iter()
        .map(|bone| bone.model_from_rest.rotation);
    let mut rotations = JointRotations {
        parents: skeleton
            .bones()
            .iter()
            .map(|bone| bone.parent.map(|parent| parent.index()))
            .collect(),
        rest_positions: skeleton.bones().iter().map(Bone::rest_tail).collect(),
        rest_rotations: rest.map(|rotation| quaternion(&rotation)).collect(),
        rotations: Vec::with_capacity(frames * skeleton.bones().len()),
    };
    for frame in 0..frames {
        clip.sample(start + frame as f64 / rate, Playback::Hold, &mut q)?;
        let placed = skeleton.pose(&q)?;
        for placement in &placed.model_from_bone {
            numbers.extend(placement.translation.to_array());
            rotations.rotations.push(quaternion(&placement.rotation));
        }
    }
    let names = skeleton.bones().iter().map(|bone| bone.name.clone());
    let capture = Capture::new(names.collect(), &numbers, rate);
    let capture = capture.and_then(|capture| capture.with_rotations(rotations));
    capture.map_err(|error| failure!("{}: {error}", loaded.file))
}

/// Unit quaternion w, x, y, z of a rotation matrix.
fn quaternion(rotation: &Matrix3<f64>) -> [f64; 4] {
    let q = Quaternion::from_matrix(rotation);
    [q.w, q.v.x, q.v.y, q.v.z]
}

/// Returns `true` if a source is an array, which needs joint names.
pub(super) fn is_array(path: &Path) -> bool {
    extension(path) == "npy"
}
