//! Attributes of an element, with its default classes as fallback.

use super::defaults::Defaults;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read, RobotFileError, exactly};

/// Attributes of an element, then of its default class, then of the enclosing classes.
#[derive(Clone, Debug)]
pub(super) struct Attributes<'a> {
    /// The element itself.
    pub(super) tag: Tag<'a>,
    layers: Vec<Tag<'a>>,
}

impl<'a> Attributes<'a> {
    /// Attributes of an element without default classes.
    pub(super) fn without_defaults(tag: Tag<'a>) -> Self {
        let layers = vec![tag];
        Self { tag, layers }
    }

    /// Attributes of an element with the class that it names, or else the `childclass` of the enclosing bodies.
    pub(super) fn of(
        tag: Tag<'a>,
        defaults: &Defaults<'a>,
        enclosing_class: Option<&str>,
    ) -> Read<Self> {
        Self::named(tag, tag.name(), defaults, enclosing_class)
    }

    /// As [`of`](Self::of), for an element that classes list under another tag name.
    pub(super) fn named(
        tag: Tag<'a>,
        name: &str,
        defaults: &Defaults<'a>,
        enclosing_class: Option<&str>,
    ) -> Read<Self> {
        let class = defaults.class(tag, tag.text("class").or(enclosing_class))?;
        let mut layers = vec![tag];
        defaults.add_layers(class, name, &mut layers);
        Ok(Self { tag, layers })
    }

    /// The tags that hold attributes of the element, highest priority first.
    pub(super) fn layers(&self) -> &[Tag<'a>] {
        &self.layers
    }

    pub(super) fn text(&self, attribute: &str) -> Option<&'a str> {
        self.layers.iter().find_map(|layer| layer.text(attribute))
    }

    /// An attribute of exactly `N` finite numbers.
    pub(super) fn numbers<const N: usize>(
        &self,
        attribute: &'static str,
    ) -> Read<Option<[f64; N]>> {
        let Some(text) = self.text(attribute) else {
            return Ok(None);
        };
        let numbers = exactly(text).ok_or_else(|| self.bad_numbers(attribute, N, text))?;
        Ok(Some(numbers))
    }

    /// An attribute of one to `N` finite numbers, and their count; missing numbers are 0.
    pub(super) fn up_to<const N: usize>(
        &self,
        attribute: &'static str,
    ) -> Read<Option<([f64; N], usize)>> {
        let Some(text) = self.text(attribute) else {
            return Ok(None);
        };
        let bad = || self.bad_numbers(attribute, N, text);
        let mut numbers = [0.0; N];
        let mut count = 0;
        for word in text.split_whitespace() {
            let number: Option<f64> = word.parse().ok().filter(|number: &f64| number.is_finite());
            let slot = numbers.get_mut(count).ok_or_else(bad)?;
            *slot = number.ok_or_else(bad)?;
            count += 1;
        }
        Ok(Some((numbers, count)))
    }

    /// An attribute of one finite number.
    pub(super) fn number(&self, attribute: &'static str) -> Read<Option<f64>> {
        Ok(self.numbers(attribute)?.map(|[value]| value))
    }

    /// Index of an attribute's value in a list of valid words.
    pub(super) fn word(
        &self,
        attribute: &'static str,
        words: &'static [&'static str],
    ) -> Read<Option<usize>> {
        let Some(text) = self.text(attribute) else {
            return Ok(None);
        };
        let index = words.iter().position(|word| *word == text);
        let unknown = || {
            self.fault(ParseIssue::UnknownWord {
                attribute,
                word: text.to_owned(),
                valid: words,
            })
        };
        Ok(Some(index.ok_or_else(unknown)?))
    }

    /// An attribute that is `true` or `false`.
    pub(super) fn flag(&self, attribute: &'static str) -> Read<Option<bool>> {
        let word = self.word(attribute, &["false", "true"])?;
        Ok(word.map(|word| word == 1))
    }

    pub(super) fn fault(&self, fault: ParseIssue) -> RobotFileError {
        self.tag.fault(fault)
    }

    fn bad_numbers(&self, attribute: &'static str, count: usize, text: &str) -> RobotFileError {
        self.fault(ParseIssue::BadNumbers {
            attribute,
            count,
            text: text.to_owned(),
        })
    }
}
