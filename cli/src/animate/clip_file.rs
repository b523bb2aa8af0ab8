//! Animated output file: a rig with its skin, or the file of a scene with an added clip.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::animation::{Armature, Clip, EulerPoseMap, KeyTolerance, Playback, Pose};
use kinopt::counted;
use kinopt::glam::Vec3;
use kinopt::io::gltf::{self, Scene, SceneFile, WriteOptions};
use kinopt::skeleton::Skeleton;
use kinopt_bindings::problem_file::number_list;
use serde::Serialize;

use super::frames::Frames;
use super::ik_options::IkOptions;
use super::ik_report::IkReport;
use crate::animated_armature::AnimatedArmature;
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::mesh_output::Skin;
use crate::{output, scene_output};

/// Up axis of glTF (section 3.4).
const UP: Vec3 = Vec3::Y;
/// Number of influences per vertex that all glTF readers support.
const INFLUENCES: usize = 4;
/// Scale tolerance of key reduction: covers single-precision rounding.
const ROUNDING: f32 = 1e-6;

/// Options of the written clip.
#[derive(Args, Debug)]
#[command(next_help_heading = "Clips as glTF")]
pub(super) struct ClipOptions {
    /// Add the clip to a .glb or .gltf, or to a copy of the model's file.
    #[arg(long, value_name = "FILE", requires = "fps", conflicts_with_all = ["out", "format"])]
    pub(super) into: Option<PathBuf>,

    /// Name of the written clip. Default: the model's clip name.
    #[arg(long, value_name = "NAME", requires = "fps")]
    clip_name: Option<String>,

    /// Remove a bone's horizontal motion and heading.
    #[arg(long, value_name = "BONE", requires = "fps")]
    in_place: Option<String>,

    /// Blend the last SECONDS into the first pose, for loops.
    #[arg(long, value_name = "SECONDS", requires = "fps", value_parser = number_list::positive)]
    close_seam: Option<f64>,

    /// Drop keys within this error, a length and radians.
    #[arg(long, value_name = "L,RAD", requires = "fps", value_parser = tolerance)]
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
        false => Err("expected a length and an angle, both ≥ 0".into()),
    }
}

#[derive(Serialize)]
struct Document<'a> {
    file: String,
    clip: &'a str,
    /// Seconds.
    duration: f64,
    keys: usize,
    /// Remarks about parts of the model that were left out or computed.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: &'a [String],
    #[serde(flatten)]
    ik: Option<&'a IkReport>,
}

impl ClipOptions {
    /// Name of the first clip option that the user gave.
    pub(super) fn given(&self) -> Option<&'static str> {
        let first_option = first_given([
            ("--into", self.into.is_some()),
            ("--clip-name", self.clip_name.is_some()),
            ("--in-place", self.in_place.is_some()),
            ("--close-seam", self.close_seam.is_some()),
            ("--reduce-keys", self.reduce_keys.is_some()),
        ]);
        first_option.or_else(|| self.ik.given())
    }

    /// Solves the keys of a rig and writes the rig file with its mesh and weights.
    pub(super) fn write_keys(
        &self,
        loaded: &LoadedModel,
        fps: f64,
        out: &Path,
        json: bool,
    ) -> Outcome<()> {
        let Some(rig) = &loaded.rig else {
            return Err(failure!("{}: the file is not a rig", loaded.file));
        };
        let mut rig = rig.clone();
        let (clip, report, changed) = self.ik.of_keys(&rig, fps)?;
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
            ik: Some(&report),
        };
        let text = || {
            format!(
                "{changed} of {} changed, in {}\n{}",
                counted(keys, "key"),
                out.display(),
                report.text()
            )
        };
        output::result(json, document, text)
    }

    /// Writes a rig's keyframes and skin as glTF.
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
            return Err(failure!("{}: the file is not a rig", loaded.file));
        };
        if self.into.is_some() || self.in_place.is_some() {
            return Err(usage!(
                "{}: --into and --in-place apply to scenes; this file is a rig",
                loaded.file
            ));
        }
        let keys = loaded.keyframes("animate")?;
        let (weights, lost) = weights.pruned(INFLUENCES)?;
        let mut notes: Vec<String> = loaded.notes().into_iter().chain(note.clone()).collect();
        if lost.largest_lost > 0.0 {
            notes.push(format!(
                "each vertex keeps its {INFLUENCES} largest weights; at most {:.3} of the total weight of 1 was removed",
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
        let (clip, report) = self.changed(clip, &scene.armature, Some(skeleton), frames)?;
        let clip = clip.renamed(self.clip_name.clone().unwrap_or_else(|| "keys".into()));
        scene.clips.push(clip.clone());
        let mut options = WriteOptions::default();
        options.up = self.ik.up();
        gltf::write(&scene, &options, out)?;
        print(out, &clip, &scene.armature, (&notes, report.as_ref()), json)
    }

    /// Writes a scene's file with its clip added, or adds the clip to the file of `--into`. The clip is sampled at
    /// `frames`. A `whole` clip with IK requests keeps its own keys.
    pub(super) fn write_scene(
        &self,
        animated: &AnimatedArmature,
        scene_file: &SceneFile,
        clip: &Clip,
        (frames, playback, whole): (Frames, Playback, bool),
        out: &Path,
        json: bool,
    ) -> Outcome<()> {
        let armature = &animated.armature;
        // Without IK requests the clip is sampled at the frames.
        let new_clip = match whole && self.ik.given().is_some() {
            true => clip.clone(),
            false => sampled(clip.name(), armature, frames, |time, pose| {
                *pose = animated.pose_at(clip, time, playback)?;
                Ok(())
            })?,
        };
        let (new_clip, report) = self.changed(new_clip, armature, None, frames)?;
        let file = match &self.into {
            Some(into) => scene_output::file_to_add_to(scene_file, into)?,
            None => scene_file.clone(),
        };
        let (given, at_rate) = (
            self.clip_name.as_deref(),
            format!("{} at {}", clip.name(), frames.per_second()),
        );
        let new_clip = scene_output::write_with_clip(file, new_clip, given, &at_rate, out)?;
        print(out, &new_clip, armature, (&[], report.as_ref()), json)
    }

    /// Applies the clip options to a clip. The report is `None` without IK requests.
    fn changed(
        &self,
        clip: Clip,
        armature: &Armature,
        skeleton: Option<&Skeleton>,
        frames: Frames,
    ) -> Outcome<(Clip, Option<IkReport>)> {
        let rate = frames.per_second();
        let (mut clip, report) = self.ik.over(clip, armature, skeleton, rate)?;
        if let Some(bone) = &self.in_place {
            (clip, _) = clip.without_root_motion(armature, armature.bone(bone)?, UP, rate)?;
        }
        if let Some(seconds) = self.close_seam {
            clip = clip.with_closed_seam(armature, seconds, rate)?;
        }
        if let Some(tolerance) = &self.reduce_keys {
            clip = clip.with_fewer_keys(armature, tolerance)?;
        }
        Ok((clip, report))
    }
}

/// Clip through the poses at the frame times. Its first key is at 0 s.
fn sampled(
    name: &str,
    armature: &Armature,
    frames: Frames,
    mut pose_at: impl FnMut(f64, &mut Pose) -> Outcome<()>,
) -> Outcome<Clip> {
    let (mut times, mut poses) = (Vec::new(), Vec::new());
    let mut pose = armature.rest().clone();
    for (_, time) in frames.iter() {
        pose_at(time, &mut pose)?;
        times.push((time - frames.start()) as f32);
        poses.push(pose.clone());
    }
    Ok(Clip::through_poses(name, armature, &times, &poses)?)
}

fn print(
    out: &Path,
    clip: &Clip,
    armature: &Armature,
    (notes, report): (&[String], Option<&IkReport>),
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
        ik: report,
    };
    let text = || {
        format!(
            "clip `{}`: {:.3} s, {}, in {}\n{}",
            clip.name(),
            clip.duration(),
            counted(keys, "key"),
            out.display(),
            report.map_or_else(String::new, IkReport::text)
        )
    };
    if !json {
        for note in notes {
            output::message(note);
        }
    }
    output::result(json, document, text)
}
