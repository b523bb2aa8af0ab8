//! Promise: so it is for triangles of two bones and for chains of points, before there is a model.
#![allow(clippy::unwrap_used)]

use kinopt::geometric::{Span, fabrik, triangle};
use kinopt::spatial::Vector3;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::vector;

fn triangles() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(161));
    for case in 0..80 {
        let root = vector(&mut random, 0.2);
        let lengths = [0.5, [0.5, 0.3, 0.8, 0.0][case % 4]];
        let towards = match case % 7 {
            0 => Vector3::zero(),
            1 => Vector3::UNITS[case % 3],
            _ => vector(&mut random, 1.0),
        };
        let target = match case % 9 {
            0 => root,
            1 => root + towards * 0.5,
            2 => root + Vector3::UNITS[case % 3] * (lengths[0] + lengths[1]),
            3 => root + Vector3::UNITS[case % 3] * 1e-3,
            _ => root + vector(&mut random, 0.9),
        };
        digest.noted(&triangle(root, lengths, target, towards));
    }
    for lengths in [&[0.5, 0.2, 0.1][..], &[0.3, 0.3, 0.3], &[0.4], &[]] {
        for distance in [0.0, 0.1, 0.2, 0.5, 0.9, 1.2] {
            digest.noted(&Span::of(lengths, distance));
        }
    }
    digest.value()
}

fn points() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(162));
    for count in [0, 1, 2, 3, 5, 6] {
        for case in 0..6 {
            let mut at = Vector3::zero();
            let mut points: Vec<Vector3<f64>> = Vec::new();
            for k in 0..count {
                points.push(at);
                // One link is longer than all others, one has no length.
                let size = if k == 0 && case % 3 == 0 { 2.0 } else { 0.3 };
                at += vector(&mut random, if k == 2 && case == 5 { 0.0 } else { size });
            }
            let target = match case {
                0 => vector(&mut random, 0.1),
                1 => vector(&mut random, 9.0),
                2 => points.last().copied().unwrap_or(Vector3::zero()),
                _ => vector(&mut random, 0.7),
            };
            let (tolerance, most) = [(1e-9, 8), (0.05, 30), (0.0, 2)][case % 3];
            digest.noted(&fabrik(&mut points, target, tolerance, most));
            points
                .iter()
                .for_each(|point| digest.doubles(point.to_array()));
        }
    }
    digest.value()
}

#[test]
fn of_triangles() {
    check(&[
        ("triangles of two bones", triangles()),
        ("chains of points by FABRIK", points()),
    ]);
}
