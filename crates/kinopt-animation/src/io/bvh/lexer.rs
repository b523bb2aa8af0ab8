//! Lexer of BVH files: words with line numbers.

use std::borrow::Cow;

use super::note::BvhNote;
use crate::io::{FileLocation, ReadError};

/// Length in characters above which messages shorten a word.
const MAX_SHOWN_CHARS: usize = 40;

/// Lexer of a text.
#[derive(Debug)]
pub(super) struct Lexer<'a> {
    file: &'a str,
    rest: &'a str,
    line: usize,
}

/// A brace, or a run of characters other than white space and braces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) text: &'a str,
    /// Line, from 1.
    pub(super) line: usize,
}

impl Word<'_> {
    /// Returns true if the word is this keyword, in upper or lower case.
    pub(super) fn is(&self, keyword: &str) -> bool {
        self.text.eq_ignore_ascii_case(keyword)
    }
}

impl<'a> Lexer<'a> {
    /// Lexer of a text; `file` is the file name for messages.
    pub(super) fn new(text: &'a str, file: &'a str) -> Self {
        Self {
            file,
            rest: text.strip_prefix('\u{feff}').unwrap_or(text),
            line: 1,
        }
    }

    #[must_use]
    pub(super) fn file(&self) -> &'a str {
        self.file
    }

    /// Number of remaining bytes.
    #[must_use]
    pub(super) fn remaining_bytes(&self) -> usize {
        self.rest.len()
    }

    /// Remaining text.
    #[must_use]
    pub(super) fn rest(&self) -> &'a str {
        self.rest
    }

    /// Line of the last word.
    #[must_use]
    pub(super) fn line(&self) -> usize {
        self.line
    }

    pub(super) fn skip_space(&mut self) {
        let bytes = self.rest.as_bytes();
        let space = bytes.iter().position(|byte| !byte.is_ascii_whitespace());
        let (space, rest) = self.rest.split_at(space.unwrap_or(bytes.len()));
        self.line += line_ends(space.as_bytes());
        self.rest = rest;
    }

    /// Next word; `None` at the end of the text.
    pub(super) fn word(&mut self) -> Option<Word<'a>> {
        self.skip_space();
        let bytes = self.rest.as_bytes();
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'{' | b'}');
        let length = match bytes.first()? {
            b'{' | b'}' => 1,
            _ => bytes.iter().position(is_end).unwrap_or(bytes.len()),
        };
        let (text, rest) = self.rest.split_at(length);
        self.rest = rest;
        let line = self.line;
        Some(Word { text, line })
    }

    /// Rest of the line up to a brace, with single spaces between words; `None` if it is empty.
    pub(super) fn name(&mut self) -> Option<String> {
        let end = self.rest.find(['\n', '\r', '{', '}']);
        let (name, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        let words: Vec<&str> = name.split_whitespace().collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    /// Reads a given word.
    pub(super) fn expect(&mut self, keyword: &str) -> Result<Word<'a>, ReadError> {
        let word = self.word();
        word.filter(|word| word.is(keyword))
            .ok_or_else(|| self.unexpected(&format!("`{keyword}`"), word))
    }

    /// Reads words followed by a colon; white space after the colon is optional.
    pub(super) fn label(&mut self, words: &[&str]) -> Result<(), ReadError> {
        for keyword in words {
            self.skip_space();
            let start = self.rest.get(..keyword.len());
            if !start.is_some_and(|start| start.eq_ignore_ascii_case(keyword)) {
                let word = self.word();
                return Err(self.unexpected(&format!("`{}:`", words.join(" ")), word));
            }
            self.rest = &self.rest[keyword.len()..];
        }
        self.skip_space();
        self.rest = self.rest.strip_prefix(':').unwrap_or(self.rest);
        Ok(())
    }

    /// Reads a finite number; `what` describes it in messages.
    pub(super) fn number(&mut self, what: impl Fn() -> String) -> Result<f64, ReadError> {
        let word = self.word();
        let number = word.and_then(|word| word.text.parse().ok());
        number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| self.unexpected(&format!("{}, a finite number", what()), word))
    }

    /// Reads a whole number.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        let word = self.word();
        let count = word.and_then(|word| word.text.parse().ok());
        count.ok_or_else(|| self.unexpected(&format!("{what}, a whole number"), word))
    }

    /// Error of an unexpected word.
    pub(super) fn unexpected(&self, expected: &str, word: Option<Word>) -> ReadError {
        let Some(Word { text, line }) = word else {
            return self.error(self.line, format!("expected {expected}, but the file ends"));
        };
        let shown: String = text.chars().take(MAX_SHOWN_CHARS).collect();
        let ellipsis = if shown.len() < text.len() { "…" } else { "" };
        self.error(
            line,
            format!("expected {expected}, found `{shown}{ellipsis}`"),
        )
    }

    pub(super) fn error(&self, line: usize, problem: impl Into<String>) -> ReadError {
        ReadError::malformed(self.file, FileLocation::Line(line), problem)
    }
}

/// Decodes a file: UTF-8, with other bytes as Latin-1 characters. Also returns a note if there are any.
pub(super) fn decode(bytes: &[u8]) -> (Cow<'_, str>, Option<BvhNote>) {
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return (text.into(), None),
        Err(error) => error,
    };
    let before = bytes.get(..error.valid_up_to()).unwrap_or(&[]);
    let line = 1 + line_ends(before);
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        text.extend(chunk.invalid().iter().map(|byte| char::from(*byte)));
    }
    (text.into(), Some(BvhNote::Latin1 { line }))
}

/// Number of line ends: line feeds, carriage returns, or pairs of both.
fn line_ends(bytes: &[u8]) -> usize {
    let next = bytes.iter().skip(1).map(Some).chain([None]);
    let pairs = bytes.iter().zip(next);
    let ends =
        pairs.filter(|&(&byte, next)| byte == b'\n' || (byte == b'\r' && next != Some(&b'\n')));
    ends.count()
}
