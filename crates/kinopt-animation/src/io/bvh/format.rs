//! Frame rate and channels of a written BVH file.

use super::BvhChannel;
use crate::io::FormatError;

/// Frame rate and channels of a written BVH file.
///
/// A number converts to a format with that many frames per second and the default channels.
/// [`MotionCapture::format`](super::MotionCapture::format) is the format of a capture that was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhFormat<'a> {
    /// Time between frames, seconds.
    frame_time: f64,
    /// Frames per second, for messages.
    rate: f64,
    channels: Option<&'a [Vec<BvhChannel>]>,
}

impl From<f64> for BvhFormat<'_> {
    /// Format with a number of frames per second.
    fn from(rate: f64) -> Self {
        Self {
            frame_time: 1.0 / rate,
            rate,
            channels: None,
        }
    }
}

impl<'a> BvhFormat<'a> {
    /// Format with a time between frames, in seconds.
    #[must_use]
    pub fn of_frame_time(frame_time: f64) -> Self {
        Self {
            frame_time,
            rate: 1.0 / frame_time,
            channels: None,
        }
    }

    /// Sets the channels of each bone, in file order.
    #[must_use]
    pub fn with_channels(mut self, channels: &'a [Vec<BvhChannel>]) -> Self {
        self.channels = Some(channels);
        self
    }

    /// Time between frames, seconds.
    #[must_use]
    pub fn frame_time(&self) -> f64 {
        self.frame_time
    }

    /// The channels of each bone; `None` for the default channels.
    #[must_use]
    pub fn channels(&self) -> Option<&'a [Vec<BvhChannel>]> {
        self.channels
    }

    /// Checks that the frame time is positive and finite, also in single precision.
    pub(super) fn check(&self) -> Result<(), FormatError> {
        let time = self.frame_time as f32;
        if time > 0.0 && time.is_finite() {
            Ok(())
        } else {
            Err(self.rate_error())
        }
    }

    pub(super) fn rate_error(&self) -> FormatError {
        FormatError::Rate { rate: self.rate }
    }

    /// Frames per second.
    pub(super) fn rate(&self) -> f64 {
        self.rate
    }
}
