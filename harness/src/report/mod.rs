//! Report of results: a table and pictures.

mod choice;
mod pictures;
mod table;

use std::path::Path;

pub use pictures::{course, jacobian, performance, routes, solved_over_time};
pub use table::markdown;

use kinopt_charts::{ChartError, Figure};

use crate::{HarnessError, Results};

/// File name of a picture, its title, and its drawing function.
type Picture = (&'static str, &'static str, fn(&Results) -> Figure);

const PICTURES: [Picture; 5] = [
    (
        "solved-over-time.svg",
        "Solved fraction over time",
        solved_over_time,
    ),
    ("profile.svg", "Performance profile", performance),
    ("routes.svg", "Derivative routes", routes),
    ("course.svg", "Cost over steps", course),
    ("jacobian.svg", "Cost of one Jacobian", jacobian),
];

/// Writes `results.json`, `results.md` and the non-empty pictures into an existing folder.
///
/// # Errors
/// Returns an error if a file cannot be written.
pub fn write(results: &Results, folder: impl AsRef<Path>) -> Result<(), HarnessError> {
    let folder = folder.as_ref();
    results.write_json(folder.join("results.json"))?;
    let mut text = markdown(results);
    for (file, title, draw) in PICTURES {
        match draw(results).write_svg(folder.join(file)) {
            Ok(()) => text.push_str(&format!("\n![{title}]({file})\n")),
            // Without solved problems or derivative modes there is no picture.
            Err(ChartError::Empty { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    let path = folder.join("results.md");
    std::fs::write(&path, text).map_err(|source| HarnessError::Write { path, source })
}
