//! Contact targets: constant positions during contact.

use std::ops::Range;

use super::limbs::Limbs;
use crate::motion::ContactDetection;
use crate::motion::contact_detection::{mean_position, smooth};
use crate::spatial::Vector3;

/// Height below which a contact is moved onto the ground, metres.
const ON_GROUND: f64 = 0.04;

/// Contact of a limb over a span of capture frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Standing {
    pub(super) limb: usize,
    pub(super) span: Range<usize>,
}

impl ContactDetection {
    /// Finds contacts and modifies the targets (capture frame by capture frame) accordingly.
    ///
    /// Each contact gets one position, on the ground or above it, with a smooth blend to and from it.
    pub(super) fn plant(
        &self,
        limbs: &Limbs,
        rate: f64,
        targets: &mut [Vector3<f64>],
    ) -> Vec<Standing> {
        let n = limbs.all.len();
        let frames = targets.len() / n;
        let mut found = Vec::new();
        for (limb, own) in limbs.all.iter().enumerate().filter(|(_, own)| own.stands) {
            let way: Vec<Vector3<f64>> =
                (0..frames).map(|frame| targets[frame * n + limb]).collect();
            let spans = self.spans(&way, |frame| way[frame].z - own.clearance, rate);
            // Moves positions below the ground up to it.
            let lift = |at: Vector3<f64>| Vector3::new(at.x, at.y, at.z.max(own.clearance));
            let lead = self.lead_frames(rate);
            for (frame, at) in way.iter().enumerate() {
                targets[frame * n + limb] = lift(*at);
            }
            for (k, span) in spans.iter().enumerate() {
                let mut place = lift(mean_position(&way[span.clone()]));
                if place.z - own.clearance < ON_GROUND {
                    place.z = own.clearance;
                }
                for frame in drawn(&spans, k, lead, frames) {
                    let off = if frame < span.start {
                        span.start - frame
                    } else {
                        (frame + 1).saturating_sub(span.end)
                    };
                    let share = 1.0 - smooth(off as f64 / (lead + 1) as f64);
                    let at = &mut targets[frame * n + limb];
                    *at = *at + (place - *at) * share;
                }
            }
            found.extend(spans.into_iter().map(|span| Standing { limb, span }));
        }
        found
    }
}

/// Returns the capture frames affected by a contact: its span and the blends, as far as the neighbouring contacts.
fn drawn(spans: &[Range<usize>], k: usize, lead: usize, frames: usize) -> Range<usize> {
    let before = k.checked_sub(1).map_or(0, |last| spans[last].end);
    let after = spans.get(k + 1).map_or(frames, |next| next.start);
    spans[k].start.saturating_sub(lead).max(before)..(spans[k].end + lead).min(after)
}

#[cfg(test)]
mod tests {
    use super::drawn;

    #[test]
    fn stance_affects_frames_up_to_its_neighbours() {
        let spans = [5..10, 12..15, 40..50];
        let all = |lead: usize| [0, 1, 2].map(|k| drawn(&spans, k, lead, 52));
        assert_eq!(all(9), [0..12, 10..24, 31..52]);
        assert_eq!(all(1), [4..11, 11..16, 39..51]);
        assert_eq!(all(0), spans);
    }
}
