//! The corner of a hull that is farthest along a direction, found by going from corner to corner.
//!
//! On a convex surface a corner that no neighbour is beyond is the farthest of all (Gilbert & Foo 1990; "hill climbing" in later
//! libraries), so that of thousands some tens are looked at. Where rounding hides which neighbour is farther, it may stop short by as much:
//! what is to be exact asks all corners once at the end.

use crate::spatial::Vector3;

/// Hulls of fewer corners are looked through sooner.
const MANY: usize = 32;
/// Cells along a side of the cube of directions.
const CELLS: usize = 6;

/// Which corners are beside which, and where to begin.
#[derive(Clone, Debug)]
pub(super) struct HullClimb {
    /// Of each corner where its neighbours end.
    ends: Vec<u32>,
    neighbours: Vec<u32>,
    /// A corner far along the middle of each cell of directions.
    starts: Vec<u32>,
}

impl HullClimb {
    /// Of a closed surface; none for few corners.
    pub(super) fn of(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<Self> {
        if vertices.len() < MANY {
            return None;
        }
        let mut ends = vec![0_u32; vertices.len()];
        for &corner in triangles.iter().flatten() {
            ends[corner as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            // Where the neighbours begin: the end once they are filled in.
            sum += std::mem::replace(end, sum);
        }
        let mut neighbours = vec![0; sum as usize];
        // Each side is one triangle's in one sense and the next one's in the other.
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let end = &mut ends[from as usize];
                neighbours[*end as usize] = to;
                *end += 1;
            }
        }
        let mut climb = Self {
            ends,
            neighbours,
            starts: Vec::with_capacity(6 * CELLS * CELLS),
        };
        let mut last = 0;
        for cell in 0..6 * CELLS * CELLS {
            last = climb.from(vertices, last, middle(cell));
            climb.starts.push(last);
        }
        Some(climb)
    }

    /// A corner that no neighbour is farther along a direction than.
    pub(super) fn farthest(&self, vertices: &[Vector3<f64>], along: Vector3<f64>) -> Vector3<f64> {
        let start = self.starts[cell(along)];
        vertices[self.from(vertices, start, along) as usize]
    }

    fn from(&self, vertices: &[Vector3<f64>], start: u32, along: Vector3<f64>) -> u32 {
        let mut best = (start, along.dot(vertices[start as usize]));
        loop {
            let corner = best.0 as usize;
            let begin = corner.checked_sub(1).map_or(0, |before| self.ends[before]);
            for &other in &self.neighbours[begin as usize..self.ends[corner] as usize] {
                let far = along.dot(vertices[other as usize]);
                if far > best.1 {
                    best = (other, far);
                }
            }
            if best.0 as usize == corner {
                return best.0;
            }
        }
    }
}

/// The cell of a cube's surface that a direction goes through.
fn cell(along: Vector3<f64>) -> usize {
    let v = along.to_array();
    let size = v.map(f64::abs);
    let axis = match (size[0] >= size[1] && size[0] >= size[2], size[1] >= size[2]) {
        (true, _) => 0,
        (_, true) => 1,
        _ => 2,
    };
    let scale = size[axis].recip();
    let at = |value: f64| {
        // Not a number for a direction of no length: the first cell.
        let cell = (value * scale + 1.0) * (0.5 * CELLS as f64);
        (cell as usize).min(CELLS - 1)
    };
    let side = 2 * axis + usize::from(v[axis] < 0.0);
    (side * CELLS + at(v[(axis + 1) % 3])) * CELLS + at(v[(axis + 2) % 3])
}

/// The direction through the middle of a cell.
fn middle(cell: usize) -> Vector3<f64> {
    let at = |cell: usize| (cell as f64 + 0.5) * (2.0 / CELLS as f64) - 1.0;
    let (side, row, column) = (cell / (CELLS * CELLS), cell / CELLS % CELLS, cell % CELLS);
    let axis = side / 2;
    let mut v = [0.0; 3];
    v[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
    v[(axis + 1) % 3] = at(row);
    v[(axis + 2) % 3] = at(column);
    Vector3::from(v)
}
