//! A movement on a model, and how well it follows.

use crate::spatial::Vector3;

/// A movement on a model.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Retargeted {
    /// Configurations, frame after frame.
    pub q: Vec<f64>,
    /// How many numbers a configuration has.
    pub configuration_len: usize,
    /// Frames a second.
    pub frame_rate: f64,
    /// The frames of the model that stand at times.
    pub standing: Vec<String>,
    /// Whether each of them stands, frame after frame.
    pub contacts: Vec<bool>,
    /// How far the driven points are from where they should be, in the mean over all frames, metres.
    pub mean_error: f64,
    /// How far a point that stands is from where it came to stand, at most, metres.
    pub slip: f64,
}

impl Retargeted {
    /// How many frames there are.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.q.len() / self.configuration_len.max(1)
    }
}

/// Collects how far points are from their targets, and from where they came to stand.
#[derive(Debug)]
pub(super) struct Measures {
    sum: f64,
    count: usize,
    anchors: Vec<Option<Vector3<f64>>>,
    pub(super) slip: f64,
}

impl Measures {
    pub(super) fn new(limbs: usize) -> Self {
        Self {
            sum: 0.0,
            count: 0,
            anchors: vec![None; limbs],
            slip: 0.0,
        }
    }

    /// Takes one limb of one frame.
    pub(super) fn take(
        &mut self,
        limb: usize,
        at: Vector3<f64>,
        target: Vector3<f64>,
        stands: bool,
    ) {
        self.sum += (at - target).norm();
        self.count += 1;
        let anchor = &mut self.anchors[limb];
        match stands {
            false => *anchor = None,
            true => {
                let slipped = (at - *anchor.get_or_insert(at)).norm();
                self.slip = self.slip.max(slipped);
            }
        }
    }

    pub(super) fn mean_error(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}
