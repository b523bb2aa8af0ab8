//! Subject of a motion: the captured person.

use super::ScoreError;
use super::body_points::{BodyPoints, PointTrack};
use super::heading::about_z;
use crate::motion::retarget::{Capture, UpAxis};
use kinopt_kinematics::spatial::Vector3;

/// Positions of a capture's joints that drive the points of a model, with z up, in the capture's unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Subject {
    frame_rate: f64,
    track: PointTrack,
}

impl Subject {
    pub(super) fn new(points: &BodyPoints, capture: &Capture, up: UpAxis) -> Self {
        let frames = (0..capture.frames()).filter_map(|frame| capture.frame(frame));
        let positions = frames.flat_map(|joints| {
            let points = points.points.iter();
            points.map(|point| up.turned_to_z() * joints[point.joint])
        });
        Self {
            frame_rate: capture.frame_rate(),
            track: PointTrack {
                samples: capture.frames(),
                width: points.points.len(),
                positions: positions.collect(),
            },
        }
    }

    /// Time of the last capture frame, seconds.
    fn end(&self) -> f64 {
        (self.track.samples.max(1) - 1) as f64 / self.frame_rate
    }

    /// Positions at the sample times of a motion that begins `start` seconds after the capture. Positions between
    /// capture frames are interpolated linearly. Samples after the end of the capture are left out.
    ///
    /// # Errors
    /// Returns an error if the motion begins after the end of the capture.
    pub(super) fn sampled(
        &self,
        samples: usize,
        frame_rate: f64,
        start: f64,
    ) -> Result<PointTrack, ScoreError> {
        // Frame times in files are rounded, so the end has a tolerance of half a capture frame.
        let last = (self.track.samples.max(1) - 1) as f64;
        let mut track = PointTrack {
            samples: 0,
            width: self.track.width,
            positions: Vec::with_capacity(samples * self.track.width),
        };
        for sample in 0..samples {
            let frame = (start + sample as f64 / frame_rate) * self.frame_rate;
            if frame > last + 0.5 {
                break;
            }
            let frame = frame.clamp(0.0, last);
            // Exact frames are not interpolated: their times have rounding errors.
            let nearest = frame.round();
            let frame = match (frame - nearest).abs() < 1e-6 * (1.0 + nearest) {
                true => nearest,
                false => frame,
            };
            let (from, share) = (frame.floor(), frame.fract());
            let from = from as usize;
            let to = (from + 1).min(self.track.samples - 1);
            let points = 0..self.track.width;
            track.positions.extend(points.map(|point| {
                let (a, b) = (self.track.at(from, point), self.track.at(to, point));
                a + (b - a) * share
            }));
            track.samples += 1;
        }
        match track.samples {
            0 => Err(ScoreError::StartsAfterEnd {
                start,
                end: self.end(),
            }),
            _ => Ok(track),
        }
    }
}

/// Positions rotated about z by a heading.
pub(super) fn rotated(track: &PointTrack, heading: f64) -> PointTrack {
    let rotation = about_z(heading);
    let positions = track.positions.iter();
    let positions: Vec<Vector3<f64>> = positions.map(|position| rotation * *position).collect();
    PointTrack {
        samples: track.samples,
        width: track.width,
        positions,
    }
}
