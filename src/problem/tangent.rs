//! Map from rates of a problem's variables to a velocity of the model.

use crate::model::{Model, ParameterMap, Segment, SegmentKind, Source, quaternion_at};
use crate::spatial::{Matrix3, Quaternion, Vector3};

/// The map ẋ ↦ v, with v as in [`Model::integrate`].
#[derive(Clone, Debug)]
pub(crate) struct Tangent {
    segments: Vec<Segment>,
    degrees_of_freedom: usize,
}

/// A configuration with its variables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentPoint<'a> {
    pub(crate) map: &'a ParameterMap,
    pub(crate) x: &'a [f64],
    pub(crate) q: &'a [f64],
}

impl TangentPoint<'_> {
    /// The variables of a ball joint whose quaternion starts at `coordinate`: first index, and angular velocity per
    /// unit rate.
    ///
    /// Axes are in the frame before its rotation. `None` if no variables move the joint.
    fn ball_axes(&self, coordinate: usize) -> Option<(usize, [Vector3<f64>; 3])> {
        let mut balls = self.map.balls().iter();
        let ball = balls.find(|ball| ball.coordinate == coordinate)?;
        Some((ball.variable, ball.chart.axes(ball.of(self.x)?)))
    }

    fn rotation(&self, coordinate: usize) -> Matrix3<f64> {
        quaternion_at(&self.q[coordinate..]).map_or(Matrix3::identity(), Quaternion::to_matrix)
    }

    fn slope(&self, coordinate: usize) -> Option<(usize, f64)> {
        self.map.sources().get(coordinate).and_then(Source::slope)
    }
}

/// Converts derivatives by a quaternion to derivatives by its angular velocity in its own axes: q' = ½ q ω.
fn by_turn(q: &[f64], by_q: &[f64]) -> [f64; 3] {
    let Some(Quaternion { w, v }) = quaternion_at(q) else {
        return [0.0; 3];
    };
    let (by_w, by) = (by_q[0], Vector3::new(by_q[1], by_q[2], by_q[3]));
    // The vector part of ½ q* by_q.
    ((by * w - v * by_w - v.cross(by)) * 0.5).to_array()
}

impl Tangent {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            segments: model.segments().to_vec(),
            degrees_of_freedom: model.degrees_of_freedom(),
        }
    }

    /// Number of components of a velocity.
    pub(crate) fn degrees_of_freedom(&self) -> usize {
        self.degrees_of_freedom
    }

    /// Writes v for the rates of the variables.
    pub(crate) fn velocity(&self, at: &TangentPoint<'_>, rates: &[f64], v: &mut [f64]) {
        let along = |coordinate| at.slope(coordinate).map_or(0.0, |(k, by)| by * rates[k]);
        let turn = |coordinate| match at.ball_axes(coordinate) {
            Some((first, [x, y, z])) => {
                let omega = x * rates[first] + y * rates[first + 1] + z * rates[first + 2];
                at.rotation(coordinate).transpose_mul(omega)
            }
            None => Vector3::zero(),
        };
        for Segment {
            kind,
            coordinate,
            velocity,
            ..
        } in &self.segments
        {
            let v = &mut v[*velocity..];
            match kind {
                SegmentKind::Scalar => v[0] = along(*coordinate),
                SegmentKind::Ball => v[..3].copy_from_slice(&turn(*coordinate).to_array()),
                SegmentKind::Free => {
                    let way = Vector3::from([0, 1, 2].map(|k| along(coordinate + k)));
                    let way = at.rotation(coordinate + 3).transpose_mul(way);
                    v[..3].copy_from_slice(&way.to_array());
                    v[3..6].copy_from_slice(&turn(coordinate + 3).to_array());
                }
            }
        }
    }

    /// Adds derivatives by v, converted to derivatives by the variables: the transpose of [`velocity`](Self::velocity).
    pub(crate) fn add_slope(&self, at: &TangentPoint<'_>, by_v: &[f64], slope: &mut [f64]) {
        for Segment {
            kind,
            coordinate,
            velocity,
            ..
        } in &self.segments
        {
            let by_v = &by_v[*velocity..];
            let mut along = |coordinate, by_value: f64| {
                if let Some((variable, ratio)) = at.slope(coordinate) {
                    slope[variable] += ratio * by_value;
                }
            };
            let (ball, by_turn) = match kind {
                SegmentKind::Scalar => {
                    along(*coordinate, by_v[0]);
                    continue;
                }
                SegmentKind::Ball => (*coordinate, by_v),
                SegmentKind::Free => {
                    let rotation = at.rotation(coordinate + 3);
                    let by_way = rotation * Vector3::new(by_v[0], by_v[1], by_v[2]);
                    for (k, by_way) in by_way.to_array().into_iter().enumerate() {
                        along(coordinate + k, by_way);
                    }
                    (coordinate + 3, &by_v[3..])
                }
            };
            if let Some((first, axes)) = at.ball_axes(ball) {
                let by_omega = Vector3::new(by_turn[0], by_turn[1], by_turn[2]);
                let by_omega = at.rotation(ball) * by_omega;
                for (slope, axis) in slope[first..].iter_mut().zip(axes) {
                    *slope += axis.dot(by_omega);
                }
            }
        }
    }

    /// Converts derivatives by the coordinates of a configuration, quaternions included, to derivatives by v.
    pub(crate) fn slope_by_velocity(&self, q: &[f64], by_q: &[f64], by_v: &mut [f64]) {
        for Segment {
            kind,
            coordinate,
            velocity,
            ..
        } in &self.segments
        {
            let (q, by_q) = (&q[*coordinate..], &by_q[*coordinate..]);
            let by_v = &mut by_v[*velocity..];
            match kind {
                SegmentKind::Scalar => by_v[0] = by_q[0],
                SegmentKind::Ball => by_v[..3].copy_from_slice(&by_turn(q, by_q)),
                SegmentKind::Free => {
                    let turned =
                        quaternion_at(&q[3..]).map_or(Matrix3::identity(), Quaternion::to_matrix);
                    let along = turned.transpose_mul(Vector3::new(by_q[0], by_q[1], by_q[2]));
                    by_v[..3].copy_from_slice(&along.to_array());
                    by_v[3..6].copy_from_slice(&by_turn(&q[3..], &by_q[3..]));
                }
            }
        }
    }

    /// Writes the squared norm of v for a unit rate of each variable; 0 for variables of ball joints.
    pub(crate) fn squared_speeds(&self, at: &TangentPoint<'_>, squared: &mut [f64]) {
        squared.fill(0.0);
        for coordinate in 0..at.map.sources().len() {
            if let Some((variable, ratio)) = at.slope(coordinate) {
                squared[variable] += ratio * ratio;
            }
        }
    }
}
