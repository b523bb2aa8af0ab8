//! Contact targets: constant positions during contact.

use std::ops::Range;

use super::limbs::Limbs;
use crate::motion::ContactDetection;
use crate::motion::contact_detection::{mean_position, smooth};
use kinopt_kinematics::spatial::Vector3;

/// Height below which a contact is moved onto the ground, metres.
const MAX_SNAP_HEIGHT: f64 = 0.04;

/// Contact of a limb over a span of capture frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimbContact {
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
    ) -> Vec<LimbContact> {
        let n = limbs.all.len();
        let frames = targets.len() / n;
        let mut contacts = Vec::new();
        for (limb, driven_limb) in limbs
            .all
            .iter()
            .enumerate()
            .filter(|(_, driven_limb)| driven_limb.makes_contact)
        {
            let positions: Vec<Vector3<f64>> =
                (0..frames).map(|frame| targets[frame * n + limb]).collect();
            let spans = self.spans(
                &positions,
                |frame| positions[frame].z - driven_limb.clearance,
                rate,
            );
            // Moves positions below the ground up to it.
            let lift = |position: Vector3<f64>| {
                Vector3::new(
                    position.x,
                    position.y,
                    position.z.max(driven_limb.clearance),
                )
            };
            let lead = self.lead_frames(rate);
            for (frame, position) in positions.iter().enumerate() {
                targets[frame * n + limb] = lift(*position);
            }
            for (k, span) in spans.iter().enumerate() {
                let mut contact_position = lift(mean_position(&positions[span.clone()]));
                if contact_position.z - driven_limb.clearance < MAX_SNAP_HEIGHT {
                    contact_position.z = driven_limb.clearance;
                }
                for frame in affected_frames(&spans, k, lead, frames) {
                    let distance = if frame < span.start {
                        span.start - frame
                    } else {
                        (frame + 1).saturating_sub(span.end)
                    };
                    let weight = 1.0 - smooth(distance as f64 / (lead + 1) as f64);
                    let target = &mut targets[frame * n + limb];
                    *target = *target + (contact_position - *target) * weight;
                }
            }
            contacts.extend(spans.into_iter().map(|span| LimbContact { limb, span }));
        }
        contacts
    }
}

/// Returns the capture frames affected by a contact: its span and the blends, as far as the neighbouring contacts.
fn affected_frames(spans: &[Range<usize>], k: usize, lead: usize, frames: usize) -> Range<usize> {
    let before = k.checked_sub(1).map_or(0, |last| spans[last].end);
    let after = spans.get(k + 1).map_or(frames, |next| next.start);
    spans[k].start.saturating_sub(lead).max(before)..(spans[k].end + lead).min(after)
}

#[cfg(test)]
mod tests {
    use super::affected_frames;

    #[test]
    fn stance_affects_frames_up_to_its_neighbours() {
        let spans = [5..10, 12..15, 40..50];
        let all = |lead: usize| [0, 1, 2].map(|k| affected_frames(&spans, k, lead, 52));
        assert_eq!(all(9), [0..12, 10..24, 31..52]);
        assert_eq!(all(1), [4..11, 11..16, 39..51]);
        assert_eq!(all(0), spans);
    }
}
