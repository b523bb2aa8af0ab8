//! Angles between the limbs of a subject and of a model.

use super::body_points::{BodyPoints, PointTrack};
use super::definitions::LIMBS;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;

/// Limb whose points exist.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ComparedLimb {
    pub(super) name: &'static str,
    from: Vec<usize>,
    to: Vec<usize>,
}

impl ComparedLimb {
    /// Returns the limbs that a body's points determine.
    pub(super) fn all_of(points: &BodyPoints) -> Vec<Self> {
        let limbs = LIMBS.iter().filter_map(|limb| {
            let is_replaced = limb
                .unless
                .is_some_and(|point| points.index(point).is_some());
            let [from, to] = [limb.from, limb.to].map(|ends| points.first_of(ends));
            let (from, to) = (from?, to?);
            (!is_replaced && from != to).then_some(Self {
                name: limb.name,
                from,
                to,
            })
        });
        limbs.collect()
    }

    /// Vector along the limb at a sample, in the unit of the track.
    pub(super) fn direction(&self, track: &PointTrack, sample: usize) -> Vector3<f64> {
        track.mean(sample, &self.to) - track.mean(sample, &self.from)
    }

    /// Angle between the limbs of subject and model at a sample, degrees; 0 if one has no direction.
    pub(super) fn angle(&self, subject: &PointTrack, model: &PointTrack, sample: usize) -> f64 {
        let [a, b] = [subject, model].map(|track| self.direction(track, sample));
        elementary::atan2(a.cross(b).norm(), a.dot(b)).to_degrees()
    }
}

/// Returns the unit vector; zero for the zero vector.
pub(super) fn unit(vector: Vector3<f64>) -> Vector3<f64> {
    match vector.norm() {
        0.0 => vector,
        length => vector * (1.0 / length),
    }
}
