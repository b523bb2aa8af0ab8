//! Error for an unknown name, with suggestions.

use std::fmt;

use thiserror::Error;

/// Largest number of names that the message lists in full.
const MAX_LISTED: usize = 12;
/// Largest number of suggestions.
const MAX_SUGGESTIONS: usize = 3;
/// Number of leading letters of a name that are compared.
const MAX_COMPARED_LETTERS: usize = 64;

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
        let similar = self.similar_names().into_iter().take(MAX_SUGGESTIONS);
        similar.map(|(_, valid)| valid).collect()
    }

    /// The valid names that resemble the unknown one, with their distances, nearest first.
    fn similar_names(&self) -> Vec<(usize, &str)> {
        let requested = letters(&self.name);
        let mut similar: Vec<(usize, &str)> = self
            .valid
            .iter()
            .filter_map(|valid| Some((distance(&requested, &letters(valid))?, valid.as_str())))
            .collect();
        // A stable sort: equally near names stay in order.
        similar.sort_by_key(|(distance, _)| *distance);
        similar
    }

    /// The valid name that is nearer than all others.
    fn closest_name(&self) -> Option<&str> {
        match self.similar_names().as_slice() {
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
        } else if count <= MAX_LISTED {
            if let Some(suggestion) = self.closest_name() {
                write!(out, "did you mean `{suggestion}`? ")?;
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
                        .take(MAX_SUGGESTIONS)
                        .map(String::as_str)
                        .collect();
                    write!(
                        out,
                        "no similar name; the first are `{}`",
                        first.join("`, `")
                    )?;
                }
            }
            let separator = if note.is_empty() { "" } else { "; " };
            write!(out, " ({count} names{separator}{note})")?;
        }
        Ok(())
    }
}

/// The letters and digits of a name, in lower case: `Left_Hand` and `leftHand` are equal.
fn letters(name: &str) -> Vec<char> {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters
        .flat_map(char::to_lowercase)
        .take(MAX_COMPARED_LETTERS)
        .collect()
}

/// Distance between two spellings; `None` if they are too different.
fn distance(requested: &[char], valid: &[char]) -> Option<usize> {
    let (shorter, longer) = match requested.len() <= valid.len() {
        true => (requested, valid),
        false => (valid, requested),
    };
    if shorter.is_empty() {
        return None;
    }
    let edit_distance = edit_distance(requested, valid);
    if edit_distance <= 1 && longer.len() > 1 {
        return Some(edit_distance);
    }
    if shorter.len() >= 3 && longer.windows(shorter.len()).any(|part| part == shorter) {
        // Ranked after single typing errors, names with the fewest further letters first.
        return Some(2 + longer.len() - shorter.len());
    }
    (edit_distance <= 1 + longer.len() / 5).then_some(1 + edit_distance)
}

/// Edit distance of two words with insertion, deletion, substitution and transposition of neighbours.
///
/// Source: optimal string alignment.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut second_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, &x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, &y) in b.iter().enumerate() {
            let substituted = last[j] + usize::from(x != y);
            let mut cost = substituted.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && x == b[j - 1] && a[i - 1] == y {
                cost = cost.min(second_last[j - 1] + 1);
            }
            row.push(cost);
        }
        second_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}
