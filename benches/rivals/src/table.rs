//! The result as a Markdown table.

/// What one solver did.
pub struct Row {
    /// The solver and its settings in a few words.
    pub name: String,
    /// Microseconds of each query.
    pub micros: Vec<f64>,
    /// How many answers the judge accepted.
    pub solved: usize,
    /// How many answers were given that the judge refused.
    pub refused: usize,
}

impl Row {
    fn quantile(sorted: &[f64], of: f64) -> f64 {
        let last = sorted.len().saturating_sub(1);
        sorted
            .get(((sorted.len() as f64 * of) as usize).min(last))
            .copied()
            .unwrap_or(f64::NAN)
    }

    fn median(&self) -> f64 {
        let mut sorted = self.micros.clone();
        sorted.sort_by(f64::total_cmp);
        Self::quantile(&sorted, 0.5)
    }
}

/// Prints the rows; ratios are to the first row's median.
pub fn print(rows: &[Row]) {
    println!("| solver | solved % | median µs | p99 µs | mean µs | median, times the first row |");
    println!("|---|---:|---:|---:|---:|---:|");
    let unit = rows.first().map_or(f64::NAN, Row::median);
    for row in rows {
        let mut sorted = row.micros.clone();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len() as f64;
        println!(
            "| {} | {:.2} | {:.1} | {:.1} | {:.1} | {:.1} |",
            row.name,
            100.0 * row.solved as f64 / count,
            Row::quantile(&sorted, 0.5),
            Row::quantile(&sorted, 0.99),
            sorted.iter().sum::<f64>() / count,
            Row::quantile(&sorted, 0.5) / unit,
        );
    }
    for row in rows.iter().filter(|row| row.refused > 0) {
        println!(
            "\n{}: {} answers that the judge refused, of {}.",
            row.name,
            row.refused,
            row.micros.len()
        );
    }
}
