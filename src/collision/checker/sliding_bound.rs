//! Longer steps of conservative advancement for pairs that slide past each other.
//!
//! Along a fixed direction n, the gap between two bodies is min n·b − max n·a over their points. Over a span s of the
//! motion, n·p(t) of a point deviates from linear interpolation by at most K s²/8. K bounds the point's acceleration.
//! The gap is therefore at least the smaller end gap minus that amount, for any tangential motion. Conservative
//! advancement along a table takes steps proportional to the clearance; these steps are proportional to its square
//! root.

use super::continuous_check::Slow;
use super::motion_bound::BoundWorkspace;
use super::parts::{Pair, Scene};
use super::scene_placements::SceneWorkspace;
use super::{Checker, CheckerWorkspace};
use crate::kinematics::KinematicsError;
use crate::spatial::{Placement, Vector3};

/// Number of spans tried, each half as long as the last.
const TRIES: usize = 3;

impl Checker {
    /// Share of the motion up to which the given pairs stay farther apart than `least` beyond their margins. At least
    /// `known`.
    ///
    /// The gaps are measured along the directions that separate the pairs at `here`.
    pub(super) fn slides_until(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        here: f64,
        known: f64,
        slow: &[(usize, Slow)],
        least: f64,
    ) -> Result<f64, KinematicsError> {
        // The curvature uses up half of the smallest gap.
        let span = |one: &Slow| {
            let room = one.room.max(0.0);
            (4.0 * room / self.bend(one.pair, &workspace.bound)).sqrt()
        };
        let longest = slow
            .iter()
            .map(|(_, one)| span(one))
            .fold(f64::INFINITY, f64::min);
        // NaN if the acceleration is unbounded.
        let mut span = if longest.is_nan() {
            0.0
        } else {
            longest.min(1.0 - here)
        };
        let mut q = std::mem::take(&mut workspace.there);
        q.resize(from.len(), 0.0);
        let mut until = Ok(known);
        for _ in 0..TRIES {
            // Only a substantial gain is worth a check.
            if here + span <= here + 2.0 * (known - here) {
                break;
            }
            let there = here + span;
            let reached = self.model.model().interpolate(from, to, there, &mut q);
            debug_assert!(reached.is_ok(), "both ends were checked");
            match self.stay_apart(workspace, &q, span, slow, least) {
                Ok(true) => {
                    until = Ok(there);
                    break;
                }
                Ok(false) => span *= 0.5,
                Err(error) => {
                    until = Err(error);
                    break;
                }
            }
        }
        workspace.there = q;
        until
    }

    /// True if all pairs stay apart along a span that ends at `q`.
    fn stay_apart(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        span: f64,
        slow: &[(usize, Slow)],
        least: f64,
    ) -> Result<bool, KinematicsError> {
        // Deviation K s²/8, without the factor K.
        let bends: f64 = 0.125 * span * span;
        let (placements, room, bound) = workspace.place_on_way(q)?;
        self.scene.begin(room);
        Ok(slow.iter().all(|(_, one)| {
            let bends = bends * self.bend(one.pair, bound);
            let gap = self.scene.gap_along(one.pair, one.normal, placements, room);
            // A NaN gap fails the comparison.
            gap.is_some_and(|gap| one.room.min(gap - one.margin) - bends > least)
        }))
    }

    /// Upper bound of the acceleration with which a pair approaches in the whole motion, metres.
    fn bend(&self, pair: Pair, room: &BoundWorkspace) -> f64 {
        let bound = self.scene.motion_bound();
        match pair {
            Pair::Standing(part, _) => bound.bend_of(part, room),
            Pair::Parts(a, b) => bound.bend_of(a, room) + bound.bend_of(b, room),
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
        room: &mut SceneWorkspace,
    ) -> Option<f64> {
        let (first, normal, second) = match pair {
            Pair::Standing(part, standing) => {
                let (shape, at) = self.standing_at(standing);
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
                self.reach_of(second, -normal, placements, room)?,
            ),
        };
        Some(-second - self.reach_of(first, normal, placements, room)?)
    }

    /// Largest coordinate of a part along a direction, metres; `None` if a shape is not convex.
    fn reach_of(
        &self,
        part: usize,
        along: Vector3<f64>,
        placements: &[Placement<f64>],
        room: &mut SceneWorkspace,
    ) -> Option<f64> {
        let (own, placed) = self.placed(part, placements, room);
        let mut most = f64::NEG_INFINITY;
        for (own, at) in own.iter().zip(placed) {
            most = most.max(own.shape.reach_along(&at.world_from_shape, along)?);
        }
        Some(most)
    }
}
