//! What themes share whose questions are put together at random, out of all that may be asked.
#![allow(clippy::unwrap_used)]

use std::error::Error;

use support::random::Random;

use crate::digest::Digest;

pub(crate) fn one_of<T: Clone>(random: &mut Random, list: &[T]) -> T {
    list[random.below(list.len())].clone()
}

/// Whether it is so this time, as it is in such a share of times.
pub(crate) fn at_times(random: &mut Random, share: f64) -> bool {
    random.unit() < share
}

impl Digest {
    /// An answer, or the words of the refusal with what they rest on; what was answered.
    pub(crate) fn answer<T, E: Error>(&mut self, answer: Result<T, E>) -> Option<T> {
        let error = match answer {
            Ok(found) => return Some(found),
            Err(error) => error,
        };
        let mut next: Option<&dyn Error> = Some(&error);
        while let Some(told) = next {
            self.text(told.to_string());
            next = told.source();
        }
        None
    }
}
