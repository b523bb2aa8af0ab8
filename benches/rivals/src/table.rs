//! Results as a Markdown table.

use std::time::Duration;

/// Results of one solver.
pub struct Row {
    name: String,
    micros: Vec<f64>,
    accepted: Vec<bool>,
    refused: Vec<bool>,
}

impl Row {
    /// Creates the row of a solver (its name and settings) with `queries` queries.
    #[must_use]
    pub fn new(name: String, queries: usize) -> Self {
        Self {
            name,
            micros: vec![f64::INFINITY; queries],
            accepted: vec![true; queries],
            refused: vec![false; queries],
        }
    }

    /// Records one result: its time, true if it had a solution, and true if the judge accepted one. Of repeated results
    /// to a query the fastest time counts, and all must have been accepted.
    pub fn note(&mut self, query: usize, took: Duration, claimed: bool, accepted: bool) {
        let fastest = self.micros[query].min(took.as_secs_f64() * 1e6);
        self.micros[query] = fastest;
        self.accepted[query] &= accepted;
        self.refused[query] |= claimed && !accepted;
    }

    fn sorted(&self) -> Vec<f64> {
        let mut sorted = self.micros.clone();
        sorted.sort_by(f64::total_cmp);
        sorted
    }
}

/// Quantile of the sorted values, at `fraction`.
fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let index = (sorted.len() as f64 * fraction) as usize;
    let index = index.min(sorted.len().saturating_sub(1));
    sorted.get(index).copied().unwrap_or(f64::NAN)
}

/// Prints the rows; ratios are relative to the median of the first row.
pub fn print(rows: &[Row]) {
    println!("| solver | solved % | median µs | p99 µs | mean µs | median ratio |");
    println!("|---|---:|---:|---:|---:|---:|");
    let unit = rows
        .first()
        .map_or(f64::NAN, |r| quantile(&r.sorted(), 0.5));
    let share = |flags: &[bool]| {
        let count = flags.iter().filter(|flag| **flag).count();
        100.0 * count as f64 / flags.len() as f64
    };
    for row in rows {
        let sorted = row.sorted();
        let median = quantile(&sorted, 0.5);
        println!(
            "| {} | {:.2} | {median:.1} | {:.1} | {:.1} | {:.1} |",
            row.name,
            share(&row.accepted),
            quantile(&sorted, 0.99),
            sorted.iter().sum::<f64>() / sorted.len() as f64,
            median / unit,
        );
    }
    for row in rows.iter().filter(|row| row.refused.contains(&true)) {
        let refused = share(&row.refused);
        println!(
            "\n{}: {refused:.2} % of the answers were refused by the judge.",
            row.name
        );
    }
}
