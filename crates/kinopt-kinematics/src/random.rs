//! Reproducible pseudorandom numbers: SplitMix64.
//!
//! Source: Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators". A crate's generator may change
//! with its version; solutions must not.

/// A stream of pseudorandom numbers for one (seed, index).
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct RandomStream {
    state: u64,
}

const GOLDEN_GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

impl RandomStream {
    /// The stream of one numbered attempt. Streams of different indices are independent.
    #[doc(hidden)]
    pub fn new(seed: u64, index: u64) -> Self {
        let mut outer = Self { state: seed };
        let base = outer.next();
        let mut inner = Self {
            state: base ^ index.wrapping_mul(GOLDEN_GAMMA),
        };
        inner.next();
        inner
    }

    /// The next 64 bits.
    pub(crate) fn next(&mut self) -> u64 {
        let bits = mix(self.state);
        self.state = self.state.wrapping_add(GOLDEN_GAMMA);
        bits
    }

    /// A number sampled uniformly within [0, 1).
    #[doc(hidden)]
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The 64 output bits of the generator at a state.
#[doc(hidden)]
pub fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(GOLDEN_GAMMA);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
