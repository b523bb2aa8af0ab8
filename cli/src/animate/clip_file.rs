//! Animated output file: a rig with its skin, or the file of a scene with an added clip.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::animation::{Armature, Clip, EulerPoseMap, KeyTolerance, Playback, Pose};
use kinopt::counted;
use kinopt::glam::Vec3;
use kinopt::io::gltf::{self, Scene, SceneFile, WriteOptions};
use kinopt::skeleton::Skeleton;
use serde::Serialize;

use super::frames::Frames;
use super::ik_options::IkOptions;
use super::ik_report::IkReport;
use crate::animated_armature::{AnimatedArmature, extension};
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::mesh_output::Skin;
use crate::{number_list, output, scene_output};

/// glTF's axis up (section 3.4).
const UP: Vec3 = Vec3::Y;
/// As many influences as every program reads.
const INFLUENCES: usize = 4;
/// What rounding hides of keys on a line.
const ROUNDING: f32 = 1e-6;

/// What becomes of a clip that is written.
#[derive(Args, Debug)]
#[command(next_help_heading = "Clips as glTF")]
pub(super) struct ClipOptions {
    /// Add a scene's clip to this file of the same bones, or where there is none to a copy of the model's: .glb or .gltf.
    #[arg(long, value_name = "FILE", requires = "fps", conflicts_with_all = ["out", "format"])]
    pub(super) into: Option<PathBuf>,

    /// What the written clip is called. Default: as the model's clip, with the rate behind it where that name is taken.
    #[arg(long, value_name = "NAME", requires = "fps")]
    clip_name: Option<String>,

    /// Take a bone's way over the ground and its turning out of the clip: a walk on the spot. Default: off.
    #[arg(long, value_name = "BONE", requires = "fps")]
    in_place: Option<String>,

    /// Lead over to the first pose within so many last seconds, so that the clip repeats without a jump. Default: off.
    #[arg(long, value_name = "SECONDS", requires = "fps", value_parser = number_list::positive)]
    close_seam: Option<f64>,

    /// Drop keys as long as no bone is further off in its parent than so much, in the file's unit, and so many radians.
    /// Default: none is dropped.
    #[arg(long, value_name = "LENGTH,RADIANS", requires = "fps", value_parser = tolerance)]
    reduce_keys: Option<KeyTolerance>,

    #[command(flatten)]
    ik: IkOptions,
}

fn tolerance(text: &str) -> Result<KeyTolerance, String> {
    let [translation, rotation] = number_list::parse_exactly::<2>(text, "--reduce-keys")?;
    match translation >= 0.0 && rotation >= 0.0 {
        true => Ok(KeyTolerance::EXACT
            .with_translation(translation as f32)
            .with_rotation(rotation as f32)
            .with_scale(ROUNDING)),
        false => Err("a length and an angle of 0 or more".into()),
    }
}

#[derive(Serialize)]
struct Document<'a> {
    file: String,
    clip: &'a str,
    /// In seconds.
    duration: f64,
    keys: usize,
    /// What was done without or made up.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: &'a [String],
    #[serde(flatten)]
    ik: Option<&'a IkReport>,
}

impl ClipOptions {
    /// The option about a clip that was given, if one was.
    pub(super) fn given(&self) -> Option<&'static str> {
        let own = first_given([
            ("--into", self.into.is_some()),
            ("--clip-name", self.clip_name.is_some()),
            ("--in-place", self.in_place.is_some()),
            ("--close-seam", self.close_seam.is_some()),
            ("--reduce-keys", self.reduce_keys.is_some()),
        ]);
        own.or_else(|| self.ik.given())
    }

    /// Writes a rig whose keys are solved for, with its mesh and weights beside it.
    pub(super) fn write_keys(
        &self,
        loaded: &LoadedModel,
        fps: f64,
        out: &Path,
        json: bool,
    ) -> Outcome<()> {
        let Some(rig) = &loaded.rig else {
            return Err(failure!("{}: it is no rig", loaded.file));
        };
        let mut rig = rig.clone();
        let (clip, told, changed) = self.ik.of_keys(&rig, fps)?;
        rig.clip = clip;
        rig.write(out)?;
        let keys = rig.clip.tracks().iter().map(|track| track.keys.len()).sum();
        let duration = rig.clip.time_span().map_or(0.0, |[from, to]| to - from);
        let document = || Document {
            file: out.display().to_string(),
            clip: "keys",
            duration,
            keys,
            notes: &[],
            ik: Some(&told),
        };
        let text = || {
            format!(
                "{changed} of {} changed, in {}\n{}",
                counted(keys, "key"),
                out.display(),
                told.text()
            )
        };
        output::result(json, document, text)
    }

    /// Writes a rig's keyframes with its skin.
    pub(super) fn write_rig(
        &self,
        loaded: &LoadedModel,
        skin: &Skin<'_>,
        (frames, playback): (Frames, Playback),
        out: &Path,
        json: bool,
    ) -> Outcome<()> {
        let Skin::Rig {
            skeleton,
            mesh,
            weights,
            note,
            ..
        } = skin
        else {
            return Err(failure!("{}: it is no rig", loaded.file));
        };
        if self.into.is_some() || self.in_place.is_some() {
            return Err(usage!(
                "{}: --into and --in-place are for scenes; this is a rig",
                loaded.file
            ));
        }
        let keys = loaded.keyframes("animate")?;
        let (weights, lost) = weights.pruned(INFLUENCES)?;
        let mut notes: Vec<String> = loaded.notes().into_iter().chain(note.clone()).collect();
        if lost.largest_lost > 0.0 {
            notes.push(format!(
                "each vertex follows its {INFLUENCES} strongest bones; others held {:.3} of one at most",
                lost.largest_lost
            ));
        }
        let mut scene = Scene::of_skeleton(skeleton, Some((mesh, &weights)))?;
        let angles = EulerPoseMap::new(skeleton);
        let mut q = vec![0.0; skeleton.angles()];
        let clip = sampled("keys", &scene.armature, frames, |time, pose| {
            keys.sample(time, playback, &mut q)?;
            Ok(angles.pose_of(&q, pose)?)
        })?;
        let (clip, told) = self.changed(clip, &scene.armature, Some(skeleton), frames)?;
        let clip = clip.renamed(self.clip_name.clone().unwrap_or_else(|| "keys".into()));
        scene.clips.push(clip.clone());
        let mut options = WriteOptions::default();
        options.up = self.ik.up();
        gltf::write(&scene, &options, out)?;
        say(out, &clip, &scene.armature, (&notes, told.as_ref()), json)
    }

    /// Writes a scene's file with its clip, by samples, added; or with --into adds that to another file. Of a `whole` clip keys
    /// that nothing changes stay as they are.
    pub(super) fn write_scene(
        &self,
        animated: &AnimatedArmature,
        own: &SceneFile,
        clip: &Clip,
        (frames, playback, whole): (Frames, Playback, bool),
        out: &Path,
        json: bool,
    ) -> Outcome<()> {
        let armature = &animated.armature;
        // Keys without IK requests do not change.
        let made = match whole && self.ik.given().is_some() {
            true => clip.clone(),
            false => sampled(clip.name(), armature, frames, |time, pose| {
                *pose = animated.pose_at(clip, time, playback)?;
                Ok(())
            })?,
        };
        let (made, told) = self.changed(made, armature, None, frames)?;
        let file = match &self.into {
            Some(into) => scene_output::file_to_add_to(own, into)?,
            None => own.clone(),
        };
        let (given, at_rate) = (
            self.clip_name.as_deref(),
            format!("{} at {}", clip.name(), frames.per_second()),
        );
        let made = scene_output::write_with_clip(file, made, given, &at_rate, out)?;
        say(out, &made, armature, (&[], told.as_ref()), json)
    }

    /// The clip as the options have it.
    fn changed(
        &self,
        clip: Clip,
        armature: &Armature,
        skeleton: Option<&Skeleton>,
        frames: Frames,
    ) -> Outcome<(Clip, Option<IkReport>)> {
        let rate = frames.per_second();
        let (mut clip, told) = self.ik.over(clip, armature, skeleton, rate)?;
        if let Some(bone) = &self.in_place {
            (clip, _) = clip.without_root_motion(armature, armature.bone(bone)?, UP, rate)?;
        }
        if let Some(seconds) = self.close_seam {
            clip = clip.with_closed_seam(armature, seconds, rate)?;
        }
        if let Some(tolerance) = &self.reduce_keys {
            clip = clip.with_fewer_keys(armature, tolerance)?;
        }
        Ok((clip, told))
    }
}

/// The clip through the poses of frames, from 0 s on.
fn sampled(
    name: &str,
    armature: &Armature,
    frames: Frames,
    mut posed: impl FnMut(f64, &mut Pose) -> Outcome<()>,
) -> Outcome<Clip> {
    let (mut times, mut poses) = (Vec::new(), Vec::new());
    let mut pose = armature.rest().clone();
    for (_, time) in frames.iter() {
        posed(time, &mut pose)?;
        times.push((time - frames.start()) as f32);
        poses.push(pose.clone());
    }
    Ok(Clip::through_poses(name, armature, &times, &poses)?)
}

/// Whether a file is written as glTF, by its name.
pub(super) fn is_gltf(path: &Path) -> bool {
    matches!(extension(path).as_str(), "glb" | "gltf")
}

fn say(
    out: &Path,
    clip: &Clip,
    armature: &Armature,
    (notes, told): (&[String], Option<&IkReport>),
    json: bool,
) -> Outcome<()> {
    let keys = clip
        .channels(armature)?
        .iter()
        .map(|(_, channel)| channel.times().len())
        .sum();
    let document = || Document {
        file: out.display().to_string(),
        clip: clip.name(),
        duration: clip.duration(),
        keys,
        notes,
        ik: told,
    };
    let text = || {
        format!(
            "clip `{}`: {:.3} s, {}, in {}\n{}",
            clip.name(),
            clip.duration(),
            counted(keys, "key"),
            out.display(),
            told.map_or_else(String::new, IkReport::text)
        )
    };
    if !json {
        for note in notes {
            output::message(note);
        }
    }
    output::result(json, document, text)
}
