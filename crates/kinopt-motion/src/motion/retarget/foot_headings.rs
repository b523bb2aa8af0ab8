//! Headings of feet that the hips do not reach.
//!
//! A foot far from the subject's heading rises on its toe: a steep foot is nearer to the direction aside than a flat one.
//! Its targets are therefore turned about the vertical to within a limit of its present heading.

use super::orientations::{FootAxes, direction, horizontal};
use super::retargeting::as_map_error;
use super::{RetargetError, Retargeting};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Largest angle between the heading of a foot and that of its targets, radians.
const MAX_HEADING_ERROR: f64 = 0.5;
/// Length of the horizontal part of a foot's axis below which the foot has no heading.
const MIN_HORIZONTAL: f64 = 0.3;

/// Targets of the driven points and axes in all samples.
pub(super) struct HeadedTargets {
    pub(super) positions: Vec<Vector3<f64>>,
    pub(super) directions: Vec<Vector3<f64>>,
}

impl FootAxes {
    /// Turns the directions of the foot, forward and left, and the position of its toe about its ankle.
    pub(super) fn limit_heading(
        &self,
        rotation: &Matrix3<f64>,
        directions: &mut [Vector3<f64>],
        positions: &mut [Vector3<f64>],
    ) {
        let [forward, left] = directions else { return };
        let Some((cosine, sine)) = turn(*rotation * self.axis().axis, *forward) else {
            return;
        };
        let turned = |v: Vector3<f64>| {
            let (x, y) = (cosine * v.x - sine * v.y, sine * v.x + cosine * v.y);
            Vector3::new(x, y, v.z)
        };
        (*forward, *left) = (turned(*forward), turned(*left));
        if let (ankle, Some(toe)) = self.limbs() {
            positions[toe] = positions[ankle] + turned(positions[toe] - positions[ankle]);
        }
    }
}

/// Returns cosine and sine of the rotation about the vertical that brings a target within the limit of a heading;
/// `None` if it is, or if one of them is steep.
fn turn(axis: Vector3<f64>, target: Vector3<f64>) -> Option<(f64, f64)> {
    let [axis, target] = [axis, target].map(horizontal);
    if axis.norm().min(target.norm()) < MIN_HORIZONTAL {
        return None;
    }
    let (axis, target) = (direction(axis)?, direction(target)?);
    let error = elementary::atan2(target.cross(axis).z, target.dot(axis));
    let excess = error.abs() - MAX_HEADING_ERROR;
    let angle = excess.copysign(error);
    (excess > 0.0).then(|| (elementary::cos(angle), elementary::sin(angle)))
}

impl Retargeting<'_> {
    /// Returns the targets with the headings that feet reach in configurations `q`.
    pub(super) fn headed_targets(&self, q: &[f64]) -> Result<HeadedTargets, RetargetError> {
        let (mut positions, mut directions) = (self.targets.to_vec(), self.directions.to_vec());
        let model = self.body.model();
        let feet: Vec<&FootAxes> = self.limbs.orientations.foot_axes().collect();
        let frames: Vec<FrameId> = feet.iter().map(|foot| foot.axis().frame).collect();
        let samples = self.frames().max(1);
        let (points, axes) = (self.limbs.all.len(), directions.len() / samples);
        if frames.is_empty() || axes == 0 {
            return Ok(HeadedTargets {
                positions,
                directions,
            });
        }
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let samples = q.chunks_exact(model.configuration_len());
        let targets = positions.chunks_exact_mut(points);
        let targets = targets.zip(directions.chunks_exact_mut(axes));
        for (q, (positions, directions)) in samples.zip(targets) {
            let placed = kinematics.place(q).map_err(as_map_error)?;
            let of_feet = directions.chunks_exact_mut(2);
            for ((foot, placed), directions) in feet.iter().zip(placed).zip(of_feet) {
                foot.limit_heading(&placed.rotation, directions, positions);
            }
        }
        Ok(HeadedTargets {
            positions,
            directions,
        })
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "tests")]
mod tests {
    use super::turn;
    use kinopt_kinematics::spatial::Vector3;

    #[test]
    fn far_target_is_turned_to_the_limit() {
        let axis = Vector3::new(1.0, 0.0, 0.1);
        for angle in [1.4_f64, -2.0] {
            let target = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let (cosine, sine) = turn(axis, target).unwrap_or_default();
            let y = sine * target.x + cosine * target.y;
            assert!((y.asin() - 0.5_f64.copysign(angle)).abs() < 1e-12, "{y}");
        }
        assert_eq!(turn(axis, Vector3::new(0.9, 0.3, 0.0)), None);
        assert_eq!(turn(Vector3::new(0.1, 0.0, -0.99), Vector3::UNITS[1]), None);
    }
}
