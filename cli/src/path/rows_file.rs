//! `--out`: the rows as a table, or the whole report as JSON.

use std::fmt::Write;
use std::path::Path;

use super::report::Report;
use crate::failure::Outcome;
use crate::output;

pub(super) fn write(path: &Path, report: &Report<'_>) -> Outcome<()> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let text = match extension {
        Some("csv") => table(report),
        Some("json") => serde_json::to_string(&report.document())? + "\n",
        _ => {
            return Err(usage!("--out {}: expected .csv or .json", path.display()));
        }
    };
    output::write_file(path, text)
}

fn table(report: &Report<'_>) -> String {
    let times = report.times.as_deref();
    let mut names = report.loaded.joint_names();
    if times.is_some() {
        names.insert(0, "time");
    }
    let mut text = names.join(",") + "\n";
    for (row, q) in report.rows().enumerate() {
        let time = times.and_then(|times| times.get(row));
        let numbers = time.into_iter().chain(&q);
        for (column, number) in numbers.enumerate() {
            let separator = if column > 0 { "," } else { "" };
            // Writing into a string cannot fail.
            let _ = write!(text, "{separator}{number}");
        }
        text.push('\n');
    }
    text
}
