//! Promise: so it is for shapes of every kind in pairs drawn at random: thin, tiny and large ones together, apart, in each other, in one
//! line and at one place, within every bound; and for what covers them.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Separation, Shape, separation, separation_within};
use kinopt::spatial::{Placement, Vector3};
use support::box_sides::box_triangles;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{place, vector};

/// So many kinds of shapes are drawn.
pub(crate) const KINDS: usize = 13;

/// A block with one corner drawn in, open or closed.
fn block(random: &mut Random, size: f64, open: usize) -> Shape {
    let corner = |k: u32| {
        let along = |bit| if k & bit == 0 { -size } else { size };
        Vector3::new(along(1), along(2), along(4))
    };
    let mut corners: Vec<_> = (0..8).map(corner).collect();
    corners[random.below(8)] = vector(random, size);
    let triangles = box_triangles().split_off(open);
    Shape::mesh(corners, triangles).unwrap()
}

/// A shape of a kind, about so large; the last three are flat or without end.
pub(crate) fn shape(random: &mut Random, kind: usize, size: f64) -> Shape {
    let mut length = |most: f64| {
        let share = match random.below(9) {
            0 => 1e-3,
            1 => 1.0,
            _ => random.within(0.1, 1.0),
        };
        share * size * most
    };
    match kind {
        0 => Shape::sphere(length(0.6)),
        1 => Shape::capsule(length(0.4), length(1.0)),
        2 => Shape::cylinder(length(0.5), length(1.0)),
        3 => Shape::cuboid([length(1.0), length(1.0), length(1.0)]),
        4 => Shape::ellipsoid([length(0.6), length(0.6), length(0.6)]),
        5 => {
            let count = 4 + random.below(9);
            let corners: Vec<_> = (0..count).map(|_| vector(random, 0.6 * size)).collect();
            Shape::convex(&corners)
        }
        6 => {
            let on_a_ball = (0..90).map(|_| {
                let at = vector(random, 1.0);
                at * (0.5 * size / at.norm())
            });
            Shape::convex(&on_a_ball.collect::<Vec<_>>())
        }
        7 => return block(random, 0.5 * size, 0),
        8 => {
            let open = 1 + random.below(9);
            return block(random, 0.5 * size, open);
        }
        9 => {
            let count = 1 + random.below(6);
            let places = (0..count).map(|_| vector(random, 0.5 * size)).collect();
            Shape::points(places, 0.1 * size)
        }
        10 => {
            let count = 70 + random.below(20);
            let places = (0..count).map(|_| vector(random, 0.5 * size)).collect();
            Shape::points(places, 0.03 * size)
        }
        11 => {
            let (rows, columns) = (2 + random.below(4), 2 + random.below(4));
            let heights = (0..rows * columns).map(|_| 0.3 * size * random.within(-1.0, 1.0));
            let heights = heights.collect();
            Shape::height_field(heights, columns, [0.3 * size, 0.2 * size])
        }
        _ => return Shape::half_space(),
    }
    .unwrap()
}

impl Digest {
    fn separation(&mut self, found: &Separation) {
        self.doubles([found.distance]);
        for v in [found.normal, found.on_first, found.on_second] {
            self.doubles(v.to_array());
        }
    }
}

/// Where a second shape stands in the first: anywhere about it, at its middle, along an axis of it, or far away.
fn beside(random: &mut Random, size: f64) -> Placement<f64> {
    match random.below(8) {
        0 => Placement::identity(),
        1 => Placement::translation(Vector3::UNITS[random.below(3)] * (0.7 * size)),
        2 => Placement::new(place(random, 0.0).rotation, Vector3::zero()),
        3 => Placement::translation(vector(random, 0.1 * size)),
        4 => place(random, 90.0 * size),
        5 => place(random, 0.3 * size),
        _ => place(random, 1.3 * size),
    }
}

fn pairs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(901));
    for first_kind in 0..KINDS {
        for second_kind in 0..KINDS {
            for _ in 0..3 {
                let size = [1.0, 1.0, 1e-3, 40.0][random.below(4)];
                let other = size * [1.0, 1.0, 0.05][random.below(3)];
                let first = shape(&mut random, first_kind, size);
                let second = shape(&mut random, second_kind, other);
                let at_first = match random.below(3) {
                    0 => Placement::identity(),
                    _ => place(&mut random, 2.0 * size),
                };
                let at_second = at_first * beside(&mut random, size);
                let found = separation(&first, &at_first, &second, &at_second);
                digest.separation(&found);
                let nudge = 1e-9 * size;
                for within in [
                    found.distance,
                    found.distance - nudge,
                    found.distance + 0.2 * size,
                    random.within(-0.5, 0.5) * size,
                    0.0,
                ] {
                    match separation_within(&second, &at_second, &first, &at_first, within) {
                        Some(near) => digest.separation(&near),
                        None => digest.word(3),
                    }
                }
            }
        }
    }
    digest.value()
}

/// Boxes and balls around shapes and distances of places from them, before and after they are scaled.
fn alone() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(902));
    for kind in (0..KINDS).chain(0..KINDS) {
        let size = [1.0, 1e-4, 300.0][random.below(3)];
        let own = shape(&mut random, kind, size);
        let times = [0.01, 1.0, 3.0][random.below(3)];
        for own in [own.scaled(times), Ok(own)] {
            let own = own.unwrap();
            digest.noted(&(own.bounding_box(), own.bounding_sphere(), own.notes()));
            let at = place(&mut random, size);
            let moved = own.bounding_box().placed(&at);
            digest.noted(&moved);
            let middle = own.bounding_sphere().centre;
            for _ in 0..6 {
                let from = match kind {
                    12 => Vector3::zero(),
                    _ => middle,
                };
                let by = [0.1, 0.6, 2.0][random.below(3)] * size;
                digest.doubles([own.signed_distance(from + vector(&mut random, by))]);
            }
        }
    }
    digest.value()
}

#[test]
fn of_mixed_pairs_of_shapes() {
    check(&[("shapes of every kind in mixed pairs", pairs())]);
}

#[test]
fn of_mixed_shapes() {
    check(&[("shapes of every kind and size by themselves", alone())]);
}
