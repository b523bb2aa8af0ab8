//! Segments that extend a path: straight lines, arcs and splines.

use glam::DVec3;

use super::{CartesianPath, PathError};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::curve::{Hermite, KeyedCurve};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3, rotation_exp};

/// Largest rotation between two points of a segment, radians.
const MAX_ROTATION: f64 = 0.05;
/// Largest number of points of a segment.
const MAX_POINTS: f64 = 1e6;
/// Smallest sine of the angle of an arc's positions.
const MIN_ARC_SINE: f64 = 1e-6;

/// Curve between the keys of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Curve {
    /// Straight lines. This is the default.
    #[default]
    Straight,
    /// Circular arcs, each through the position of a key to the next key.
    Arc,
    /// A Catmull-Rom spline.
    Spline,
}

impl CartesianPath {
    /// The path along a curve through its points as keys. Points are as in [`through`](Self::through).
    ///
    /// # Errors
    /// Returns the errors of [`through`](Self::through), [`arc_through`](Self::arc_through) and
    /// [`spline_through`](Self::spline_through), and an error for arcs with an even number of points.
    pub fn along(&self, curve: Curve, step: f64) -> Result<Self, PathError> {
        let (first, keys) = self.points.split_first().ok_or(PathError::Empty)?;
        self.check_extension(&self.points, step)?;
        let mut path = Self::new([*first])?.with_traversal(self.traversal);
        path.oriented = self.oriented;
        match curve {
            _ if keys.is_empty() => Ok(path),
            Curve::Straight => path.through(keys, step),
            Curve::Spline => path.spline_through(keys, step),
            Curve::Arc => keys.chunks(2).try_fold(path, |path, arc| match arc {
                [via, end] => path.arc_through(via.translation, end, step),
                _ => Err(PathError::ArcKeys(self.points.len())),
            }),
        }
    }

    /// Continues the path from its last point through keys (`base_from_tool`), on straight lines.
    ///
    /// Points are at most `step` metres and 0.05 rad apart, and include the keys. The tool rotates at a constant rate
    /// from key to key.
    ///
    /// # Errors
    /// Returns an error for a key that is not finite or not rigid to 1e-6.
    /// Returns an error for a `step` that is not positive or gives more than a million points, and for a path with times
    /// or tools.
    pub fn through(mut self, keys: &[Placement<f64>], step: f64) -> Result<Self, PathError> {
        self.check_extension(keys, step)?;
        for key in keys {
            let from = self.last().translation;
            let steps = self.steps_to(key, (key.translation - from).norm(), step)?;
            self.append_segment(*key, steps, |fraction, _| {
                (from + (key.translation - from) * fraction, 0.0)
            });
        }
        Ok(self)
    }

    /// Continues the path from its last point on a circular arc through the position `via` to `end`.
    ///
    /// The tool rotates at a constant rate from the last point to `end`. Points are as in [`through`](Self::through).
    ///
    /// # Errors
    /// Returns the errors of [`through`](Self::through), and an error for three positions on one line. A full circle
    /// is two arcs.
    pub fn arc_through(
        mut self,
        via: impl Into<Vector3<f64>>,
        end: impl Into<Placement<f64>>,
        step: f64,
    ) -> Result<Self, PathError> {
        let (via, end) = (via.into(), end.into());
        self.check_extension(&[Placement::translation(via), end], step)?;
        let start = self.last().translation;
        let (to_via, to_end) = (via - start, end.translation - start);
        let normal = to_via.cross(to_end);
        let [via_squared, end_squared, normal_squared] =
            [to_via, to_end, normal].map(Vector3::norm_squared);
        // Negated test: an overflow to NaN fails it.
        let is_arc = normal_squared > MIN_ARC_SINE * MIN_ARC_SINE * via_squared * end_squared
            && normal_squared.is_finite();
        if !is_arc {
            return Err(PathError::StraightArc);
        }
        // Circumcentre of the triangle of the three positions.
        let from_start = (to_end * via_squared - to_via * end_squared).cross(normal);
        let from_start = from_start * (0.5 / normal_squared);
        let (centre, first) = (start + from_start, -from_start);
        let last = end.translation - centre;
        let axis = normal * normal_squared.sqrt().recip();
        let angle = elementary::atan2(axis.dot(first.cross(last)), first.dot(last));
        let angle = if angle <= 0.0 {
            angle + std::f64::consts::TAU
        } else {
            angle
        };
        let radius = first.norm();
        let steps = self.steps_to(&end, radius * angle, step)?;
        let half = 0.5 * angle / steps as f64;
        let sagitta = radius * (1.0 - elementary::cos(half));
        self.append_segment(end, steps, |fraction, _| {
            let rotation = Matrix3::rotation(axis, elementary::sin_cos(angle * fraction));
            (centre + rotation * first, sagitta)
        });
        Ok(self)
    }

    /// Continues the path from its last point on a spline through keys (`base_from_tool`).
    ///
    /// It is the curve of [`spline`](Self::spline) through the last point and the keys, with uniform key times. Points
    /// are as in [`through`](Self::through).
    ///
    /// # Errors
    /// Returns the errors of [`through`](Self::through), and an error if the distances of keys overflow.
    pub fn spline_through(mut self, keys: &[Placement<f64>], step: f64) -> Result<Self, PathError> {
        self.check_extension(keys, step)?;
        let first = self.last();
        let positions = std::iter::once(&first).chain(keys);
        let positions: Vec<DVec3> = positions.map(|key| key.translation.into()).collect();
        let times = (0..positions.len()).map(|key| key as f64).collect();
        let curve = KeyedCurve::<DVec3>::catmull_rom(times, positions)?;
        for (key, (segment, _)) in keys.iter().zip(curve.cubics()) {
            let steps = self.steps_to(key, max_speed(&segment), step)?;
            self.append_cubic(&segment, *key, steps);
        }
        Ok(self)
    }

    fn last(&self) -> Placement<f64> {
        self.points.last().copied().unwrap_or(Placement::identity())
    }

    fn check_extension(&self, keys: &[Placement<f64>], step: f64) -> Result<(), PathError> {
        BadOption::check("step", step, POSITIVE)?;
        if !(self.times.is_empty() && self.tools.is_empty()) {
            return Err(PathError::Extended);
        }
        match keys.is_empty() {
            true => Err(PathError::Empty),
            false => Self::new(keys).map(|_| ()),
        }
    }

    /// Number of steps of a segment from the last point to `to` with a length in metres.
    fn steps_to(&self, to: &Placement<f64>, length: f64, step: f64) -> Result<usize, PathError> {
        let angle = self.rotation_to(to).norm();
        let steps = (length / step).max(angle / MAX_ROTATION).ceil().max(1.0);
        let allowed = "a step that gives at most 1000000 points for a segment";
        if steps > MAX_POINTS {
            BadOption::check("step", step, (|_| false, allowed))?;
        }
        Ok(steps as usize)
    }

    /// Rotation vector from the last point to another one, in the axes of the last point.
    fn rotation_to(&self, to: &Placement<f64>) -> Vector3<f64> {
        Quaternion::from_matrix(&(self.last().rotation.transpose() * to.rotation)).log()
    }

    /// Appends the points of a segment from the last point to `to`, which rotates at a constant rate.
    ///
    /// `position` gives the position at a fraction of the segment, and a bound on the distance of the curve from the
    /// straight step since the fraction before.
    pub(super) fn append_segment(
        &mut self,
        to: Placement<f64>,
        steps: usize,
        position: impl Fn(f64, f64) -> (Vector3<f64>, f64),
    ) {
        let from = self.last();
        let rotation = self.rotation_to(&to);
        self.bulges.resize(self.points.len(), 0.0);
        for step in 1..=steps {
            let fraction = step as f64 / steps as f64;
            let (position, bulge) = position(fraction, (step - 1) as f64 / steps as f64);
            let point = Placement::new(from.rotation * rotation_exp(rotation * fraction), position);
            self.points.push(match step == steps {
                true => to,
                false => point.made_rigid(),
            });
            self.bulges.push(bulge);
        }
    }
}

/// Upper bound of the speed of a cubic over its parameter: the control points of its derivative.
fn max_speed(curve: &Hermite<DVec3>) -> f64 {
    let middle = (curve.end - curve.start) * 3.0 - curve.leaving - curve.arriving;
    [curve.leaving, middle, curve.arriving]
        .map(DVec3::length)
        .into_iter()
        .fold(0.0, f64::max)
}
