//! Map from rates of a problem's variables to a velocity of the model.

use kinopt_kinematics::model::{Model, ParameterMap, Segment, SegmentKind, Source, quaternion_at};
use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3};

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
fn slope_by_angular_velocity(q: &[f64], slope_by_q: &[f64]) -> [f64; 3] {
    let Some(Quaternion { w, v }) = quaternion_at(q) else {
        return [0.0; 3];
    };
    let (slope_by_w, slope_by_vector) = (
        slope_by_q[0],
        Vector3::new(slope_by_q[1], slope_by_q[2], slope_by_q[3]),
    );
    // The vector part of ½ q* by_q.
    ((slope_by_vector * w - v * slope_by_w - v.cross(slope_by_vector)) * 0.5).to_array()
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
    pub(crate) fn velocity(&self, point: &TangentPoint<'_>, rates: &[f64], v: &mut [f64]) {
        let rate = |coordinate| {
            point
                .slope(coordinate)
                .map_or(0.0, |(k, ratio)| ratio * rates[k])
        };
        let angular_velocity = |coordinate| match point.ball_axes(coordinate) {
            Some((first, [x, y, z])) => {
                let world_velocity = x * rates[first] + y * rates[first + 1] + z * rates[first + 2];
                point.rotation(coordinate).transpose_mul(world_velocity)
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
                SegmentKind::Scalar => v[0] = rate(*coordinate),
                SegmentKind::Ball => {
                    v[..3].copy_from_slice(&angular_velocity(*coordinate).to_array())
                }
                SegmentKind::Free => {
                    let linear = Vector3::from([0, 1, 2].map(|k| rate(coordinate + k)));
                    let linear = point.rotation(coordinate + 3).transpose_mul(linear);
                    v[..3].copy_from_slice(&linear.to_array());
                    v[3..6].copy_from_slice(&angular_velocity(coordinate + 3).to_array());
                }
            }
        }
    }

    /// Adds derivatives by v, converted to derivatives by the variables: the transpose of [`velocity`](Self::velocity).
    pub(crate) fn add_slope(
        &self,
        point: &TangentPoint<'_>,
        slope_by_v: &[f64],
        slope: &mut [f64],
    ) {
        for Segment {
            kind,
            coordinate,
            velocity,
            ..
        } in &self.segments
        {
            let slope_by_v = &slope_by_v[*velocity..];
            let mut add = |coordinate, slope_by_value: f64| {
                if let Some((variable, ratio)) = point.slope(coordinate) {
                    slope[variable] += ratio * slope_by_value;
                }
            };
            let (ball, slope_by_turn) = match kind {
                SegmentKind::Scalar => {
                    add(*coordinate, slope_by_v[0]);
                    continue;
                }
                SegmentKind::Ball => (*coordinate, slope_by_v),
                SegmentKind::Free => {
                    let rotation = point.rotation(coordinate + 3);
                    let slope_by_linear =
                        rotation * Vector3::new(slope_by_v[0], slope_by_v[1], slope_by_v[2]);
                    for (k, slope_by_linear) in slope_by_linear.to_array().into_iter().enumerate() {
                        add(coordinate + k, slope_by_linear);
                    }
                    (coordinate + 3, &slope_by_v[3..])
                }
            };
            if let Some((first, axes)) = point.ball_axes(ball) {
                let slope_by_angular =
                    Vector3::new(slope_by_turn[0], slope_by_turn[1], slope_by_turn[2]);
                let slope_by_angular = point.rotation(ball) * slope_by_angular;
                for (slope, axis) in slope[first..].iter_mut().zip(axes) {
                    *slope += axis.dot(slope_by_angular);
                }
            }
        }
    }

    /// Converts derivatives by the coordinates of a configuration, quaternions included, to derivatives by v.
    pub(crate) fn slope_by_velocity(&self, q: &[f64], slope_by_q: &[f64], slope_by_v: &mut [f64]) {
        for Segment {
            kind,
            coordinate,
            velocity,
            ..
        } in &self.segments
        {
            let (q, slope_by_q) = (&q[*coordinate..], &slope_by_q[*coordinate..]);
            let slope_by_v = &mut slope_by_v[*velocity..];
            match kind {
                SegmentKind::Scalar => slope_by_v[0] = slope_by_q[0],
                SegmentKind::Ball => {
                    slope_by_v[..3].copy_from_slice(&slope_by_angular_velocity(q, slope_by_q))
                }
                SegmentKind::Free => {
                    let rotation =
                        quaternion_at(&q[3..]).map_or(Matrix3::identity(), Quaternion::to_matrix);
                    let slope_by_linear = rotation.transpose_mul(Vector3::new(
                        slope_by_q[0],
                        slope_by_q[1],
                        slope_by_q[2],
                    ));
                    slope_by_v[..3].copy_from_slice(&slope_by_linear.to_array());
                    slope_by_v[3..6]
                        .copy_from_slice(&slope_by_angular_velocity(&q[3..], &slope_by_q[3..]));
                }
            }
        }
    }

    /// Writes the squared norm of v for a unit rate of each variable; 0 for variables of ball joints.
    pub(crate) fn squared_speeds(&self, point: &TangentPoint<'_>, squared: &mut [f64]) {
        squared.fill(0.0);
        for coordinate in 0..point.map.sources().len() {
            if let Some((variable, ratio)) = point.slope(coordinate) {
                squared[variable] += ratio * ratio;
            }
        }
    }
}
