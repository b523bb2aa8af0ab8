//! Distinct solutions at every station of a path.
//!
//! Each station has the continued solutions of the previous station (on their branch, or self-motion), and sometimes
//! new ones. New solutions are continued backwards too, so that every branch is known over its whole extent.

use std::f64::consts::TAU;

use super::PathError;
use super::branch_continuation::{Carrier, FEW};
use super::knots::Knots;
use super::neighbour_index::Sorted;
use super::step_bounds::StepBounds;
use super::tools::Tools;
use super::winding::Turns;
use crate::arm::{Ends, QueryError};

/// Distance below which two configurations are merged, radians (for every joint).
const MERGING: f32 = 0.03;
/// Number of attempts at the first station, and at later stations with few known branches.
const FIRST_ATTEMPTS: u32 = 96;
const ATTEMPTS: u32 = 8;
/// Number of stations between such searches.
const LOOKS: usize = 4;
/// Number of attempts if no configuration is known.
pub(super) const LAST_ATTEMPTS: u32 = 200;
/// Distance from a joint limit, radians, below which the configuration one revolution back is added.
const NEAR_LIMIT: f64 = 0.4;

/// Link of a configuration that was not followed in parts from any predecessor.
pub(super) const UNLINKED: u16 = u16::MAX;

/// Configurations of one station. Single precision suffices as a start.
#[derive(Clone, Debug, Default)]
pub(super) struct Layer {
    pub(super) q: Vec<f32>,
    /// For each configuration, that of the previous station from (or to) which it was followed in parts, or merged;
    /// empty if none.
    pub(super) links: Vec<u16>,
    /// True if further configurations were dropped.
    pub(super) full: bool,
    /// True if no configuration reaches the target without collision. The layer then has the nearest one found.
    pub(super) missed: bool,
}

/// Generator of the layers, with its settings.
#[derive(Debug)]
pub(super) struct Growth<'a> {
    pub(super) arms: &'a Tools<'a>,
    pub(super) knots: &'a Knots,
    pub(super) bounds: &'a StepBounds,
    /// Maximum number of configurations per station. A quarter is reserved for backward continuation.
    pub(super) most: usize,
    /// Number of continued configurations below which a station searches for more.
    pub(super) looked_for: usize,
    /// Given configurations at the start and end of the path.
    pub(super) start: Option<&'a [f64]>,
    pub(super) end: Option<&'a [f64]>,
    /// For a cyclic path with a free start, joint displacement over one cycle. Both ends then move together.
    pub(super) ring: Option<Vec<f64>>,
    /// Reference values of unlimited joints, merging distances, and flags of prismatic joints.
    pub(super) middle: Vec<f64>,
    pub(super) merging: Vec<f32>,
    pub(super) slides: Vec<bool>,
    /// Joints whose whole revolutions are ignored.
    pub(super) turns: Turns,
}

/// Scratch memory of searches at a station.
#[derive(Debug, Default)]
struct LayerWorkspace {
    ends: Ends,
    reached: Vec<f64>,
    free: Vec<bool>,
}

impl<'a> Growth<'a> {
    /// Computes the merging distances and the centres of the joint limits.
    pub(super) fn new(
        arms: &'a Tools<'a>,
        knots: &'a Knots,
        bounds: &'a StepBounds,
        most: usize,
    ) -> Self {
        let arm = arms.own();
        let middle = arm.limits().map(|limits| {
            let middle = 0.5 * (limits.lower + limits.upper);
            if middle.is_finite() { middle } else { 0.0 }
        });
        Self {
            arms,
            knots,
            bounds,
            most,
            looked_for: most / 2,
            start: None,
            end: None,
            ring: None,
            middle: middle.collect(),
            merging: (arm.scales().iter())
                .map(|scale| MERGING / *scale as f32)
                .collect(),
            slides: arm.slides(),
            turns: Turns::kept(arm.joint_count()),
        }
    }

    /// Returns one layer per station.
    pub(super) fn layers(&self) -> Result<Vec<Layer>, PathError> {
        let stations = &self.knots.stations;
        let mut room = LayerWorkspace::default();
        let mut carrier = Carrier::default();
        let mut layers: Vec<Layer> = vec![Layer::default(); stations.len()];
        // Number of configurations that came from the previous station.
        let mut carried = vec![0_usize; stations.len()];
        match self.start {
            Some(start) => layers[0].take_folded(start, &self.turns),
            None => self.look(&mut layers[0], stations[0], FIRST_ATTEMPTS, 0, &mut room)?,
        }
        self.make_do(&mut layers, 0, &mut room)?;
        for to in 1..layers.len() {
            if let (Some(end), true) = (self.end, to + 1 == stations.len()) {
                layers[to].take_folded(end, &self.turns);
                continue;
            }
            carrier.carry(self, &mut layers, (to - 1, to), 0)?;
            let layer = &mut layers[to];
            carried[to] = layer.count(self.width());
            let room_left = !layer.full;
            self.turn_over(layer, stations[to], &mut room)?;
            if to % LOOKS == 0 && room_left && carried[to] < self.looked_for || carried[to] == 0 {
                let first = 1 + ATTEMPTS * (to / LOOKS) as u32 % 128;
                self.look(layer, stations[to], ATTEMPTS, first, &mut room)?;
            }
            self.make_do(&mut layers, to, &mut room)?;
        }
        carrier.forget();
        let first = usize::from(self.start.is_some());
        for to in (first..layers.len().saturating_sub(1)).rev() {
            // The first `carried` configurations came from the previous station.
            match layers[to].missed || layers[to + 1].missed {
                true => carrier.forget(),
                false => carrier.carry(self, &mut layers, (to + 1, to), carried[to + 1])?,
            }
        }
        Ok(layers)
    }

    pub(super) fn width(&self) -> usize {
        self.middle.len()
    }

    /// Adds configurations near a joint limit with that joint one revolution back, to avoid winding up.
    fn turn_over(
        &self,
        layer: &mut Layer,
        knot: usize,
        room: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        room.reached.clear();
        for (joint, limits) in self.arms.own().limits().enumerate() {
            let finite = limits.lower.is_finite() && limits.upper.is_finite();
            if !finite || limits.upper - limits.lower <= TAU || self.slides[joint] {
                continue;
            }
            for row in layer.q.chunks_exact(n) {
                let value = f64::from(row[joint]);
                let turned = if limits.upper - value < NEAR_LIMIT {
                    value - TAU
                } else if value - limits.lower < NEAR_LIMIT {
                    value + TAU
                } else {
                    continue;
                };
                let first = room.reached.len();
                room.reached.extend(row.iter().map(|q| f64::from(*q)));
                room.reached[first + joint] = limits.clamp(turned);
            }
        }
        self.add(layer, knot, self.most, false, room)
    }

    /// Returns the index of a configuration of the layer within the merging distance.
    pub(super) fn find(&self, layer: &Layer, q: &[f64]) -> Option<usize> {
        let mut known = layer.q.chunks_exact(q.len());
        known.position(|known| self.is_as_good(known, q.iter().map(|q| *q as f32)))
    }

    /// Returns the same index with the help of `sorted`.
    pub(super) fn find_sorted(&self, layer: &Layer, sorted: &Sorted, q: &[f32]) -> Option<usize> {
        let n = q.len();
        let known = |place: usize| &layer.q[place * n..(place + 1) * n];
        let mut first = None;
        sorted.each_near(q, &self.merging, |place| {
            let sooner = first.is_none_or(|first| place < first);
            if sooner && self.is_as_good(known(place), q.iter().copied()) {
                first = Some(place);
            }
        });
        first
    }

    fn is_as_good(&self, known: &[f32], q: impl Iterator<Item = f32>) -> bool {
        let mut moves = known.iter().zip(q).zip(&self.merging).enumerate();
        moves.all(|(joint, ((a, b), most))| self.turns.difference(joint, b, *a).abs() <= *most)
    }

    /// Searches for configurations at a station by independent attempts.
    fn look(
        &self,
        layer: &mut Layer,
        knot: usize,
        attempts: u32,
        first: u32,
        room: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        let arm = self.arms.of(self.knots.tool(knot));
        // Joints without limits end near the known configurations.
        let near: Vec<f64> = match layer.q.get(..n) {
            Some(known) => known.iter().map(|q| f64::from(*q)).collect(),
            None => self.start.map_or(self.middle.clone(), <[f64]>::to_vec),
        };
        let target = self.knots.targets[knot];
        arm.attempt_several(&target, &near, first, attempts, &mut room.ends)?;
        room.reached.clear();
        let ends = room.ends.q.chunks_exact(n).zip(&room.ends.outcomes);
        for (q, _) in ends.filter(|(_, outcome)| outcome.reached) {
            room.reached.extend_from_slice(q);
        }
        let most = self.most - self.most / 4;
        self.add(layer, knot, most, false, room)?;
        if layer.count(n) < FEW {
            // The spheres of the fast check enclose the shapes.
            self.add(layer, knot, most, true, room)?;
        }
        Ok(())
    }

    /// Adds the candidates of the last search that are collision-free and new.
    fn add(
        &self,
        layer: &mut Layer,
        knot: usize,
        most: usize,
        by_shapes: bool,
        room: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        self.note_free(knot, &room.reached, by_shapes, &mut room.free)?;
        for (q, free) in room.reached.chunks_exact(n).zip(&room.free) {
            if layer.count(n) >= most {
                layer.full = true;
                break;
            }
            if *free && self.find(layer, q).is_none() {
                layer.take_folded(q, &self.turns);
            }
        }
        Ok(())
    }

    /// Writes whether each configuration is collision-free.
    pub(super) fn note_free(
        &self,
        knot: usize,
        q: &[f64],
        by_shapes: bool,
        free: &mut Vec<bool>,
    ) -> Result<(), QueryError> {
        #[cfg(feature = "collision")]
        {
            let arm = self.arms.of(self.knots.tool(knot));
            arm.are_free(q, by_shapes, free)
        }
        #[cfg(not(feature = "collision"))]
        {
            let _ = (knot, by_shapes);
            free.clear();
            free.resize(q.len() / self.width(), true);
            Ok(())
        }
    }

    /// Searches harder at an empty station, and finally takes the nearest configuration.
    fn make_do(
        &self,
        layers: &mut [Layer],
        at: usize,
        room: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        let knot = self.knots.stations[at];
        if layers[at].q.len() >= n {
            return Ok(());
        }
        let arm = self.arms.of(self.knots.tool(knot));
        let target = self.knots.targets[knot];
        if arm.falls_short(&target).is_none() {
            let layer = &mut layers[at];
            self.look(layer, knot, LAST_ATTEMPTS, 0, room)?;
            if layer.q.len() >= n {
                return Ok(());
            }
        }
        let before = at.checked_sub(1).map(|before| &layers[before].q[..n]);
        let near: Vec<f64> = match before {
            Some(before) => before.iter().map(|q| f64::from(*q)).collect(),
            None => self.middle.clone(),
        };
        arm.continue_all(&[target], &near, &mut room.ends)?;
        let nearest = std::mem::take(&mut room.ends.q);
        layers[at].take_folded(&nearest, &self.turns);
        layers[at].missed = true;
        Ok(())
    }
}

impl Layer {
    pub(super) fn count(&self, n: usize) -> usize {
        self.q.len() / n
    }

    pub(super) fn take(&mut self, q: &[f64]) {
        self.q.extend(q.iter().map(|q| *q as f32));
    }

    /// Adds a configuration, folded by the ignored revolutions.
    pub(super) fn take_folded(&mut self, q: &[f64], turns: &Turns) {
        let first = self.q.len();
        self.take(q);
        turns.fold(&mut self.q[first..]);
    }

    /// Records the predecessor of a configuration.
    pub(super) fn link(&mut self, place: usize, before: usize) {
        if self.links.len() <= place {
            self.links.resize(place + 1, UNLINKED);
        }
        if self.links[place] == UNLINKED {
            self.links[place] = u16::try_from(before).unwrap_or(UNLINKED);
        }
    }

    /// Returns the predecessor of a configuration, if it has one.
    pub(super) fn linked_to(&self, place: usize) -> Option<usize> {
        let link = self.links.get(place).copied().unwrap_or(UNLINKED);
        (link != UNLINKED).then_some(usize::from(link))
    }
}
