//! Promise: so it is for what a box of bounds allows, holds and leaves.
#![allow(clippy::unwrap_used)]

use kinopt::solver::ConfigurationSpace;
use support::random::Random;

use crate::digest::{Digest, Value, check};

/// What a box of bounds allows.
fn boxes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(142));
    let lower = [f64::NEG_INFINITY, -1.0, 0.5, -0.2];
    let upper = [f64::INFINITY, 1.0, 0.5, f64::INFINITY];
    let space = ConfigurationSpace::new(&lower, &upper);
    digest.noted(&[space.is_of(4), space.is_of(3)]);
    for case in 0..12 {
        let mut x: Vec<f64> = (0..4).map(|_| random.within(-2.0, 2.0)).collect();
        let step: Vec<f64> = (0..4).map(|_| random.within(-2.0, 2.0)).collect();
        if case % 3 > 0 {
            space.project(&mut x);
        }
        digest.doubles(x.iter().copied());
        let mut to = x.clone();
        space.integrate(&x, &step, &mut to);
        digest.doubles(to.iter().copied());
        space.integrate_share(&x, 0.3, &step, &mut to);
        let mut way = x.clone();
        space.difference(&to, &x, &mut way);
        digest.doubles(way.iter().copied());
        digest.doubles([space.distance(&to, &x, &mut way)]);
        digest.doubles([space.projected_gradient_norm(&x, &step, 2.0)]);
        for (k, &own) in step.iter().enumerate() {
            digest.doubles([space.integrate_one(&x, k, 0.1, &mut to)]);
            space.return_one(&x, k, &mut to);
            let (down, up) = space.room(&x, k);
            digest.doubles([down, up]);
            digest.noted(&(
                space.stopped_step(&x, k, own),
                space.stopped_step(&x, k, 0.01),
            ));
            for slope in [-1.0, 0.0, 1e-4, 1.0] {
                digest.noted(&(
                    space.held_at(&x, k, slope, 1e-3),
                    space.holds(&x, k, slope, 0.0),
                ));
            }
        }
        digest.doubles(to);
    }
    digest.value()
}

#[test]
fn of_boxes() {
    check(&[("what a box of bounds allows", boxes())]);
}
