//! Events of a clip; each fires exactly once when playback passes it.

use std::iter::successors;

use super::{Clip, Passage};
use crate::animation::Playback;
use kinopt_kinematics::interruption::is_stopped;

/// Named event at a time of a clip, such as a footfall or a sound.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// Clip time, seconds.
    pub time: f32,
    /// Name of the event.
    pub name: String,
}

/// Event that playback passed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fired<'a> {
    /// The event.
    pub event: &'a Event,
    /// Time since playback started, seconds.
    pub elapsed: f64,
}

impl Clip {
    /// The events of the clip, sorted by time.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The events passed during a passage, in playback order. In a chain of passages from a
    /// [`Playhead`](super::Playhead), each event fires once per pass. This holds for any step size, across loop ends
    /// and backwards in ping-pong, with one firing at turning points. The iterator is lazy: a passage of n loops yields
    /// the events n times.
    pub fn fired(&self, playback: Playback, passage: Passage) -> impl Iterator<Item = Fired<'_>> {
        let [start, end] = self.span().map(f64::from);
        let length = end - start;
        let repeats = playback != Playback::Hold && length > 0.0;
        let is_ping_pong = playback == Playback::PingPong;
        let period = if is_ping_pong { 2.0 * length } else { length };
        let is_in_span = |event: &&Event| (start..=end).contains(&f64::from(event.time));
        let outbound = self
            .events
            .iter()
            .filter(is_in_span)
            .map(move |event| (event, f64::from(event.time) - start));
        // Turning points belong to the forward direction.
        let inbound = outbound
            .clone()
            .rev()
            .filter(move |(_, offset)| is_ping_pong && *offset > 0.0 && *offset < length);
        let inbound = inbound.map(move |(event, offset)| (event, 2.0 * length - offset));
        let cycle: Vec<(&Event, f64)> = outbound.chain(inbound).collect();

        let [low, high] = [passage.from.min(passage.to), passage.from.max(passage.to)];
        // One more cycle at each end: an event at a cycle's end fires at the start of the next cycle.
        let [first, last] = match repeats {
            true => [(low / period).floor() - 1.0, (high / period).floor() + 1.0],
            false => [0.0, 0.0],
        };
        let forwards = passage.to >= passage.from;
        let step = if forwards { 1.0 } else { -1.0 };
        let cycles = successors(Some(if forwards { first } else { last }), move |k| {
            let next = k + step;
            // Above 2^53 cycles, adding one does not change the number.
            (next != *k && (first..=last).contains(&next)).then_some(next)
        });
        // Without events in the span no cycle has any.
        let cycles = cycles.take(if cycle.is_empty() { 0 } else { usize::MAX });
        let cycles = cycles.take_while(|_| !is_stopped());
        cycles.flat_map(move |k| {
            // One expression for the time of an event in a cycle, so adjacent passages agree on which side an event is.
            let mut events: Vec<Fired<'_>> = cycle
                .iter()
                .map(|&(event, offset)| (event, offset, k * period + offset))
                .filter(|&(_, offset, elapsed)| {
                    // A loop that starts here does not play the previous cycle's end.
                    let last_offset = if forwards { length } else { 0.0 };
                    let is_loop_start = playback == Playback::Loop && elapsed == passage.from;
                    passage.passes(elapsed) && !(repeats && is_loop_start && offset == last_offset)
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
