//! Report of `kinopt reach`, as text and JSON.

use serde::Serialize;

use super::criterion::RankedBy;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_format::{magnitude, six_digits, time};
use crate::table::Table;

/// Largest number of ranked pairs that the text lists.
const MAX_RANKED: usize = 10;
/// Largest number of unreached pairs that the text explains.
const MAX_EXPLAINED: usize = 3;

/// Result of a pair of tool and target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) enum Status {
    /// A configuration reaches the target, free of collisions if obstacles are avoided.
    #[serde(rename = "reached")]
    Reached,
    /// Reached in collision only.
    #[serde(rename = "in collision")]
    InCollision,
    /// Proven: no configuration within the joint limits reaches the target.
    #[serde(rename = "unreachable")]
    Unreachable,
    /// Neither a configuration nor a proof.
    #[serde(rename = "undecided")]
    Undecided,
}

impl Status {
    const ALL: [Self; 4] = [
        Self::Reached,
        Self::InCollision,
        Self::Unreachable,
        Self::Undecided,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::InCollision => "in collision",
            Self::Unreachable => "unreachable",
            Self::Undecided => "undecided",
        }
    }
}

/// Decision of a pair of tool and target.
#[derive(Clone, Debug)]
pub(super) struct Decision {
    pub(super) tool: usize,
    pub(super) target: usize,
    pub(super) status: Status,
    /// Configuration of the arm: the best of a reached target, else the closest pose found.
    pub(super) q: Vec<f64>,
    /// Cost by the criterion, for a reached target.
    pub(super) cost: Option<f64>,
    /// Number of boxes of joint values that were examined.
    pub(super) boxes: usize,
    /// Position error in metres.
    pub(super) position_error: f64,
    /// Orientation error in radians.
    pub(super) orientation_error: f64,
    /// Reason in words, for a target that is not reached.
    pub(super) explanation: Option<String>,
}

/// Decisions of all pairs, with the model.
pub(super) struct Report<'a> {
    pub(super) loaded: &'a LoadedModel,
    /// Names of the arm's joints.
    pub(super) joints: Vec<&'a str>,
    pub(super) ranked_by: RankedBy,
    /// Reached pairs of tool and target, best first.
    pub(super) ranking: Vec<(usize, usize)>,
    /// Configuration of the model with the arm at a configuration.
    pub(super) configuration: &'a dyn Fn(&[f64]) -> Outcome<Vec<f64>>,
    /// In the order of tools, then targets.
    pub(super) decisions: Vec<Decision>,
    /// Number of targets.
    pub(super) targets: usize,
    /// True if angles in text are degrees.
    pub(super) degrees: bool,
    /// Time of all decisions in microseconds.
    pub(super) micros: f64,
}

#[derive(Serialize)]
pub(super) struct Document<'a> {
    /// Joint names of every q.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<Vec<&'a str>>,
    criterion: &'static str,
    solutions: Vec<SolutionDocument<'a>>,
    /// Pairs of tool and target that are reached, best first.
    ranking: &'a [(usize, usize)],
    summary: Summary,
}

#[derive(Serialize)]
struct SolutionDocument<'a> {
    tool: usize,
    target: usize,
    status: Status,
    /// Configuration of the model; the closest pose found if the target is not reached.
    q: Vec<f64>,
    /// Value of the criterion, for a reached target.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    /// Boxes of joint values of the proof.
    boxes: usize,
    position_error: f64,
    orientation_error: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<&'a str>,
}

/// Counts of pairs by status, and the time in microseconds.
#[derive(Serialize)]
struct Summary {
    reached: usize,
    in_collision: usize,
    unreachable: usize,
    undecided: usize,
    total: usize,
    micros: f64,
}

impl Report<'_> {
    fn count(&self, status: Status) -> usize {
        let decisions = self.decisions.iter();
        decisions
            .filter(|decision| decision.status == status)
            .count()
    }

    /// Number of targets that no tool reaches.
    pub(super) fn missed_targets(&self) -> usize {
        let mut is_reached = vec![false; self.targets];
        for decision in &self.decisions {
            if let Some(reached) = is_reached.get_mut(decision.target) {
                *reached |= decision.status == Status::Reached;
            }
        }
        is_reached.iter().filter(|reached| !**reached).count()
    }

    /// Value of the criterion for a decision, if its target is reached.
    pub(super) fn value(&self, decision: &Decision) -> Option<f64> {
        decision.cost.map(|cost| self.ranked_by.value(cost))
    }

    fn decision(&self, (tool, target): (usize, usize)) -> Option<&Decision> {
        self.decisions.get(tool * self.targets + target)
    }

    pub(super) fn document(&self) -> Outcome<Document<'_>> {
        let solutions = self.decisions.iter().map(|decision| {
            Ok(SolutionDocument {
                tool: decision.tool,
                target: decision.target,
                status: decision.status,
                q: (self.configuration)(&decision.q)?,
                value: self.value(decision),
                boxes: decision.boxes,
                position_error: decision.position_error,
                orientation_error: decision.orientation_error,
                explanation: decision.explanation.as_deref(),
            })
        });
        Ok(Document {
            joints: self.loaded.documented_joints(),
            criterion: self.ranked_by.name(),
            solutions: solutions.collect::<Outcome<_>>()?,
            ranking: &self.ranking,
            summary: Summary {
                reached: self.count(Status::Reached),
                in_collision: self.count(Status::InCollision),
                unreachable: self.count(Status::Unreachable),
                undecided: self.count(Status::Undecided),
                total: self.decisions.len(),
                micros: self.micros,
            },
        })
    }

    /// Counts, the ranking, the best configuration, and the first targets that are not reached.
    pub(super) fn text(&self) -> String {
        let total = self.decisions.len();
        let mut text = match self.decisions.as_slice() {
            [only] => format!("{}\n", only.status.name()),
            _ => self.counts(total),
        };
        text.push_str(&format!("time      {}\n", time(self.micros)));
        text.push_str(&self.ranking_table());
        text.push_str(&self.best_table());
        text + &self.explanations()
    }

    fn counts(&self, total: usize) -> String {
        let counts = Status::ALL.map(|status| (status, self.count(status)));
        let shown = counts
            .into_iter()
            .filter(|(status, count)| *count > 0 || matches!(status, Status::Reached));
        let lines =
            shown.map(|(status, count)| format!("{:<14}{count} of {total}\n", status.name()));
        lines.collect()
    }

    /// The first pairs of the ranking; empty for one pair.
    fn ranking_table(&self) -> String {
        if self.decisions.len() < 2 || self.ranking.is_empty() {
            return String::new();
        }
        let mut table = Table::new(&format!(">tool | >target | >{}", self.ranked_by.column()));
        for &(tool, target) in self.ranking.iter().take(MAX_RANKED) {
            let decision = self.decision((tool, target));
            let value = decision.and_then(|decision| self.value(decision));
            let value = value.map_or_else(String::new, magnitude);
            table.row([tool.to_string(), target.to_string(), value]);
        }
        let rest = match self.ranking.len() > MAX_RANKED {
            true => "  … (all with --json)\n",
            false => "",
        };
        format!("\nBest first:\n{}{rest}", table.text())
    }

    /// Joint values of the best pair.
    fn best_table(&self) -> String {
        let best = self.ranking.first().and_then(|&pair| self.decision(pair));
        let Some(best) = best else {
            return String::new();
        };
        let unit = if self.degrees { "degrees" } else { "radians" };
        let or_metres = if self.loaded.slides() {
            " or metres"
        } else {
            ""
        };
        let mut table = Table::new(&format!("joint | >{unit}{or_metres}"));
        let Ok(q) = (self.configuration)(&best.q) else {
            return String::new();
        };
        let shown = self.loaded.shown(&q, self.degrees);
        for (name, value) in self.loaded.coordinate_names().into_iter().zip(shown) {
            if self.joints.iter().any(|joint| **joint == *name) {
                table.row([name.to_string(), six_digits(value)]);
            }
        }
        format!("\n{}", table.text())
    }

    fn explanations(&self) -> String {
        let missed = || self.decisions.iter().filter(|d| d.explanation.is_some());
        let count = missed().count();
        if count == 0 {
            return String::new();
        }
        let mut text = match (self.decisions.len(), count) {
            (1, _) => "\n".to_owned(),
            (_, count) if count > MAX_EXPLAINED => {
                format!("\nThe first {MAX_EXPLAINED} of {count} that are not reached:\n")
            }
            _ => "\nNot reached:\n".to_owned(),
        };
        for decision in missed().take(MAX_EXPLAINED) {
            let explanation = decision.explanation.as_deref().unwrap_or_default();
            if self.decisions.len() == 1 {
                text.push_str(&format!("{explanation}\n"));
                continue;
            }
            let (tool, target) = (decision.tool, decision.target);
            let status = decision.status.name();
            let indented = explanation.replace('\n', "\n    ");
            text.push_str(&format!(
                "  tool {tool}, target {target}: {status}. {indented}\n"
            ));
        }
        text
    }
}
