//! Events at times of a clip, each fired exactly once as playback passes.

use std::iter::successors;

use super::{Clip, Passage};
use crate::animation::Playback;
use crate::interruption::is_stopped;

/// Something that happens at a time of a clip: a foot lands, a sound starts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// In seconds of the clip's own time.
    pub time: f32,
    /// What happens.
    pub name: String,
}

/// An event that playback passed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fired<'a> {
    /// Which one.
    pub event: &'a Event,
    /// When, in seconds since playback started.
    pub elapsed: f64,
}

impl Clip {
    /// The clip's events, sorted by time.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The events that a passage of playback goes by, in the order in which it meets them. In a
    /// chain of passages, such as a [`Playhead`](super::Playhead) makes, each event fires exactly
    /// once each time it is passed: at any lengths of steps, over the ends of loops, and on the way
    /// back of ping-pong (once at its turning points). They are found as they are asked for: a passage
    /// of a million loops has a million times the events.
    pub fn fired(&self, playback: Playback, passage: Passage) -> impl Iterator<Item = Fired<'_>> {
        let [start, end] = self.span().map(f64::from);
        let length = end - start;
        let repeats = playback != Playback::Hold && length > 0.0;
        let there_and_back = playback == Playback::PingPong;
        let period = if there_and_back { 2.0 * length } else { length };
        let within = |event: &&Event| (start..=end).contains(&f64::from(event.time));
        let there = self
            .events
            .iter()
            .filter(within)
            .map(move |event| (event, f64::from(event.time) - start));
        // Turning points belong to the way there.
        let back = there
            .clone()
            .rev()
            .filter(move |(_, at)| there_and_back && *at > 0.0 && *at < length);
        let back = back.map(move |(event, at)| (event, 2.0 * length - at));
        let cycle: Vec<(&Event, f64)> = there.chain(back).collect();

        let [low, high] = [passage.from.min(passage.to), passage.from.max(passage.to)];
        // One more on either side, because an event at a cycle's end fires as the next one starts.
        let [first, last] = match repeats {
            true => [(low / period).floor() - 1.0, (high / period).floor() + 1.0],
            false => [0.0, 0.0],
        };
        let forwards = passage.to >= passage.from;
        let step = if forwards { 1.0 } else { -1.0 };
        let cycles = successors(Some(if forwards { first } else { last }), move |k| {
            let next = k + step;
            // Beyond 2^53 cycles the next one is the same number.
            (next != *k && (first..=last).contains(&next)).then_some(next)
        });
        // Without events in the span no cycle has any.
        let cycles = cycles.take(if cycle.is_empty() { 0 } else { usize::MAX });
        let cycles = cycles.take_while(|_| !is_stopped());
        cycles.flat_map(move |k| {
            // The same expression for the same event and cycle always, so that passages which meet
            // at a time agree on which side of it an event is.
            let mut events: Vec<Fired<'_>> = cycle
                .iter()
                .map(|&(event, at)| (event, at, k * period + at))
                .filter(|&(_, at, elapsed)| {
                    // A loop that starts here does not play the other cycle that meets here.
                    let other = if forwards { length } else { 0.0 };
                    let meets = playback == Playback::Loop && elapsed == passage.from;
                    passage.passes(elapsed) && !(repeats && meets && at == other)
                })
                .map(|(event, _, elapsed)| Fired { event, elapsed })
                .collect();
            if !forwards {
                events.reverse();
            }
            events
        })
    }
}
