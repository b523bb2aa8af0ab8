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
use kinopt_bindings::problem_file::{ModelSettings, number_list};
use serde::Serialize;

use self::clip_file::ClipOptions;
use self::frames::Frames;
use crate::animated_armature::{AnimatedArmature, extension, is_scene};
use crate::failure::{Failure, Outcome};
use crate::interpolation_choice::{InterpolationChoice, playback};
use crate::loaded_model::LoadedModel;
use crate::mesh_output::{self, MeshFile, MeshFormat};
use crate::model_options::ProblemFile;
use crate::progress::Countdown;
use crate::{output, scene_output};

const EXAMPLES: &str = "\
Examples:
  kinopt animate arm.json --time 1.5 --out posed.obj
  kinopt animate arm.json --fps 24 --format glb --out arm.glb
  kinopt animate fox.glb --clip Run --fps 30 --in-place hip --clip-name spot --into fox.glb
  kinopt animate hero.glb --fps 30 --reach hand=0.4,1.2,0.3 --span 1,2.5 --into hero.glb

--time writes one file. --fps writes numbered frames into a folder, or one animated .glb. Lengths
are in the unit of the file. Curves of --reach: .csv or .npy. Guide: docs/guide/clip-ik.md.
Skinning: {\"output\": {\"skinning\": \"dqs\", \"skin_weights\": \"heat\"}} in the --problem file.";

/// Meshes of a rig's keyframes or a scene's clip, with optional inverse kinematics.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
#[command(group = ArgGroup::new("moments").args(["time", "fps"]).required(true))]
pub(crate) struct Arguments {
    /// Rig (.json) with keyframes and a mesh, or scene (.glb, .gltf, .vrm).
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// A .obj, .ply or .glb file; with --fps a folder, .glb, or rig .json.
    #[arg(long, value_name = "FILE|DIR", required_unless_present = "into")]
    out: Option<PathBuf>,

    /// Clip of a scene, by name or end of the name. Default: the first.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,

    /// Time of the pose, in seconds.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true,
          value_parser = number_list::number)]
    time: Option<f64>,

    /// Frames per second.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// With --fps: time of the first frame. Default: the first key.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    from: Option<f64>,

    /// With --fps: time limit of the last frame. Default: the last key.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, conflicts_with = "time",
          value_parser = number_list::number)]
    to: Option<f64>,

    /// Repeat the keyframes instead of holding the end poses.
    #[arg(long = "loop")]
    looped: bool,

    /// linear, catmull-rom or kochanek-bartels:T,C,B. Default: the file's.
    #[arg(long, value_name = "NAME", value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// With --fps: obj, ply or glb. Default: obj.
    #[arg(long, value_enum, conflicts_with = "time", hide_possible_values = true)]
    format: Option<MeshFormat>,

    #[command(flatten)]
    clip_options: ClipOptions,

    #[command(flatten)]
    file: ProblemFile,
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
    let output = arguments.file.read()?.output;
    let skinning = output.skinning.unwrap_or_default();
    let mut loaded = LoadedModel::read(&arguments.model, &ModelSettings::default())?;
    loaded.refuse_clip(arguments.clip.as_deref())?;
    loaded.interpolate_keyframes(arguments.interpolation)?;
    if let (Some(fps), Some(out)) = (
        arguments.fps,
        arguments.out.as_deref().filter(|out| is_rig(out)),
    ) {
        return arguments.clip_options.write_keys(&loaded, fps, out, json);
    }
    let clip = loaded.keyframes("animate")?;
    let skin = loaded.skin(output.skin_weights)?;
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
    write_frames(
        arguments,
        json,
        (&notes, skinning),
        span,
        |time, playback, file| {
            clip.sample(time, playback, &mut q)?;
            let mesh = skin.posed(&q, skinning)?;
            file.write(&mesh)?;
            Ok(mesh.positions().len())
        },
    )
}

fn run_scene(arguments: &Arguments, json: bool) -> Outcome<()> {
    let output = arguments.file.read()?.output;
    let skinning = output.skinning.unwrap_or_default();
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
    let scene = mesh_output::with_meshes(scene, (file, kind), output.skin_weights)?;
    let clip = clip?;
    let mut posing = ScenePosing::new(scene, skinning)?;
    write_frames(
        arguments,
        json,
        (&[], skinning),
        span(clip),
        |time, playback, file| {
            let pose = animated.pose_at(clip, time, playback)?;
            match scene_file.filter(|_| is_scene(file.path())) {
                Some(scene_file) => {
                    scene_output::write_posed(scene_file, &pose, skinning, file.path())?
                }
                None => file.write(&posing.mesh(&pose)?)?,
            }
            Ok(scene
                .meshes
                .iter()
                .map(|node| node.mesh.positions().len())
                .sum())
        },
    )
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
        let Some(out) = out.filter(|out| is_scene(out) || self.format == Some(MeshFormat::Glb))
        else {
            return match options.given() {
                Some(option) => Err(usage!(
                    "{option} applies to clips written as .glb, .gltf or .vrm: --out FILE.glb"
                )),
                None => Ok(None),
            };
        };
        if !is_scene(out) {
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
    (notes, skinning): (&[String], SkinningMethod),
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
        skinning: skinning.name(),
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
