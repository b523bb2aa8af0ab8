//! The path as it is solved: its points, and those of them at which branches are compared.

use super::cartesian_path::{CartesianPath, Traversal};
use super::tools::Tools;
use crate::spatial::Placement;

/// How far the tool goes from one comparison of branches to the next, radians (metres as the arm counts them), where points are as near
/// as that.
pub(super) const NEAR: f64 = 0.05;

/// The points in the order in which they are gone; of a cyclic path the first comes once more.
#[derive(Debug)]
pub(super) struct Knots {
    pub(super) targets: Vec<Placement<f64>>,
    /// Empty where all are the first.
    tools: Vec<u32>,
    /// How far the tool has come, radians.
    pub(super) way: Vec<f64>,
    /// Seconds; empty where there are none that count.
    pub(super) times: Vec<f64>,
    /// The knots at which branches are compared: the first, the last, and every so many.
    pub(super) stations: Vec<usize>,
    /// Whether the last knot is the first point again.
    pub(super) closed: bool,
}

impl Knots {
    pub(super) fn of(path: &CartesianPath, arms: &Tools<'_>) -> Self {
        let closed = path.traversal == Traversal::Cyclic && path.points.len() > 1;
        let again = closed.then_some(0);
        let points = || (0..path.points.len()).chain(again);
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
            way: vec![0.0],
            times,
            stations: Vec::new(),
            closed,
        };
        for knot in 1..knots.len() {
            // Between tools the path says nothing of the way.
            let length = match knots.is_led_to(knot) {
                true => {
                    let arm = arms.of(knots.tool(knot));
                    arm.apart(&knots.targets[knot - 1], &knots.targets[knot])
                }
                false => 0.0,
            };
            knots.way.push(knots.way[knot - 1] + length);
        }
        knots.find_stations();
        knots
    }

    fn find_stations(&mut self) {
        let mut last = 0;
        self.stations.push(0);
        for knot in 1..self.len() {
            let end = knot + 1 == self.len();
            let far = !end && self.way[knot + 1] - self.way[last] > NEAR;
            let changes = !self.is_led_to(knot) || !end && !self.is_led_to(knot + 1);
            // A path that stands still is looked at now and then.
            let many = knot - last >= 1000;
            if end || far || changes || many {
                self.stations.push(knot);
                last = knot;
            }
        }
    }

    /// Compares branches at these knots too; whether that is new.
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

    /// Whether the path says how the tool comes to a knot from the one before.
    pub(super) fn is_led_to(&self, knot: usize) -> bool {
        self.tool(knot) == self.tool(knot - 1)
    }
}
