//! Report of a path.

use kinopt::Arm;
use kinopt::arm::JointPath;
use kinopt::counted;
use kinopt::motion::path::{CartesianPath, CsvColumns, Deviation, MissReason, Missed, PathReport};
use serde::Serialize;

use crate::collision_document::{CollisionDocument, depth};
use crate::jump_document::JumpDocument;
use crate::loaded_model::LoadedModel;
use crate::table;

/// Largest number of entries in a list of the text.
const MAX_LISTED_ROWS: usize = 10;

/// Solution of a path.
pub(super) struct Report<'a> {
    pub(super) loaded: &'a LoadedModel,
    pub(super) arm: &'a Arm,
    pub(super) path: &'a CartesianPath,
    pub(super) solution: &'a JointPath<PathReport>,
    /// Time of each row in seconds, if known.
    pub(super) times: Option<Vec<f64>>,
    pub(super) milliseconds: f64,
    pub(super) columns_read: &'a CsvColumns,
}

#[derive(Serialize)]
pub(super) struct Document<'a> {
    joints: Vec<&'a str>,
    q: Vec<Vec<f64>>,
    points: usize,
    read_as: String,
    entry: usize,
    jumps: Vec<JumpDocument>,
    length: f64,
    largest_deviation: f64,
    largest_deviation_at: usize,
    largest_turn: f64,
    largest_turn_at: usize,
    reached: bool,
    missed: Vec<Miss>,
    blocked: Vec<Block<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    times: Option<&'a [f64]>,
    milliseconds: f64,
}

#[derive(Serialize)]
struct Miss {
    index: usize,
    position_error: f64,
    orientation_error: f64,
    reason: String,
}

#[derive(Serialize)]
struct Block<'a> {
    index: usize,
    #[serde(flatten)]
    by: CollisionDocument<'a>,
}

impl<'a> Report<'a> {
    /// Configuration of the model for every row; joints outside the arm are at rest.
    pub(super) fn rows(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let rest = self.loaded.rest();
        self.solution.rows().map(move |row| {
            let mut q = rest.clone();
            // Both lengths are those of the arm.
            let _ = self.arm.configuration(row, &mut q);
            q
        })
    }

    pub(super) fn document(&'a self) -> Document<'a> {
        let solution = self.solution;
        let report = &solution.report;
        let deviation = report.largest_deviation;
        let joints: Vec<&str> = self.arm.joints().collect();
        let jumps = solution.jumps.iter();
        let jumps = jumps.map(|jump| JumpDocument::of(jump, &joints));
        let misses = report.missed.iter().map(|miss| Miss {
            index: miss.index,
            position_error: miss.position_error,
            orientation_error: miss.orientation_error,
            reason: reason(miss),
        });
        let blocked = report.blocked.iter().map(|blocked| Block {
            index: blocked.index,
            by: CollisionDocument::of(&blocked.by),
        });
        Document {
            joints: self.loaded.joint_names(),
            q: self.rows().collect(),
            points: self.path.points().len(),
            read_as: self.columns_read.to_string(),
            entry: report.entry,
            jumps: jumps.collect(),
            length: report.length,
            largest_deviation: deviation.metres,
            largest_deviation_at: deviation.metres_at,
            largest_turn: deviation.radians,
            largest_turn_at: deviation.radians_at,
            reached: solution.reached(),
            missed: misses.collect(),
            blocked: blocked.collect(),
            times: self.times.as_deref(),
            milliseconds: self.milliseconds,
        }
    }

    pub(super) fn text(&self) -> String {
        let solution = self.solution;
        let report = &solution.report;
        let points = counted(self.path.points().len(), "point");
        let reached = solution.rows().len() - report.missed.len();
        let mut entries = vec![
            (
                "path",
                format!(
                    "{reached} of {} reached, {points} given",
                    counted(solution.rows().len(), "row")
                ),
            ),
            ("branches", self.branches()),
            ("length", format!("{:.4} of joint motion", report.length)),
            ("deviation", deviation_text(&report.largest_deviation)),
        ];
        if report.entry > 0 {
            entries.push(("entry", format!("starts at point {}", report.entry)));
        }
        if let Some(last) = self.times.as_ref().and_then(|times| times.last()) {
            entries.push((
                "duration",
                format!("{last:.3} s from the first row to the last"),
            ));
        }
        entries.push(("time", format!("{:.1} ms", self.milliseconds)));
        let mut text = table::lines(entries);
        let joints: Vec<&str> = self.arm.joints().collect();
        let steps = solution.jumps.iter().map(|step| {
            let joint = joints.get(step.joint).copied().unwrap_or_default();
            format!(
                "  to row {}: {joint} moves by {:.3} rad",
                step.index, step.distance
            )
        });
        add(&mut text, "reconfigurations", steps.collect());
        let misses = report.missed.iter().map(|miss| {
            let (metres, radians) = (miss.position_error, miss.orientation_error);
            let (row, why) = (miss.index, reason(miss));
            match miss.reason {
                // The pose itself is reached.
                MissReason::Touches(_) => format!("  row {row}: {why}"),
                _ => format!("  row {row}: by {metres:.3e} m and {radians:.3e} rad, {why}"),
            }
        });
        add(&mut text, "not reached", misses.collect());
        let blocked = report.blocked.iter();
        let blocked = blocked.map(|step| format!("  to row {}: {}", step.index, step.by));
        add(&mut text, "possible collisions", blocked.collect());
        text
    }

    fn branches(&self) -> String {
        match self.solution.jumps.len() {
            0 => "one branch, no reconfiguration".to_owned(),
            1 => "1 reconfiguration".to_owned(),
            count => format!("{count} reconfigurations"),
        }
    }
}

fn add(text: &mut String, name: &str, lines: Vec<String>) {
    if lines.is_empty() {
        return;
    }
    text.push_str(name);
    text.push('\n');
    for line in lines.iter().take(MAX_LISTED_ROWS) {
        text.push_str(line);
        text.push('\n');
    }
    if lines.len() > MAX_LISTED_ROWS {
        text.push_str(&format!("  and {} more\n", lines.len() - MAX_LISTED_ROWS));
    }
}

fn reason(missed: &Missed) -> String {
    match &missed.reason {
        MissReason::BeyondReach { distance, reach } => format!(
            "beyond reach: {distance:.4} m from the base of the chain, which is {reach:.4} m long"
        ),
        MissReason::Touches(pair) => format!("{pair} are in contact, {}", depth(pair)),
        _ => "no configuration within the limits was found".to_owned(),
    }
}

fn deviation_text(deviation: &Deviation) -> String {
    let metres = (deviation.metres, "m", deviation.metres_at);
    let radians = (deviation.radians, "rad", deviation.radians_at);
    // Without a deviation there is no row.
    let deviations = [metres, radians]
        .into_iter()
        .filter(|deviation_part| deviation_part.0 > 0.0);
    let parts: Vec<String> = deviations
        .map(|(largest, unit, row)| format!("at most {largest:.3e} {unit} (before row {row})"))
        .collect();
    match parts.is_empty() {
        true => "none between rows".to_owned(),
        false => format!("{} between rows", parts.join(", ")),
    }
}
