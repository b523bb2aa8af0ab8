//! `kinopt retarget`: motion capture on robots and skeletons.

mod contact_options;
mod folder;
mod keep_clear;
mod map_choice;
mod movement_file;
mod source;
mod target;

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::counted;
use kinopt::motion::retarget::folder::FolderQuestion;
use kinopt::motion::retarget::{
    FootShapes, KnownSkeleton, LostContact, RetargetOptions, Retargeting,
};
use serde::Serialize;

use self::contact_options::ContactOptions;
use self::keep_clear::{Clear, KeepClearOptions, tell_touching};
use self::map_choice::{MapChoice, MapOptions};
use self::movement_file::Format;
use self::source::{SourceOptions, Up};
use self::target::Target;
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::help_headings::OUTPUT;
use crate::model_options::ModelOptions;
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt retarget walk.bvh g1.urdf --base-joint free --out walk.npz
                                               frame by frame, as a live follower does; the map goes by names
  kinopt retarget climb.npy g1.urdf --map g1.json --base-joint free --fps 120 --whole --out climb.npz
                                               all frames as one: smooth; told is how still feet stand
  kinopt retarget walk.bvh g1.urdf --base-joint free --keep-clear 0.01 --out walk.npz
                                               no link nearer than 1 cm to another
  kinopt retarget climb.npy g1.urdf --map g1.json --base-joint free --world boxes.json --world-scale stride --out climb.npz
                                               clear of the boxes that the person climbed, and of itself
  kinopt retarget walk.bvh g1.urdf --print-map > map.json
                                               which joint would drive which frame, to be corrected
  kinopt retarget poses.npy g1.urdf --map smpl --base-joint free --out poses.csv
                                               an array (frames, 24, 3) in the order of SMPL's joints
  kinopt retarget walk.bvh character.glb --out walking.glb
                                               the character's file, with one clip more
  kinopt retarget captures g1.urdf --base-joint free --out movements --format csv
                                               a folder, in parallel; given overwrite it goes on where it was

The map, of which what is left out goes by names and by the file:
  {\"joints\": [\"Hips\", \"LeftFoot\", …], \"fps\": 120, \"up\": \"z\",
   \"drives\": {\"Hips\": \"pelvis\", \"LeftFoot\": {\"frame\": \"left_ankle\", \"weight\": 2, \"offset\": [0, 0, -0.05]}},
   \"contacts\": [\"LeftFoot\"]}";

/// Brings a captured movement onto a robot or a figure, within its limits of position and speed in every frame.
///
/// Limbs are scaled by their lengths, the ground is found, and feet are held where they stand. A figure is put on a free
/// base. A .npz or .json has the configurations `q` (frames × numbers of a configuration), `fps`, `names` (of those
/// numbers) and `contacts` (frames × what stands, named in `standing`). A .csv has a line a frame without a header: x, y, z, the quaternion x,
/// y, z, w of a free base, then the joints, as the retargeted LAFAN1 of Unitree is written. A .bvh or .glb is of a figure.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The movement: .bvh, a clip of a .glb or .gltf, .npy of (frames, joints, 3), the keyframes of a rig's .json; or a folder of all but
    /// those.
    #[arg(value_name = "SOURCE")]
    source: PathBuf,

    /// The robot's .urdf or MJCF .xml file, or a figure's: a rig's .json, .glb, .gltf or .bvh.
    #[arg(value_name = "TARGET")]
    target: PathBuf,

    #[command(flatten)]
    map: MapOptions,

    #[command(flatten)]
    source_options: SourceOptions,

    /// The axis that points upward in a figure's file. Default: y of .glb, .gltf and .bvh, z of a rig's .json.
    #[arg(long, value_enum, value_name = "AXIS")]
    target_up: Option<Up>,

    /// Solve the whole movement as one instead of frame by frame. Default: frame by frame.
    #[arg(long)]
    whole: bool,

    #[command(flatten)]
    contacts: ContactOptions,

    #[command(flatten)]
    keep_clear: KeepClearOptions,

    /// Where to write: .npz, .json, .csv, .bvh or .glb; of a folder, a folder.
    #[arg(long, value_name = "FILE|DIR", help_heading = OUTPUT, required_unless_present_any = ["print_map", "save_map"])]
    out: Option<PathBuf>,

    /// Of a folder: what is written. Default: npz.
    #[arg(long, value_enum, help_heading = OUTPUT, hide_default_value = true)]
    format: Option<Format>,

    /// Of a .csv: a first line of names, times before and what stands behind, the quaternion w, x, y, z. Default: the numbers alone.
    #[arg(long, help_heading = OUTPUT)]
    header: bool,

    /// Of a folder: do all of it anew. Default: what is done stays.
    #[arg(long, help_heading = OUTPUT)]
    overwrite: bool,

    #[command(flatten)]
    model_options: ModelOptions,
}

/// What came of a movement.
#[derive(Debug, Serialize)]
struct Clip {
    out: PathBuf,
    frames: usize,
    fps: f64,
    /// How many times as large as the person's the steps are.
    stride: f64,
    /// Metres, in the mean over all driven points and frames.
    mean_error: f64,
    /// Metres, at most.
    slip: f64,
    /// Of a foot in the ground, metres, at most.
    ground_penetration: f64,
    contact_frames: Vec<String>,
    /// What could be held no longer, and from which frame on.
    lost_contacts: Vec<LostContactReport>,
}

#[derive(Debug, Serialize)]
struct LostContactReport {
    frame: usize,
    contact_frame: String,
}

/// Feet that are deeper in the ground than this are told of, metres.
const SUNK: f64 = 1e-3;

impl Clip {
    /// In a line.
    fn summary(&self) -> String {
        let ground_penetration = match self.ground_penetration > SUNK {
            true => format!(
                "; feet are {:.1} mm in the ground at most",
                1e3 * self.ground_penetration
            ),
            false => String::new(),
        };
        format!(
            "{}: {}, {} a second; {:.1} mm off in the mean; what stands slips by {:.3} mm at most{ground_penetration}\n",
            self.out.display(),
            counted(self.frames, "frame"),
            // Frame times in files are rounded: 0.033333 s are 30 frames a second.
            (1e3 * self.fps).round() / 1e3,
            1e3 * self.mean_error,
            1e3 * self.slip
        )
    }
}

fn lost_contact(own: LostContact) -> LostContactReport {
    LostContactReport {
        frame: own.frame,
        contact_frame: own.contact_frame,
    }
}

/// What is done with every movement.
struct Job<'a> {
    arguments: &'a Arguments,
    target: Target,
    clear: Option<Clear>,
    /// Of the feet: meshes that are not found are left out.
    shapes: FootShapes,
    map: MapChoice,
    format: Format,
}

impl<'a> Job<'a> {
    fn new(arguments: &'a Arguments, format: Format) -> Outcome<Self> {
        let target = Target::read(
            &arguments.target,
            arguments.target_up,
            &arguments.model_options,
        )?;
        format.check(&target)?;
        let map = arguments.map.read(&arguments.target)?;
        Ok(Self {
            arguments,
            clear: arguments.keep_clear.clear(&target)?,
            shapes: FootShapes::of_files(&target.robot),
            target,
            map,
            format,
        })
    }

    fn options(&self) -> RetargetOptions {
        RetargetOptions::default()
            .with_shapes(self.shapes.clone())
            .with_contacts(self.arguments.contacts.detection())
    }

    /// What tells the answers of one question from another's.
    fn question(&self) -> FolderQuestion<'_> {
        let mut question = FolderQuestion::new(&self.target.robot, self.options());
        self.arguments.source_options.ask(&mut question);
        if let Some(clear) = &self.clear {
            clear.ask(&mut question);
            question
                .more
                .extend(self.arguments.keep_clear.unusual_shapes());
        }
        question.map = self.map.given();
        question.skeleton = self.map.skeleton().map(KnownSkeleton::name);
        question.whole = self.arguments.whole;
        if self.format == Format::Csv && self.arguments.header {
            question.more.push("header".to_owned());
        }
        question
    }

    fn run(&self, source: &Path, out: &Path) -> Outcome<Clip> {
        let file = source.display().to_string();
        let (given, skeleton) = (self.map.given(), self.map.skeleton());
        let read = self
            .arguments
            .source_options
            .read(source, given, skeleton)?;
        let robot = &self.target.robot;
        let guess = self.map.of(&file, &read, robot.model())?;
        self.map.say(&file, &guess, read.up);
        let mut map = guess.map;
        // The option has priority over the map.
        map.up = Some(read.up);
        let fitted = Retargeting::new(robot, &map, &read.capture, self.options());
        let mut fitted = fitted.map_err(|error| self.map.failed(&file, &error))?;
        self.target.tell_up(fitted.model_stands_along());
        let stride = fitted.stride();
        if let Some(clear) = &self.clear {
            fitted = fitted.keep_clear(&clear.at_stride(stride)?);
        }
        let found = match self.arguments.whole {
            true => fitted.whole(),
            false => fitted.per_frame(),
        };
        let found = found.map_err(|error| self.map.failed(&file, &error))?;
        tell_touching(&file, &found);
        let name = source.file_stem().unwrap_or_default().to_string_lossy();
        let header = self.arguments.header;
        self.format
            .write(&self.target, &found, &name, header, out)?;
        Ok(Clip {
            out: out.to_owned(),
            frames: found.frames(),
            fps: found.frame_rate,
            stride,
            mean_error: found.mean_error,
            slip: found.slip,
            ground_penetration: found.ground_penetration,
            contact_frames: found.contact_frames,
            lost_contacts: found.lost_contacts.into_iter().map(lost_contact).collect(),
        })
    }
}

impl Arguments {
    /// The map alone.
    fn show_map(&self) -> Outcome<()> {
        let target = Target::read(&self.target, self.target_up, &self.model_options)?;
        let choice = self.map.read(&self.target)?;
        let (given, skeleton) = (choice.given(), choice.skeleton());
        let read = self.source_options.read(&self.source, given, skeleton)?;
        let file = self.source.display().to_string();
        let guess = choice.of(&file, &read, target.robot.model())?;
        // With `--out`, the retargeting reports the guess itself.
        if self.out.is_none() {
            choice.say(&file, &guess, read.up);
        }
        let mut map = guess.map;
        if source::is_array(&self.source) {
            map.joints = read.capture.names().to_vec();
        }
        let text = map.to_json();
        if let Some(path) = &self.map.save_map {
            output::write_file(path, &text)?;
        }
        match self.map.print_map {
            true => output::result(false, || (), || text),
            false => Ok(()),
        }
    }
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let folder = arguments.source.is_dir();
    if arguments.map.asks_for_map() {
        if folder {
            return Err(usage!(
                "--print-map and --save-map are of one movement, not of a folder"
            ));
        }
        arguments.show_map()?;
    }
    let Some(out) = arguments.out.as_deref() else {
        return Ok(());
    };
    if folder {
        return folder::run(arguments, out, json);
    }
    if let Some(option) = first_given([
        ("--format", arguments.format.is_some()),
        ("--overwrite", arguments.overwrite),
    ]) {
        return Err(usage!(
            "{option} is for folders; {} is none",
            arguments.source.display()
        ));
    }
    let clip = Job::new(arguments, Format::of(out)?)?.run(&arguments.source, out)?;
    if arguments.map.print_map {
        // Standard output has the map only, so that it is valid JSON.
        output::message(clip.summary().trim_end());
        return Ok(());
    }
    output::result(json, || &clip, || clip.summary())
}
