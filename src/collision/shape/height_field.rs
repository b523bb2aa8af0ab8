//! Terrain as a height field over a grid.

use super::ShapeError;
use super::error::{check_number, size};
use crate::collision::aabb_tree::AabbTree;
use crate::collision::bounding_box::BoundingBox;
use crate::spatial::Vector3;

/// Heights over a grid that is centred on the origin. The volume below the surface is solid.
#[derive(Clone, Debug)]
pub struct HeightField {
    heights: Vec<f64>,
    columns: usize,
    spacing: [f64; 2],
    /// Triangles of the side walls and the floor.
    below: Vec<[Vector3<f64>; 3]>,
    /// AABB tree over the triangles: two a cell, then those in `below`.
    tree: AabbTree,
}

impl HeightField {
    pub(super) fn new(
        heights: Vec<f64>,
        columns: usize,
        [x, y]: [f64; 2],
    ) -> Result<Self, ShapeError> {
        let spacing = [
            size("spacing of the height field along x", x)?,
            size("spacing of the height field along y", y)?,
        ];
        check_number("heights", heights.len())?;
        if columns == 0 || !heights.len().is_multiple_of(columns) {
            return Err(ShapeError::RowBlock {
                heights: heights.len(),
                columns,
            });
        }
        for (what, given) in [("columns", columns), ("rows", heights.len() / columns)] {
            if given < 2 {
                return Err(ShapeError::TooFew {
                    shape: "height field",
                    what,
                    needed: 2,
                    given,
                });
            }
        }
        // The limit of all coordinates. It also bounds the far corners of the grid.
        if let Some(index) = heights.iter().position(|z| z.is_nan() || z.abs() > 1e9) {
            return Err(ShapeError::Coordinate {
                what: "height",
                index,
            });
        }
        let mut field = Self {
            heights,
            columns,
            spacing,
            below: Vec::new(),
            tree: AabbTree::default(),
        };
        field.below = field.walls_and_floor();
        field.tree = AabbTree::new(field.triangle_count(), |i| {
            BoundingBox::around(field.triangle(i))
        });
        Ok(field)
    }

    /// Heights in metres, row after row along y, each row along x.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Number of heights a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.heights.len() / self.columns
    }

    /// Distances of neighbours along x and y, metres.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    #[must_use]
    pub(crate) fn tree(&self) -> &AabbTree {
        &self.tree
    }

    /// Number of triangles of the surface, the walls and the floor.
    #[must_use]
    pub(crate) fn triangle_count(&self) -> usize {
        self.surface_count() + self.below.len()
    }

    #[must_use]
    fn surface_count(&self) -> usize {
        2 * (self.columns - 1) * (self.rows() - 1)
    }

    #[must_use]
    pub(super) fn bounding_box(&self) -> BoundingBox {
        self.tree.bounds()
    }

    /// The corners of a triangle, counter-clockwise seen from outside.
    pub(crate) fn triangle(&self, index: usize) -> [Vector3<f64>; 3] {
        if let Some(&below) = index
            .checked_sub(self.surface_count())
            .and_then(|i| self.below.get(i))
        {
            return below;
        }
        let cell = index / 2;
        let (column, row) = (cell % (self.columns - 1), cell / (self.columns - 1));
        let corner = |i: usize, j: usize| self.corner(column + i, row + j);
        match index % 2 {
            0 => [corner(0, 0), corner(1, 0), corner(1, 1)],
            _ => [corner(0, 0), corner(1, 1), corner(0, 1)],
        }
    }

    fn corner(&self, column: usize, row: usize) -> Vector3<f64> {
        let [x, y] = self.spacing;
        let from_centre = |i: usize, n: usize| i as f64 - 0.5 * (n - 1) as f64;
        Vector3::new(
            x * from_centre(column, self.columns),
            y * from_centre(row, self.rows()),
            self.heights[row * self.columns + column],
        )
    }

    /// Height of a point above the surface along z, metres; `None` outside the grid.
    fn height_above(&self, point: Vector3<f64>) -> Option<f64> {
        let [dx, dy] = self.spacing;
        let cell = |x: f64, spacing: f64, n: usize| {
            let grid_position = x / spacing + 0.5 * (n - 1) as f64;
            let inside = (0.0..=(n - 1) as f64).contains(&grid_position);
            let low = (grid_position as usize).min(n - 2);
            inside.then_some((low, grid_position - low as f64))
        };
        let (column, u) = cell(point.x, dx, self.columns)?;
        let (row, v) = cell(point.y, dy, self.rows())?;
        let height = |i: usize, j: usize| self.corner(column + i, row + j).z;
        let [low, high] = [height(0, 0), height(1, 1)];
        // Interpolates in the triangle of the cell that holds the point.
        let surface = match u >= v {
            true => low + u * (height(1, 0) - low) + v * (high - height(1, 0)),
            false => low + v * (height(0, 1) - low) + u * (high - height(0, 1)),
        };
        Some(point.z - surface)
    }

    fn walls_and_floor(&self) -> Vec<[Vector3<f64>; 3]> {
        let (columns, rows) = (self.columns - 1, self.rows() - 1);
        let lowest = self.heights.iter().copied().fold(f64::INFINITY, f64::min);
        let [x, y] = self.spacing;
        let floor = lowest - (x * columns as f64).max(y * rows as f64);
        let foot = |p: Vector3<f64>| Vector3::new(p.x, p.y, floor);
        // Vertices around the rim, counter-clockwise seen from above.
        let rim: Vec<_> = (0..columns)
            .map(|i| (i, 0))
            .chain((0..rows).map(|j| (columns, j)))
            .chain((0..columns).map(|i| (columns - i, rows)))
            .chain((0..rows).map(|j| (0, rows - j)))
            .map(|(i, j)| self.corner(i, j))
            .collect();
        let next = rim.iter().cycle().skip(1);
        let walls = rim
            .iter()
            .zip(next)
            .flat_map(|(&from, &to)| [[from, foot(from), foot(to)], [from, foot(to), to]]);
        let corners = [(0, 0), (0, rows), (columns, rows), (columns, 0)];
        let [a, b, c, d] = corners.map(|(i, j)| foot(self.corner(i, j)));
        walls.chain([[a, b, c], [a, c, d]]).collect()
    }

    /// True if a point is below the surface and above the floor.
    pub(crate) fn contains(&self, point: Vector3<f64>) -> bool {
        let is_above_floor = point.z > self.tree.bounds().min.z;
        is_above_floor
            && self
                .height_above(point)
                .is_some_and(|height_above| height_above < 0.0)
    }
}
