//! Shapes of a part with their placements.

use crate::collision::{Ball, Separation, Shape, separation_within};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A shape of a part.
#[derive(Clone, Debug)]
pub(super) struct PartShape {
    pub(super) shape: Shape,
    pub(super) part_from_shape: Placement<f64>,
    /// Bounding sphere in the shape's frame. Stored, since bounding a hull of thousands of vertices takes as long as a
    /// check.
    pub(super) ball: Ball,
}

/// Placement of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedShape {
    pub(super) world_from_shape: Placement<f64>,
    /// Centre of its bounding sphere in the world.
    pub(super) centre: Vector3<f64>,
}

impl PlacedShape {
    pub(super) fn unplaced() -> Self {
        Self {
            world_from_shape: Placement::identity(),
            centre: Vector3::zero(),
        }
    }
}

/// The shapes of a part, with their placements in the same order.
pub(super) type PlacedShapes<'a> = (&'a [PartShape], &'a [PlacedShape]);

impl PartShape {
    pub(super) fn new(shape: Shape, part_from_shape: Placement<f64>) -> Self {
        Self {
            ball: shape.bounding_sphere(),
            shape,
            part_from_shape,
        }
    }

    pub(super) fn placed(&self, world_from_part: &Placement<f64>) -> PlacedShape {
        let world_from_shape = *world_from_part * self.part_from_shape;
        PlacedShape {
            centre: world_from_shape.apply(self.ball.centre),
            world_from_shape,
        }
    }
}

/// The smallest separation of two parts, if it is at most `max_distance` metres.
pub(super) fn part_to_part(
    a: PlacedShapes<'_>,
    b: PlacedShapes<'_>,
    max_distance: f64,
) -> Option<Separation> {
    let mut nearest: Option<Separation> = None;
    for (first, first_placed) in a.0.iter().zip(a.1) {
        for (second, second_placed) in b.0.iter().zip(b.1) {
            // Rejects by bounding spheres.
            let reach = first.ball.radius + second.ball.radius + max_distance;
            if (first_placed.centre - second_placed.centre).norm_squared() > reach * reach {
                continue;
            }
            let separation = separation_within(
                &first.shape,
                &first_placed.world_from_shape,
                &second.shape,
                &second_placed.world_from_shape,
                max_distance,
            );
            if let Some(separation) = separation {
                update_nearest(&mut nearest, separation);
            }
        }
    }
    nearest
}

fn update_nearest(nearest: &mut Option<Separation>, other: Separation) {
    if nearest
        .as_ref()
        .is_none_or(|current| other.distance < current.distance)
    {
        *nearest = Some(other);
    }
}
