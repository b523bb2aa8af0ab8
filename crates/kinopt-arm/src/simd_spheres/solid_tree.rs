//! Large sets of solids, with an AABB tree.

use kinopt_collision::collision::dynamic_aabb_tree::{DynamicAabbTree, ItemChange};
pub(super) use kinopt_collision::collision::wide_aabb_tree::Predicate;
use kinopt_collision::collision::{BoundingBox, Shape};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A shape and the inverse of its placement in the chain's base frame.
type TreeSolid = (Shape, Placement<f64>);

/// Placed shapes with an AABB tree over their boxes.
#[derive(Clone, Debug)]
pub(super) struct SolidTree {
    solids: DynamicAabbTree<TreeSolid>,
}

/// A number with its new shape and placement in the base frame; `None` removes the shape.
pub(super) type SolidChange<'a> = (u64, Option<(&'a Shape, Placement<f64>)>);

impl SolidTree {
    /// Builds the tree. The shapes must be bounded.
    pub(super) fn new<'a>(
        solids: impl IntoIterator<Item = (u64, &'a Shape, Placement<f64>)>,
    ) -> Self {
        let solids = solids.into_iter().map(|(number, shape, base_from_solid)| {
            let (placed, bounds) = placed(shape, &base_from_solid);
            (number, placed, bounds)
        });
        Self {
            solids: DynamicAabbTree::new(solids),
        }
    }

    /// A copy with changes, which are in the order of their numbers.
    pub(super) fn changed(&self, changes: &[SolidChange<'_>]) -> Self {
        let changes = changes
            .iter()
            .map(|(number, new_solid)| -> ItemChange<TreeSolid> {
                (*number, new_solid.map(|(shape, at)| placed(shape, &at)))
            });
        Self {
            solids: self.solids.changed(changes.collect()),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// True if a point in the base frame is in a shape or nearer to it than `reach` metres.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near(&self, point: Vector3<f64>, reach: f64) -> bool {
        self.solids.any(point, reach, &NearPoint { point, reach })
    }
}

/// Predicate: a shape is nearer to the point than `reach`.
struct NearPoint {
    point: Vector3<f64>,
    reach: f64,
}

impl Predicate<&TreeSolid> for NearPoint {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, (shape, solid_from_base): &TreeSolid) -> bool {
        shape.is_within(solid_from_base.apply(self.point), self.reach)
    }
}

fn placed(shape: &Shape, base_from_solid: &Placement<f64>) -> (TreeSolid, BoundingBox) {
    let bounds = shape.bounding_box().placed(base_from_solid);
    ((shape.clone(), base_from_solid.inverse()), bounds)
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "it is a test")]
mod tests {
    use super::*;
    use kinopt_collision::collision::ShapeError;
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::scalar::elementary;
    use kinopt_kinematics::spatial::Matrix3;

    /// Random numbers, points and shapes.
    struct Numbers(RandomStream);

    impl Numbers {
        fn new(seed: u64) -> Self {
            Self(RandomStream::new(seed, 0))
        }

        /// The next number, in [-1, 1).
        fn next(&mut self) -> f64 {
            2.0 * self.0.unit() - 1.0
        }

        /// A point with each coordinate in [-`size`, `size`).
        fn point(&mut self, size: f64) -> Vector3<f64> {
            Vector3::new(self.next(), self.next(), self.next()) * size
        }

        fn placement(&mut self) -> Placement<f64> {
            let [x, z] = [(); 2].map(|()| elementary::sin_cos(3.0 * self.next()));
            let rotation = Matrix3::identity().rotated_about_z(z).rotated_about_x(x);
            Placement::new(rotation, self.point(1.0))
        }

        /// A cube with one corner moved, open or closed.
        fn mesh(&mut self, size: f64) -> Result<Shape, ShapeError> {
            let corner = |i: u32| {
                let along = |bit| if i & bit == 0 { -size } else { size };
                Vector3::new(along(1), along(2), along(4))
            };
            let mut corners: Vec<_> = (0..8).map(corner).collect();
            corners[7] = self.point(size);
            let sides = [
                [0, 2, 3, 1],
                [4, 5, 7, 6],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 4, 6, 2],
                [1, 3, 7, 5],
            ];
            let triangles = sides
                .into_iter()
                .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
            let open = usize::from(self.next() > 0.0);
            Shape::mesh(corners, triangles.skip(open).collect())
        }

        fn shape(&mut self) -> Shape {
            let size = 0.06 + 0.04 * self.next();
            let shape = match (8.0 * self.0.unit()) as u32 {
                0 => Shape::sphere(size),
                1 => Shape::cylinder(size, 0.05),
                2 => Shape::capsule(size, 0.05),
                3 => Shape::cuboid([size, 0.02, 0.1]),
                4 => Shape::convex(&[(); 20].map(|()| self.point(0.1))),
                5 => self.mesh(0.1),
                6 => {
                    let heights = [(); 12].map(|()| 0.05 * self.next());
                    Shape::height_field(heights.to_vec(), 4, [0.05; 2])
                }
                _ => Shape::points((0..100).map(|_| self.point(0.2)).collect(), 0.004),
            };
            shape.expect("a shape of a size")
        }
    }

    type Known = (u64, Shape, Placement<f64>);

    fn is_near(solids: &[Known], point: Vector3<f64>, reach: f64) -> bool {
        let near = |(_, shape, at): &Known| {
            let point = at.inverse().apply(point);
            shape.signed_distance(point) < reach
        };
        solids.iter().any(near)
    }

    /// Compares point queries with a linear search over all solids.
    fn check_queries(
        solid_tree: &SolidTree,
        solids: &[Known],
        numbers: &mut Numbers,
        counts: &mut [usize; 2],
    ) {
        for _ in 0..4_000 {
            let point = numbers.point(1.3);
            let reach = 0.05 + 0.05 * numbers.next();
            let near = is_near(solids, point, reach);
            assert_eq!(solid_tree.near(point, reach), near, "{point:?} {reach}");
            counts[usize::from(near)] += 1;
        }
    }

    #[test]
    fn solid_tree_matches_linear_search() {
        let numbers = &mut Numbers::new(1);
        let mut placed = |number| {
            let shape = numbers.shape();
            (number, shape, numbers.placement())
        };
        let mut solids: Vec<Known> = (0..400).map(&mut placed).collect();
        let all = solids
            .iter()
            .map(|(number, shape, at)| (*number, shape, *at));
        let mut solid_tree = SolidTree::new(all);
        let mut counts = [0; 2];
        let first = solid_tree.clone();
        let before = solids.clone();
        for change in 0..6 {
            check_queries(
                &solid_tree,
                &solids,
                &mut Numbers::new(10 + change),
                &mut counts,
            );
            let number = 7 * change;
            let moved = placed(number);
            solid_tree =
                solid_tree.changed(&[(number, Some((&moved.1, moved.2))), (number + 1, None)]);
            solids.retain(|(known, ..)| *known != number && *known != number + 1);
            solids.push(moved);
        }
        assert!(solid_tree.solids.has_new() && solid_tree.solids.shares_old(&first.solids));
        check_queries(&first, &before, &mut Numbers::new(99), &mut counts);
        assert!(counts.iter().all(|&count| count > 4_000), "{counts:?}");
    }
}
