//! `kinopt retarget`: people's movements on robots.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::io::bvh;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetOptions, Retargeted, Retargeting, UpAxis,
};
use serde::Serialize;

use crate::animated_armature::extension;
use crate::failure::Outcome;
use crate::help_headings::OUTPUT;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::number_list;
use crate::numpy_file::{self, Column};
use crate::output;

/// What is taken where neither the source nor anybody says it.
const FRAME_RATE: f64 = 120.0;

const EXAMPLES: &str = "\
Examples:
  kinopt retarget walk.bvh g1.urdf --map g1.json --base-joint free --out walk.npz
                                               frame by frame, as a live follower does
  kinopt retarget climb.npy g1.urdf --map g1.json --base-joint free --fps 120 --whole --out climb.npz
                                               all frames as one: smooth, and feet stand to a micrometre

The map, with all but drives left out where it may be:
  {\"joints\": [\"Hips\", \"LeftFoot\", …], \"fps\": 120, \"up\": \"z\",
   \"drives\": {\"Hips\": \"pelvis\", \"LeftFoot\": {\"frame\": \"left_ankle\", \"weight\": 2, \"offset\": [0, 0, -0.05]}},
   \"contacts\": [\"LeftFoot\"]}";

/// Brings a captured movement onto a robot, within its limits of position and speed in every frame.
///
/// Limbs are scaled by their lengths, the ground is found, and feet are held where they stand. The source is a .bvh, or a
/// .npy of (frames, joints, 3) whose joints the map names. What is written has the configurations `q` (frames × numbers
/// of a configuration), `fps`, `names` (of those numbers) and `contacts` (frames × what stands, named in `standing`).
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The movement: .bvh, or .npy of (frames, joints, 3).
    #[arg(value_name = "SOURCE")]
    source: PathBuf,

    /// The robot's .urdf or MJCF .xml file.
    #[arg(value_name = "TARGET")]
    target: PathBuf,

    /// Which joint of the source drives which frame of the robot: a .json file, as below. It may hold several robots'
    /// drives, under the names of their files.
    #[arg(long, value_name = "FILE")]
    map: PathBuf,

    /// Frames a second: of a .bvh those that are taken, of a .npy those that it has. Default: as the file or the map
    /// says, else 120.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// Solve the whole movement as one instead of frame by frame. Default: frame by frame.
    #[arg(long)]
    whole: bool,

    /// Where to write: .npz, .json or .csv.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    out: PathBuf,

    #[command(flatten)]
    model_options: ModelOptions,
}

/// What is printed.
#[derive(Serialize)]
struct Summary<'a> {
    out: &'a Path,
    frames: usize,
    fps: f64,
    /// Metres, in the mean over all driven points and frames.
    mean_error: f64,
    /// Metres, at most.
    slip: f64,
    standing: &'a [String],
}

/// What a .json file holds.
#[derive(Serialize)]
struct Document<'a> {
    fps: f64,
    names: &'a [String],
    standing: &'a [String],
    q: Vec<&'a [f64]>,
    contacts: Vec<&'a [bool]>,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let out = &arguments.out;
    let format = extension(out);
    if !["npz", "json", "csv"].contains(&format.as_str()) {
        return Err(usage!(
            "--out {}: .npz, .json or .csv is written",
            out.display()
        ));
    }
    let loaded = LoadedModel::read(&arguments.target, &arguments.model_options)?;
    let Some(robot) = &loaded.robot else {
        return Err(usage!("{}: retarget is for robots", loaded.file));
    };
    let map_file = arguments.map.display();
    let text = std::fs::read_to_string(&arguments.map);
    let text = text.map_err(|error| failure!("{map_file}: {error}"))?;
    let name = arguments.target.file_name().unwrap_or_default();
    let map = BodyMap::from_json(&text, &name.to_string_lossy());
    let map = map.map_err(|error| failure!("{map_file}: {error}"))?;
    let (capture, up) = read_source(arguments, &map)?;
    let options = RetargetOptions {
        up,
        ..RetargetOptions::default()
    };
    let retargeting = Retargeting::new(robot, &map, &capture, options)?;
    let found = match arguments.whole {
        true => retargeting.whole()?,
        false => retargeting.per_frame()?,
    };
    let names = loaded.coordinate_names();
    let bytes = match format.as_str() {
        "npz" => as_npz(&found, &names)?,
        "csv" => as_csv(&found, &names).into_bytes(),
        _ => serde_json::to_vec(&document(&found, &names))?,
    };
    std::fs::write(out, bytes).map_err(|error| failure!("{}: {error}", out.display()))?;
    let summary = Summary {
        out,
        frames: found.frames(),
        fps: found.frame_rate,
        mean_error: found.mean_error,
        slip: found.slip,
        standing: &found.standing,
    };
    output::result(
        json,
        || &summary,
        || {
            format!(
                "{}: {} frames, {} a second; {:.1} mm off in the mean; what stands slips by {:.3} mm at most\n",
                out.display(),
                summary.frames,
                summary.fps,
                1e3 * summary.mean_error,
                1e3 * summary.slip
            )
        },
    )
}

/// The capture, and which way is up in files of its kind.
fn read_source(arguments: &Arguments, map: &BodyMap) -> Outcome<(Capture, UpAxis)> {
    let source = &arguments.source;
    let file = source.display();
    let told = |error: kinopt::motion::retarget::RetargetError| failure!("{file}: {error}");
    match extension(source).as_str() {
        "bvh" => {
            let capture = bvh::read(source)?;
            let rate = arguments.fps.unwrap_or(1.0 / capture.frame_time);
            let own = Capture::of_clip(&capture.armature, &capture.clip, rate).map_err(told)?;
            Ok((own, UpAxis::Y))
        }
        "npy" => {
            let array = numpy_file::read(source)?;
            let joints = map.joints.len();
            let fits = matches!(array.shape[..], [_, own, 3] if own == joints);
            if !fits {
                let shape = array
                    .shape
                    .iter()
                    .map(ToString::to_string)
                    .collect::<Vec<_>>();
                return Err(failure!(
                    "{file}: of the shape ({}), where the map names {joints} joints: (frames, {joints}, 3)",
                    shape.join(", ")
                ));
            }
            let said = arguments.fps.or(map.frame_rate);
            if said.is_none() {
                output::message(&format!(
                    "note: nobody says the frames a second: {FRAME_RATE} are taken"
                ));
            }
            let rate = said.unwrap_or(FRAME_RATE);
            let own = Capture::new(map.joints.clone(), &array.numbers, rate).map_err(told)?;
            Ok((own, UpAxis::Z))
        }
        _ => Err(usage!("{file}: a .bvh or a .npy is read")),
    }
}

fn as_npz(found: &Retargeted, names: &[String]) -> Outcome<Vec<u8>> {
    let (frames, width) = (found.frames(), names.len());
    let standing = found.standing.len();
    numpy_file::npz(&[
        ("q", &[frames, width], Column::Numbers(&found.q)),
        ("fps", &[], Column::Numbers(&[found.frame_rate])),
        ("names", &[width], Column::Words(names)),
        (
            "contacts",
            &[frames, standing],
            Column::Flags(&found.contacts),
        ),
        ("standing", &[standing], Column::Words(&found.standing)),
    ])
}

fn document<'a>(found: &'a Retargeted, names: &'a [String]) -> Document<'a> {
    Document {
        fps: found.frame_rate,
        names,
        standing: &found.standing,
        q: found.q.chunks_exact(names.len().max(1)).collect(),
        contacts: contacts(found).collect(),
    }
}

/// What stands, frame by frame.
fn contacts(found: &Retargeted) -> impl Iterator<Item = &[bool]> {
    let width = found.standing.len();
    (0..found.frames()).map(move |frame| {
        found
            .contacts
            .get(frame * width..(frame + 1) * width)
            .unwrap_or_default()
    })
}

/// A line a frame: its time, the configuration, and 1 for what stands.
fn as_csv(found: &Retargeted, names: &[String]) -> String {
    let standing = found.standing.iter().map(|frame| format!("{frame} stands"));
    let columns = std::iter::once("time".to_owned())
        .chain(names.iter().cloned())
        .chain(standing);
    let mut text = columns.collect::<Vec<_>>().join(",") + "\n";
    let rows = found
        .q
        .chunks_exact(names.len().max(1))
        .zip(contacts(found));
    for (frame, (q, stands)) in rows.enumerate() {
        let _ = write!(text, "{}", frame as f64 / found.frame_rate);
        for number in q {
            let _ = write!(text, ",{number}");
        }
        for stands in stands {
            let _ = write!(text, ",{}", u8::from(*stands));
        }
        text.push('\n');
    }
    text
}
