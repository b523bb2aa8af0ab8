//! `--hand`: retargeting of a captured hand to a robot hand.

use std::path::Path;

use kinopt::counted;
use kinopt::motion::retarget::{HandMap, HandRetargeting};
use kinopt_bindings::trajectory_file::TrajectoryTable;
use serde::Serialize;

use super::target::Target;
use super::{Arguments, movement_file};
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::{file_access, output};

/// Result of a hand movement.
#[derive(Debug, Serialize)]
struct Grip<'a> {
    out: &'a Path,
    frames: usize,
    fps: f64,
    /// Mean distance of fingertips from the scaled ones of the subject, metres.
    tip_error: f64,
    /// Mean distance of a fingertip from the thumb's while the subject pinches, metres.
    pinch_distance: f64,
    /// Ratio of each finger's length to the subject's, from the thumb outward.
    scales: Vec<f64>,
}

/// Retargets one hand movement.
pub(super) fn run(arguments: &Arguments, out: &Path, json: bool) -> Outcome<()> {
    let unused = [
        ("--whole", arguments.whole),
        ("--surroundings", arguments.surroundings.is_given()),
        ("--overwrite", arguments.overwrite),
        ("--format", arguments.format.is_some()),
    ];
    if let Some(option) = first_given(unused) {
        return Err(usage!("{option} does not apply to --hand"));
    }
    let format = movement_file::format_of(out)?;
    let problem = arguments.model_options.problem()?;
    let target = Target::read(&arguments.target, arguments.target_up, &problem.model)?;
    movement_file::check(format, &target)?;
    let file = arguments.source.display();
    let read = arguments
        .source_options
        .read(&arguments.source, None, None)?;
    let map = match arguments.map.choice.file() {
        Some(path) => {
            let map = HandMap::from_json(&file_access::text(path)?);
            map.map_err(|error| failure!("{}: {error}", path.display()))?
        }
        None => {
            let side = arguments.hand.as_deref().filter(|side| !side.is_empty());
            let map = HandMap::guess(&read.capture, target.robot.model(), side);
            map.map_err(|error| failure!("{file}: {error}"))?
        }
    };
    let fitted = HandRetargeting::new(&target.robot, &map, &read.capture);
    let motion = fitted.and_then(|fitted| fitted.per_frame());
    let motion = motion.map_err(|error| failure!("{file}: {error}"))?;
    let table = TrajectoryTable {
        names: &target.names(),
        times: &motion.times,
        q: &motion.q,
        contacts: None,
        is_free: target.is_free(),
        layout: arguments.layout(),
    };
    table.write(format, arguments.header, out)?;
    let report = motion.report;
    let grip = Grip {
        out,
        frames: motion.times.len(),
        fps: report.frame_rate,
        tip_error: report.tip_error,
        pinch_distance: report.pinch_distance,
        scales: report.scales,
    };
    let summary = || {
        format!(
            "{}: {}; mean fingertip error {:.1} mm, mean distance of pinches {:.1} mm\n",
            out.display(),
            counted(grip.frames, "frame"),
            1e3 * grip.tip_error,
            1e3 * grip.pinch_distance
        )
    };
    output::result(json, || &grip, summary)
}
