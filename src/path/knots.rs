//! Knots of a path, and the stations among them.

use super::cartesian_path::{CartesianPath, Traversal};
use super::tools::Tools;
use crate::spatial::Placement;

/// Spacing of stations along the tool's path, radians (metres converted by the arm's scale), if knots are dense enough.
pub(super) const STATION_SPACING: f64 = 0.05;

/// Points in the order of traversal. A cyclic path repeats its first point at the end.
#[derive(Debug)]
pub(super) struct Knots {
    pub(super) targets: Vec<Placement<f64>>,
    /// Tool index of each knot; empty if all use tool 0.
    tools: Vec<u32>,
    /// Length of the tool's path up to each knot, radians.
    pub(super) arc_lengths: Vec<f64>,
    /// Times, seconds; empty if times do not count.
    pub(super) times: Vec<f64>,
    /// Knots at which branches are compared: the first, the last, and some in between.
    pub(super) stations: Vec<usize>,
    /// True if the last knot repeats the first point.
    pub(super) closed: bool,
}

impl Knots {
    pub(super) fn of(path: &CartesianPath, arms: &Tools<'_>) -> Self {
        let closed = path.traversal == Traversal::Cyclic && path.points.len() > 1;
        let closing_point = closed.then_some(0);
        let points = || (0..path.points.len()).chain(closing_point);
        let tools = match path.tools.is_empty() {
            true => Vec::new(),
            false => points().map(|point| path.tools[point] as u32).collect(),
        };
        let times = match path.traversal {
            Traversal::Open => path.times.clone(),
            Traversal::Cyclic | Traversal::AnyStart => Vec::new(),
        };
        let mut knots = Self {
            targets: points().map(|point| path.points[point]).collect(),
            tools,
            arc_lengths: vec![0.0],
            times,
            stations: Vec::new(),
            closed,
        };
        for knot in 1..knots.len() {
            // A tool change has no defined path.
            let length = match knots.has_segment_to(knot) {
                true => {
                    let arm = arms.arm(knots.tool(knot));
                    arm.apart(&knots.targets[knot - 1], &knots.targets[knot])
                }
                false => 0.0,
            };
            knots.arc_lengths.push(knots.arc_lengths[knot - 1] + length);
        }
        knots.find_stations();
        knots
    }

    fn find_stations(&mut self) {
        let mut last = 0;
        self.stations.push(0);
        for knot in 1..self.len() {
            let end = knot + 1 == self.len();
            let is_far =
                !end && self.arc_lengths[knot + 1] - self.arc_lengths[last] > STATION_SPACING;
            let changes_tool = !self.has_segment_to(knot) || !end && !self.has_segment_to(knot + 1);
            // Limits the distance of stations while the tool is at rest.
            let is_long_run = knot - last >= 1000;
            if end || is_far || changes_tool || is_long_run {
                self.stations.push(knot);
                last = knot;
            }
        }
    }

    /// Adds stations at these knots. Returns whether any is new.
    pub(super) fn add_stations(&mut self, knots: &[usize]) -> bool {
        let before = self.stations.len();
        self.stations.extend_from_slice(knots);
        self.stations.sort_unstable();
        self.stations.dedup();
        self.stations.len() > before
    }

    pub(super) fn len(&self) -> usize {
        self.targets.len()
    }

    pub(super) fn tool(&self, knot: usize) -> usize {
        self.tools.get(knot).map_or(0, |tool| *tool as usize)
    }

    /// Returns whether the path defines the motion to a knot from the one before.
    pub(super) fn has_segment_to(&self, knot: usize) -> bool {
        self.tool(knot) == self.tool(knot - 1)
    }
}
