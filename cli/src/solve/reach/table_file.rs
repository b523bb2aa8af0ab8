//! `--out`: one row a pair of tool and target as a table, or the whole report as JSON.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::report::Report;
use crate::animated_armature::extension;
use crate::failure::Outcome;
use crate::output;

/// Output file of the decisions.
#[derive(Clone, Debug)]
pub(super) enum TableFile {
    Csv(PathBuf),
    Json(PathBuf),
}

impl TableFile {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        match extension(&path).as_str() {
            "csv" => Ok(Self::Csv(path)),
            "json" => Ok(Self::Json(path)),
            _ => Err("expected .csv or .json".to_owned()),
        }
    }

    pub(super) fn path(&self) -> &Path {
        let (Self::Csv(path) | Self::Json(path)) = self;
        path
    }

    pub(super) fn write(&self, report: &Report<'_>) -> Outcome<()> {
        let text = match self {
            Self::Csv(_) => table(report)?,
            Self::Json(_) => serde_json::to_string(&report.document()?)? + "\n",
        };
        output::write_file(self.path(), text)
    }
}

/// Columns `tool`, `target`, `status`, the criterion (empty if not reached), `boxes`, and all moving joints.
fn table(report: &Report<'_>) -> Outcome<String> {
    let joints = report.loaded.joint_names().join(",");
    let criterion = report.ranked_by.name();
    let mut text = format!("tool,target,status,{criterion},boxes,{joints}\n");
    for decision in &report.decisions {
        let value = report.value(decision);
        let value = value.map_or_else(String::new, |value| value.to_string());
        // Writing into a string cannot fail.
        let _ = write!(
            text,
            "{},{},{},{value},{}",
            decision.tool,
            decision.target,
            decision.status.name(),
            decision.boxes
        );
        for number in (report.configuration)(&decision.q)? {
            let _ = write!(text, ",{number}");
        }
        text.push('\n');
    }
    Ok(text)
}
