//! Sources of motion: arrays, motion capture, clips of scenes and keyframes of rigs.

use std::path::Path;

use clap::{Args, ValueEnum};
use kinopt::animation::Playback;
use kinopt::motion::retarget::folder::FolderQuestion;
use kinopt::motion::retarget::{BodyMap, Capture, KnownSkeleton, RetargetError, UpAxis};

use crate::animated_armature::{AnimatedArmature, extension};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::{number_list, numpy_file, output};

/// What is taken where neither the source nor anybody says it: of arrays …
const ARRAY_RATE: f64 = 120.0;
/// … and of clips, whose keys stand anywhere.
const CLIP_RATE: f64 = 60.0;

/// How a movement is read.
#[derive(Args, Debug)]
pub(super) struct SourceOptions {
    /// Frames a second: of a .npy those that it has, of all else those that are taken. Default: as the file or the map
    /// says, else 120 of a .npy and 60 of clips.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// Which of a scene's clips: its name. Default: the first.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,

    /// The axis that points upward in the source. Default: as the map says, else y of .bvh, .glb and .gltf, and z.
    #[arg(long, value_enum, value_name = "AXIS")]
    up: Option<Up>,
}

/// An axis that points upward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Up {
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

/// A movement, and which way is up in it.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) capture: Capture,
    pub(super) up: UpAxis,
}

impl SourceOptions {
    /// Says in a folder's question how movements are read.
    pub(super) fn ask<'a>(&'a self, question: &mut FolderQuestion<'a>) {
        question.frame_rate = self.fps;
        question.clip = self.clip.as_deref();
        question.up = self.up.map(UpAxis::from);
    }

    /// Reads a movement, with what a map or the skeleton that it is said to be tells of arrays.
    pub(super) fn read(
        &self,
        path: &Path,
        map: Option<&BodyMap>,
        skeleton: Option<&KnownSkeleton>,
    ) -> Outcome<Source> {
        let file = path.display();
        let told = |error: RetargetError| failure!("{file}: {error}");
        let kind = extension(path);
        if self.clip.is_some() && !matches!(kind.as_str(), "glb" | "gltf") {
            return Err(usage!("{file}: --clip is for scenes (.glb, .gltf)"));
        }
        let said = self.fps.or(map.and_then(|map| map.frame_rate));
        let (capture, up) = match kind.as_str() {
            "bvh" | "glb" | "gltf" => {
                let animated = AnimatedArmature::read(path)?;
                let own = animated.frames.as_ref().map(|frames| 1.0 / frames.time);
                let rate = said.or(own).unwrap_or(CLIP_RATE);
                let clip = animated.clip(self.clip.as_deref())?;
                let capture = Capture::of_clip(&animated.armature, clip, rate);
                (capture.map_err(told)?, UpAxis::Y)
            }
            "json" => (of_rig(path, said.unwrap_or(CLIP_RATE))?, UpAxis::Z),
            "npy" => {
                let array = numpy_file::read(path)?;
                let names = names(&file.to_string(), &array.shape, map, skeleton)?;
                if said.is_none() {
                    output::message(&format!(
                        "note: {file}: nobody says the frames a second: {ARRAY_RATE} are taken"
                    ));
                }
                let rate = said.unwrap_or(ARRAY_RATE);
                let capture = Capture::new(names, &array.numbers, rate);
                (capture.map_err(told)?, UpAxis::Z)
            }
            _ => {
                return Err(usage!(
                    "{file}: a .npy, .bvh, .glb, .gltf or a rig's .json is read"
                ));
            }
        };
        let said = self.up.map(UpAxis::from);
        let up = said.or(map.and_then(|map| map.up)).unwrap_or(up);
        Ok(Source { capture, up })
    }
}

/// The names of an array's joints, where its shape fits them.
fn names(
    file: &str,
    shape: &[usize],
    map: Option<&BodyMap>,
    skeleton: Option<&KnownSkeleton>,
) -> Outcome<Vec<String>> {
    let told = || {
        let axes: Vec<String> = shape.iter().map(ToString::to_string).collect();
        axes.join(", ")
    };
    let [_, joints, 3] = *shape else {
        return Err(failure!(
            "{file}: of the shape ({}), where (frames, joints, 3) is read",
            told()
        ));
    };
    let named = map.map(|map| &map.joints).filter(|names| !names.is_empty());
    if let Some(names) = named {
        return match names.len() == joints {
            true => Ok(names.clone()),
            false => Err(failure!(
                "{file}: of the shape ({}), where the map names {own} joints: (frames, {own}, 3)",
                told(),
                own = names.len()
            )),
        };
    }
    let Some(skeleton) = skeleton else {
        let known: Vec<&str> = KnownSkeleton::names().collect();
        return Err(failure!(
            "{file}: nobody says what its {joints} joints are called: \"joints\" of a map does, or --map NAME for a skeleton of: {}",
            known.join(", ")
        ));
    };
    let names = skeleton.joints_of_array(joints);
    names.map(<[String]>::to_vec).ok_or_else(|| {
        failure!(
            "{file}: of the shape ({}), which is no array of the skeleton {}",
            told(),
            skeleton.name()
        )
    })
}

/// Where a rig's bones are by its keyframes.
fn of_rig(path: &Path, rate: f64) -> Outcome<Capture> {
    let loaded = LoadedModel::read(path, &ModelOptions::default())?;
    let clip = loaded.keyframes("retarget")?;
    let lacks = || failure!("{}: it is no rig", loaded.file);
    let skeleton = &loaded.rig.as_ref().ok_or_else(lacks)?.skeleton;
    let [start, end] = clip.time_span().unwrap_or([0.0; 2]);
    let frames = ((end - start) * rate + 0.5).floor() as usize + 1;
    let mut q = vec![0.0; skeleton.angles()];
    let mut numbers = Vec::with_capacity(3 * frames * skeleton.bones().len());
    for frame in 0..frames {
        clip.sample(start + frame as f64 / rate, Playback::Hold, &mut q)?;
        let placed = skeleton.pose(&q)?;
        for bone in skeleton.bone_ids() {
            numbers.extend(placed.tail(bone)?.to_array());
        }
    }
    let names = skeleton.bones().iter().map(|bone| bone.name.clone());
    let capture = Capture::new(names.collect(), &numbers, rate);
    capture.map_err(|error| failure!("{}: {error}", loaded.file))
}

/// Whether a source is an array, whose joints a map has to name.
pub(super) fn is_array(path: &Path) -> bool {
    extension(path) == "npy"
}
