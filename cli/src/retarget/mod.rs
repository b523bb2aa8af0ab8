//! `kinopt retarget`: retargeting of motion capture to robots and skeletons.

mod collision_avoidance;
pub(crate) mod contact_options;
mod folder;
mod hand;
pub(crate) mod map_choice;
mod movement_file;
pub(crate) mod source;
mod surroundings;
mod target;

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::counted;
use kinopt::motion::retarget::{
    FootShapes, KnownSkeleton, LostContact, RetargetOptions, Retargeting,
};
use kinopt::motion::score::MotionScore;
use kinopt_bindings::retarget_folder::FolderSettings;
use kinopt_bindings::trajectory_file::{TableLayout, TrajectoryFormat};
use serde::Serialize;

use self::collision_avoidance::{AvoidanceOptions, CollisionAvoidance, report_contacts};
use self::contact_options::ContactOptions;
use self::map_choice::{MapChoice, MapOptions};
use self::movement_file::FormatChoice;
use self::source::{SourceOptions, Up};
use self::surroundings::{Surroundings, SurroundingsOptions};
use self::target::Target;
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::help_headings::OUTPUT;
use crate::model_options::ModelOptions;
use crate::{collision_options, output};

const EXAMPLES: &str = "\
Examples:
  kinopt retarget walk.bvh g1.urdf --base-joint free --margin 0.01 --out walk.npz
  kinopt retarget climb.npy g1.urdf --map g1.json --base-joint free --whole --out climb.npz
  kinopt retarget walk.bvh g1.urdf --print-map > map.json
  kinopt retarget captures g1.urdf --base-joint free --out movements --format csv

Limbs are scaled by their lengths, feet in contact are locked, and a figure gets a free base. A
folder is solved in parallel and continues after an interruption. Body maps, output formats and
collisions: docs/guide/retargeting.md. Collision shapes are keys of the --problem file:
  {\"collisions\": {\"meshes\": \"parts\", \"package\": [\"/opt/ros/share\"]}}";

/// Retarget a captured movement to a robot or a figure, within its limits in every frame.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Movement .bvh, .glb, .gltf, .vrm, .npz, .c3d, .npy (frames, joints, 3), rig .json; or a folder.
    #[arg(value_name = "SOURCE")]
    source: PathBuf,

    /// Robot .urdf or .xml, or figure .json, .glb, .gltf, .vrm or .bvh.
    #[arg(value_name = "TARGET")]
    target: PathBuf,

    #[command(flatten)]
    map: MapOptions,

    #[command(flatten)]
    source_options: SourceOptions,

    /// Up axis of a figure, y or z. Default: detected, else y; of a rig z.
    #[arg(long, value_enum, value_name = "AXIS", hide_possible_values = true)]
    target_up: Option<Up>,

    /// Solve the movement as one smooth problem. Default: frame by frame.
    #[arg(long)]
    whole: bool,

    #[command(flatten)]
    contacts: ContactOptions,

    /// Robot hand: fingertips follow. SIDE selects a hand of a body.
    #[arg(long, value_name = "SIDE", num_args = 0..=1, default_missing_value = "", require_equals = true)]
    hand: Option<String>,

    #[command(flatten)]
    surroundings: SurroundingsOptions,

    #[command(flatten)]
    avoidance: AvoidanceOptions,

    /// A .npz, .json, .csv, .bvh or .glb file; for a folder a folder.
    #[arg(long, value_name = "FILE|DIR", help_heading = OUTPUT, required_unless_present_any = ["print_map", "save_map"])]
    out: Option<PathBuf>,

    /// Folders: npz, json, csv, bvh or glb. Also files: qpos of MuJoCo. Default: npz.
    #[arg(long, value_parser = FormatChoice::parse, help_heading = OUTPUT)]
    format: Option<FormatChoice>,

    /// .csv: header row, times, quaternion w, x, y, z, and contacts.
    #[arg(long, help_heading = OUTPUT)]
    header: bool,

    /// Folders: solve all movements again. Default: keep output files.
    #[arg(long, help_heading = OUTPUT)]
    overwrite: bool,

    #[command(flatten)]
    model_options: ModelOptions,
}

/// Result of one movement.
#[derive(Debug, Serialize)]
struct Clip {
    out: PathBuf,
    frames: usize,
    fps: f64,
    /// Ratio of the target's step length to the subject's.
    stride: f64,
    /// Figures next to the person.
    score: MotionScore,
    /// Largest foot sliding, metres.
    slip: f64,
    /// Largest ground penetration of a foot, metres.
    ground_penetration: f64,
    contact_frames: Vec<String>,
    /// Lost contacts, with their first frame.
    lost_contacts: Vec<LostContactReport>,
}

#[derive(Debug, Serialize)]
struct LostContactReport {
    frame: usize,
    contact_frame: String,
}

/// Ground penetration of feet above which it is reported, metres.
const MIN_REPORTED_PENETRATION: f64 = 1e-3;

impl Clip {
    /// One-line summary.
    fn summary(&self) -> String {
        let ground_penetration = match self.ground_penetration > MIN_REPORTED_PENETRATION {
            true => format!(
                "; ground penetration at most {:.1} mm",
                1e3 * self.ground_penetration
            ),
            false => String::new(),
        };
        let direction_error = match mean_angle(&self.score) {
            Some(degrees) => format!("mean direction error {degrees:.1}°; "),
            None => String::new(),
        };
        format!(
            "{}: {}, {} per second; {direction_error}foot sliding at most {:.3} mm{ground_penetration}\n",
            self.out.display(),
            counted(self.frames, "frame"),
            // Frame times in files are rounded: 0.033333 s are 30 frames a second.
            (1e3 * self.fps).round() / 1e3,
            1e3 * self.slip
        )
    }
}

/// Mean direction error over all limbs, degrees; `None` without limbs.
fn mean_angle(score: &MotionScore) -> Option<f64> {
    let count = score.limbs.len();
    let sum: f64 = score.limbs.iter().map(|limb| limb.angle.mean).sum();
    (count > 0).then(|| sum / count as f64)
}

fn lost_contact(lost: LostContact) -> LostContactReport {
    LostContactReport {
        frame: lost.frame,
        contact_frame: lost.contact_frame,
    }
}

/// Arguments shared by all movements.
struct Job<'a> {
    arguments: &'a Arguments,
    target: Target,
    avoidance: Option<CollisionAvoidance>,
    /// Shapes of the feet. Meshes whose files are missing are left out.
    shapes: FootShapes,
    surroundings: Surroundings,
    map: MapChoice,
    format: TrajectoryFormat,
    /// Collision shapes in words, if they are not the default.
    unusual_shapes: Option<String>,
}

impl<'a> Job<'a> {
    fn new(arguments: &'a Arguments, format: TrajectoryFormat) -> Outcome<Self> {
        let problem = arguments.model_options.problem()?;
        let target = Target::read(&arguments.target, arguments.target_up, &problem.model)?;
        movement_file::check(format, &target)?;
        let map = arguments.map.choice.read(&arguments.target)?;
        Ok(Self {
            arguments,
            avoidance: arguments.avoidance.of(&target, &problem.collisions)?,
            shapes: FootShapes::of_files(&target.robot),
            surroundings: arguments.surroundings.read()?,
            target,
            map,
            format,
            unusual_shapes: collision_options::unusual_shapes(&problem.collisions),
        })
    }

    fn options(&self) -> RetargetOptions {
        RetargetOptions::default()
            .with_shapes(self.shapes.clone())
            .with_terrain(self.surroundings.terrain.clone())
            .with_contacts(self.arguments.contacts.detection())
    }

    /// Folder query: everything that determines the results.
    fn folder_query(&self) -> FolderSettings<'_> {
        let mut query = FolderSettings::new(&self.target.robot, self.options());
        self.arguments.source_options.add_to_query(&mut query);
        if let Some(avoidance) = &self.avoidance {
            avoidance.add_to_query(&mut query);
            query.more.extend(self.unusual_shapes.clone());
        }
        query.map = self.map.given();
        query.skeleton = self.map.skeleton().map(KnownSkeleton::name);
        query.whole = self.arguments.whole;
        if self.arguments.is_qpos() {
            query.more.push("qpos".to_owned());
        }
        query.more.extend(
            self.surroundings
                .object
                .as_ref()
                .map(|object| format!("{object:?}")),
        );
        if self.format == TrajectoryFormat::Csv && self.arguments.header {
            query.more.push("header".to_owned());
        }
        query
    }

    fn run(&self, source: &Path, out: &Path) -> Outcome<Clip> {
        let file = source.display().to_string();
        let (given, skeleton) = (self.map.given(), self.map.skeleton());
        let read = self
            .arguments
            .source_options
            .read(source, given, skeleton)?;
        let robot = &self.target.robot;
        let guess = self.map.of(
            &file,
            &read,
            self.target.robot.model(),
            self.target.human_bones(),
        )?;
        self.map.report(&file, &guess, read.up);
        let mut map = guess.map;
        // The option has priority over the map.
        map.up = Some(read.up);
        let fitted = match &self.target.figure {
            Some(figure) => {
                Retargeting::onto_character(figure, &map, &read.capture, self.options())
            }
            None => Retargeting::new(robot, &map, &read.capture, self.options()),
        };
        let mut fitted = fitted.map_err(|error| self.map.failed(&file, &error))?;
        self.target.report_up_axis(fitted.model_stands_along());
        let stride = fitted.stride();
        if let Some(object) = &self.surroundings.object {
            let held = fitted.with_object(object, &read.capture);
            fitted = held.map_err(|error| self.map.failed(&file, &error))?;
        }
        if let Some(avoidance) = &self.avoidance {
            fitted = fitted.keep_clear(&avoidance.at_stride(stride)?);
        }
        let retargeted = match self.arguments.whole {
            true => fitted.whole(),
            false => fitted.per_frame(),
        };
        let retargeted = retargeted.map_err(|error| self.map.failed(&file, &error))?;
        report_contacts(&file, &retargeted);
        let name = source.file_stem().unwrap_or_default().to_string_lossy();
        let layout = self.arguments.layout();
        let options = (self.arguments.header, layout);
        movement_file::write(self.format, &self.target, &retargeted, &name, options, out)?;
        Ok(Clip {
            out: out.to_owned(),
            frames: retargeted.rows().len(),
            fps: retargeted.report.frame_rate,
            stride,
            score: retargeted.report.score,
            slip: retargeted.report.slip,
            ground_penetration: retargeted.report.ground_penetration,
            contact_frames: retargeted.report.contact_frames,
            lost_contacts: retargeted
                .report
                .lost_contacts
                .into_iter()
                .map(lost_contact)
                .collect(),
        })
    }
}

impl Arguments {
    /// True if configurations are written as MuJoCo's `qpos`.
    fn is_qpos(&self) -> bool {
        self.format == Some(FormatChoice::Qpos)
    }

    /// Layout of configurations in files.
    fn layout(&self) -> TableLayout {
        match self.is_qpos() {
            true => TableLayout::Mujoco,
            false => TableLayout::Lafan1,
        }
    }

    /// Prints or saves the map.
    fn show_map(&self) -> Outcome<()> {
        let settings = self.model_options.problem()?.model;
        let target = Target::read(&self.target, self.target_up, &settings)?;
        let choice = self.map.choice.read(&self.target)?;
        let (given, skeleton) = (choice.given(), choice.skeleton());
        let read = self.source_options.read(&self.source, given, skeleton)?;
        let file = self.source.display().to_string();
        let guess = choice.of(&file, &read, target.robot.model(), target.human_bones())?;
        // With `--out`, the retargeting reports the guess itself.
        if self.out.is_none() {
            choice.report(&file, &guess, read.up);
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
    if arguments.map.outputs_map() {
        if folder {
            return Err(usage!(
                "--print-map and --save-map apply to one movement, not to a folder"
            ));
        }
        arguments.show_map()?;
    }
    let Some(out) = arguments.out.as_deref() else {
        return Ok(());
    };
    if arguments.hand.is_some() {
        return hand::run(arguments, out, json);
    }
    if folder {
        return folder::run(arguments, out, json);
    }
    if let Some(option) = first_given([
        (
            "--format",
            arguments
                .format
                .is_some_and(|format| format != FormatChoice::Qpos),
        ),
        ("--overwrite", arguments.overwrite),
    ]) {
        return Err(usage!(
            "{option} applies to folders; {} is a file",
            arguments.source.display()
        ));
    }
    let format = movement_file::format_of(out)?;
    if arguments.is_qpos() && !matches!(format, TrajectoryFormat::Csv | TrajectoryFormat::Npz) {
        return Err(usage!(
            "{}: --format qpos applies to .csv and .npz",
            out.display()
        ));
    }
    let clip = Job::new(arguments, format)?.run(&arguments.source, out)?;
    if arguments.map.print_map {
        // Standard output has the map only, so that it is valid JSON.
        output::message(clip.summary().trim_end());
        return Ok(());
    }
    output::result(json, || &clip, || clip.summary())
}
