//! Elimination order by nested dissection, which keeps the Cholesky factor sparse.

use glam::DVec3;

/// Largest number of points in a part that is not divided.
const SMALLEST: usize = 32;

/// A nested dissection order (George 1973): the separator of two halves comes after both halves, recursively. Parts are
/// halved along their longest axis. `neighbours` lists the adjacent points of each point.
pub(super) fn order(points: &[DVec3], neighbours: &[Vec<usize>]) -> Vec<usize> {
    let mut own = Dissection {
        points,
        neighbours,
        side: vec![0; points.len()],
        sides: 0,
        order: Vec::with_capacity(points.len()),
    };
    own.divide((0..points.len()).collect());
    own.order
}

struct Dissection<'a> {
    points: &'a [DVec3],
    neighbours: &'a [Vec<usize>],
    /// Number of the latest part to which each point belongs; numbers are unique.
    side: Vec<usize>,
    sides: usize,
    order: Vec<usize>,
}

impl Dissection<'_> {
    /// Halves a part; the depth is logarithmic in the number of points.
    fn divide(&mut self, mut part: Vec<usize>) {
        if part.len() <= SMALLEST {
            self.order.append(&mut part);
            return;
        }
        let axis = self.longest_axis(&part);
        part.sort_by(|&a, &b| {
            let [x, y] = [a, b].map(|point| self.points[point][axis]);
            x.total_cmp(&y).then(a.cmp(&b))
        });
        let upper = part.split_off(part.len() / 2);
        self.sides += 1;
        for &point in &upper {
            self.side[point] = self.sides;
        }
        let far = self.sides;
        let touches = |&point: &usize| {
            let mut next = self.neighbours[point].iter();
            next.any(|&other| self.side[other] == far)
        };
        let (mut between, lower): (Vec<usize>, Vec<usize>) = part.into_iter().partition(touches);
        self.divide(lower);
        self.divide(upper);
        self.order.append(&mut between);
    }

    fn longest_axis(&self, part: &[usize]) -> usize {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &point in part {
            low = low.min(self.points[point]);
            high = high.max(self.points[point]);
        }
        let sides = high - low;
        match (sides.x >= sides.y && sides.x >= sides.z, sides.y >= sides.z) {
            (true, _) => 0,
            (false, true) => 1,
            (false, false) => 2,
        }
    }
}
