//! Table of sampled configurations and their tool poses, for chains without a seed atlas.

use super::serial_chain::Serial;
use super::workspace::ArmWorkspace;
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::problem::ProblemInstance;

/// Number of sampled configurations: about 2.5 MB for seven joints, and a few milliseconds once.
const TABLE_ROWS: usize = 16_384;

/// Sampled configurations and their tool poses.
#[derive(Clone, Debug)]
pub(super) struct SeedTable {
    /// Configurations, in sequence.
    values: Vec<f64>,
    /// Pose of the tool in the base frame at each configuration.
    poses: Vec<Placement<f64>>,
}

impl SeedTable {
    /// Samples the chain by Roberts's R sequence, which fills a box more evenly than random numbers.
    pub(super) fn new(serial: &Serial, workspace: &mut ArmWorkspace) -> Self {
        let n = serial.map.variables();
        // Root of x^(n + 1) = x + 1 by bisection; the steps are its inverse powers.
        let (mut low, mut high) = (1.0_f64, 2.0_f64);
        for _ in 0..60 {
            let root = 0.5 * (low + high);
            let power = (0..=n).fold(1.0, |power, _| power * root);
            match power < root + 1.0 {
                true => low = root,
                false => high = root,
            }
        }
        let steps = std::iter::successors(Some(1.0 / low), |step| Some(step / low));
        let steps: Vec<f64> = steps.take(n).collect();
        let ranges: Vec<(f64, f64)> = (serial.map.lower().iter().zip(serial.map.upper()))
            .enumerate()
            .map(|(i, (&lower, &upper))| {
                let centre = Limits::new(lower, upper).clamp(0.0);
                ProblemInstance::from(&workspace.question.problem).sampling_range(i, centre)
            })
            .collect();
        let mut table = Self {
            values: Vec::with_capacity(TABLE_ROWS * n),
            poses: Vec::with_capacity(TABLE_ROWS),
        };
        let mut x = vec![0.0; n];
        for k in 0..TABLE_ROWS {
            for ((value, step), (lower, upper)) in x.iter_mut().zip(&steps).zip(&ranges) {
                let fraction = (0.5 + step * (k as f64 + 1.0)).fract();
                *value = lower + fraction * (upper - lower);
            }
            table.values.extend_from_slice(&x);
            table.poses.push(workspace.base_from_tool(serial, &x));
        }
        table
    }

    /// Configuration of a row.
    pub(super) fn seed(&self, row: usize) -> &[f64] {
        let n = self.values.len() / self.poses.len().max(1);
        self.values.get(row * n..(row + 1) * n).unwrap_or(&[])
    }

    /// Writes the `max_count` rows nearest to a target to `rows`, nearest first.
    ///
    /// The squared distance is `position` per squared metre, plus the squared rotation chord times `metres_per_radian`
    /// squared.
    pub(super) fn nearest(
        &self,
        target: &Placement<f64>,
        (position, metres_per_radian): (f64, f64),
        max_count: usize,
        rows: &mut Vec<(f64, usize)>,
    ) {
        let orientation_weight = 0.5 * metres_per_radian * metres_per_radian;
        rows.clear();
        rows.extend(self.poses.iter().enumerate().map(|(row, pose)| {
            let offset = pose.translation - target.translation;
            let (a, b) = (&pose.rotation, &target.rotation);
            let chord = [a.x - b.x, a.y - b.y, a.z - b.z].map(|column| column.dot(column));
            let chord: f64 = chord.iter().sum();
            (
                position * offset.dot(offset) + orientation_weight * chord,
                row,
            )
        }));
        let by_distance =
            |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if rows.len() > max_count {
            rows.select_nth_unstable_by(max_count, by_distance);
            rows.truncate(max_count);
        }
        rows.sort_unstable_by(by_distance);
    }
}

#[cfg(test)]
mod tests {
    use super::SeedTable;
    use kinopt_kinematics::spatial::Placement;

    #[test]
    fn nearest_rows_come_first_and_ties_by_index() {
        let pose_at = |x: f64| Placement::translation([x, 0.0, 0.0].into());
        let poses: Vec<_> = (0..50_u32)
            .map(|k| pose_at(f64::from(k * 37 % 50)))
            .collect();
        let table = SeedTable {
            values: vec![0.0; poses.len()],
            poses,
        };
        let mut rows = Vec::new();
        table.nearest(&pose_at(20.0), (1.0, 1.0), 9, &mut rows);
        let distance = |row: usize| f64::from(row as u32 * 37 % 50) - 20.0;
        let mut expected: Vec<(f64, usize)> = (0..50)
            .map(|row| (distance(row) * distance(row), row))
            .collect();
        expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(rows, expected[..9]);
    }

    #[test]
    fn radian_weight_matches_metres_per_radian() {
        let mut turned = Placement::identity();
        // A small angle, whose chord has the same length.
        let small = 1e-3;
        turned.rotation = turned
            .rotation
            .rotated_about_z((small, 1.0 - 0.5 * small * small));
        let table = SeedTable {
            values: vec![0.0; 2],
            poses: vec![turned, Placement::translation([small, 0.0, 0.0].into())],
        };
        let mut rows = Vec::new();
        for (metres_per_radian, position) in [(0.9, 1.0), (1.1, 1.0), (1.8, 4.0), (2.2, 4.0)] {
            let target = Placement::identity();
            table.nearest(&target, (position, metres_per_radian), 2, &mut rows);
            let squared = metres_per_radian * metres_per_radian;
            assert_eq!(rows[0].1, usize::from(squared > position));
            for (distance, row) in &rows {
                let expected = small * small * if *row == 0 { squared } else { position };
                assert!(
                    (distance / expected - 1.0).abs() < 1e-5,
                    "{row}: {distance}"
                );
            }
        }
    }
}
