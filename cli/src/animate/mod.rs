//! `kinopt animate`: from keyframes and clips to posed meshes.

mod frames;

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use kinopt::animation::Playback;
use kinopt::io::gltf::ScenePosing;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::SkinningMethod;
use serde::Serialize;

use self::frames::Frames;
use crate::animated_armature::AnimatedArmature;
use crate::failure::{Failure, Outcome};
use crate::interpolation_choice::{InterpolationChoice, playback};
use crate::loaded_model::LoadedModel;
use crate::mesh_output::{self, MeshFile, MeshFormat};
use crate::model_options::ModelOptions;
use crate::progress::Countdown;
use crate::weights_choice::WeightsChoice;
use crate::{number_list, output, skinning_choice};

const EXAMPLES: &str = "\
Examples:
  kinopt animate arm.json --time 1.5 --out posed.obj    the mesh after 1.5 s
  kinopt animate arm.json --fps 24 --out frames         a file for each frame of all keyframes
  kinopt animate fox.glb --clip Run --time 0.2 --out posed.glb
                                                        a scene's clip after 0.2 s
  kinopt animate arm.json --fps 60 --from 1 --to 2 --format ply --skinning dqs --out frames
                                                        one second of them";

/// Pose a rig's mesh by its keyframes, or a scene's meshes by one of its clips, at one time or frame
/// by frame.
///
/// A scene's meshes are written as one, where they stand in the scene. A rig's keys are interpolated over their own times, by Catmull-Rom splines unless the file or
/// --interpolation says otherwise; lengths are in the rig's own unit. One time makes one file; frames are numbered from 0 in a folder, which is made where there
/// is none: frame-0000.obj, frame-0001.obj, …
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
#[command(group = ArgGroup::new("moments").args(["time", "fps"]).required(true))]
pub(crate) struct Arguments {
    /// The rig's .json file, with keyframes and a mesh, or a scene's .glb or .gltf file.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Where to write: with --time a .obj, .ply or .glb file, with --fps a folder.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,

    /// Which of a scene's clips: its name, or the end of it (`Walk` for `Armature|Walk`). Default: the first.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,

    /// Pose the mesh at this time, in seconds. Default: none.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true,
          value_parser = number_list::number)]
    time: Option<f64>,

    /// Pose it this many times a second. Default: none.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// With --fps: the time of the first frame, in seconds. Default: the first key's.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    from: Option<f64>,

    /// With --fps: no frame after this time, in seconds. Default: the last key's.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    to: Option<f64>,

    /// Repeat the keyframes outside their span instead of holding the ends. Default: off.
    #[arg(long = "loop")]
    looped: bool,

    /// What runs between keys, whatever the file says: `linear`, `catmull-rom` or
    /// `kochanek-bartels:T,C,B`. Default: as the file says, else catmull-rom.
    ///
    /// T, C and B are tension, continuity and bias at every key, usually within −1 and 1.
    #[arg(long, value_name = "NAME", value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// With --fps: what to write. Default: obj.
    #[arg(long, value_enum, conflicts_with = "time", hide_default_value = true)]
    format: Option<MeshFormat>,

    /// How a rig's skin weights are made up. Default: those of the file, else by heat.
    #[arg(long, value_enum, hide_default_value = true)]
    skin_weights: Option<WeightsChoice>,

    /// How the bones move the skin.
    #[arg(long, value_name = "METHOD", default_value_t, value_parser = skinning_choice::parser())]
    skinning: SkinningMethod,
}

#[derive(Serialize)]
struct Document<'a> {
    frames: Vec<FrameDocument<'a>>,
    vertices: usize,
    skinning: &'static str,
    /// What was done without or made up.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: &'a [String],
}

#[derive(Serialize)]
struct FrameDocument<'a> {
    time: f64,
    file: std::borrow::Cow<'a, str>,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    match AnimatedArmature::is_at(&arguments.model) {
        true => run_scene(arguments, json),
        false => run_rig(arguments, json),
    }
}

fn run_rig(arguments: &Arguments, json: bool) -> Outcome<()> {
    let mut loaded = LoadedModel::read(&arguments.model, &ModelOptions::default())?;
    loaded.refuse_clip(arguments.clip.as_deref())?;
    loaded.interpolate_keyframes(arguments.interpolation)?;
    let clip = loaded.keyframes("animate")?;
    let skin = loaded.skin(arguments.skin_weights)?;
    let mut notes = loaded.notes();
    notes.extend(skin.note());
    let span = clip.time_span().unwrap_or([0.0; 2]);
    let mut q = vec![0.0; loaded.model.configuration_len()];
    write_frames(arguments, json, &notes, span, |time, playback| {
        clip.sample(time, playback, &mut q)?;
        skin.posed(&q, arguments.skinning)
    })
}

fn run_scene(arguments: &Arguments, json: bool) -> Outcome<()> {
    let animated = AnimatedArmature::read(&arguments.model)?;
    let (file, kind) = (&animated.file, animated.kind);
    if arguments.interpolation.is_some() {
        let problem = format!(
            "{file}: --interpolation is for rigs; a {kind} says itself what is between keys"
        );
        return Err(Failure::usage(problem));
    }
    let scene = animated.scene.as_deref();
    let scene = mesh_output::with_meshes(scene, (file, kind), arguments.skin_weights)?;
    let clip = animated.clip(arguments.clip.as_deref())?;
    let mut posing = ScenePosing::new(scene, arguments.skinning)?;
    let span = clip.span().map(f64::from);
    write_frames(arguments, json, &[], span, |time, playback| {
        let pose = animated.pose_at(clip, time, playback)?;
        Ok(posing.mesh(&pose)?)
    })
}

/// Writes the meshes at the times that are asked for and says what was written.
fn write_frames(
    arguments: &Arguments,
    json: bool,
    notes: &[String],
    span: [f64; 2],
    mut posed: impl FnMut(f64, Playback) -> Outcome<TriangleMesh>,
) -> Outcome<()> {
    let files = files(arguments, span)?;
    let playback = playback(arguments.looped);
    let countdown = Countdown::new(files.len(), "frames");
    let mut vertices = 0;
    for (time, file) in &files {
        let mesh = posed(*time, playback)?;
        file.write(&mesh)?;
        vertices = mesh.positions().len();
        countdown.one_more();
    }
    drop(countdown);
    let frames = files.iter().map(|(time, file)| FrameDocument {
        time: *time,
        file: file.path().to_string_lossy(),
    });
    let document = || Document {
        frames: frames.collect(),
        vertices,
        skinning: arguments.skinning.name(),
        notes,
    };
    output::result(json, document, || text(&files, vertices))
}

/// The times in seconds and where their meshes go. Makes the folder of frames.
fn files(arguments: &Arguments, span: [f64; 2]) -> Outcome<Vec<(f64, MeshFile)>> {
    let out = &arguments.out;
    let Some(fps) = arguments.fps else {
        let file = MeshFile::parse(&out.to_string_lossy())
            .map_err(|problem| usage!("--out {}: with --time, {problem}", out.display()))?;
        return Ok(vec![(arguments.time.unwrap_or(span[0]), file)]);
    };
    if MeshFormat::of(out).is_some() && !out.is_dir() {
        return Err(usage!(
            "--out {}: with --fps it is a folder; choose obj, ply or glb by --format",
            out.display()
        ));
    }
    let [start, end] = span;
    let frames = Frames::new(
        fps,
        arguments.from.unwrap_or(start),
        arguments.to.unwrap_or(end),
    )?;
    let format = arguments.format.unwrap_or(MeshFormat::Obj);
    output::make_folder(out)?;
    let named = frames.iter().map(|(stem, time)| {
        let file = MeshFile::within(out, &stem, format);
        (time, file)
    });
    Ok(named.collect())
}

fn text(files: &[(f64, MeshFile)], vertices: usize) -> String {
    let shown = |file: &MeshFile| file.path().display().to_string();
    match files {
        [(time, file)] => format!("{time} s: {vertices} vertices in {}\n", shown(file)),
        [(start, first), .., (end, last)] => format!(
            "{} frames from {start} s to {end} s: {vertices} vertices each in {} to {}\n",
            files.len(),
            shown(first),
            shown(last)
        ),
        [] => String::new(),
    }
}
