//! Bounds of the acceleration along a curve, as lines over the squared speed.
//!
//! Let x = ṡ² be the squared speed of the curve parameter, and u = s̈ its acceleration, constant in a cell. A joint
//! accelerates by q′ u + q″ x at the cell's first point. At its last point it accelerates by q′ u + q″ (x + 2 Δ u).
//! Both are linear in (u, x).

use super::grid::Grid;
use super::tool_motion::ToolMotion;

/// Linear bound of u over x: `height − slope · x` from above, or `−height − slope · x` from below.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    slope: f64,
    height: f64,
}

/// Linear bounds of all cells, one cell after another.
#[derive(Clone, Debug, Default)]
struct Lines {
    lines: Vec<Line>,
    /// Index of the first line of each cell.
    starts: Vec<usize>,
}

impl Lines {
    fn of_cell(&self, cell: usize) -> &[Line] {
        let end = self.starts.get(cell + 1);
        &self.lines[self.starts[cell]..end.copied().unwrap_or(self.lines.len())]
    }
}

/// Constraints of all cells of a grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    /// Largest x at each grid point.
    pub(super) speed: Vec<f64>,
    /// Lines that bound u from above, and with negated height from below.
    both: Lines,
    /// Lines that bound u from one side.
    upper: Lines,
    lower: Lines,
}

/// Bounds of u at one x, with the lines that set them.
struct SpeedRange {
    upper: f64,
    upper_line: Line,
    lower: f64,
    lower_line: Line,
}

/// Maximum number of rounds of the search for the largest x. Each takes the intersection of two lines.
const MAX_ROUNDS: usize = 64;
/// Largest relative gap between bounds of u that counts as zero.
const RELATIVE_GAP_TOLERANCE: f64 = 1e-12;

impl Constraints {
    /// Creates the constraints from velocity and acceleration limits of joints and tool on a grid.
    ///
    /// `scales` are the fractions of the acceleration limits that each cell uses.
    pub(super) fn new(
        grid: &Grid,
        velocity: &[f64],
        acceleration: &[f64],
        tool: Option<&ToolMotion>,
        scales: &[f64],
    ) -> Self {
        let mut constraints = Self {
            speed: vec![f64::INFINITY; grid.points.len()],
            ..Self::default()
        };
        for (point, max_squared_speed) in constraints.speed.iter_mut().enumerate() {
            for (joint, limit) in velocity.iter().enumerate() {
                let (first, _) = grid.derivatives(point, joint);
                let ratio = limit / first.abs();
                *max_squared_speed = max_squared_speed.min(ratio * ratio);
            }
            if let Some(tool) = tool {
                *max_squared_speed = max_squared_speed.min(tool.largest_squared_speed(point));
            }
        }
        let finite: Vec<(usize, f64)> = acceleration.iter().copied().enumerate().collect();
        let finite: Vec<(usize, f64)> = finite.into_iter().filter(|(_, a)| a.is_finite()).collect();
        constraints
            .both
            .lines
            .reserve(2 * finite.len() * grid.cells());
        for (cell, scale) in scales.iter().enumerate() {
            for lines in [
                &mut constraints.both,
                &mut constraints.upper,
                &mut constraints.lower,
            ] {
                lines.starts.push(lines.lines.len());
            }
            let twice = 2.0 * grid.step(cell);
            for (joint, limit) in &finite {
                let limit = limit * scale;
                let (first, second) = grid.derivatives(cell, *joint);
                constraints.push_both(cell, [first, second, limit]);
                let (first, second) = grid.derivatives(cell + 1, *joint);
                constraints.push_both(cell, [first + twice * second, second, limit]);
            }
            if let Some(tool) = tool {
                tool.half_planes(cell, twice, *scale, |half_plane| {
                    constraints.push_half_plane(cell, half_plane);
                });
            }
        }
        constraints
    }

    /// Adds the constraint |a u + b x| ≤ c.
    fn push_both(&mut self, cell: usize, [a, b, c]: [f64; 3]) {
        let size = a.abs();
        if size > f64::EPSILON * b.abs() {
            let (slope, height) = (b / a, c / size);
            self.both.lines.push(Line { slope, height });
        } else if b != 0.0 {
            self.speed[cell] = self.speed[cell].min(c / b.abs());
        }
    }

    /// Adds the constraint a u + b x ≤ c.
    fn push_half_plane(&mut self, cell: usize, [a, b, c]: [f64; 3]) {
        let size = a.abs();
        if size > f64::EPSILON * b.abs() {
            let side = if a > 0.0 {
                &mut self.upper
            } else {
                &mut self.lower
            };
            let (slope, height) = (b / a, c / size);
            side.lines.push(Line { slope, height });
        } else if b > 0.0 {
            self.speed[cell] = self.speed[cell].min(c / b);
        }
    }

    /// Returns whether u is bounded in a cell.
    pub(super) fn are_bounded(&self, cell: usize) -> bool {
        let has = |lines: &Lines| !lines.of_cell(cell).is_empty();
        has(&self.both) || (has(&self.upper) && has(&self.lower))
    }

    /// Returns the bounds of u in a cell at `x`, with `x + 2 Δ u` in `[0, next]`.
    fn range(&self, cell: usize, x: f64, half_inverse: f64, next: f64) -> SpeedRange {
        let slope = half_inverse;
        let height = next * half_inverse;
        let line = |height: f64| Line { slope, height };
        let mut range = SpeedRange {
            upper: height - slope * x,
            upper_line: line(height),
            lower: -slope * x,
            lower_line: line(0.0),
        };
        for line in self.both.of_cell(cell) {
            let middle = -line.slope * x;
            range.bound_from_above(middle + line.height, line);
            range.bound_from_below(middle - line.height, line);
        }
        for line in self.upper.of_cell(cell) {
            range.bound_from_above(line.height - line.slope * x, line);
        }
        for line in self.lower.of_cell(cell) {
            range.bound_from_below(-line.height - line.slope * x, line);
        }
        range
    }

    /// Returns the largest x at the first point of a cell from which some u leads to at most `next` at its last point.
    ///
    /// The gap between the bounds of u is concave in x and not negative at 0. Newton's method from the right converges
    /// to its zero in a few rounds, because the bounds are piecewise linear.
    pub(super) fn largest_squared_speed(&self, cell: usize, step: f64, next: f64) -> f64 {
        let half_inverse = 0.5 / step;
        let mut x = self.speed[cell].min(f64::MAX.sqrt());
        for _ in 0..MAX_ROUNDS {
            let range = self.range(cell, x, half_inverse, next);
            let size = range.upper.abs().max(range.lower.abs());
            if range.upper - range.lower >= -RELATIVE_GAP_TOLERANCE * size {
                break;
            }
            let (above, below) = (range.upper_line, range.lower_line);
            let crossing = (above.height + below.height) / (above.slope - below.slope);
            // Only rounding errors can increase x.
            if crossing.is_nan() || crossing >= x {
                break;
            }
            x = crossing.max(0.0);
        }
        x
    }

    /// Returns the largest u in a cell at `x` that leads to at most `next` at the last point.
    pub(super) fn largest_acceleration(&self, cell: usize, step: f64, x: f64, next: f64) -> f64 {
        let range = self.range(cell, x, 0.5 / step, next);
        range.upper.max(range.lower)
    }
}

impl SpeedRange {
    fn bound_from_above(&mut self, bound: f64, line: &Line) {
        if bound < self.upper {
            (self.upper, self.upper_line) = (bound, *line);
        }
    }

    fn bound_from_below(&mut self, bound: f64, line: &Line) {
        if bound > self.lower {
            (self.lower, self.lower_line) = (bound, *line);
        }
    }
}
