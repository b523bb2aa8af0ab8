//! How fast an arm goes on towards where it rests.

/// How much slower where a motion turns back, and faster where it goes on.
const SLOWER: f64 = 0.5;
const FASTER: f64 = 1.02;
/// A cost above this share of the last one's does not fall.
const STILL: f64 = 0.999;

/// The share of its speed that an arm takes while its target rests out of reach: less where it goes back
/// and forth, so that it comes to rest.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    pub(super) share: f64,
    last: Vec<f64>,
    cost: f64,
}

impl Pace {
    pub(super) fn new(joints: usize) -> Self {
        Self {
            share: 1.0,
            last: vec![0.0; joints],
            cost: 0.0,
        }
    }

    /// After a step by `motion`, a joint each, to a place of this cost; whether that missed the last step's
    /// target once more.
    pub(super) fn after(&mut self, again: bool, cost: f64, motion: impl Iterator<Item = f64>) {
        let mut along = 0.0;
        for (last, by) in self.last.iter_mut().zip(motion) {
            along += *last * by;
            *last = by;
        }
        let turns_back = along < 0.0 && cost > STILL * self.cost;
        self.cost = cost;
        self.share = match again {
            true if turns_back => self.share * SLOWER,
            true => (self.share * FASTER).min(1.0),
            false => 1.0,
        };
    }
}
