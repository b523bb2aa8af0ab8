//! Angle limit of a ball joint, from its start or from its zero.

use std::f64::consts::TAU;

use crate::bisection::bisect;
use crate::model::RotationChart;
use crate::spatial::{Quaternion, Vector3};

/// Relative distance from the edge within which a joint moves along and across it, so that the edge holds one variable.
const NEAR: f64 = 1e-6;
/// Relative distance from the edge within which a joint counts as on it.
const ON: f64 = 1e-12;
/// Relative distance within the edge at which a projection ends, for rounding.
const WITHIN: f64 = 1e-14;
/// Additional distance within the edge, radians, for the rounding of quaternions.
const ROUNDING: f64 = 1e-15;
/// Halvings of a bisection after which no number is left between its ends.
const HALVINGS: usize = 52;

/// Rotations within an angle of a central one, in the three variables of a ball joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TurnLimit {
    /// Index of the first variable; two others follow it.
    pub(crate) first: usize,
    chart: RotationChart,
    centre: Quaternion<f64>,
    at_centre: [f64; 3],
    /// Variables within all limits of the joint.
    inside: [f64; 3],
    /// Largest angle, radians.
    pub(crate) most: f64,
}

impl TurnLimit {
    /// Limit of the angle from the joint's zero. `inside` are variables of the joint within all of its limits.
    pub(crate) fn from_zero(
        first: usize,
        chart: RotationChart,
        inside: [f64; 3],
        most: f64,
    ) -> Self {
        let own = Self {
            first,
            chart,
            centre: Quaternion::exp(Vector3::zero()),
            at_centre: [0.0; 3],
            inside,
            most,
        };
        debug_assert!(own.angle(inside) <= most);
        own
    }

    /// Sets the centre to the rotation at x, which must be within all limits of the joint.
    pub(crate) fn centre_at(&mut self, x: &[f64]) {
        let own = self.of(x);
        self.centre = self.chart.rotation(own);
        (self.at_centre, self.inside) = (own, own);
    }

    pub(crate) fn variables(&self) -> std::ops::Range<usize> {
        self.first..self.first + 3
    }

    /// Range of a variable within the limit, up to the distortion of the chart.
    pub(crate) fn range_of(&self, variable: usize) -> (f64, f64) {
        let centre = self.at_centre[variable - self.first];
        (centre - self.most, centre + self.most)
    }

    fn of(&self, x: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| x[self.first + k])
    }

    /// Rotation vector from the centre.
    fn turn(&self, own: [f64; 3]) -> Vector3<f64> {
        (self.chart.rotation(own) * self.centre.conjugate()).log()
    }

    fn angle(&self, own: [f64; 3]) -> f64 {
        self.turn(own).norm()
    }

    /// Returns true if the angle is certainly below the limit by more than `share` times the limit, without
    /// trigonometry.
    ///
    /// The angle is at most the distance of two rotation vectors, or the sum of the changes of swing and twist.
    fn is_well_within(&self, own: [f64; 3], share: f64) -> bool {
        let [a, b, c] = [0, 1, 2].map(|k| own[k] - self.at_centre[k]);
        let swing = (a * a + b * b).sqrt();
        let most = match self.chart {
            RotationChart::Exponential => (a * a + b * b + c * c).sqrt(),
            RotationChart::SwingTwist(_) => swing + c.abs(),
        };
        most < self.most * (1.0 - share) - ROUNDING
    }

    /// Returns true if the angle is within the limit.
    pub(in crate::solver) fn is_within(&self, own: [f64; 3]) -> bool {
        self.is_well_within(own, 0.0) || self.angle(own) <= self.most
    }

    /// Outward unit normal of the edge, if it is near, and true if x is on the edge.
    pub(in crate::solver) fn near_edge(&self, x: &[f64]) -> Option<(bool, Vector3<f64>)> {
        let own = self.of(x);
        if self.is_well_within(own, NEAR) {
            return None;
        }
        let turn = self.turn(own);
        let angle = turn.norm();
        if angle < self.most * (1.0 - NEAR) - ROUNDING {
            return None;
        }
        let about = turn * (1.0 / angle);
        let [a, b, c] = self.chart.axes(own).map(|axis| axis.dot(about));
        let slope = Vector3::new(a, b, c);
        let length = slope.norm();
        let is_on = angle >= self.most * (1.0 - ON) - 8.0 * ROUNDING;
        (length > 0.0).then(|| (is_on, slope * (1.0 / length)))
    }

    /// Projects x into the limit, by a rotation straight back to the centre.
    ///
    /// If that leaves the joint's other limits, x moves on the line between the variables and a point within all
    /// limits.
    pub(in crate::solver) fn project(
        &self,
        x: &mut [f64],
        keeps_others: impl Fn([f64; 3]) -> bool,
    ) {
        let own = self.of(x);
        let most = self.most * (1.0 - WITHIN) - ROUNDING;
        if self.is_well_within(own, WITHIN) {
            return;
        }
        let turn = self.turn(own);
        let angle = turn.norm();
        // NaN stays NaN.
        if angle.is_nan() || angle <= most {
            return;
        }
        let back = Quaternion::exp(turn * (most / angle)) * self.centre;
        let back = self.chart.variables(back);
        let put = match self.is_within(back) && keeps_others(back) {
            true => back,
            false => self.last_within(own, most, keeps_others),
        };
        x[self.variables()].copy_from_slice(&put);
    }

    /// Last point within all limits on the line of the variables from `inside`, if the line leaves the limits only
    /// once.
    ///
    /// Otherwise it is one of the points at which the line leaves them.
    fn last_within(
        &self,
        mut to: [f64; 3],
        most: f64,
        keeps_others: impl Fn([f64; 3]) -> bool,
    ) -> [f64; 3] {
        if let RotationChart::SwingTwist(_) = self.chart {
            // Whole revolutions of twist give the same rotation.
            to[2] -= TAU * ((to[2] - self.inside[2]) / TAU).round();
        }
        let at = |share: f64| [0, 1, 2].map(|k| self.inside[k] + share * (to[k] - self.inside[k]));
        at(bisect(0.0, 1.0, HALVINGS, |share| {
            self.angle(at(share)) <= most && keeps_others(at(share))
        }))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::{TAU, TurnLimit};
    use crate::model::{BallLimits, Limits, Model, ParameterMap};
    use crate::random::RandomStream;
    use crate::spatial::{Placement, Vector3};

    /// Whole revolutions of twist give the same rotation, hence the same projection.
    ///
    /// This also holds if the straight rotation back leaves the cone.
    #[test]
    fn whole_turns_of_twist_change_nothing() {
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
            let mut draw = |most: f64| most * (2.0 * random.unit() - 1.0);
            let centre = [draw(0.2), draw(0.8), draw(3.0)];
            let own = [draw(0.3), draw(1.2), centre[2] + draw(3.0)];
            if !in_cone(centre) || !in_cone(own) {
                continue;
            }
            let mut limit = TurnLimit::from_zero(0, chart, [0.0; 3], 0.4);
            limit.centre_at(&centre);
            let [mut put, mut wound] = [own; 2];
            wound[2] += 2.0 * TAU;
            limit.project(&mut put, in_cone);
            limit.project(&mut wound, in_cone);
            assert!(limit.is_within(put) && in_cone(put), "{put:?}");
            if limit.is_well_within(own, 1e-6) {
                continue;
            }
            let straight = limit.turn(own) * (0.4 / limit.angle(own));
            let back = super::Quaternion::exp(straight) * limit.centre;
            by_the_variables += u32::from(!in_cone(limit.chart.variables(back)));
            let apart = limit.chart.rotation(put).conjugate() * limit.chart.rotation(wound);
            assert!(apart.log().norm() < 1e-9, "{own:?}: {put:?} {wound:?}");
        }
        assert!(by_the_variables > 20, "{by_the_variables}");
    }
}
