//! Index of configurations by one joint, for neighbour queries.

use super::revolutions::Revolutions;

/// Configurations in cells of the joint with the largest spread, among those whose revolutions count.
#[derive(Debug, Default)]
pub(super) struct NeighbourIndex {
    joint: Option<usize>,
    /// Number of uses since the joint was selected.
    age: usize,
    /// Lower end of the first cell, and cells per unit of the joint.
    low: f32,
    per_unit: f32,
    /// Last configuration of each cell, and for each configuration the previous one in its cell.
    lasts: Vec<u16>,
    previous: Vec<u16>,
}

/// Factor of the query range, for rounding errors.
const QUERY_FACTOR: f32 = 1.001;
/// Cells per query distance, and maximum number of cells.
const CELLS_PER_DISTANCE: f32 = 1.0;
const MAX_CELLS: f32 = 512.0;
/// Number of stations after which the joint is selected again; branches spread slowly.
const RESELECT_INTERVAL: usize = 8;
/// End of a cell's list.
const END_OF_CELL: u16 = u16::MAX;

impl NeighbourIndex {
    /// Indexes `known` by the joint with the largest spread of `queries`.
    ///
    /// `limits` is the query distance of each joint.
    pub(super) fn build(
        &mut self,
        known: &[f32],
        queries: &[f32],
        limits: &[f32],
        revolutions: &Revolutions,
    ) {
        let n = limits.len();
        if self.age.is_multiple_of(RESELECT_INTERVAL) {
            self.joint = widest(queries, limits, revolutions);
        }
        self.age += 1;
        let (mut low, mut high, mut cells) = (0.0, 0.0, 1.0);
        if let Some(joint) = self.joint {
            (low, high) = (f32::MAX, f32::MIN);
            for row in known.chunks_exact(n).chain(queries.chunks_exact(n)) {
                (low, high) = (low.min(row[joint]), high.max(row[joint]));
            }
            cells = (CELLS_PER_DISTANCE * (high - low) / limits[joint]).clamp(1.0, MAX_CELLS);
        }
        self.low = low;
        self.per_unit = if high > low {
            cells / (high - low)
        } else {
            0.0
        };
        self.lasts.clear();
        // `cells` is NaN if both the spread and the query distance are zero.
        self.lasts.resize((cells as usize).max(1), END_OF_CELL);
        self.previous.clear();
        for (index, row) in known.chunks_exact(n).enumerate() {
            self.insert(row, index);
        }
    }

    /// Adds a configuration with the next index.
    pub(super) fn insert(&mut self, q: &[f32], index: usize) {
        debug_assert_eq!(index, self.previous.len());
        let cell = self.cell(self.joint.map_or(0.0, |joint| q[joint]));
        self.previous.push(self.lasts[cell]);
        self.lasts[cell] = index as u16;
    }

    /// Returns the cell of a value. Values beyond the ends belong to the outer cells.
    fn cell(&self, value: f32) -> usize {
        let cell = ((value - self.low) * self.per_unit) as i32;
        (cell.max(0) as usize).min(self.lasts.len() - 1)
    }

    /// Visits all configurations within the query distance in the indexed joint, and some others.
    pub(super) fn for_each_near(&self, q: &[f32], limits: &[f32], mut visit: impl FnMut(usize)) {
        let cells = match self.joint {
            Some(joint) => {
                let distance = QUERY_FACTOR * limits[joint];
                self.cell(q[joint] - distance)..self.cell(q[joint] + distance) + 1
            }
            None => 0..1,
        };
        for &last in &self.lasts[cells] {
            let mut index = last;
            while index != END_OF_CELL {
                visit(usize::from(index));
                index = self.previous[usize::from(index)];
            }
        }
    }
}

/// Returns the joint with the largest spread relative to its limit.
fn widest(from: &[f32], limits: &[f32], revolutions: &Revolutions) -> Option<usize> {
    let n = limits.len();
    let (mut low, mut high) = (vec![f32::MAX; n], vec![f32::MIN; n]);
    for row in from.chunks_exact(n) {
        for ((value, low), high) in row.iter().zip(&mut low).zip(&mut high) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
    }
    let spread = |joint: usize| (high[joint] - low[joint]) / limits[joint];
    let joints = (0..n).filter(|joint| !revolutions.is_ignored(*joint));
    joints.max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
}

#[cfg(test)]
mod tests {
    use super::NeighbourIndex;
    use crate::arm::Arm;
    use crate::path::CartesianPath;
    use crate::path::knots::Knots;
    use crate::path::layers::{Layer, LayerGenerator};
    use crate::path::step_bounds::StepBounds;
    use crate::path::tools::Tools;
    use kinopt_kinematics::model::{Limits, Model};
    use kinopt_kinematics::spatial::{Placement, Vector3};
    use kinopt_robot::robot::Robot;

    /// Configurations of two joints on a grid, in scrambled order.
    fn grid() -> impl Iterator<Item = [f64; 2]> {
        let steps = |step: usize| 0.02 * (step as f64) - 0.4;
        (0..40 * 40).map(move |k| {
            let k = k * 907 % 1600;
            [steps(k / 40), steps(k % 40)]
        })
    }

    /// Of several configurations within the merging distance, the first known one is found, independent of its cell.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn duplicate_lookup_finds_first_match() {
        let mut builder = Model::builder("two links");
        let (link, origin) = (
            Placement::translation(Vector3::UNITS[0]),
            Placement::identity(),
        );
        let joint_limits = Limits::new(-3.0, 3.0);
        let base = builder.frame("base", None, origin);
        let first = builder.revolute("first", None, origin, Vector3::UNITS[2], joint_limits);
        let second = builder.revolute("second", Some(first), link, Vector3::UNITS[1], joint_limits);
        let tip = builder.frame("tip", Some(second), link);
        let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
        let arm = Arm::builder(&robot, base, tip).with_atlas(false);
        let arm = arm.build().unwrap();
        let tools = Tools::new(&arm);
        let path = CartesianPath::new(vec![link; 2]).unwrap();
        let knots = Knots::of(&path, &tools);
        let bounds = StepBounds::new(&arm, 0.1, Vec::new());
        let generator = LayerGenerator::new(&tools, &knots, &bounds, 2000);

        let mut layer = Layer::default();
        let mut neighbours = NeighbourIndex::default();
        let known: Vec<[f64; 2]> = grid().collect();
        for q in &known {
            layer.push(q);
        }
        neighbours.build(
            &layer.q,
            &layer.q,
            &generator.merge_distances,
            &generator.revolutions,
        );
        for q in grid().step_by(7) {
            // The grid values within 0.03 are those at −0.025, −0.005 and 0.015.
            let query = q.map(|value| value + 0.005);
            let is_near = |known: &[f64; 2]| (0..2).all(|j| (known[j] - query[j]).abs() < 0.03);
            let first = known.iter().position(is_near);
            assert!(first.is_some() && known.iter().filter(|known| is_near(known)).count() >= 4);
            let single = query.map(|value| value as f32);
            assert_eq!(generator.find_indexed(&layer, &neighbours, &single), first);
            assert_eq!(generator.find(&layer, &query), first);
        }
        let far = [0.0, 1.0];
        assert_eq!(generator.find_indexed(&layer, &neighbours, &far), None);
    }
}
