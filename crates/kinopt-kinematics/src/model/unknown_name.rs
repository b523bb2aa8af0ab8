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
    /// separate them. A name that has all words of the unknown one is similar too.
    #[must_use]
    pub fn suggestions(&self) -> Vec<&str> {
        let similar = self.similar_names().into_iter().take(MAX_SUGGESTIONS);
        similar.map(|(_, valid)| valid).collect()
    }

    /// The valid names that resemble the unknown one, with their distances, nearest first.
    fn similar_names(&self) -> Vec<(usize, &str)> {
        let mut similar: Vec<(usize, &str)> = self
            .valid
            .iter()
            .filter_map(|valid| Some((distance(&self.name, valid)?, valid.as_str())))
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
fn letters(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters
        .flat_map(char::to_lowercase)
        .take(MAX_COMPARED_LETTERS)
        .collect()
}

/// The words of a name, in lower case: `left_hand` and `LeftHand` have the words `left` and `hand`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for letter in name.chars().take(MAX_COMPARED_LETTERS) {
        let starts = letter.is_uppercase() && !last.is_uppercase()
            || letter.is_numeric() != last.is_numeric();
        if starts || !letter.is_alphanumeric() {
            words.push(String::new());
        }
        if let (Some(word), true) = (words.last_mut(), letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
        last = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Distance between two names, the smaller the more similar; `None` if they are too different.
///
/// Single typing errors come first, then names that contain the letters or all words of the other, then several typing
/// errors.
fn distance(requested: &str, valid: &str) -> Option<usize> {
    let [requested_letters, valid_letters] = [requested, valid].map(letters);
    let [requested_len, valid_len] =
        [&requested_letters, &valid_letters].map(|letters| letters.chars().count());
    let (shorter, longer) = (requested_len.min(valid_len), requested_len.max(valid_len));
    if shorter == 0 {
        return None;
    }
    let edits = strsim::osa_distance(&requested_letters, &valid_letters);
    if edits <= 1 && longer > 1 {
        return Some(edits);
    }
    let is_part = shorter >= 3
        && (requested_letters.contains(&valid_letters)
            || valid_letters.contains(&requested_letters));
    let [requested_words, valid_words] = [requested, valid].map(words);
    let has_words = requested_words.len() > 1
        && requested_words
            .iter()
            .all(|word| valid_words.contains(word));
    if is_part || has_words {
        // Names with the fewest further letters come first.
        return Some(2 + longer - shorter);
    }
    (edits <= 1 + longer / 5).then_some(1 + edits)
}
