//! Error for an unknown name, with suggestions.

use std::fmt;

use thiserror::Error;

/// Largest number of names that the message lists in full.
const LISTED: usize = 12;
/// Largest number of suggestions.
const SUGGESTED: usize = 3;
/// Number of leading letters of a name that are compared.
const COMPARED: usize = 64;

/// Error for an unknown name, with the valid names.
///
/// The message lists up to twelve valid names. For more it gives [suggestions](Self::suggestions).
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct UnknownName {
    /// The kind of object: "joint", "frame", …
    pub kind: &'static str,
    /// The requested name.
    pub name: Box<str>,
    /// All valid names.
    pub valid: Vec<String>,
    /// A remark on the valid names.
    note: Option<Box<Note>>,
}

/// Boxed to keep this error, which most functions return, small.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Note(String);

impl UnknownName {
    /// An error for `name`, with the valid names.
    pub fn new<'a>(
        kind: &'static str,
        name: &str,
        valid: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        Self {
            kind,
            name: name.into(),
            valid: valid.into_iter().map(str::to_owned).collect(),
            note: None,
        }
    }

    /// Adds a remark on the valid names, for example where they are listed.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(Box::new(Note(note.into())));
        self
    }

    /// Up to three valid names that resemble the unknown one, most similar first.
    ///
    /// Names are similar if their letters and digits are equal without case, if one contains the other, or if few edits
    /// separate them.
    #[must_use]
    pub fn suggestions(&self) -> Vec<&str> {
        let near = self.near().into_iter().take(SUGGESTED);
        near.map(|(_, valid)| valid).collect()
    }

    /// The valid names that resemble the unknown one, with their distances, nearest first.
    fn near(&self) -> Vec<(usize, &str)> {
        let asked = letters(&self.name);
        let mut near: Vec<(usize, &str)> = self
            .valid
            .iter()
            .filter_map(|valid| Some((distance(&asked, &letters(valid))?, valid.as_str())))
            .collect();
        // A stable sort: equally near names stay in order.
        near.sort_by_key(|(distance, _)| *distance);
        near
    }

    /// The valid name that is nearer than all others.
    fn nearest(&self) -> Option<&str> {
        match self.near().as_slice() {
            [(_, only)] => Some(only),
            [(near, first), (next, _), ..] if near < next => Some(first),
            _ => None,
        }
    }
}

impl fmt::Display for UnknownName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "no {} named `{}`; ", self.kind, self.name)?;
        let note = self.note.as_ref().map_or("", |note| note.0.as_str());
        let count = self.valid.len();
        if count == 0 {
            write!(out, "there are no names")?;
        } else if count <= LISTED {
            if let Some(meant) = self.nearest() {
                write!(out, "did you mean `{meant}`? ")?;
            }
            write!(out, "valid names: {}", self.valid.join(", "))?;
            if !note.is_empty() {
                write!(out, " ({note})")?;
            }
        } else {
            let suggestions = self.suggestions();
            match suggestions.split_last() {
                Some((only, [])) => write!(out, "did you mean `{only}`?")?,
                Some((last, others)) => {
                    write!(out, "did you mean `{}` or `{last}`?", others.join("`, `"))?;
                }
                None => {
                    let first: Vec<&str> = self
                        .valid
                        .iter()
                        .take(SUGGESTED)
                        .map(String::as_str)
                        .collect();
                    write!(
                        out,
                        "no similar name; the first are `{}`",
                        first.join("`, `")
                    )?;
                }
            }
            let more = if note.is_empty() { "" } else { "; " };
            write!(out, " ({count} names{more}{note})")?;
        }
        Ok(())
    }
}

/// The letters and digits of a name, in lower case: `Left_Hand` and `leftHand` are equal.
fn letters(name: &str) -> Vec<char> {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters
        .flat_map(char::to_lowercase)
        .take(COMPARED)
        .collect()
}

/// Distance between two spellings; `None` if they are too different.
fn distance(asked: &[char], valid: &[char]) -> Option<usize> {
    let (shorter, longer) = match asked.len() <= valid.len() {
        true => (asked, valid),
        false => (valid, asked),
    };
    if shorter.is_empty() {
        return None;
    }
    let slips = slips(asked, valid);
    if slips <= 1 && longer.len() > 1 {
        return Some(slips);
    }
    if shorter.len() >= 3 && longer.windows(shorter.len()).any(|part| part == shorter) {
        // Ranked after single typing errors, names with the fewest further letters first.
        return Some(2 + longer.len() - shorter.len());
    }
    (slips <= 1 + longer.len() / 5).then_some(1 + slips)
}

/// Edit distance of two words with insertion, deletion, substitution and transposition of neighbours.
///
/// Source: optimal string alignment.
fn slips(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, &x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, &y) in b.iter().enumerate() {
            let changed = last[j] + usize::from(x != y);
            let mut least = changed.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && x == b[j - 1] && a[i - 1] == y {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}
