//! All movements of a folder, in parallel; what is done stays done where the command is given again.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::movement_file::{Format, is_unfinished};
use super::source::movements;
use super::{Arguments, Clip, Job};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::progress::Countdown;

/// Beside the movements: what was asked, so that a folder has the answers to one question.
const QUESTION: &str = "retarget.json";

/// What was asked of a folder.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Asked {
    kinopt: String,
    arguments: Vec<String>,
}

/// What came of one movement.
#[derive(Serialize)]
struct Report {
    source: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    /// Whether it was done before.
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

/// Brings every movement of the source's folder onto the target, into files of the same names in `into`.
pub(super) fn run(arguments: &Arguments, into: &Path, json: bool) -> Outcome<()> {
    let format = arguments.format.unwrap_or(Format::Npz);
    let from = &arguments.source;
    let job = Job::new(arguments, format)?;
    let sources = movements(from)?;
    if sources.is_empty() {
        return Err(failure!(
            "{}: there is no .npy, .bvh, .glb or .gltf in it",
            from.display()
        ));
    }
    let pairs = pairs(from, &sources, into, format)?;
    output::make_folder(into)?;
    ask(arguments, into)?;
    for (_, out) in &pairs {
        let folder = out.parent().unwrap_or(into);
        output::make_folder(folder)?;
        sweep(folder)?;
    }
    let countdown = Countdown::new(pairs.len(), "movements");
    let reports: Vec<Report> = pairs
        .par_iter()
        .map(|(source, out)| {
            let report = one(&job, source, out, arguments.again);
            countdown.one_more();
            report
        })
        .collect();
    drop(countdown);
    tell(into, &reports, json)
}

fn one(job: &Job<'_>, source: &Path, out: &Path, again: bool) -> Report {
    let done_before = !again && is_newer(out, source);
    let solved = match done_before {
        true => Ok(None),
        false => job.run(source, out).map(Some),
    };
    let (clip, error) = match solved {
        Ok(clip) => (clip, None),
        Err(Failure::Reason(reason) | Failure::Usage(reason)) => (None, Some(reason)),
        Err(_) => (None, Some("not done".to_owned())),
    };
    Report {
        source: source.to_owned(),
        error,
        done_before,
        clip,
    }
}

fn tell(into: &Path, reports: &[Report], json: bool) -> Outcome<()> {
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
            .filter_map(|report| Some(report.clip.as_ref()?.told()));
        let lines: String = lines.collect();
        let (done, before) = (summary.done, summary.done_before);
        format!(
            "{lines}{}: {done} movements done, {before} done before, {} failed\n",
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

/// Where each movement goes.
fn pairs(
    from: &Path,
    sources: &[PathBuf],
    into: &Path,
    format: Format,
) -> Outcome<Vec<(PathBuf, PathBuf)>> {
    let mut taken: std::collections::BTreeMap<PathBuf, &Path> = std::collections::BTreeMap::new();
    let mut pairs = Vec::with_capacity(sources.len());
    for source in sources {
        let name = source.strip_prefix(from).unwrap_or(source);
        let out = into.join(name).with_extension(format.ending());
        if let Some(other) = taken.insert(out.clone(), source) {
            return Err(failure!(
                "{} and {} would both be written to {}",
                other.display(),
                source.display(),
                out.display()
            ));
        }
        pairs.push((source.clone(), out));
    }
    Ok(pairs)
}

/// Notes what is asked, or refuses a folder whose movements answer something else.
fn ask(arguments: &Arguments, into: &Path) -> Outcome<()> {
    let path = into.join(QUESTION);
    let told = |error: std::io::Error| failure!("{}: {error}", path.display());
    let asked = Asked {
        kinopt: env!("CARGO_PKG_VERSION").to_owned(),
        arguments: arguments.question(),
    };
    if !arguments.again && path.exists() {
        let text = std::fs::read_to_string(&path).map_err(told)?;
        let before: Option<Asked> = serde_json::from_str(&text).ok();
        if before.as_ref() != Some(&asked) {
            return Err(failure!(
                "{} answers another question, as {QUESTION} in it says: give another folder, or --again to do all of it anew",
                into.display()
            ));
        }
        return Ok(());
    }
    let text = serde_json::to_string_pretty(&asked)? + "\n";
    std::fs::write(&path, text).map_err(told)
}

/// Whether a movement was written after its source.
fn is_newer(out: &Path, source: &Path) -> bool {
    let time = |path: &Path| {
        std::fs::metadata(path)
            .and_then(|file| file.modified())
            .ok()
    };
    time(out)
        .zip(time(source))
        .is_some_and(|(out, source)| out >= source)
}

/// Removes what a command that was ended was writing.
fn sweep(folder: &Path) -> Outcome<()> {
    let told = |error: std::io::Error| failure!("{}: {error}", folder.display());
    for entry in std::fs::read_dir(folder).map_err(told)? {
        let path = entry.map_err(told)?.path();
        if is_unfinished(&path) {
            std::fs::remove_file(&path).map_err(told)?;
        }
    }
    Ok(())
}
