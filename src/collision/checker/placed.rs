//! Shapes of a part where they stand.

use crate::collision::{Separation, Shape, separation_within};
use crate::spatial::{Placement, Vector3};

/// A part's shape where it stands, and the ball around it.
pub(super) struct Placed<'a> {
    pub(super) shape: &'a Shape,
    pub(super) world_from_shape: Placement<f64>,
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
}

impl<'a> Placed<'a> {
    pub(super) fn new(shape: &'a Shape, world_from_shape: Placement<f64>) -> Self {
        let ball = shape.bounding_sphere();
        Self {
            shape,
            centre: world_from_shape.apply(ball.centre),
            radius: ball.radius,
            world_from_shape,
        }
    }
}

/// The least distance of two parts, if that is at most `within`.
pub(super) fn part_to_part(a: &[Placed<'_>], b: &[Placed<'_>], within: f64) -> Option<Separation> {
    let mut nearest: Option<Separation> = None;
    for first in a {
        for second in b {
            // By the balls around them.
            let reach = first.radius + second.radius + within;
            if (first.centre - second.centre).norm_squared() > reach * reach {
                continue;
            }
            let separation = separation_within(
                first.shape,
                &first.world_from_shape,
                second.shape,
                &second.world_from_shape,
                within,
            );
            if let Some(separation) = separation {
                keep_nearer(&mut nearest, separation);
            }
        }
    }
    nearest
}

fn keep_nearer(nearest: &mut Option<Separation>, other: Separation) {
    if nearest
        .as_ref()
        .is_none_or(|known| other.distance < known.distance)
    {
        *nearest = Some(other);
    }
}
