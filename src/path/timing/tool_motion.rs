//! Velocity and acceleration limits of the tool along a curve.
//!
//! Per unit of curve parameter the tool moves by w = J q′, linear and angular. Its acceleration w u + w′ x lies in the
//! plane of w and w′. An inscribed polygon replaces the disc of allowed accelerations. Its half-planes are linear in
//! (u, x).

use super::cubic_curve::CubicCurve;
use super::grid::Grid;
use crate::arm::{Arm, QueryError};
use crate::kinematics::Jacobian;
use crate::scalar::elementary::{cos, hypot, sin_cos};

/// Largest speeds and accelerations of the tool relative to the arm's base; infinity for none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ToolLimits {
    /// Linear limit, m/s, and angular limit, rad/s.
    pub(super) velocity: [f64; 2],
    /// Linear limit, m/s², and angular limit, rad/s².
    pub(super) acceleration: [f64; 2],
}

impl ToolLimits {
    pub(super) const NONE: Self = Self {
        velocity: [f64::INFINITY; 2],
        acceleration: [f64::INFINITY; 2],
    };
}

/// Number of sides of the polygon per quarter of the disc.
const POLYGON_SIDES: usize = 8;
/// Step of the central differences for second derivatives, relative to the curve's length.
const DIFFERENCE_STEP: f64 = 1e-5;

/// Linear and angular motion of the tool per unit of curve parameter at one point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rate {
    /// Norm of w.
    size: [f64; 2],
    /// Component of w′ along w.
    along: [f64; 2],
    /// Norm of the component of w′ across w.
    across: [f64; 2],
}

/// Motion of the tool at the points of a grid and halfway between them.
#[derive(Clone, Debug)]
pub(super) struct ToolMotion {
    limits: ToolLimits,
    rates: Vec<Rate>,
}

/// Computes the motion of the tool at points of a curve.
pub(super) fn rates(
    arm: &Arm,
    curve: &CubicCurve,
    points: impl IntoIterator<Item = f64>,
) -> Result<Vec<Rate>, QueryError> {
    let mut jacobian = arm.jacobian()?;
    let (start, end) = (curve.start(), curve.end());
    let difference = DIFFERENCE_STEP * (end - start);
    let rates = points.into_iter().map(|s| {
        let [from, to] = [s - difference, s + difference].map(|s| s.clamp(start, end));
        let w = twist(&mut jacobian, curve, s)?;
        let before = twist(&mut jacobian, curve, from)?;
        let after = twist(&mut jacobian, curve, to)?;
        let change = std::array::from_fn(|k| (after[k] - before[k]) / (to - from));
        Ok(Rate::of(w, change))
    });
    rates.collect()
}

impl ToolMotion {
    pub(super) fn new(
        arm: &Arm,
        limits: ToolLimits,
        curve: &CubicCurve,
        grid: &Grid,
    ) -> Result<Self, QueryError> {
        let cells = grid.points.windows(2);
        let points = cells.flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        let rates = rates(arm, curve, points.chain([curve.end()]))?;
        Ok(Self { limits, rates })
    }

    /// Returns the largest squared speed of the curve parameter at a grid point, by the tool's velocity limits.
    pub(super) fn largest_squared_speed(&self, point: usize) -> f64 {
        self.rates[2 * point].largest_squared_speed(self.limits)
    }

    /// Passes the half-planes a u + b x ≤ c of a cell to `push`. `twice` is twice the step, `scale` scales the limits.
    pub(super) fn half_planes(
        &self,
        cell: usize,
        twice: f64,
        scale: f64,
        mut push: impl FnMut([f64; 3]),
    ) {
        let limits = ToolLimits {
            acceleration: self.limits.acceleration.map(|limit| limit * scale),
            ..self.limits
        };
        self.rates[2 * cell].half_planes(limits, 0.0, &mut push);
        self.rates[2 * cell + 2].half_planes(limits, twice, &mut push);
    }

    /// Returns the largest ratio by which a limit is exceeded in a cell, in terms of squared speed; sampled at the ends
    /// and halfway.
    pub(super) fn excess(&self, cell: usize, step: f64, from: f64, u: f64) -> f64 {
        let ratios = (0..3_usize).map(|k| {
            let x = from + u * step * k as f64;
            self.rates[2 * cell + k].excess(self.limits, u, x)
        });
        ratios.fold(0.0, f64::max)
    }
}

impl Rate {
    /// Returns the largest squared speed of the curve parameter, by the velocity limits.
    pub(super) fn largest_squared_speed(&self, limits: ToolLimits) -> f64 {
        let ratios = limits.velocity.iter().zip(self.size);
        let max_speed = ratios.map(|(limit, size)| limit / size);
        let max_speed = max_speed.fold(f64::INFINITY, f64::min);
        max_speed * max_speed
    }

    /// Passes the half-planes a u + b x ≤ c of the acceleration limits at squared speed x + `later` · u to `push`.
    pub(super) fn half_planes(
        &self,
        limits: ToolLimits,
        later: f64,
        mut push: impl FnMut([f64; 3]),
    ) {
        let side = std::f64::consts::FRAC_PI_2 / POLYGON_SIDES as f64;
        for part in 0..2 {
            let limit = limits.acceleration[part];
            if limit.is_infinite() {
                continue;
            }
            let (along, across) = (self.along[part], self.across[part]);
            // Coefficients of u in the components along and across w.
            let [along_u, across_u] = [self.size[part] + later * along, later * across];
            for k in 0..POLYGON_SIDES {
                let (sine, cosine) = sin_cos((k as f64 + 0.5) * side);
                let reach = limit * cos(0.5 * side);
                for cosine in [cosine, -cosine] {
                    let (a, b) = (
                        cosine * along_u + sine * across_u,
                        cosine * along + sine * across,
                    );
                    push([a, b, reach]);
                }
            }
        }
    }

    /// Returns the largest ratio by which a limit is exceeded at acceleration u and squared speed x, in terms of
    /// squared speed.
    pub(super) fn excess(&self, limits: ToolLimits, u: f64, x: f64) -> f64 {
        let parts = (0..2).map(|part| {
            let along = self.size[part] * u + self.along[part] * x;
            let acceleration = hypot(along, self.across[part] * x) / limits.acceleration[part];
            let speed = self.size[part] / limits.velocity[part];
            acceleration.max(speed * speed * x)
        });
        parts.fold(0.0, f64::max)
    }

    /// Converts to the motion per unit of another parameter, given the first two derivatives of the curve parameter.
    pub(super) fn eased(&self, first: f64, second: f64) -> Self {
        let square = first * first;
        let each = |values: [f64; 2], factor: f64| values.map(|value| value * factor);
        let along = [0, 1].map(|part| self.along[part] * square + self.size[part] * second);
        Self {
            size: each(self.size, first),
            along,
            across: each(self.across, square),
        }
    }

    fn of(w: [f64; 6], change: [f64; 6]) -> Self {
        let mut rate = Self::default();
        for part in 0..2 {
            let rows = 3 * part..3 * part + 3;
            let (w, change) = (&w[rows.clone()], &change[rows]);
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let size = product(w, w).sqrt();
            let along = match size > f64::EPSILON {
                true => product(w, change) / size,
                false => 0.0,
            };
            rate.size[part] = size;
            rate.along[part] = along;
            rate.across[part] = (product(change, change) - along * along).max(0.0).sqrt();
        }
        rate
    }
}

/// Returns the tool's twist per unit of curve parameter.
fn twist(jacobian: &mut Jacobian, curve: &CubicCurve, s: f64) -> Result<[f64; 6], QueryError> {
    let jets: Vec<_> = curve.jets(curve.piece(s), s).collect();
    let q: Vec<f64> = jets.iter().map(|jet| jet.value).collect();
    let columns = jacobian.at(&q)?;
    let mut twist = [0.0; 6];
    for (column, jet) in columns.column_iter().zip(&jets) {
        for (entry, j) in twist.iter_mut().zip(column.iter()) {
            *entry += j * jet.first;
        }
    }
    Ok(twist)
}
