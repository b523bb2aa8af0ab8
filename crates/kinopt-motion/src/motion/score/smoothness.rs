//! Jerk of joints and points: third differences.

use super::body_points::PointTrack;
use super::{ScoreError, Spread};
use kinopt_kinematics::model::{Model, SegmentKind};
use kinopt_kinematics::spatial::Vector3;

/// Jerk of points over all samples, in the unit of the track per s³.
pub(super) fn point_jerk(track: &PointTrack, points: &[usize], frame_rate: f64) -> Spread {
    let cubed = frame_rate * frame_rate * frame_rate;
    let jerks = points.iter().flat_map(|&point| {
        let positions = track.of_point(point);
        let thirds: Vec<f64> = positions
            .windows(4)
            .map(|p| {
                let third: Vector3<f64> = p[3] - p[0] - (p[2] - p[1]) * 3.0;
                third.norm() * cubed
            })
            .collect();
        thirds
    });
    Spread::of(jerks.collect())
}

/// Jerk of joint angles over all samples, rad/s³. The free base and sliding joints are left out.
pub(super) fn joint_jerk(model: &Model, q: &[f64], frame_rate: f64) -> Result<Spread, ScoreError> {
    let width = model.configuration_len().max(1);
    let rows: Vec<&[f64]> = q.chunks_exact(width).collect();
    let freedom = model.degrees_of_freedom();
    let mut velocities = Vec::with_capacity(rows.len());
    for pair in rows.windows(2) {
        let mut v = vec![0.0; freedom];
        model.difference(pair[0], pair[1], &mut v)?;
        velocities.push(v);
    }
    let angles = model
        .segments()
        .iter()
        .filter_map(|segment| match segment.kind {
            SegmentKind::Free => None,
            SegmentKind::Ball => Some(segment.velocity..segment.velocity + 3),
            SegmentKind::Scalar => {
                let slides = model.joint_of(segment.coordinate).kind.slides();
                (!slides).then_some(segment.velocity..segment.velocity + 1)
            }
        });
    let cubed = frame_rate * frame_rate * frame_rate;
    let mut jerks = Vec::new();
    for range in angles {
        for v in velocities.windows(3) {
            let squares = range.clone().map(|k| {
                let second = v[2][k] - 2.0 * v[1][k] + v[0][k];
                second * second
            });
            jerks.push(squares.sum::<f64>().sqrt() * cubed);
        }
    }
    Ok(Spread::of(jerks))
}
