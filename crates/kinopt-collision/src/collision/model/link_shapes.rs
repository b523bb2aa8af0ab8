//! Shapes grouped by link, for repeated distance queries.

use super::CollisionModel;
use crate::collision::sphere_model::enclosing;
use crate::collision::{Ball, Separation, Shape, separation_within};
use kinopt_kinematics::spatial::Placement;

/// Shapes of one link.
#[derive(Clone, Debug)]
pub(super) struct LinkShapes {
    /// Shapes with their placements in the link's frame.
    shapes: Vec<(Placement<f64>, Shape)>,
    /// Bounding sphere of all shapes, in the link's frame.
    ball: Ball,
}

impl LinkShapes {
    /// Separation from another link's shapes, if it is at most `max_distance` metres. Both placements are in the world.
    pub(super) fn separation(
        &self,
        world_from_link: &Placement<f64>,
        other: &Self,
        world_from_other: &Placement<f64>,
        max_distance: f64,
    ) -> Option<Separation> {
        let [a, b] = [(self, world_from_link), (other, world_from_other)];
        let between = b.1.apply(b.0.ball.centre) - a.1.apply(a.0.ball.centre);
        if between.norm() > a.0.ball.radius + b.0.ball.radius + max_distance {
            return None;
        }
        let mut nearest: Option<Separation> = None;
        for (link_from_first, first) in &self.shapes {
            let world_from_first = *world_from_link * *link_from_first;
            for (other_from_second, second) in &other.shapes {
                let world_from_second = *world_from_other * *other_from_second;
                let max_distance = nearest.map_or(max_distance, |nearest| nearest.distance);
                let placements = (&world_from_first, &world_from_second);
                let separation =
                    separation_within(first, placements.0, second, placements.1, max_distance);
                nearest = separation.or(nearest);
            }
        }
        nearest
    }
}

impl CollisionModel {
    /// Shapes of each link with shapes, in the order of [`links`](Self::links).
    pub(super) fn link_shapes(&self) -> Vec<LinkShapes> {
        let of_link = |link| {
            let objects = self.objects_of(link);
            let ball = |object: &super::CollisionObject| {
                let Ball { centre, radius } = object.shape.bounding_sphere();
                let centre = object.link_from_shape.apply(centre);
                Ball { centre, radius }
            };
            let balls: Vec<Ball> = self.objects_of(link).map(ball).collect();
            LinkShapes {
                shapes: objects
                    .map(|object| (object.link_from_shape, object.shape.clone()))
                    .collect(),
                ball: enclosing(&balls),
            }
        };
        self.links.iter().map(|link| of_link(*link)).collect()
    }
}
