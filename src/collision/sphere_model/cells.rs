//! A solid cut into cubes, each of which must lie in a sphere.

use super::solid::Solid;
use crate::collision::Ball;
use crate::interruption::is_stopped;
use crate::spatial::Vector3;

/// The part of a solid in a cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) centre: Vector3<f64>,
    /// From the middle to a side.
    pub(super) half: f64,
    /// No point of the part is farther from here than the cube's half diagonal.
    pub(super) heart: Vector3<f64>,
    /// How deep the centre is; less than nothing outside.
    pub(super) depth: f64,
}

impl Cell {
    /// The cube, if there may be anything of the solid in it.
    fn new(solid: &Solid<'_>, centre: Vector3<f64>, half: f64) -> Option<Self> {
        let probe = solid.probe(centre, half * SQRT_3)?;
        let depth = -probe.distance;
        // Of a convex body all points are nearer to the nearest one than to what is outside.
        let heart = match depth < 0.0 && probe.is_convex {
            true => probe.nearest,
            false => centre,
        };
        Some(Self {
            centre,
            half,
            heart,
            depth,
        })
    }

    fn reach(&self) -> f64 {
        self.half * SQRT_3
    }

    /// The radius of a ball about a point that surely holds the part.
    pub(super) fn needs(&self, about: Vector3<f64>) -> f64 {
        let away = self.centre - about;
        let corner = Vector3::new(
            away.x.abs() + self.half,
            away.y.abs() + self.half,
            away.z.abs() + self.half,
        );
        corner
            .norm()
            .min((self.heart - about).norm() + self.reach())
    }

    /// Whether a ball surely holds the part.
    pub(super) fn is_in(&self, ball: &Ball) -> bool {
        // What it needs is at least the way to its middle: most are told by that, without a root.
        let away = (self.centre - ball.centre).norm_squared();
        away <= ball.radius * ball.radius * (1.0 + ROUNDING)
            && self.needs(ball.centre) <= ball.radius
    }

    /// A point of the solid, where one is known.
    pub(super) fn point(&self) -> Option<Vector3<f64>> {
        // What is outside knows one where that was the nearest.
        (self.depth >= 0.0 || self.heart != self.centre).then_some(self.heart)
    }

    /// Whether it lies well within the solid, so that it may stay large.
    fn is_inner(&self) -> bool {
        self.depth >= 2.0 * self.reach()
    }

    /// In eight.
    pub(super) fn split(&self, solid: &Solid<'_>) -> impl Iterator<Item = Self> {
        let (half, centre) = (self.half / 2.0, self.centre);
        (0..8).filter_map(move |corner: u8| {
            let to = |bit: u8| if corner & bit == 0 { -half } else { half };
            Self::new(solid, centre + Vector3::new(to(1), to(2), to(4)), half)
        })
    }
}

/// What rounding may hide of a square.
const ROUNDING: f64 = 1e-12;
const SQRT_3: f64 = 1.732_050_807_568_877_4;
/// A link of so many cells is finer than anything needs.
const MOST: usize = 4_000_000;

/// One that holds all of a solid.
pub(super) fn whole(solid: &Solid<'_>) -> Option<Cell> {
    let bounds = solid.bounds();
    let size = bounds.max - bounds.min;
    let half = 0.5 * size.x.max(size.y).max(size.z) * (1.0 + 1e-12);
    Cell::new(solid, bounds.centre(), half)
}

/// Cells at the surface, no wider than `finest`, and larger ones within; `None` where there would be millions.
pub(super) fn cells(solid: &Solid<'_>, finest: f64) -> Option<(Vec<Cell>, Vec<Cell>)> {
    let mut rest: Vec<Cell> = whole(solid).into_iter().collect();
    let (mut surface, mut inner) = (Vec::new(), Vec::new());
    while let Some(cell) = rest.pop() {
        if cell.is_inner() {
            inner.push(cell);
        } else if 2.0 * cell.half <= finest {
            surface.push(cell);
        } else {
            rest.extend(cell.split(solid));
        }
        if surface.len() + inner.len() + rest.len() > MOST || is_stopped() {
            return None;
        }
    }
    Some((surface, inner))
}
