//! Motion of the feet during contact.

use std::ops::Range;

use super::body_points::{BodyPoints, PointTrack};
use super::{FootMotion, LostSubjectContact, Spread};
use crate::motion::ContactDetection;
use crate::motion::contact::NOMINAL_LEG_LENGTH_M;
use kinopt_kinematics::spatial::Vector3;

/// Distance from the touchdown position at which a contact counts as lost, metres for a leg of 0.9 m.
const LOST_CONTACT_DISTANCE: f64 = 0.03;
/// Height above its lowest position up to which a point without a subject is in contact, metres for a leg of 0.9 m.
const MAX_CONTACT_HEIGHT: f64 = 0.02;
/// Quantile of the heights of a point that counts as its lowest position.
const LOWEST_QUANTILE: f64 = 0.05;

/// Feet of a motion, with the person if there is one.
pub(super) struct ScoredFeet<'a> {
    pub(super) points: &'a BodyPoints,
    pub(super) model: &'a PointTrack,
    /// Positions of the subject, in the capture's unit.
    pub(super) subject: Option<&'a PointTrack>,
    pub(super) detection: ContactDetection,
    pub(super) frame_rate: f64,
    /// Leg length of the model, metres.
    pub(super) leg: f64,
    /// Ratio of the model's leg length to the subject's.
    pub(super) scale: f64,
}

impl ScoredFeet<'_> {
    /// Measures the contacts of all points in contact; `None` without such points.
    pub(super) fn motion(&self) -> Option<FootMotion> {
        let points = self.points.points.iter().enumerate();
        let feet: Vec<_> = points.filter(|(_, point)| point.makes_contact).collect();
        if feet.is_empty() {
            return None;
        }
        let (mut slides, mut speeds, mut lost_contacts) = (Vec::new(), Vec::new(), Vec::new());
        let lost_distance = LOST_CONTACT_DISTANCE * self.size();
        for (index, point) in feet {
            let positions = self.model.of_point(index);
            for span in self.spans(index, &positions) {
                let positions = &positions[span.clone()];
                let Some(touchdown) = positions.first() else {
                    continue;
                };
                let distances = positions.iter().map(|at| horizontal(*at - *touchdown));
                slides.push(distances.fold(0.0, f64::max));
                let steps = positions.windows(2);
                speeds.extend(steps.map(|step| horizontal(step[1] - step[0]) * self.frame_rate));
                let mut distances = positions.iter().map(|at| (*at - *touchdown).norm());
                let lost = distances.position(|distance| distance > lost_distance);
                if let Some(sample) = lost.filter(|_| self.subject.is_some()) {
                    lost_contacts.push(LostSubjectContact {
                        frame: span.start + sample,
                        joint: point.joint_name.clone(),
                    });
                }
            }
        }
        Some(FootMotion {
            of_subject: self.subject.is_some(),
            contacts: slides.len(),
            sliding: Spread::of(slides),
            sliding_speed: Spread::of(speeds),
            lost_contacts,
        })
    }

    /// Size of the model relative to a body with legs of 0.9 m.
    fn size(&self) -> f64 {
        match self.leg > 0.0 {
            true => self.leg / NOMINAL_LEG_LENGTH_M,
            false => 1.0,
        }
    }

    /// Spans of samples in which a point is in contact.
    fn spans(&self, point: usize, model: &[Vector3<f64>]) -> Vec<Range<usize>> {
        match self.subject {
            Some(subject) => {
                let positions: Vec<_> = subject.of_point(point);
                let positions: Vec<_> = positions.iter().map(|at| *at * self.scale).collect();
                let lowest = lowest(&positions);
                let detection = self
                    .detection
                    .with_speed(self.detection.speed * self.size());
                detection.spans(
                    &positions,
                    |frame| positions[frame].z - lowest,
                    self.frame_rate,
                )
            }
            None => {
                let highest = lowest(model) + MAX_CONTACT_HEIGHT * self.size();
                spans_where(model.len(), |sample| model[sample].z <= highest)
            }
        }
    }
}

/// Lowest height of a point, without outliers.
fn lowest(positions: &[Vector3<f64>]) -> f64 {
    let mut heights: Vec<f64> = positions.iter().map(|at| at.z).collect();
    heights.sort_by(f64::total_cmp);
    let rank = (LOWEST_QUANTILE * heights.len() as f64) as usize;
    heights.get(rank).copied().unwrap_or(0.0)
}

fn horizontal(vector: Vector3<f64>) -> f64 {
    (vector.x * vector.x + vector.y * vector.y).sqrt()
}

/// Spans of at least two samples in which a condition holds.
fn spans_where(samples: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for sample in (0..samples).filter(|sample| holds(*sample)) {
        match spans.last_mut() {
            Some(span) if span.end == sample => span.end += 1,
            _ => spans.push(sample..sample + 1),
        }
    }
    spans.retain(|span| span.len() > 1);
    spans
}
