//! A name that is not there, and the names that may have been meant.

use std::fmt;

use thiserror::Error;

/// So many names are listed in full; of more, the nearest are.
const LISTED: usize = 12;
/// So many names are suggested.
const SUGGESTED: usize = 3;
/// Names count as spelt with so many letters; the rest of longer ones is not compared.
const COMPARED: usize = 64;

/// A name that is not there, with the ones that are. Its message lists up to twelve of them; of more
/// it suggests those that are [like](Self::suggestions) the one asked for.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct UnknownName {
    /// What was looked up: "joint", "frame", …
    pub kind: &'static str,
    /// The name asked for.
    pub name: Box<str>,
    /// All names there are.
    pub valid: Vec<String>,
    /// What else is to be said of the valid names.
    note: Option<Box<Note>>,
}

/// Boxed, as errors that hold this one are returned from everywhere.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Note(String);

impl UnknownName {
    /// Records the valid names beside the wrong one.
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

    /// Says more of the valid names, such as where all of them are listed.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(Box::new(Note(note.into())));
        self
    }

    /// Up to three valid names that may have been meant, likeliest first: the same letters and
    /// digits whatever their case, one within the other, or a few slips of the finger apart.
    #[must_use]
    pub fn suggestions(&self) -> Vec<&str> {
        let near = self.near().into_iter().take(SUGGESTED);
        near.map(|(_, valid)| valid).collect()
    }

    /// The valid names that are like the one asked for, nearest first, and how far they are from it.
    fn near(&self) -> Vec<(usize, &str)> {
        let asked = letters(&self.name);
        let mut near: Vec<(usize, &str)> = self
            .valid
            .iter()
            .filter_map(|valid| Some((distance(&asked, &letters(valid))?, valid.as_str())))
            .collect();
        // Stable: of equally near names the first stays first.
        near.sort_by_key(|(distance, _)| *distance);
        near
    }

    /// The one that is nearer than all others.
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
            write!(out, "there is none")?;
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
                        "none is like it; they begin with `{}`",
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

/// The letters and digits of a name, in lower case: `Left_Hand` and `leftHand` are alike.
fn letters(name: &str) -> Vec<char> {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters
        .flat_map(char::to_lowercase)
        .take(COMPARED)
        .collect()
}

/// How far apart two spellings are; none where one was hardly meant for the other.
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
        // After single slips; those with the least around it first.
        return Some(2 + longer.len() - shorter.len());
    }
    (slips <= 1 + longer.len() / 5).then_some(1 + slips)
}

/// The least number of letters put in, left out, changed, or changed with their neighbour, that
/// makes one word of the other (optimal string alignment).
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
