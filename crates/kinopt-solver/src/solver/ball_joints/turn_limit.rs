//! Angle limit of a ball joint, from its start or from its zero.

use std::f64::consts::TAU;

use kinopt_kinematics::bisection::bisect;
use kinopt_kinematics::model::RotationChart;
use kinopt_kinematics::spatial::{Quaternion, Vector3};

/// Relative distance from the edge within which a joint moves along and across it, so that the edge holds one variable.
const NEAR_EDGE_TOLERANCE: f64 = 1e-6;
/// Relative distance from the edge within which a joint counts as on it.
const ON_EDGE_TOLERANCE: f64 = 1e-12;
/// Relative distance within the edge at which a projection ends, for rounding.
const PROJECTION_MARGIN: f64 = 1e-14;
/// Additional distance within the edge, radians, for the rounding of quaternions.
const ROUNDING_MARGIN: f64 = 1e-15;
/// Halvings of a bisection after which no number is left between its ends.
const HALVINGS: usize = 52;

/// Rotations within an angle of a central one, in the three variables of a ball joint.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct TurnLimit {
    /// Index of the first variable; two others follow it.
    pub(crate) first: usize,
    chart: RotationChart,
    centre: Quaternion<f64>,
    centre_variables: [f64; 3],
    /// Variables within all limits of the joint.
    inside: [f64; 3],
    /// Largest angle, radians.
    pub(crate) max_angle: f64,
}

impl TurnLimit {
    /// Limit of the angle from the joint's zero. `inside` are variables of the joint within all of its limits.
    pub(crate) fn from_zero(
        first: usize,
        chart: RotationChart,
        inside: [f64; 3],
        max_angle: f64,
    ) -> Self {
        let limit = Self {
            first,
            chart,
            centre: Quaternion::exp(Vector3::zero()),
            centre_variables: [0.0; 3],
            inside,
            max_angle,
        };
        debug_assert!(limit.angle(inside) <= max_angle);
        limit
    }

    /// Sets the centre to the rotation at x, which must be within all limits of the joint.
    pub(crate) fn centre_at(&mut self, x: &[f64]) {
        let variables = self.of(x);
        self.centre = self.chart.rotation(variables);
        (self.centre_variables, self.inside) = (variables, variables);
    }

    pub(crate) fn variables(&self) -> std::ops::Range<usize> {
        self.first..self.first + 3
    }

    /// Range of a variable within the limit, up to the distortion of the chart.
    pub(crate) fn range_of(&self, variable: usize) -> (f64, f64) {
        let centre = self.centre_variables[variable - self.first];
        (centre - self.max_angle, centre + self.max_angle)
    }

    fn of(&self, x: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| x[self.first + k])
    }

    /// Rotation vector from the centre.
    fn rotation_vector(&self, variables: [f64; 3]) -> Vector3<f64> {
        (self.chart.rotation(variables) * self.centre.conjugate()).log()
    }

    fn angle(&self, variables: [f64; 3]) -> f64 {
        self.rotation_vector(variables).norm()
    }

    /// Returns true if the angle is certainly below the limit by more than `margin` times the limit, without
    /// trigonometry.
    ///
    /// The angle is at most the distance of two rotation vectors, or the sum of the changes of swing and twist.
    fn is_well_within(&self, variables: [f64; 3], margin: f64) -> bool {
        let [a, b, c] = [0, 1, 2].map(|k| variables[k] - self.centre_variables[k]);
        let swing = (a * a + b * b).sqrt();
        let max_distance = match self.chart {
            RotationChart::Exponential => (a * a + b * b + c * c).sqrt(),
            RotationChart::SwingTwist(_) => swing + c.abs(),
        };
        max_distance < self.max_angle * (1.0 - margin) - ROUNDING_MARGIN
    }

    /// Returns true if the angle is within the limit.
    pub(in crate::solver) fn is_within(&self, variables: [f64; 3]) -> bool {
        self.is_well_within(variables, 0.0) || self.angle(variables) <= self.max_angle
    }

    /// Outward unit normal of the edge, if it is near, and true if x is on the edge.
    pub(in crate::solver) fn near_edge(&self, x: &[f64]) -> Option<(bool, Vector3<f64>)> {
        let variables = self.of(x);
        if self.is_well_within(variables, NEAR_EDGE_TOLERANCE) {
            return None;
        }
        let rotation_vector = self.rotation_vector(variables);
        let angle = rotation_vector.norm();
        if angle < self.max_angle * (1.0 - NEAR_EDGE_TOLERANCE) - ROUNDING_MARGIN {
            return None;
        }
        let rotation_axis = rotation_vector * (1.0 / angle);
        let [a, b, c] = self
            .chart
            .axes(variables)
            .map(|axis| axis.dot(rotation_axis));
        let slope = Vector3::new(a, b, c);
        let length = slope.norm();
        let is_on = angle >= self.max_angle * (1.0 - ON_EDGE_TOLERANCE) - 8.0 * ROUNDING_MARGIN;
        (length > 0.0).then(|| (is_on, slope * (1.0 / length)))
    }

    /// Projects x into the limit, by a rotation straight back to the centre.
    ///
    /// If that leaves the joint's other limits, x moves on the line between the variables and a point within all
    /// limits.
    pub(in crate::solver) fn project(
        &self,
        x: &mut [f64],
        satisfies_others: impl Fn([f64; 3]) -> bool,
    ) {
        let variables = self.of(x);
        let max_angle = self.max_angle * (1.0 - PROJECTION_MARGIN) - ROUNDING_MARGIN;
        if self.is_well_within(variables, PROJECTION_MARGIN) {
            return;
        }
        let rotation_vector = self.rotation_vector(variables);
        let angle = rotation_vector.norm();
        // NaN stays NaN.
        if angle.is_nan() || angle <= max_angle {
            return;
        }
        let rotated_back = Quaternion::exp(rotation_vector * (max_angle / angle)) * self.centre;
        let rotated_back = self.chart.variables(rotated_back);
        let projected = match self.is_within(rotated_back) && satisfies_others(rotated_back) {
            true => rotated_back,
            false => self.last_within(variables, max_angle, satisfies_others),
        };
        x[self.variables()].copy_from_slice(&projected);
    }

    /// Last point within all limits on the line of the variables from `inside`, if the line leaves the limits only
    /// once.
    ///
    /// Otherwise it is one of the points at which the line leaves them.
    fn last_within(
        &self,
        mut variables: [f64; 3],
        max_angle: f64,
        satisfies_others: impl Fn([f64; 3]) -> bool,
    ) -> [f64; 3] {
        if let RotationChart::SwingTwist(_) = self.chart {
            // Whole revolutions of twist give the same rotation.
            variables[2] -= TAU * ((variables[2] - self.inside[2]) / TAU).round();
        }
        let point_at = |fraction: f64| {
            [0, 1, 2].map(|k| self.inside[k] + fraction * (variables[k] - self.inside[k]))
        };
        point_at(bisect(0.0, 1.0, HALVINGS, |fraction| {
            self.angle(point_at(fraction)) <= max_angle && satisfies_others(point_at(fraction))
        }))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::{TAU, TurnLimit};
    use kinopt_kinematics::model::{BallLimits, Limits, Model, ParameterMap};
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::spatial::{Placement, Vector3};

    /// Whole revolutions of twist give the same rotation, hence the same projection.
    ///
    /// This also holds if the straight rotation back leaves the cone.
    #[test]
    fn projection_ignores_whole_revolutions_of_twist() {
        let z = Vector3::UNITS[2];
        let cone = BallLimits::elliptic([1.0, 0.0, 0.0], [0.3, 1.2], Limits::UNBOUNDED);
        let mut builder = Model::builder("shoulder");
        builder.ball("ball", None, Placement::identity(), z, Some(cone));
        let model = builder.build().unwrap();
        let chart = ParameterMap::free(&model).balls()[0].chart;
        let in_cone = |[a, b, _]: [f64; 3]| a * a / 0.09 + b * b / 1.44 <= 1.0;
        let mut random = RandomStream::new(3, 0);
        let mut by_the_variables = 0;
        for _ in 0..2000 {
            let mut draw = |max: f64| max * (2.0 * random.unit() - 1.0);
            let centre = [draw(0.2), draw(0.8), draw(3.0)];
            let variables = [draw(0.3), draw(1.2), centre[2] + draw(3.0)];
            if !in_cone(centre) || !in_cone(variables) {
                continue;
            }
            let mut limit = TurnLimit::from_zero(0, chart, [0.0; 3], 0.4);
            limit.centre_at(&centre);
            let [mut projected, mut rotated] = [variables; 2];
            rotated[2] += 2.0 * TAU;
            limit.project(&mut projected, in_cone);
            limit.project(&mut rotated, in_cone);
            assert!(
                limit.is_within(projected) && in_cone(projected),
                "{projected:?}"
            );
            if limit.is_well_within(variables, 1e-6) {
                continue;
            }
            let straight = limit.rotation_vector(variables) * (0.4 / limit.angle(variables));
            let back = super::Quaternion::exp(straight) * limit.centre;
            by_the_variables += u32::from(!in_cone(limit.chart.variables(back)));
            let difference =
                limit.chart.rotation(projected).conjugate() * limit.chart.rotation(rotated);
            assert!(
                difference.log().norm() < 1e-9,
                "{variables:?}: {projected:?} {rotated:?}"
            );
        }
        assert!(by_the_variables > 20, "{by_the_variables}");
    }
}
