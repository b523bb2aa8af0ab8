//! What slides past something stays apart for longer than its room over its motion says.
//!
//! Along a fixed direction n the gap between two bodies is min n·b − max n·a over their places. Each place's n·p(t) is off the straight line between
//! its values at both ends of a span of the way by at most K/8 times the span squared, where K bounds its acceleration; so the gap is nowhere less than at
//! the ends by more than that, however far the bodies go across n. Where conservative advancement alone creeps by a hair's breadth a step along a
//! table, this goes by the square root of it.

use super::continuous_check::Slow;
use super::motion_bound::BoundRoom;
use super::parts::{Pair, Scene};
use super::scene_placements::SceneRoom;
use super::{Checker, CheckerWorkspace};
use crate::kinematics::KinematicsError;
use crate::spatial::{Placement, Vector3};

/// Shorter spans are tried so often, each half as long.
const TRIES: usize = 3;

impl Checker {
    /// How far what is slow stays surely apart by more than `least` beyond the margin, found along the directions in which it is apart
    /// `here`; no less than is known.
    pub(super) fn slides_until(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        here: f64,
        known: f64,
        slow: &[(usize, Slow)],
        least: f64,
    ) -> Result<f64, KinematicsError> {
        // Half of the least room for what the way bends.
        let span = |one: &Slow| {
            let room = one.room.max(0.0);
            (4.0 * room / self.bend(one.pair, &workspace.bound)).sqrt()
        };
        let longest = slow
            .iter()
            .map(|(_, one)| span(one))
            .fold(f64::INFINITY, f64::min);
        // Not a number where nothing bounds the way.
        let mut span = if longest.is_nan() {
            0.0
        } else {
            longest.min(1.0 - here)
        };
        let mut q = std::mem::take(&mut workspace.there);
        q.resize(from.len(), 0.0);
        let mut until = Ok(known);
        for _ in 0..TRIES {
            // Worth a look only where it goes well beyond.
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

    /// Whether what was apart at the begin of a span, which ends at q, is so all along it.
    fn stay_apart(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        span: f64,
        slow: &[(usize, Slow)],
        least: f64,
    ) -> Result<bool, KinematicsError> {
        let bends: f64 = 0.125 * span * span;
        let (placements, room, bound) = workspace.place_on_way(q)?;
        self.scene.begin(room);
        Ok(slow.iter().all(|(_, one)| {
            let bends = bends * self.bend(one.pair, bound);
            let gap = self.scene.gap_along(one.pair, one.normal, placements, room);
            // Not a number is no gap.
            gap.is_some_and(|gap| one.room.min(gap - one.margin) - bends > least)
        }))
    }

    /// A bound on the acceleration with which two come together, on the whole way.
    fn bend(&self, pair: Pair, room: &BoundRoom) -> f64 {
        let bound = self.scene.motion_bound();
        match pair {
            Pair::Standing(part, _) => bound.bend_of(part, room),
            Pair::Parts(a, b) => bound.bend_of(a, room) + bound.bend_of(b, room),
        }
    }
}

impl Scene {
    /// How much room is between two along a direction from the first to the second; `None` for what is not convex.
    pub(super) fn gap_along(
        &self,
        pair: Pair,
        normal: Vector3<f64>,
        placements: &[Placement<f64>],
        room: &mut SceneRoom,
    ) -> Option<f64> {
        let (first, normal, second) = match pair {
            Pair::Standing(part, standing) => {
                let (shape, at) = self.standing_at(standing);
                // A plane has no end but along its own normal.
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

    /// How far a part reaches along a direction.
    fn reach_of(
        &self,
        part: usize,
        along: Vector3<f64>,
        placements: &[Placement<f64>],
        room: &mut SceneRoom,
    ) -> Option<f64> {
        let (own, placed) = self.placed(part, placements, room);
        let mut most = f64::NEG_INFINITY;
        for (own, at) in own.iter().zip(placed) {
            most = most.max(own.shape.reach_along(&at.world_from_shape, along)?);
        }
        Some(most)
    }
}
