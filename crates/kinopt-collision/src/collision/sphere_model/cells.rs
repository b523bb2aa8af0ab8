//! Octree decomposition of a solid into cubes, each of which must be covered by a sphere.

use super::solid::Solid;
use crate::collision::Ball;
use kinopt_kinematics::interruption::is_stopped;
use kinopt_kinematics::spatial::Vector3;

/// The part of a solid in a cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) centre: Vector3<f64>,
    /// Half the length of a side, metres.
    pub(super) half: f64,
    /// A point whose distance to all points of the part is at most the cube's half diagonal.
    pub(super) anchor: Vector3<f64>,
    /// Depth of the centre in the solid, metres; negative outside.
    pub(super) depth: f64,
}

impl Cell {
    /// The cell of a cube; `None` if the cube contains nothing of the solid.
    fn new(solid: &Solid<'_>, centre: Vector3<f64>, half: f64) -> Option<Self> {
        let probe = solid.probe(centre, half * SQRT_3)?;
        let depth = -probe.distance;
        // All points of a convex body are nearer to its closest point than to a point outside.
        let anchor = match depth < 0.0 && probe.is_convex {
            true => probe.nearest,
            false => centre,
        };
        Some(Self {
            centre,
            half,
            anchor,
            depth,
        })
    }

    fn reach(&self) -> f64 {
        self.half * SQRT_3
    }

    /// Radius of a ball about a point that contains the part for certain.
    pub(super) fn required_radius(&self, centre: Vector3<f64>) -> f64 {
        let offset = self.centre - centre;
        let corner = Vector3::new(
            offset.x.abs() + self.half,
            offset.y.abs() + self.half,
            offset.z.abs() + self.half,
        );
        corner
            .norm()
            .min((self.anchor - centre).norm() + self.reach())
    }

    /// True if a ball contains the part for certain.
    pub(super) fn is_in(&self, ball: &Ball) -> bool {
        // The required radius is at least the distance of the centres. That test needs no square root and rejects most.
        let squared_distance = (self.centre - ball.centre).norm_squared();
        squared_distance <= ball.radius * ball.radius * (1.0 + ROUNDING)
            && self.required_radius(ball.centre) <= ball.radius
    }

    /// A point of the solid, if one is known.
    pub(super) fn point(&self) -> Option<Vector3<f64>> {
        // For a centre outside, it is the closest point of a convex shape.
        (self.depth >= 0.0 || self.anchor != self.centre).then_some(self.anchor)
    }

    /// True if it is well inside the solid, so that it may stay large.
    fn is_inner(&self) -> bool {
        self.depth >= 2.0 * self.reach()
    }

    /// Splits the cube into eight.
    pub(super) fn split(&self, solid: &Solid<'_>) -> impl Iterator<Item = Self> {
        let (half, centre) = (self.half / 2.0, self.centre);
        (0..8).filter_map(move |corner: u8| {
            let along = |bit: u8| if corner & bit == 0 { -half } else { half };
            Self::new(
                solid,
                centre + Vector3::new(along(1), along(2), along(4)),
                half,
            )
        })
    }
}

/// Relative rounding of a square.
const ROUNDING: f64 = 1e-12;
const SQRT_3: f64 = 1.732_050_807_568_877_4;
/// Largest number of cells of a link.
const MAX_CELLS: usize = 4_000_000;

/// The cell that contains the whole solid.
pub(super) fn root_cell(solid: &Solid<'_>) -> Option<Cell> {
    let bounds = solid.bounds();
    let size = bounds.max - bounds.min;
    let half = 0.5 * size.x.max(size.y).max(size.z) * (1.0 + 1e-12);
    Cell::new(solid, bounds.centre(), half)
}

/// Surface cells no wider than `max_width`, and larger inner cells; `None` above the largest number of cells.
pub(super) fn cells(solid: &Solid<'_>, max_width: f64) -> Option<(Vec<Cell>, Vec<Cell>)> {
    let mut pending: Vec<Cell> = root_cell(solid).into_iter().collect();
    let (mut surface, mut inner) = (Vec::new(), Vec::new());
    while let Some(cell) = pending.pop() {
        if cell.is_inner() {
            inner.push(cell);
        } else if 2.0 * cell.half <= max_width {
            surface.push(cell);
        } else {
            pending.extend(cell.split(solid));
        }
        if surface.len() + inner.len() + pending.len() > MAX_CELLS || is_stopped() {
            return None;
        }
    }
    Some((surface, inner))
}
