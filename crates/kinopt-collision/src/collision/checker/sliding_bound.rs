//! Longer steps of conservative advancement for pairs that slide past each other.
//!
//! Along a fixed direction n, the gap between two bodies is min n·b − max n·a over their points. Over a span s of the
//! motion, n·p(t) of a point deviates from linear interpolation by at most K s²/8. K bounds the point's acceleration.
//! The gap is therefore at least the smaller end gap minus that amount, for any tangential motion. Conservative
//! advancement along a table takes steps proportional to the clearance; these steps are proportional to its square
//! root.

use super::continuous_check::SlidingPair;
use super::motion_bound::BoundWorkspace;
use super::parts::{Pair, Scene};
use super::scene_placements::SceneWorkspace;
use super::{Checker, CheckerWorkspace};
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Number of spans tried, each half as long as the last.
const MAX_SPANS: usize = 3;

impl Checker {
    /// Share of the motion up to which the given pairs stay farther apart than `min_slack` beyond their margins. At
    /// least `known_share`.
    ///
    /// The gaps are measured along the directions that separate the pairs at `share`.
    pub(super) fn max_sliding_share(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        share: f64,
        known_share: f64,
        sliding_pairs: &[(usize, SlidingPair)],
        min_slack: f64,
    ) -> Result<f64, KinematicsError> {
        // The curvature uses up half of the smallest gap.
        let span = |sliding: &SlidingPair| {
            let slack = sliding.slack.max(0.0);
            (4.0 * slack / self.max_acceleration(sliding.pair, &workspace.bound)).sqrt()
        };
        let longest = sliding_pairs
            .iter()
            .map(|(_, sliding)| span(sliding))
            .fold(f64::INFINITY, f64::min);
        // NaN if the acceleration is unbounded.
        let mut span = if longest.is_nan() {
            0.0
        } else {
            longest.min(1.0 - share)
        };
        let mut q = std::mem::take(&mut workspace.sliding_configuration);
        q.resize(from.len(), 0.0);
        let mut proven_share = Ok(known_share);
        for _ in 0..MAX_SPANS {
            // Only a substantial gain is worth a check.
            if share + span <= share + 2.0 * (known_share - share) {
                break;
            }
            let end_share = share + span;
            let reached = self.model.model().interpolate(from, to, end_share, &mut q);
            debug_assert!(reached.is_ok(), "both ends were checked");
            match self.stay_apart(workspace, &q, span, sliding_pairs, min_slack) {
                Ok(true) => {
                    proven_share = Ok(end_share);
                    break;
                }
                Ok(false) => span *= 0.5,
                Err(error) => {
                    proven_share = Err(error);
                    break;
                }
            }
        }
        workspace.sliding_configuration = q;
        proven_share
    }

    /// True if all pairs stay apart along a span that ends at `q`.
    fn stay_apart(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        span: f64,
        sliding_pairs: &[(usize, SlidingPair)],
        min_slack: f64,
    ) -> Result<bool, KinematicsError> {
        // Deviation K s²/8, without the factor K.
        let deviation: f64 = 0.125 * span * span;
        let (placements, scene_workspace, bound) = workspace.place_in_motion(q)?;
        self.scene.begin(scene_workspace);
        Ok(sliding_pairs.iter().all(|(_, sliding)| {
            let deviation = deviation * self.max_acceleration(sliding.pair, bound);
            let gap =
                self.scene
                    .gap_along(sliding.pair, sliding.normal, placements, scene_workspace);
            // A NaN gap fails the comparison.
            gap.is_some_and(|gap| sliding.slack.min(gap - sliding.margin) - deviation > min_slack)
        }))
    }

    /// Upper bound of the acceleration with which a pair approaches in the whole motion, metres.
    fn max_acceleration(&self, pair: Pair, workspace: &BoundWorkspace) -> f64 {
        let bound = self.scene.motion_bound();
        match pair {
            Pair::FixedObstacle(part, _) => bound.acceleration_of(part, workspace),
            Pair::Parts(a, b) => {
                bound.acceleration_of(a, workspace) + bound.acceleration_of(b, workspace)
            }
        }
    }
}

impl Scene {
    /// Gap of a pair along a direction from the first to the second, metres; `None` if a shape is not convex.
    pub(super) fn gap_along(
        &self,
        pair: Pair,
        normal: Vector3<f64>,
        placements: &[Placement<f64>],
        workspace: &mut SceneWorkspace,
    ) -> Option<f64> {
        let (first, normal, second) = match pair {
            Pair::FixedObstacle(part, obstacle) => {
                let (shape, at) = self.fixed_obstacle(obstacle);
                // A half-space is bounded only along its normal.
                let normal = match shape.is_half_space() {
                    true => -at.rotation.z,
                    false => normal,
                };
                (part, normal, shape.reach_along(at, -normal)?)
            }
            Pair::Parts(first, second) => (
                first,
                normal,
                self.part_reach(second, -normal, placements, workspace)?,
            ),
        };
        Some(-second - self.part_reach(first, normal, placements, workspace)?)
    }

    /// Largest coordinate of a part along a direction, metres; `None` if a shape is not convex.
    fn part_reach(
        &self,
        part: usize,
        along: Vector3<f64>,
        placements: &[Placement<f64>],
        workspace: &mut SceneWorkspace,
    ) -> Option<f64> {
        let (shapes, placed) = self.placed(part, placements, workspace);
        let mut max_reach = f64::NEG_INFINITY;
        for (shape, placed) in shapes.iter().zip(placed) {
            max_reach = max_reach.max(shape.shape.reach_along(&placed.world_from_shape, along)?);
        }
        Some(max_reach)
    }
}
