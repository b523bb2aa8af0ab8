//! Trajectories of markers.

use glam::DVec3;

/// Reason why arrays are not trajectories of markers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MarkerError {
    /// There are no markers or no frames.
    #[error("the file has no markers")]
    NoMarkers,
    /// The file is shorter than its header states.
    #[error("{read} frames are complete, but the header states {stated}")]
    Truncated {
        /// Number of complete frames.
        read: usize,
        /// Number of frames in the header.
        stated: usize,
    },
    /// The frame rate is not positive.
    #[error("the frame rate is {0}, expected a positive number")]
    BadFrameRate(f64),
    /// The unit of length is unknown.
    #[error("the unit of length is `{0}`, expected m, dm, cm, mm or in")]
    UnknownUnit(String),
    /// The count of positions does not match whole frames.
    #[error("{positions} positions of {markers} markers are no whole frames")]
    NotFrames {
        /// Count of positions.
        positions: usize,
        /// Number of markers.
        markers: usize,
    },
}

/// Trajectories of markers, metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MarkerCapture {
    /// Labels of the markers, without the name of the subject.
    pub names: Vec<String>,
    /// Positions, frame by frame, marker by marker; `None` where a marker was not seen.
    pub positions: Vec<Option<DVec3>>,
    /// Frames per second.
    pub frame_rate: f64,
}

impl MarkerCapture {
    /// Creates trajectories from labels and positions in metres. The name of the subject before a colon is removed from
    /// labels.
    ///
    /// # Errors
    /// Returns an error without markers, for incomplete frames, and for a rate that is not positive.
    pub fn new(
        labels: &[String],
        positions: Vec<Option<DVec3>>,
        frame_rate: f64,
    ) -> Result<Self, MarkerError> {
        let markers = labels.len();
        if markers == 0 || positions.is_empty() {
            return Err(MarkerError::NoMarkers);
        }
        if !positions.len().is_multiple_of(markers) {
            let positions = positions.len();
            return Err(MarkerError::NotFrames { positions, markers });
        }
        if !(frame_rate > 0.0 && frame_rate.is_finite()) {
            return Err(MarkerError::BadFrameRate(frame_rate));
        }
        let names = labels.iter().map(|label| {
            let name = label.rsplit(':').next().unwrap_or(label);
            name.trim().to_owned()
        });
        Ok(Self {
            names: names.collect(),
            positions,
            frame_rate,
        })
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.positions.len() / self.names.len()
    }

    /// Index of a marker. Letter case is ignored.
    #[must_use]
    pub fn marker(&self, name: &str) -> Option<usize> {
        let is_named = |known: &String| known.eq_ignore_ascii_case(name);
        self.names.iter().position(is_named)
    }

    /// Trajectory of a marker with its gaps filled: linearly between two known positions, and constant before the first
    /// and after the last. `None` for a marker that was never seen.
    #[must_use]
    pub fn filled(&self, marker: usize) -> Option<Vec<DVec3>> {
        let trajectory = self.positions.iter().skip(marker).step_by(self.names.len());
        let trajectory: Vec<Option<DVec3>> = trajectory.copied().collect();
        let known = trajectory.iter().enumerate();
        let known: Vec<(usize, DVec3)> = known.filter_map(|(k, at)| Some((k, (*at)?))).collect();
        let ((_, start), (last, end)) = (*known.first()?, *known.last()?);
        let mut filled = vec![start; trajectory.len()];
        filled[last..].fill(end);
        for pair in known.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            for (step, position) in filled[from..=to].iter_mut().enumerate() {
                *position = a.lerp(b, step as f64 / (to - from) as f64);
            }
        }
        Some(filled)
    }
}
