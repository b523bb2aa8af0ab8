//! A ball joint that turns no further than an angle from where it stood, or from its zero.

use std::f64::consts::TAU;

use crate::bisection::bisect;
use crate::model::RotationChart;
use crate::spatial::{Quaternion, Vector3};

/// Within this share of its edge a turn is moved along the edge and across, so that what holds it is one variable.
const NEAR: f64 = 1e-6;
/// Within this share it stands on the edge …
const ON: f64 = 1e-12;
/// … and is put so far within it, for rounding, …
const WITHIN: f64 = 1e-14;
/// … and by so much more, in radians, for that of quaternions.
const ROUNDING: f64 = 1e-15;
/// What halves a way until nothing is left between two numbers.
const HALVINGS: usize = 52;

/// The rotations within an angle of one: three variables of which the turn to there has a length, as a ball has.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TurnLimit {
    /// The first variable; two others follow.
    pub(crate) first: usize,
    chart: RotationChart,
    centre: Quaternion<f64>,
    at_centre: [f64; 3],
    /// A place within all limits of the joint.
    inside: [f64; 3],
    /// The angle, in radians.
    pub(crate) most: f64,
}

impl TurnLimit {
    /// At most so far from the joint's zero, for a joint that has the variables `inside` within its limits.
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

    /// Takes for its centre where x is, which is within all limits of the joint.
    pub(crate) fn centre_at(&mut self, x: &[f64]) {
        let own = self.of(x);
        self.centre = self.chart.rotation(own);
        (self.at_centre, self.inside) = (own, own);
    }

    pub(crate) fn variables(&self) -> std::ops::Range<usize> {
        self.first..self.first + 3
    }

    /// How far around a variable of its own it lets go at most, but for what charts stretch.
    pub(crate) fn range_of(&self, variable: usize) -> (f64, f64) {
        let centre = self.at_centre[variable - self.first];
        (centre - self.most, centre + self.most)
    }

    fn of(&self, x: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| x[self.first + k])
    }

    /// The rotation vector from the centre.
    fn turn(&self, own: [f64; 3]) -> Vector3<f64> {
        (self.chart.rotation(own) * self.centre.conjugate()).log()
    }

    fn angle(&self, own: [f64; 3]) -> f64 {
        self.turn(own).norm()
    }

    /// Whether it is further from the edge than `share` of the angle, told without trigonometry where it can be:
    /// no rotation vector is longer than what it turns by, and a swing and a twist add up.
    fn is_well_within(&self, own: [f64; 3], share: f64) -> bool {
        let [a, b, c] = [0, 1, 2].map(|k| own[k] - self.at_centre[k]);
        let swing = (a * a + b * b).sqrt();
        let most = match self.chart {
            RotationChart::Exponential => (a * a + b * b + c * c).sqrt(),
            RotationChart::SwingTwist(_) => swing + c.abs(),
        };
        most < self.most * (1.0 - share) - ROUNDING
    }

    /// Whether it is as far as it may be.
    pub(in crate::solver) fn is_within(&self, own: [f64; 3]) -> bool {
        self.is_well_within(own, 0.0) || self.angle(own) <= self.most
    }

    /// Whether it stands on the edge, where it is near: with the outward normal there.
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

    /// Puts x within the angle: straight back towards the centre, or where that would leave the joint's other limits,
    /// by the variables' way to a place within all.
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

    /// A place within the angle, and within the joint's other limits, on the variables' way from the inside: the last
    /// where there is one way in and out.
    fn last_within(
        &self,
        mut to: [f64; 3],
        most: f64,
        keeps_others: impl Fn([f64; 3]) -> bool,
    ) -> [f64; 3] {
        if let RotationChart::SwingTwist(_) = self.chart {
            // A twist by whole turns more is the same.
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

    /// A twist wound up by whole turns is the same rotation, so it is put to the same place, also where the way straight
    /// back leaves the cone.
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
