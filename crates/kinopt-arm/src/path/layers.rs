//! Distinct solutions at every station of a path.
//!
//! Each station has the continued solutions of the previous station (on their branch, or self-motion), and sometimes
//! new ones. New solutions are continued backwards too, so that every branch is known over its whole extent.

use std::f64::consts::TAU;

use super::PathError;
use super::branch_continuation::{BranchContinuation, MIN_FREE_COUNT};
use super::knots::Knots;
use super::neighbour_index::NeighbourIndex;
use super::revolutions::Revolutions;
use super::step_bounds::StepBounds;
use super::tools::Tools;
use crate::arm::{Ends, QueryError};

/// Distance below which two configurations are merged, radians (for every joint).
const MERGE_DISTANCE: f32 = 0.03;
/// Number of attempts at the first station, and at later stations with few known branches.
const FIRST_ATTEMPTS: u32 = 96;
const STATION_ATTEMPTS: u32 = 8;
/// Number of stations between such searches.
const SEARCH_INTERVAL: usize = 4;
/// Number of attempts if no configuration is known.
pub(super) const FALLBACK_ATTEMPTS: u32 = 200;
/// Distance from a joint limit, radians, below which the configuration one revolution back is added.
const LIMIT_PROXIMITY: f64 = 0.4;

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
    pub(super) unreached: bool,
}

/// Generator of the layers, with its settings.
#[derive(Debug)]
pub(super) struct LayerGenerator<'a> {
    pub(super) arms: &'a Tools<'a>,
    pub(super) knots: &'a Knots,
    pub(super) bounds: &'a StepBounds,
    /// Maximum number of configurations per station. A quarter is reserved for backward continuation.
    pub(super) max_configurations: usize,
    /// Number of continued configurations below which a station searches for more.
    pub(super) search_threshold: usize,
    /// Given configurations at the start and end of the path.
    pub(super) start: Option<&'a [f64]>,
    pub(super) end: Option<&'a [f64]>,
    /// For a cyclic path with a free start, joint displacement over one cycle. Both ends then move together.
    pub(super) cycle_displacement: Option<Vec<f64>>,
    /// Reference values of unlimited joints, merging distances, and flags of prismatic joints.
    pub(super) middle: Vec<f64>,
    pub(super) merge_distances: Vec<f32>,
    pub(super) is_prismatic: Vec<bool>,
    /// Joints whose whole revolutions are ignored.
    pub(super) revolutions: Revolutions,
}

/// Scratch memory of searches at a station.
#[derive(Debug, Default)]
struct LayerWorkspace {
    ends: Ends,
    reached: Vec<f64>,
    free: Vec<bool>,
}

impl<'a> LayerGenerator<'a> {
    /// Computes the merging distances and the centres of the joint limits.
    pub(super) fn new(
        arms: &'a Tools<'a>,
        knots: &'a Knots,
        bounds: &'a StepBounds,
        max_configurations: usize,
    ) -> Self {
        let arm = arms.primary();
        let middle = arm.limits().map(|limits| {
            let middle = 0.5 * (limits.lower + limits.upper);
            if middle.is_finite() { middle } else { 0.0 }
        });
        Self {
            arms,
            knots,
            bounds,
            max_configurations,
            search_threshold: max_configurations / 2,
            start: None,
            end: None,
            cycle_displacement: None,
            middle: middle.collect(),
            merge_distances: (arm.scales().iter())
                .map(|scale| MERGE_DISTANCE / *scale as f32)
                .collect(),
            is_prismatic: arm.slides(),
            revolutions: Revolutions::counted(arm.joint_count()),
        }
    }

    /// Returns one layer per station.
    pub(super) fn layers(&self) -> Result<Vec<Layer>, PathError> {
        let stations = &self.knots.stations;
        let mut workspace = LayerWorkspace::default();
        let mut continuation = BranchContinuation::default();
        let mut layers: Vec<Layer> = vec![Layer::default(); stations.len()];
        // Number of configurations that came from the previous station.
        let mut carried = vec![0_usize; stations.len()];
        match self.start {
            Some(start) => layers[0].push_folded(start, &self.revolutions),
            None => self.search(
                &mut layers[0],
                stations[0],
                FIRST_ATTEMPTS,
                0,
                &mut workspace,
            )?,
        }
        self.fill_empty(&mut layers, 0, &mut workspace)?;
        for to in 1..layers.len() {
            if let (Some(end), true) = (self.end, to + 1 == stations.len()) {
                layers[to].push_folded(end, &self.revolutions);
                continue;
            }
            continuation.continue_layer(self, &mut layers, (to - 1, to), 0)?;
            let layer = &mut layers[to];
            carried[to] = layer.count(self.width());
            let has_capacity = !layer.full;
            self.add_unwound(layer, stations[to], &mut workspace)?;
            if to % SEARCH_INTERVAL == 0 && has_capacity && carried[to] < self.search_threshold
                || carried[to] == 0
            {
                let first = 1 + STATION_ATTEMPTS * (to / SEARCH_INTERVAL) as u32 % 128;
                self.search(layer, stations[to], STATION_ATTEMPTS, first, &mut workspace)?;
            }
            self.fill_empty(&mut layers, to, &mut workspace)?;
        }
        continuation.reset();
        let first = usize::from(self.start.is_some());
        for to in (first..layers.len().saturating_sub(1)).rev() {
            // The first `carried` configurations came from the previous station.
            match layers[to].unreached || layers[to + 1].unreached {
                true => continuation.reset(),
                false => {
                    continuation.continue_layer(self, &mut layers, (to + 1, to), carried[to + 1])?
                }
            }
        }
        Ok(layers)
    }

    pub(super) fn width(&self) -> usize {
        self.middle.len()
    }

    /// Adds configurations near a joint limit with that joint one revolution back, to avoid winding up.
    fn add_unwound(
        &self,
        layer: &mut Layer,
        knot: usize,
        workspace: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        workspace.reached.clear();
        for (joint, limits) in self.arms.primary().limits().enumerate() {
            let finite = limits.lower.is_finite() && limits.upper.is_finite();
            if !finite || limits.upper - limits.lower <= TAU || self.is_prismatic[joint] {
                continue;
            }
            for row in layer.q.chunks_exact(n) {
                let value = f64::from(row[joint]);
                let wrapped = if limits.upper - value < LIMIT_PROXIMITY {
                    value - TAU
                } else if value - limits.lower < LIMIT_PROXIMITY {
                    value + TAU
                } else {
                    continue;
                };
                let first = workspace.reached.len();
                workspace.reached.extend(row.iter().map(|q| f64::from(*q)));
                workspace.reached[first + joint] = limits.clamp(wrapped);
            }
        }
        self.add(layer, knot, self.max_configurations, false, workspace)
    }

    /// Returns the index of a configuration of the layer within the merging distance.
    pub(super) fn find(&self, layer: &Layer, q: &[f64]) -> Option<usize> {
        let mut known = layer.q.chunks_exact(q.len());
        known.position(|known| self.is_as_good(known, q.iter().map(|q| *q as f32)))
    }

    /// Returns the same index with the help of `neighbours`.
    pub(super) fn find_indexed(
        &self,
        layer: &Layer,
        neighbours: &NeighbourIndex,
        q: &[f32],
    ) -> Option<usize> {
        let n = q.len();
        let known = |index: usize| &layer.q[index * n..(index + 1) * n];
        let mut first = None;
        neighbours.for_each_near(q, &self.merge_distances, |index| {
            let is_earlier = first.is_none_or(|first| index < first);
            if is_earlier && self.is_as_good(known(index), q.iter().copied()) {
                first = Some(index);
            }
        });
        first
    }

    fn is_as_good(&self, known: &[f32], q: impl Iterator<Item = f32>) -> bool {
        let mut moves = known.iter().zip(q).zip(&self.merge_distances).enumerate();
        moves.all(|(joint, ((a, b), limit))| {
            self.revolutions.difference(joint, b, *a).abs() <= *limit
        })
    }

    /// Searches for configurations at a station by independent attempts.
    fn search(
        &self,
        layer: &mut Layer,
        knot: usize,
        attempts: u32,
        first: u32,
        workspace: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        let arm = self.arms.arm(self.knots.tool(knot));
        // Joints without limits end near the known configurations.
        let reference: Vec<f64> = match layer.q.get(..n) {
            Some(known) => known.iter().map(|q| f64::from(*q)).collect(),
            None => self.start.map_or(self.middle.clone(), <[f64]>::to_vec),
        };
        let target = self.knots.targets[knot];
        arm.attempt_several(&target, &reference, first, attempts, &mut workspace.ends)?;
        workspace.reached.clear();
        let ends = workspace
            .ends
            .q
            .chunks_exact(n)
            .zip(&workspace.ends.outcomes);
        for (q, _) in ends.filter(|(_, outcome)| outcome.reached) {
            workspace.reached.extend_from_slice(q);
        }
        let max_count = self.max_configurations - self.max_configurations / 4;
        self.add(layer, knot, max_count, false, workspace)?;
        if layer.count(n) < MIN_FREE_COUNT {
            // The spheres of the fast check enclose the shapes.
            self.add(layer, knot, max_count, true, workspace)?;
        }
        Ok(())
    }

    /// Adds the candidates of the last search that are collision-free and new.
    fn add(
        &self,
        layer: &mut Layer,
        knot: usize,
        max_count: usize,
        by_shapes: bool,
        workspace: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        self.mark_free(knot, &workspace.reached, by_shapes, &mut workspace.free)?;
        for (q, free) in workspace.reached.chunks_exact(n).zip(&workspace.free) {
            if layer.count(n) >= max_count {
                layer.full = true;
                break;
            }
            if *free && self.find(layer, q).is_none() {
                layer.push_folded(q, &self.revolutions);
            }
        }
        Ok(())
    }

    /// Writes whether each configuration is collision-free.
    pub(super) fn mark_free(
        &self,
        knot: usize,
        q: &[f64],
        by_shapes: bool,
        free: &mut Vec<bool>,
    ) -> Result<(), QueryError> {
        #[cfg(feature = "collision")]
        {
            let arm = self.arms.arm(self.knots.tool(knot));
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
    fn fill_empty(
        &self,
        layers: &mut [Layer],
        station: usize,
        workspace: &mut LayerWorkspace,
    ) -> Result<(), QueryError> {
        let n = self.width();
        let knot = self.knots.stations[station];
        if layers[station].q.len() >= n {
            return Ok(());
        }
        let arm = self.arms.arm(self.knots.tool(knot));
        let target = self.knots.targets[knot];
        if arm.falls_short(&target).is_none() {
            let layer = &mut layers[station];
            self.search(layer, knot, FALLBACK_ATTEMPTS, 0, workspace)?;
            if layer.q.len() >= n {
                return Ok(());
            }
        }
        let before = station.checked_sub(1).map(|before| &layers[before].q[..n]);
        let reference: Vec<f64> = match before {
            Some(before) => before.iter().map(|q| f64::from(*q)).collect(),
            None => self.middle.clone(),
        };
        arm.continue_all(&[target], &reference, &mut workspace.ends)?;
        let nearest = std::mem::take(&mut workspace.ends.q);
        layers[station].push_folded(&nearest, &self.revolutions);
        layers[station].unreached = true;
        Ok(())
    }
}

impl Layer {
    pub(super) fn count(&self, n: usize) -> usize {
        self.q.len() / n
    }

    pub(super) fn push(&mut self, q: &[f64]) {
        self.q.extend(q.iter().map(|q| *q as f32));
    }

    /// Adds a configuration, folded by the ignored revolutions.
    pub(super) fn push_folded(&mut self, q: &[f64], revolutions: &Revolutions) {
        let first = self.q.len();
        self.push(q);
        revolutions.fold(&mut self.q[first..]);
    }

    /// Records the predecessor of a configuration.
    pub(super) fn link(&mut self, index: usize, predecessor: usize) {
        if self.links.len() <= index {
            self.links.resize(index + 1, UNLINKED);
        }
        if self.links[index] == UNLINKED {
            self.links[index] = u16::try_from(predecessor).unwrap_or(UNLINKED);
        }
    }

    /// Returns the predecessor of a configuration, if it has one.
    pub(super) fn linked_to(&self, index: usize) -> Option<usize> {
        let link = self.links.get(index).copied().unwrap_or(UNLINKED);
        (link != UNLINKED).then_some(usize::from(link))
    }
}
