//! Seeded random numbers and the cases of randomised tests.
//!
//! `KINOPT_CASES` sets the number of cases. A test that fails prints the seeds of its generators and the case.

use std::fmt;

use super::{Rigid, rigid};
use nalgebra as na;

/// The recurrence of a generator.
#[derive(Clone, Copy, Debug)]
enum Recurrence {
    /// Marsaglia's xorshift64*.
    XorShift,
    /// SplitMix64 of Steele, Lea and Flood.
    SplitMix,
}

/// A seeded generator, independent of the library's. It prints its seed if a test panics.
#[derive(Clone)]
pub struct Random {
    seed: u64,
    state: u64,
    recurrence: Recurrence,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        let state = seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ 0x1234_5678_9ABC_DEF1;
        let mut generator = Self {
            seed,
            state,
            recurrence: Recurrence::XorShift,
        };
        for _ in 0..8 {
            generator.bits();
        }
        generator
    }

    /// The SplitMix64 sequence that starts at `seed`.
    pub fn split_mix(seed: u64) -> Self {
        Self {
            seed,
            state: seed,
            recurrence: Recurrence::SplitMix,
        }
    }

    pub fn bits(&mut self) -> u64 {
        match self.recurrence {
            Recurrence::XorShift => {
                self.state ^= self.state >> 12;
                self.state ^= self.state << 25;
                self.state ^= self.state >> 27;
                self.state.wrapping_mul(0x2545_F491_4F6C_DD1D)
            }
            Recurrence::SplitMix => {
                self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
                let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                z ^ (z >> 31)
            }
        }
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 33) as usize % count
    }

    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// Uniform in the cube of half side `size`.
    pub fn vector(&mut self, size: f64) -> na::Vector3<f64> {
        na::Vector3::from_fn(|_, _| self.within(-size, size))
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> na::Unit<na::Vector3<f64>> {
        loop {
            let v = self.vector(1.0);
            if (0.1..1.0).contains(&v.norm()) {
                return na::Unit::new_normalize(v);
            }
        }
    }

    /// Rotation about a random axis by up to π.
    pub fn rotation(&mut self) -> na::Rotation3<f64> {
        let angle = self.within(-std::f64::consts::PI, std::f64::consts::PI);
        na::Rotation3::from_axis_angle(&self.direction(), angle)
    }

    pub fn rigid(&mut self, size: f64) -> Rigid {
        rigid(self.rotation(), self.vector(size))
    }
}

impl fmt::Debug for Random {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of seed {}", self.recurrence, self.seed)
    }
}

impl Drop for Random {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("random numbers: {self:?}");
        }
    }
}

/// Number of cases: the first number in a release build, the second in a debug build, or `KINOPT_CASES`.
pub fn case_count(release: usize, debug: usize) -> usize {
    let requested = std::env::var("KINOPT_CASES").ok();
    let usual = if cfg!(debug_assertions) {
        debug
    } else {
        release
    };
    requested.map_or(usual, |count| count.parse().unwrap())
}

/// Indices of the cases, as many as [`case_count`] returns. A panic prints the index of its case.
pub fn cases(release: usize, debug: usize) -> Cases {
    Cases {
        next: 0,
        count: case_count(release, debug),
    }
}

/// Indices of the cases of a test.
pub struct Cases {
    next: usize,
    count: usize,
}

impl Iterator for Cases {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let index = (self.next < self.count).then_some(self.next);
        self.next += usize::from(index.is_some());
        index
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.count - self.next;
        (left, Some(left))
    }
}

impl Drop for Cases {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let case = self.next.saturating_sub(1);
            eprintln!("case {case} of {} (set by KINOPT_CASES)", self.count);
        }
    }
}

/// True if a test checks only a part of its cases: in a debug build, unless `KINOPT_CASES` is set.
pub fn few() -> bool {
    cfg!(debug_assertions) && std::env::var_os("KINOPT_CASES").is_none()
}

/// All items, or every `every`-th item in a debug build.
pub fn part<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if few() { every } else { 1 })
}
