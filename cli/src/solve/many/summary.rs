//! Summary of several queries, as text and JSON.

use serde::Serialize;

use super::super::query::Answer;
use super::super::report::{self, Report};
use crate::jump_document::JumpDocument;
use crate::loaded_model::LoadedModel;
use crate::number_format::{magnitude, time};
use crate::solve::task_name::TaskName;

/// Largest number of unreached targets and jumps that the text explains.
const MAX_EXPLAINED: usize = 3;

/// Solutions in the order of the targets.
pub(super) struct Outcomes<'b> {
    pub(super) answers: Vec<Answer>,
    pub(super) tasks: &'b [TaskName],
    /// True if obstacles are avoided.
    pub(super) keeps_clear: bool,
    /// Steps of a path in which a joint exceeds the jump bound.
    pub(super) jumps: Option<Vec<JumpDocument>>,
    /// Time of all targets that were solved together, in microseconds.
    pub(super) batch_micros: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct Document<'a> {
    /// Joint names of every q, for a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<Vec<&'a str>>,
    solutions: Vec<report::Document<'a>>,
    summary: Summary<'a>,
}

/// Counts, and times of one target in microseconds.
#[derive(Clone, Copy, Debug, Serialize)]
struct Summary<'a> {
    solved: usize,
    total: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    micros_median: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    micros_p99: Option<f64>,
    micros_mean: f64,
    /// In a sequence: steps in which a joint moves more than 0.2 rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    jumps: Option<&'a [JumpDocument]>,
}

impl Outcomes<'_> {
    pub(super) fn document<'a>(&'a self, loaded: &'a LoadedModel) -> Document<'a> {
        let solutions = self.answers.iter().map(|answer| {
            let report = Report {
                loaded,
                answer,
                tasks: self.tasks,
                idle: &[],
                keeps_clear: self.keeps_clear,
            };
            report.document()
        });
        Document {
            joints: loaded.documented_joints(),
            solutions: solutions.collect(),
            summary: self.summary(),
        }
    }

    fn summary(&self) -> Summary<'_> {
        let total = self.answers.len();
        let mut micros: Vec<f64> = self.answers.iter().filter_map(|a| a.micros).collect();
        micros.sort_by(f64::total_cmp);
        let total_micros = self.batch_micros.unwrap_or_else(|| micros.iter().sum());
        Summary {
            solved: self.answers.iter().filter(|a| a.solution.reached).count(),
            total,
            micros_median: median(&micros),
            micros_p99: percentile(&micros, 99),
            micros_mean: total_micros / total.max(1) as f64,
            jumps: self.jumps.as_deref(),
        }
    }

    /// Counts, times, largest errors of reached targets, and the first targets that are not reached.
    pub(super) fn text(&self, loaded: &LoadedModel) -> String {
        let summary = self.summary();
        let [median, mean] = [summary.micros_median, Some(summary.micros_mean)]
            .map(|micros| micros.map_or_else(String::new, time));
        let time = match summary.micros_p99 {
            Some(p99) => format!("median {median}, 99 % within {}, mean {mean}", time(p99)),
            None => format!("mean {mean} (solved together)"),
        };
        let mut text = format!(
            "solved    {} of {}\ntime      {time}\n",
            summary.solved, summary.total
        );
        if let Some(worst) = self.worst_errors(loaded) {
            text.push_str(&format!("errors    at most {worst} where solved\n"));
        }
        text.push_str(&self.jumps_text());
        let misses = self.answers.iter().enumerate();
        let misses = misses.filter(|(_, answer)| !answer.solution.reached);
        let count = summary.total - summary.solved;
        if count > 0 {
            let shown = count.min(MAX_EXPLAINED);
            let which = match count {
                1 => "The target that is not reached".to_owned(),
                _ if shown == count => format!("The {count} targets that are not reached"),
                _ => format!("The first {shown} of {count} targets that are not reached"),
            };
            text.push_str(&format!("\n{which} (numbered from 0):\n"));
            for (index, answer) in misses.take(shown) {
                let explanation = answer.solution.explain().replace('\n', "\n    ");
                text.push_str(&format!("  target {index}: {explanation}\n"));
            }
        }
        text
    }

    /// Line about the continuity of a path, with the first jumps.
    fn jumps_text(&self) -> String {
        let Some(jumps) = &self.jumps else {
            return String::new();
        };
        let mut text = match jumps.len() {
            0 => "jumps     none: no joint moves more than 0.2 rad in a step\n".to_owned(),
            count => {
                let steps = if count == 1 { "step" } else { "steps" };
                format!("jumps     {count} {steps} in which a joint moves more than 0.2 rad\n")
            }
        };
        for jump in jumps.iter().take(MAX_EXPLAINED) {
            text.push_str(&format!("          {}\n", jump.text()));
        }
        if jumps.len() > MAX_EXPLAINED {
            text.push_str("          … (all with --json)\n");
        }
        text
    }

    /// Largest errors of the reached solutions.
    fn worst_errors(&self, loaded: &LoadedModel) -> Option<String> {
        let reached = || self.answers.iter().filter(|a| a.solution.reached);
        let tasks = || reached().flat_map(|answer| answer.solution.tasks());
        let position = tasks().filter_map(|task| task.position_error());
        let orientation = tasks().filter_map(|task| task.orientation_error());
        let [position, orientation] =
            [position.reduce(f64::max), orientation.reduce(f64::max)].map(|e| e.map(magnitude));
        let position = position.map(|error| format!("{error} {}", loaded.length_unit()));
        let orientation = orientation.map(|error| format!("{error} rad"));
        let errors: Vec<String> = position.into_iter().chain(orientation).collect();
        (!errors.is_empty()).then(|| errors.join(" and "))
    }
}

/// Median of sorted numbers; the mean of the two in the middle if their count is even.
pub(super) fn median(sorted: &[f64]) -> Option<f64> {
    let upper = sorted.get(sorted.len() / 2)?;
    if sorted.len() % 2 == 1 {
        return Some(*upper);
    }
    let lower = sorted.get(sorted.len() / 2 - 1)?;
    Some(0.5 * (lower + upper))
}

/// Smallest of sorted numbers that at least `percent` of them do not exceed.
pub(super) fn percentile(sorted: &[f64], percent: usize) -> Option<f64> {
    let rank = (sorted.len() * percent).div_ceil(100);
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentile_and_median_by_rank() {
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile(&hundred, 99), Some(99.0));
        assert_eq!(percentile(&[4.0], 99), Some(4.0));
        assert_eq!(percentile(&[], 99), None);
        assert_eq!(median(&hundred), Some(50.5));
        assert_eq!(median(&[1.0, 5.0, 9.0]), Some(5.0));
        assert_eq!(median(&[]), None);
    }
}
