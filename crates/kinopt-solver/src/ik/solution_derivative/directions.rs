//! Active joint limits of a configuration, and the directions that they leave free.

use crate::problem::{ProblemInstance, TangentPoint};
use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::spatial::Vector3;

/// Distance from a limit within which the variable of a ball joint is at it, radians; rounding of the quaternion.
const BOUND_TOLERANCE: f64 = 1e-12;

/// Joint limit at which the configuration is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// Variable of the limit. For a swing limit it is the first of two.
    pub(super) variable: usize,
    /// Outward normal, in the components of that variable and the next.
    pub(super) normal: [f64; 2],
    /// Curvature of the limit, 1/rad; 0 for a plain bound.
    pub(super) curvature: f64,
    /// True if lower and upper bound are equal, so that the multiplier may have any sign.
    pub(super) is_locked: bool,
    pub(super) is_held: bool,
}

impl Bound {
    /// Returns whether it is a swing limit.
    fn is_edge(&self) -> bool {
        self.curvature > 0.0
    }

    /// Tangent of a swing limit.
    pub(super) fn tangent(&self) -> [f64; 2] {
        [-self.normal[1], self.normal[0]]
    }

    /// Returns the outward component of the negative gradient `slope`.
    pub(super) fn push(&self, slope: &[f64]) -> f64 {
        let second = match self.is_edge() {
            true => slope[self.variable + 1] * self.normal[1],
            false => 0.0,
        };
        -(slope[self.variable] * self.normal[0] + second)
    }
}

/// Snaps variables of ball joints to limits within rounding, and lists the limits at x, all active.
pub(super) fn list_bounds(instance: ProblemInstance<'_>, x: &mut [f64], bounds: &mut Vec<Bound>) {
    let problem = instance.problem();
    let (lower, upper) = (instance.lower(), instance.upper());
    for ball in problem.parameters().balls() {
        for j in ball.variable..ball.variable + 3 {
            for limit in [lower[j], upper[j]] {
                if (x[j] - limit).abs() <= BOUND_TOLERANCE {
                    x[j] = limit;
                }
            }
        }
    }
    bounds.clear();
    let mut variable = 0;
    while variable < x.len() {
        let edge = problem.swing_at(variable).and_then(|swing| swing.edge(x));
        if let Some((normal, curvature)) = edge {
            bounds.push(Bound {
                variable,
                normal,
                curvature,
                is_locked: false,
                is_held: true,
            });
            variable += 2;
            continue;
        }
        let outward = match x[variable] {
            value if value <= lower[variable] => Some(-1.0),
            value if value >= upper[variable] => Some(1.0),
            _ => None,
        };
        if let Some(outward) = outward {
            bounds.push(Bound {
                variable,
                normal: [outward, 0.0],
                curvature: 0.0,
                is_locked: lower[variable] >= upper[variable],
                is_held: true,
            });
        }
        variable += 1;
    }
}

/// Direction of the variables. At most three of them move together.
#[derive(Clone, Copy, Debug, Default)]
struct Direction {
    first: usize,
    count: usize,
    components: [f64; 3],
}

/// Basis of the directions that no active limit blocks, orthonormal in the model's velocities.
#[derive(Clone, Debug, Default)]
pub(super) struct Directions {
    directions: Vec<Direction>,
    squared_speeds: Vec<f64>,
    is_blocked: Vec<bool>,
}

impl Directions {
    /// Computes the basis for the active bounds.
    pub(super) fn compute(
        &mut self,
        instance: ProblemInstance<'_>,
        point: &TangentPoint<'_>,
        bounds: &[Bound],
    ) {
        let problem = instance.problem();
        let n = point.x.len();
        refill(&mut self.squared_speeds, n, 0.0);
        problem
            .tangent()
            .squared_speeds(point, &mut self.squared_speeds);
        refill(&mut self.is_blocked, n, false);
        for bound in bounds.iter().filter(|bound| bound.is_held) {
            self.is_blocked[bound.variable] = true;
        }
        self.directions.clear();
        let mut balls = problem.parameters().balls().iter();
        let mut ball = balls.next();
        let mut variable = 0;
        while variable < n {
            if let Some(current_ball) = ball.filter(|ball| ball.variable == variable) {
                let edge = bounds
                    .iter()
                    .find(|bound| bound.variable == variable && bound.is_edge() && bound.is_held);
                let axes = current_ball.of(point.x).map(|x| current_ball.chart.axes(x));
                self.add_ball_directions(variable, axes.unwrap_or([Vector3::zero(); 3]), edge);
                variable += 3;
                ball = balls.next();
                continue;
            }
            if !self.is_blocked[variable] {
                self.directions.push(Direction {
                    first: variable,
                    count: 1,
                    components: [1.0 / self.squared_speeds[variable].sqrt(), 0.0, 0.0],
                });
            }
            variable += 1;
        }
    }

    /// Gram-Schmidt orthonormalisation of the angular velocities of a ball joint.
    fn add_ball_directions(&mut self, first: usize, axes: [Vector3<f64>; 3], edge: Option<&Bound>) {
        let mut basis = [([0.0; 3], Vector3::zero()); 3];
        let mut count = 0;
        for k in 0..3 {
            let mut components = [0.0; 3];
            components[k] = 1.0;
            match (edge, k) {
                (Some(_), 0) => continue,
                (Some(edge), 1) => components[..2].copy_from_slice(&edge.tangent()),
                _ if self.is_blocked[first + k] => continue,
                _ => {}
            }
            let mut angular_velocity =
                axes[0] * components[0] + axes[1] * components[1] + axes[2] * components[2];
            for (other_components, axis) in &basis[..count] {
                let projection = angular_velocity.dot(*axis);
                angular_velocity -= *axis * projection;
                for (component, other) in components.iter_mut().zip(other_components) {
                    *component -= projection * other;
                }
            }
            let scale = 1.0 / angular_velocity.norm();
            if scale.is_finite() {
                basis[count] = (
                    components.map(|component| component * scale),
                    angular_velocity * scale,
                );
                count += 1;
            }
        }
        self.directions
            .extend(basis[..count].iter().map(|&(components, _)| Direction {
                first,
                count: 3,
                components,
            }));
    }

    pub(super) fn len(&self) -> usize {
        self.directions.len()
    }

    /// Adds a linear combination of the directions, scaled by `scale`, to the variables.
    pub(super) fn expand(&self, y: &[f64], scale: f64, x: &mut [f64]) {
        for (direction, y) in self.directions.iter().zip(y) {
            let values = x[direction.first..].iter_mut().zip(direction.components);
            for (x, component) in values.take(direction.count) {
                *x += scale * y * component;
            }
        }
    }

    /// Writes derivatives along the directions from derivatives by the variables.
    ///
    /// `slopes` has `rows` rows and is stored column by column.
    pub(super) fn reduce(&self, rows: usize, slopes: &[f64], reduced: &mut Vec<f64>) {
        reduced.clear();
        for direction in &self.directions {
            let start = reduced.len();
            let columns = slopes[direction.first * rows..].chunks_exact(rows.max(1));
            let mut columns = columns.zip(direction.components).take(direction.count);
            match columns.next() {
                Some((column, 1.0)) => reduced.extend_from_slice(column),
                Some((column, component)) => {
                    reduced.extend(column.iter().map(|entry| component * entry))
                }
                None => reduced.resize(start + rows, 0.0),
            }
            for (column, component) in columns.filter(|(_, component)| *component != 0.0) {
                for (sum, entry) in reduced[start..].iter_mut().zip(column) {
                    *sum += component * entry;
                }
            }
        }
    }
}
