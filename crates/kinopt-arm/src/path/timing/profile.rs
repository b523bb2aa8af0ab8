//! Time-optimal speed profile along a curve under velocity and acceleration limits.
//!
//! The method is reachability analysis (Pham & Pham 2018, "A new approach to time-optimal path parameterization based
//! on reachability analysis"). A backward pass finds at every grid point the largest squared speed from which the arm
//! can still stop at the end. A forward pass then accelerates as much as these speeds allow. Squared speed 0 is always
//! controllable, so each controllable set is an interval from 0.
//!
//! Linear constraints impose the limits at both ends of every cell. The extrema within a cell have a closed form. Cells
//! that exceed a limit are tightened iteratively. The remaining excess slows the whole curve.

use super::constraints::Constraints;
use super::grid::Grid;
use super::tool_motion::ToolMotion;

/// Velocity and acceleration limits of joints and tool.
#[derive(Clone, Copy)]
pub(super) struct PathRateLimits<'a> {
    pub(super) velocity: &'a [f64],
    pub(super) acceleration: &'a [f64],
    pub(super) tool: Option<&'a ToolMotion>,
}

/// Relative excess over a limit that is left to slowing the whole curve.
const SMALL_EXCESS: f64 = 5e-4;
/// Maximum number of passes that tighten single cells.
const MAX_TIGHTENINGS: usize = 6;

/// Computes the squared speeds at the points of a grid, from rest to rest.
///
/// # Errors
/// Returns the index of the first cell with unbounded acceleration.
pub(super) fn squared_speeds(grid: &Grid, limits: PathRateLimits<'_>) -> Result<Vec<f64>, usize> {
    let mut scales = vec![1.0; grid.cells()];
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..=MAX_TIGHTENINGS {
        let mut x = passes(grid, limits, &scales)?;
        let mut max_excess = 1.0_f64;
        for (cell, scale) in scales.iter_mut().enumerate() {
            let excess = excess(grid, limits, cell, &x);
            max_excess = max_excess.max(excess);
            *scale /= excess.max(1.0);
        }
        x.iter_mut().for_each(|x| *x /= max_excess);
        let time = time(grid, &x);
        if best.as_ref().is_none_or(|(best_time, _)| time < *best_time) {
            best = Some((time, x));
        }
        if max_excess <= 1.0 + SMALL_EXCESS {
            break;
        }
    }
    Ok(best.map_or_else(Vec::new, |(_, x)| x))
}

/// Returns the duration of a profile, seconds.
fn time(grid: &Grid, x: &[f64]) -> f64 {
    let cells = x.windows(2).enumerate();
    cells
        .map(|(cell, x)| 2.0 * grid.step(cell) / (x[0].sqrt() + x[1].sqrt()))
        .sum()
}

/// Runs the backward and the forward pass.
fn passes(grid: &Grid, limits: PathRateLimits<'_>, scales: &[f64]) -> Result<Vec<f64>, usize> {
    let PathRateLimits {
        velocity,
        acceleration,
        tool,
    } = limits;
    let constraints = Constraints::new(grid, velocity, acceleration, tool, scales);
    let cells = grid.cells();
    if let Some(cell) = (0..cells).find(|cell| !constraints.are_bounded(*cell)) {
        return Err(cell);
    }
    let mut x = vec![0.0; cells + 1];
    for cell in (1..cells).rev() {
        let largest = constraints.largest_squared_speed(cell, grid.step(cell), x[cell + 1]);
        // In a tightened cell, both the acceleration limit and the speed are reduced.
        x[cell] = (largest * scales[cell].min(scales[cell - 1])).min(constraints.speed[cell]);
    }
    let mut current = 0.0;
    for cell in 0..cells {
        let step = grid.step(cell);
        let u = constraints.largest_acceleration(cell, step, current, x[cell + 1]);
        current = (current + 2.0 * step * u).clamp(0.0, x[cell + 1]);
        x[cell + 1] = current;
    }
    Ok(x)
}

/// Returns the largest ratio by which a limit is exceeded in a cell, in terms of squared speed.
fn excess(grid: &Grid, limits: PathRateLimits<'_>, cell: usize, x: &[f64]) -> f64 {
    let step = grid.step(cell);
    let (from, to) = (x[cell], x[cell + 1]);
    let u = (to - from) / (2.0 * step);
    let mut max_ratio = 0.0_f64;
    let rates = limits.velocity.iter().zip(limits.acceleration);
    for (joint, (velocity, acceleration)) in rates.enumerate() {
        let (first, second) = grid.derivatives(cell, joint);
        let (_, next) = grid.derivatives(cell + 1, joint);
        let half_third = 0.5 * (next - second) / step;
        // Acceleration over the distance y from the cell's first point: a parabola.
        let [a, b, c] = [
            first * u + second * from,
            3.0 * second * u + 2.0 * half_third * from,
            5.0 * half_third * u,
        ];
        let acceleration_at = |y: f64| a + y * (b + y * c);
        let end = acceleration_at(step);
        let has_summit = b * c < 0.0 && b.abs() < 2.0 * step * c.abs();
        let summit = if has_summit {
            acceleration_at(-0.5 * b / c)
        } else {
            a
        };
        let largest = a.abs().max(end.abs()).max(summit.abs());
        max_ratio = max_ratio.max(largest / acceleration);
        // The velocity is extreme at the ends, or at zeros of the acceleration.
        let squared = |y: f64| {
            let slope = first + y * (second + y * half_third);
            slope * slope * (from + 2.0 * u * y)
        };
        let mut fastest = squared(0.0).max(squared(step));
        if a * end < 0.0 || a * summit < 0.0 {
            let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
            let q = -0.5 * (b + root.copysign(b));
            for y in [q / c, a / q] {
                if y > 0.0 && y < step {
                    fastest = fastest.max(squared(y));
                }
            }
        }
        max_ratio = max_ratio.max(fastest / (velocity * velocity));
    }
    match limits.tool {
        Some(tool) => max_ratio.max(tool.excess(cell, step, from, u)),
        None => max_ratio,
    }
}
