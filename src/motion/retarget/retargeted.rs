//! A movement on a model, and how well it follows.

use crate::problem::Collision;
use crate::spatial::Vector3;

/// What stands and is farther than this from where it came to stand, metres, stands no more.
const SLIPPED: f64 = 1e-3;

/// A movement on a model.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// The point of each that stands, in its coordinates, metres: two of one frame are its ball and its toes, say.
    pub standing_at: Vec<Vector3<f64>>,
    /// Whether each of them stands, frame after frame.
    pub contacts: Vec<bool>,
    /// How far the driven points are from where they should be, in the mean over all frames, metres.
    pub mean_error: f64,
    /// How far a point that stands is from where it came to stand, at most, metres.
    pub slip: f64,
    /// How deep the lowest point of a foot with a shape is in the ground, at most, metres; 0 where none is.
    pub sunk: f64,
    /// What could not be held until the person let go of it, as limits win: from each of these frames on it stands no more.
    pub given_up: Vec<GivenUp>,
    /// The frames in which something touches all the same, where the body is to keep clear: of a movement frame by frame only
    /// those from the first on, until one is free.
    pub touching: Vec<Touching>,
}

/// What touches in a frame.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Touching {
    /// The frame.
    pub frame: usize,
    /// The pair that is nearest, or deepest.
    pub pair: Collision,
}

/// What stood, and could be held no longer.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GivenUp {
    /// The first frame in which it has slipped by more than a millimetre.
    pub frame: usize,
    /// The frame of the model, as in [`Retargeted::standing`].
    pub standing: String,
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
    footing: Vec<Footing>,
    pub(super) slip: f64,
    pub(super) sunk: f64,
    /// The frames in which limbs were given up.
    pub(super) given_up: Vec<(usize, usize)>,
}

/// Whether a limb stands, and where it came to.
#[derive(Clone, Copy, Debug)]
enum Footing {
    None,
    At(Vector3<f64>),
    GivenUp,
}

impl Measures {
    pub(super) fn new(limbs: usize) -> Self {
        Self {
            sum: 0.0,
            count: 0,
            footing: vec![Footing::None; limbs],
            slip: 0.0,
            sunk: 0.0,
            given_up: Vec::new(),
        }
    }

    /// Takes one limb of one frame, which should stand or not; whether it does.
    pub(super) fn take(
        &mut self,
        frame: usize,
        limb: usize,
        at: Vector3<f64>,
        target: Vector3<f64>,
        stands: bool,
    ) -> bool {
        self.sum += (at - target).norm();
        self.count += 1;
        let footing = &mut self.footing[limb];
        match (stands, *footing) {
            (false, _) => *footing = Footing::None,
            (true, Footing::None) => *footing = Footing::At(at),
            (true, Footing::At(place)) => {
                let slipped = (at - place).norm();
                if slipped > SLIPPED {
                    *footing = Footing::GivenUp;
                    self.given_up.push((frame, limb));
                } else {
                    self.slip = self.slip.max(slipped);
                }
            }
            (true, Footing::GivenUp) => {}
        }
        matches!(footing, Footing::At(_))
    }

    pub(super) fn mean_error(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::Measures;
    use crate::spatial::Vector3;

    #[test]
    fn what_has_slipped_stands_again_only_after_it_was_let_go() {
        let mut measures = Measures::new(1);
        let mut take = |frame: usize, x: f64, stands: bool| {
            let at = Vector3::new(x, 0.0, 0.0);
            measures.take(frame, 0, at, at, stands)
        };
        assert!(take(0, 0.0, true) && take(1, 0.9e-3, true));
        // A slide is told once, however long it is.
        for frame in 2..9 {
            assert!(!take(frame, 2e-3 * frame as f64, true), "{frame}");
        }
        assert!(!take(9, 0.1, false) && take(10, 0.1, true));
        assert_eq!(measures.given_up, [(2, 0)]);
        assert_eq!(measures.slip, 0.9e-3);
    }
}
