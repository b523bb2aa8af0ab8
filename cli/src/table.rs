//! Text in aligned columns.

/// Lines of a name and a text.
pub(crate) fn lines<'n>(lines: impl IntoIterator<Item = (&'n str, String)>) -> String {
    let lines = lines.into_iter();
    lines
        .map(|(name, line)| format!("{name:<10}{line}\n"))
        .collect()
}

/// Rows under a header; every column is as wide as its widest cell.
#[derive(Debug)]
pub(crate) struct Table {
    /// Flags of the columns that are aligned right.
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Table with column names between bars; `>` before a name aligns the column right.
    pub(crate) fn new(columns: &str) -> Self {
        let columns = columns.split('|').map(str::trim);
        let aligned = columns.map(|name| match name.strip_prefix('>') {
            Some(name) => (true, name.to_owned()),
            None => (false, name.to_owned()),
        });
        let (right, names) = aligned.unzip();
        let rows = vec![names];
        Self { right, rows }
    }

    pub(crate) fn row(&mut self, cells: impl Into<Vec<String>>) {
        self.rows.push(cells.into());
    }

    /// Table with every line indented by two spaces; empty without rows.
    pub(crate) fn text(&self) -> String {
        if self.rows.len() < 2 {
            return String::new();
        }
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.right.len()).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for ((cell, &width), right) in row.iter().zip(&widths).zip(&self.right) {
                line.push_str(&match right {
                    false => format!("  {cell:<width$}"),
                    true => format!("  {cell:>width$}"),
                });
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let mut table = Table::new("name | >value");
        assert_eq!(table.text(), "");
        table.row(["a".into(), "-10.25".into()]);
        table.row(["längere".into(), "1".into()]);
        let expected = "  name      value\n  a        -10.25\n  längere       1\n";
        assert_eq!(table.text(), expected);
    }
}
