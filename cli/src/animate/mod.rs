//! `kinopt animate`: posed meshes and animated files from keyframes and clips.

mod clip_file;
mod frames;
mod ik_options;
mod ik_report;

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use kinopt::animation::{Clip, Playback};
use kinopt::counted;
use kinopt::io::gltf::{SceneFile, ScenePosing};
use kinopt::skinning::SkinningMethod;
use serde::Serialize;

use self::clip_file::{ClipOptions, is_gltf};
use self::frames::Frames;
use crate::animated_armature::{AnimatedArmature, extension};
use crate::failure::{Failure, Outcome};
use crate::interpolation_choice::{InterpolationChoice, playback};
use crate::loaded_model::LoadedModel;
use crate::mesh_output::{self, MeshFile, MeshFormat};
use crate::model_options::ModelOptions;
use crate::progress::Countdown;
use crate::weights_choice::WeightsChoice;
use crate::{number_list, output, scene_output, skinning_choice};

const EXAMPLES: &str = "\
Examples:
  kinopt animate arm.json --time 1.5 --out posed.obj    the mesh at 1.5 s
  kinopt animate arm.json --fps 24 --out frames         one file for each frame of the keyframes
  kinopt animate fox.glb --clip Run --time 0.2 --out posed.glb
                                                        a scene's clip at 0.2 s
  kinopt animate arm.json --fps 24 --format glb --out arm.glb
                                                        one animated file: bones, skin and clip
  kinopt animate fox.glb --clip Run --fps 30 --in-place b_Hip_01 --clip-name Run_on_the_spot --into fox.glb
                                                        adds a clip to the file and keeps its other content
  kinopt animate fox.glb --clip Walk --loop --to 4 --fps 30 --root-velocity feet --plant b_LeftFoot02_018 --plant b_RightFoot02_022 --ground
        stairs.json --into fox.glb                      the repeated walk climbs stairs, with foot locks
  kinopt animate hero.glb --clip Idle --fps 30 --reach hand.r=0.4,1.2,0.3 --span 1,2.5 --fade 0.3 --into hero.glb
                                                        a hand reaches for a point from 1 s to 2.5 s
  kinopt animate humanoid.json --fps 60 --reach right_hand=curve.csv --span 1.2,3 --out changed.json
                                                        changes only the rig's keys of the arm
  kinopt animate arm.json --fps 60 --from 1 --to 2 --format ply --skinning dqs --out frames
                                                        one second of frames";

/// Pose a rig's mesh by its keyframes, or a scene's meshes by a clip, at one time or frame by frame.
///
/// The meshes of a scene are written as one mesh, in scene coordinates. A .glb or .gltf file keeps all other content
/// of the scene: materials, images, cameras and unknown extensions. With --fps it is one animated file.
///
/// A rig's keys are interpolated by Catmull-Rom splines, unless the file or --interpolation selects another method.
/// Lengths are in the rig's unit.
///
/// --time writes one file. --fps writes numbered frames into a folder: frame-0000.obj, frame-0001.obj, … The folder
/// is created if it does not exist.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
#[command(group = ArgGroup::new("moments").args(["time", "fps"]).required(true))]
pub(crate) struct Arguments {
    /// Rig (.json) with keyframes and a mesh, or scene (.glb, .gltf).
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Output. With --time a .obj, .ply or .glb file; with --fps a folder, or a .glb file of all frames.
    ///
    /// With --fps and --reach a .json file receives the rig with its solved keys.
    #[arg(long, value_name = "FILE|DIR", required_unless_present = "into")]
    out: Option<PathBuf>,

    /// Clip of a scene: its name, or the end of its name (`Walk` for `Armature|Walk`). Default: the first clip.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,

    /// Time of the pose, in seconds. Default: none.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true,
          value_parser = number_list::number)]
    time: Option<f64>,

    /// Frames per second. Range: > 0. Default: none.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// With --fps: time of the first frame, in seconds. Default: the first key.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    from: Option<f64>,

    /// With --fps: time limit of the last frame, in seconds. Default: the last key.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    to: Option<f64>,

    /// Repeat the keyframes outside their span instead of holding the end poses. Default: off.
    #[arg(long = "loop")]
    looped: bool,

    /// Interpolation between a rig's keys: `linear`, `catmull-rom` or `kochanek-bartels:T,C,B`. Default: from the
    /// file, else catmull-rom.
    ///
    /// T, C and B are tension, continuity and bias at every key, usually within −1 and 1.
    #[arg(long, value_name = "NAME", value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// With --fps: file format of the frames. Default: obj.
    #[arg(long, value_enum, conflicts_with = "time", hide_default_value = true)]
    format: Option<MeshFormat>,

    /// Method that computes a rig's skin weights. Default: the weights of the file, else bone heat.
    #[arg(long, value_enum, hide_default_value = true)]
    skin_weights: Option<WeightsChoice>,

    /// Skinning method.
    #[arg(long, value_name = "METHOD", default_value_t, value_parser = skinning_choice::parser())]
    skinning: SkinningMethod,

    #[command(flatten)]
    clip_options: ClipOptions,
}

#[derive(Serialize)]
struct Document<'a> {
    frames: Vec<FrameDocument<'a>>,
    vertices: usize,
    skinning: &'static str,
    /// Remarks about parts of the model that were left out or computed.
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
    if let (Some(fps), Some(out)) = (
        arguments.fps,
        arguments.out.as_deref().filter(|out| is_rig(out)),
    ) {
        return arguments.clip_options.write_keys(&loaded, fps, out, json);
    }
    let clip = loaded.keyframes("animate")?;
    let skin = loaded.skin(arguments.skin_weights)?;
    let span = clip.time_span().unwrap_or([0.0; 2]);
    if let Some((frames, out)) = arguments.one_file(span)? {
        let playing = (frames, playback(arguments.looped));
        return arguments
            .clip_options
            .write_rig(&loaded, &skin, playing, out, json);
    }
    let mut notes = loaded.notes();
    notes.extend(skin.note());
    let mut q = vec![0.0; loaded.model.configuration_len()];
    write_frames(arguments, json, &notes, span, |time, playback, file| {
        clip.sample(time, playback, &mut q)?;
        let mesh = skin.posed(&q, arguments.skinning)?;
        file.write(&mesh)?;
        Ok(mesh.positions().len())
    })
}

fn run_scene(arguments: &Arguments, json: bool) -> Outcome<()> {
    let animated = AnimatedArmature::read(&arguments.model)?;
    let (file, kind) = (&animated.file, animated.kind);
    if arguments.interpolation.is_some() {
        let problem = format!(
            "{file}: --interpolation applies to rigs; the keys of a {kind} have their own interpolation"
        );
        return Err(Failure::usage(problem));
    }
    let scene_file = animated.scene.as_deref();
    let scene = scene_file.map(SceneFile::scene);
    let clip = animated.clip(arguments.clip.as_deref());
    let span = |clip: &Clip| clip.span().map(f64::from);
    let one_file = match &clip {
        Ok(clip) => arguments.one_file(span(clip))?,
        Err(_) => None,
    };
    if let (Some((frames, out)), Some(scene_file)) = (one_file, scene_file) {
        let whole = arguments.from.is_none() && arguments.to.is_none();
        let playback_range = (frames, playback(arguments.looped), whole);
        let options = &arguments.clip_options;
        return options.write_scene(&animated, scene_file, clip?, playback_range, out, json);
    }
    let scene = mesh_output::with_meshes(scene, (file, kind), arguments.skin_weights)?;
    let clip = clip?;
    let mut posing = ScenePosing::new(scene, arguments.skinning)?;
    write_frames(arguments, json, &[], span(clip), |time, playback, file| {
        let pose = animated.pose_at(clip, time, playback)?;
        match scene_file.filter(|_| is_gltf(file.path())) {
            Some(scene_file) => {
                scene_output::write_posed(scene_file, &pose, arguments.skinning, file.path())?
            }
            None => file.write(&posing.mesh(&pose)?)?,
        }
        Ok(scene
            .meshes
            .iter()
            .map(|node| node.mesh.positions().len())
            .sum())
    })
}

/// Returns `true` if the file extension is `.json`.
fn is_rig(path: &Path) -> bool {
    extension(path) == "json"
}

impl Arguments {
    /// Frames and path of a single animated output file. `None` if the output is one mesh or a folder.
    fn one_file(&self, span: [f64; 2]) -> Outcome<Option<(Frames, &Path)>> {
        let options = &self.clip_options;
        let Some(fps) = self.fps else {
            return Ok(None);
        };
        let out = options.into.as_deref().or(self.out.as_deref());
        let Some(out) = out.filter(|out| is_gltf(out) || self.format == Some(MeshFormat::Glb))
        else {
            return match options.given() {
                Some(option) => Err(usage!(
                    "{option} applies to clips written as .glb or .gltf: --out FILE.glb"
                )),
                None => Ok(None),
            };
        };
        if !is_gltf(out) {
            return Err(usage!(
                "--out {}: --format glb writes all frames to one file; its name must end in .glb",
                out.display()
            ));
        }
        Ok(Some((self.frames(fps, span)?, out)))
    }

    fn frames(&self, fps: f64, [start, end]: [f64; 2]) -> Outcome<Frames> {
        Frames::new(fps, self.from.unwrap_or(start), self.to.unwrap_or(end))
    }
}

/// Writes the meshes at the requested times and reports the files.
fn write_frames(
    arguments: &Arguments,
    json: bool,
    notes: &[String],
    span: [f64; 2],
    mut write: impl FnMut(f64, Playback, &MeshFile) -> Outcome<usize>,
) -> Outcome<()> {
    let files = files(arguments, span)?;
    let playback = playback(arguments.looped);
    let countdown = Countdown::new(files.len(), "frames");
    let mut vertices = 0;
    for (time, file) in &files {
        vertices = write(*time, playback, file)?;
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

/// Times in seconds with their mesh files. Creates the folder of the frames.
fn files(arguments: &Arguments, span: [f64; 2]) -> Outcome<Vec<(f64, MeshFile)>> {
    let Some(out) = &arguments.out else {
        return Err(usage!(
            "--into applies to clips of scenes; write meshes with --out"
        ));
    };
    let Some(fps) = arguments.fps else {
        let file = MeshFile::parse(&out.to_string_lossy())
            .map_err(|problem| usage!("--out {}: with --time, {problem}", out.display()))?;
        return Ok(vec![(arguments.time.unwrap_or(span[0]), file)]);
    };
    if MeshFormat::of(out).is_some() && !out.is_dir() {
        return Err(usage!(
            "--out {}: with --fps it must be a folder, or a .glb file of all frames; select obj or ply by --format",
            out.display()
        ));
    }
    let frames = arguments.frames(fps, span)?;
    let format = arguments.format.unwrap_or(MeshFormat::Obj);
    output::make_folder(out)?;
    let files = frames.iter().map(|(stem, time)| {
        let file = MeshFile::within(out, &stem, format);
        (time, file)
    });
    Ok(files.collect())
}

fn text(files: &[(f64, MeshFile)], vertices: usize) -> String {
    let vertices = counted(vertices, "vertex");
    let path_text = |file: &MeshFile| file.path().display().to_string();
    match files {
        [(time, file)] => format!("{time} s: {vertices} in {}\n", path_text(file)),
        [(start, first), .., (end, last)] => format!(
            "{} frames from {start} s to {end} s: {vertices} each in {} to {}\n",
            files.len(),
            path_text(first),
            path_text(last)
        ),
        [] => String::new(),
    }
}
