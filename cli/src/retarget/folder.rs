//! Retargeting of a folder in parallel; a repeated command continues after an interruption.

use std::path::{Path, PathBuf};

use kinopt_bindings::retarget_folder::{FolderError, FolderMotion, MotionFolder};
use kinopt_bindings::trajectory_file::TrajectoryFormat;
use rayon::prelude::*;
use serde::Serialize;

use super::movement_file::{FormatChoice, extension_of};
use super::{Arguments, Clip, Job};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::progress::Countdown;

/// Result of one movement.
#[derive(Serialize)]
struct Report {
    source: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    /// `true` if the output file already existed.
    done_before: bool,
    #[serde(flatten)]
    clip: Option<Clip>,
}

#[derive(Serialize)]
struct Summary<'a> {
    out: &'a Path,
    done: usize,
    done_before: usize,
    failed: usize,
    clips: &'a [Report],
}

/// Retargets every movement of the source folder. The files in `into` have the names of their sources.
pub(super) fn run(arguments: &Arguments, into: &Path, json: bool) -> Outcome<()> {
    let format = arguments
        .format
        .map_or(TrajectoryFormat::Npz, FormatChoice::of_files);
    let job = Job::new(arguments, format)?;
    let folder = MotionFolder::find(&arguments.source, into, extension_of(format))?;
    let movements = folder.begin(&job.folder_query(), arguments.overwrite);
    let movements = movements.map_err(|error| match error {
        FolderError::OtherQuestion { .. } => {
            failure!("{error}: use another folder, or --overwrite to solve all movements again")
        }
        error => error.into(),
    })?;
    let countdown = Countdown::new(movements.len(), "movements");
    let reports: Vec<Report> = movements
        .into_par_iter()
        .map(|movement| {
            let report = retarget_one(&job, movement);
            countdown.one_more();
            report
        })
        .collect();
    drop(countdown);
    print(into, &reports, json)
}

fn retarget_one(job: &Job<'_>, movement: FolderMotion) -> Report {
    let solved = match movement.done_before {
        true => Ok(None),
        false => job.run(&movement.source, &movement.out).map(Some),
    };
    let (clip, error) = match solved {
        Ok(clip) => (clip, None),
        Err(Failure::Reason(reason) | Failure::Usage(reason)) => (None, Some(reason)),
        Err(_) => (None, Some("not solved".to_owned())),
    };
    Report {
        source: movement.source,
        error,
        done_before: movement.done_before,
        clip,
    }
}

fn print(into: &Path, reports: &[Report], json: bool) -> Outcome<()> {
    let failed: Vec<&str> = reports
        .iter()
        .filter_map(|report| report.error.as_deref())
        .collect();
    let done_before = reports.iter().filter(|report| report.done_before).count();
    let summary = Summary {
        out: into,
        done: reports.len() - failed.len() - done_before,
        done_before,
        failed: failed.len(),
        clips: reports,
    };
    let text = || {
        let lines = reports
            .iter()
            .filter_map(|report| Some(report.clip.as_ref()?.summary()));
        let lines: String = lines.collect();
        let (done, before) = (summary.done, summary.done_before);
        format!(
            "{lines}{}: {done} movements solved, {before} already done, {} failed\n",
            into.display(),
            failed.len()
        )
    };
    output::result(json, || &summary, text)?;
    match failed.as_slice() {
        [] => Ok(()),
        _ => {
            for reason in &failed {
                output::message(reason);
            }
            Err(failure!(
                "{} of {} movements failed",
                failed.len(),
                reports.len()
            ))
        }
    }
}
