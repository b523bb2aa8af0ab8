//! Index of configurations by one joint, for neighbour queries.

use super::winding::Turns;

/// Configurations in cells of the joint with the largest spread, among those whose revolutions count.
#[derive(Debug, Default)]
pub(super) struct Sorted {
    joint: Option<usize>,
    /// Number of uses since the joint was selected.
    age: usize,
    /// Lower end of the first cell, and cells per unit of the joint.
    low: f32,
    per_unit: f32,
    /// Last configuration of each cell, and for each configuration the previous one in its cell.
    lasts: Vec<u16>,
    before: Vec<u16>,
}

/// Factor of the query range, for rounding errors.
const MORE: f32 = 1.001;
/// Cells per query distance, and maximum number of cells.
const CELLS: f32 = 1.0;
const MOST_CELLS: f32 = 512.0;
/// Number of stations after which the joint is selected again; branches spread slowly.
const LASTING: usize = 8;
/// End of a cell's list.
const NONE: u16 = u16::MAX;

impl Sorted {
    /// Indexes `known` by the joint with the largest spread of the queries `asked`.
    ///
    /// `limits` is the query distance of each joint.
    pub(super) fn take(&mut self, known: &[f32], asked: &[f32], limits: &[f32], turns: &Turns) {
        let n = limits.len();
        if self.age.is_multiple_of(LASTING) {
            self.joint = widest(asked, limits, turns);
        }
        self.age += 1;
        let (mut low, mut high, mut cells) = (0.0, 0.0, 1.0);
        if let Some(joint) = self.joint {
            (low, high) = (f32::MAX, f32::MIN);
            for row in known.chunks_exact(n).chain(asked.chunks_exact(n)) {
                (low, high) = (low.min(row[joint]), high.max(row[joint]));
            }
            cells = (CELLS * (high - low) / limits[joint]).clamp(1.0, MOST_CELLS);
        }
        self.low = low;
        self.per_unit = if high > low {
            cells / (high - low)
        } else {
            0.0
        };
        self.lasts.clear();
        // `cells` is NaN if both the spread and the query distance are zero.
        self.lasts.resize((cells as usize).max(1), NONE);
        self.before.clear();
        for (place, row) in known.chunks_exact(n).enumerate() {
            self.insert(row, place);
        }
    }

    /// Adds a configuration with the next index.
    pub(super) fn insert(&mut self, q: &[f32], place: usize) {
        debug_assert_eq!(place, self.before.len());
        let cell = self.cell(self.joint.map_or(0.0, |joint| q[joint]));
        self.before.push(self.lasts[cell]);
        self.lasts[cell] = place as u16;
    }

    /// Returns the cell of a value. Values beyond the ends belong to the outer cells.
    fn cell(&self, value: f32) -> usize {
        let cell = ((value - self.low) * self.per_unit) as i32;
        (cell.max(0) as usize).min(self.lasts.len() - 1)
    }

    /// Visits all configurations within the query distance in the indexed joint, and some others.
    pub(super) fn each_near(&self, q: &[f32], limits: &[f32], mut look: impl FnMut(usize)) {
        let cells = match self.joint {
            Some(joint) => {
                let most = MORE * limits[joint];
                self.cell(q[joint] - most)..self.cell(q[joint] + most) + 1
            }
            None => 0..1,
        };
        for &last in &self.lasts[cells] {
            let mut place = last;
            while place != NONE {
                look(usize::from(place));
                place = self.before[usize::from(place)];
            }
        }
    }
}

/// Returns the joint with the largest spread relative to its limit.
fn widest(from: &[f32], limits: &[f32], turns: &Turns) -> Option<usize> {
    let n = limits.len();
    let (mut low, mut high) = (vec![f32::MAX; n], vec![f32::MIN; n]);
    for row in from.chunks_exact(n) {
        for ((value, low), high) in row.iter().zip(&mut low).zip(&mut high) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
    }
    let spread = |joint: usize| (high[joint] - low[joint]) / limits[joint];
    let joints = (0..n).filter(|joint| !turns.is_left_out(*joint));
    joints.max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
}

#[cfg(test)]
mod tests {
    use super::Sorted;
    use crate::arm::Arm;
    use crate::model::{Limits, Model};
    use crate::motion::path::CartesianPath;
    use crate::motion::path::knots::Knots;
    use crate::motion::path::layers::{Growth, Layer};
    use crate::motion::path::step_bounds::StepBounds;
    use crate::motion::path::tools::Tools;
    use crate::robot::Robot;
    use crate::spatial::{Placement, Vector3};

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
    fn the_first_of_those_as_good_is_found() {
        let mut builder = Model::builder("two links");
        let (link, here) = (
            Placement::translation(Vector3::UNITS[0]),
            Placement::identity(),
        );
        let turns = Limits::new(-3.0, 3.0);
        let base = builder.frame("base", None, here);
        let first = builder.revolute("first", None, here, Vector3::UNITS[2], turns);
        let second = builder.revolute("second", Some(first), link, Vector3::UNITS[1], turns);
        let tip = builder.frame("tip", Some(second), link);
        let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
        let arm = Arm::builder(&robot, base, tip).with_atlas(false);
        let arm = arm.build().unwrap();
        let tools = Tools::new(&arm);
        let path = CartesianPath::new(vec![link; 2]).unwrap();
        let knots = Knots::of(&path, &tools);
        let bounds = StepBounds::new(&arm, 0.1, Vec::new());
        let growth = Growth::new(&tools, &knots, &bounds, 2000);

        let mut layer = Layer::default();
        let mut sorted = Sorted::default();
        let known: Vec<[f64; 2]> = grid().collect();
        for q in &known {
            layer.take(q);
        }
        sorted.take(&layer.q, &layer.q, &growth.merging, &growth.turns);
        for q in grid().step_by(7) {
            // The grid values within 0.03 are those at −0.025, −0.005 and 0.015.
            let asked = q.map(|value| value + 0.005);
            let near = |known: &[f64; 2]| (0..2).all(|j| (known[j] - asked[j]).abs() < 0.03);
            let first = known.iter().position(near);
            assert!(first.is_some() && known.iter().filter(|known| near(known)).count() >= 4);
            let single = asked.map(|value| value as f32);
            assert_eq!(growth.find_sorted(&layer, &sorted, &single), first);
            assert_eq!(growth.find(&layer, &asked), first);
        }
        let far = [0.0, 1.0];
        assert_eq!(growth.find_sorted(&layer, &sorted, &far), None);
    }
}
