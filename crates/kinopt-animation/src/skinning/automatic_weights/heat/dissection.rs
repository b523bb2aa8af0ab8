//! Elimination order by nested dissection, which keeps the Cholesky factor sparse.

use glam::DVec3;

/// Largest number of points in a part that is not divided.
const MAX_LEAF_POINTS: usize = 32;

/// A nested dissection order (George 1973): the separator of two halves comes after both halves, recursively. Parts are
/// halved along their longest axis. `neighbours` lists the adjacent points of each point.
pub(super) fn order(points: &[DVec3], neighbours: &[Vec<usize>]) -> Vec<usize> {
    let mut dissection = Dissection {
        points,
        neighbours,
        part_of: vec![0; points.len()],
        part_count: 0,
        order: Vec::with_capacity(points.len()),
    };
    dissection.divide((0..points.len()).collect());
    dissection.order
}

struct Dissection<'a> {
    points: &'a [DVec3],
    neighbours: &'a [Vec<usize>],
    /// Number of the latest part to which each point belongs; numbers are unique.
    part_of: Vec<usize>,
    part_count: usize,
    order: Vec<usize>,
}

impl Dissection<'_> {
    /// Halves a part; the depth is logarithmic in the number of points.
    fn divide(&mut self, mut part: Vec<usize>) {
        if part.len() <= MAX_LEAF_POINTS {
            self.order.append(&mut part);
            return;
        }
        let axis = self.longest_axis(&part);
        part.sort_by(|&a, &b| {
            let [x, y] = [a, b].map(|point| self.points[point][axis]);
            x.total_cmp(&y).then(a.cmp(&b))
        });
        let upper = part.split_off(part.len() / 2);
        self.part_count += 1;
        for &point in &upper {
            self.part_of[point] = self.part_count;
        }
        let upper_part = self.part_count;
        let is_adjacent = |&point: &usize| {
            let mut next = self.neighbours[point].iter();
            next.any(|&other| self.part_of[other] == upper_part)
        };
        let (mut separator, lower): (Vec<usize>, Vec<usize>) =
            part.into_iter().partition(is_adjacent);
        self.divide(lower);
        self.divide(upper);
        self.order.append(&mut separator);
    }

    fn longest_axis(&self, part: &[usize]) -> usize {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &point in part {
            low = low.min(self.points[point]);
            high = high.max(self.points[point]);
        }
        let extent = high - low;
        match (
            extent.x >= extent.y && extent.x >= extent.z,
            extent.y >= extent.z,
        ) {
            (true, _) => 0,
            (false, true) => 1,
            (false, false) => 2,
        }
    }
}
