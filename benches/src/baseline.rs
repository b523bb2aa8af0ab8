//! Stored instruction counts: a table in a file with the compiler and processor, then one stage for each line.
//!
//! ```text
//! # compiler: rustc 1.90.0 (1159e78c4 2025-09-14)
//! # processor under valgrind: x86_64, avx2 fma
//! forward kinematics, 22 bones<TAB>6172.0
//! ```

use std::collections::BTreeMap;
use std::fmt::Write;

/// Counts with the environment of their measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Baseline {
    /// Output of `rustc -V`.
    pub compiler: String,
    /// Instruction sets that the program sees under valgrind.
    pub processor: String,
    /// Instructions for one element, by stage.
    pub counts: BTreeMap<String, f64>,
}

const COMPILER: &str = "# compiler: ";
const PROCESSOR: &str = "# processor under valgrind: ";

impl Baseline {
    /// Reads a table.
    ///
    /// # Errors
    /// Returns the number, from 1, of a line that is neither a heading nor a stage with a number.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut baseline = Self::default();
        for (index, line) in text.lines().enumerate() {
            if let Some(compiler) = line.strip_prefix(COMPILER) {
                compiler.clone_into(&mut baseline.compiler);
            } else if let Some(processor) = line.strip_prefix(PROCESSOR) {
                processor.clone_into(&mut baseline.processor);
            } else if !line.is_empty() && !line.starts_with('#') {
                let stage_and_count = line.split_once('\t');
                let (stage, count) = stage_and_count
                    .and_then(|(stage, count)| Some((stage, count.parse().ok()?)))
                    .ok_or_else(|| format!("line {}: no stage, tab and number", index + 1))?;
                baseline.counts.insert(stage.to_owned(), count);
            }
        }
        Ok(baseline)
    }

    /// Writes the table.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{COMPILER}{}\n{PROCESSOR}{}\n",
            self.compiler, self.processor
        );
        for (stage, count) in &self.counts {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{stage}\t{count:.1}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::Baseline;

    #[test]
    fn baseline_written_text_reads_back() {
        let mut baseline = Baseline {
            compiler: "rustc 1.90.0 (1159e78c4)".to_owned(),
            processor: "x86_64, avx2 fma".to_owned(),
            ..Baseline::default()
        };
        let counts = [("two bones, bare", 345.5), ("CCD sweep", 12_345.0)];
        let counts = counts.map(|(stage, count)| (stage.to_owned(), count));
        baseline.counts.extend(counts);
        assert_eq!(Baseline::parse(&baseline.to_text()), Ok(baseline));
        let error = Baseline::parse("# a heading\n\nno tab 3\n");
        assert_eq!(error, Err("line 3: no stage, tab and number".to_owned()));
    }
}
