//! Visibility of points through a surface, with an AABB tree of its triangles.

use glam::DVec3;

use super::surface::Surface;

/// Largest number of triangles in a leaf.
const MAX_LEAF_TRIANGLES: usize = 8;

pub(super) struct Crossings<'a> {
    surface: &'a Surface,
    /// Triangle indices; those of a leaf are contiguous.
    triangles: Vec<usize>,
    boxes: Vec<Bounds>,
}

struct Bounds {
    low: DVec3,
    high: DVec3,
    content: Content,
}

enum Content {
    /// Range in the list of triangles.
    Triangles(std::ops::Range<usize>),
    /// Index of the second child; the first child follows its parent in the list.
    Second(usize),
}

impl<'a> Crossings<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        let mut tree = Self {
            surface,
            triangles: (0..surface.triangles.len()).collect(),
            boxes: Vec::new(),
        };
        tree.divide(0..tree.triangles.len());
        tree
    }

    /// Splits a range at the median; the depth is logarithmic in the number of triangles.
    fn divide(&mut self, range: std::ops::Range<usize>) {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &triangle in &self.triangles[range.clone()] {
            for corner in self.surface.corners(self.surface.triangles[triangle]) {
                low = low.min(corner);
                high = high.max(corner);
            }
        }
        let index = self.boxes.len();
        self.boxes.push(Bounds {
            low,
            high,
            content: Content::Triangles(range.clone()),
        });
        if range.len() <= MAX_LEAF_TRIANGLES {
            return;
        }
        let axis = (high - low).max_position();
        let surface = self.surface;
        let middle = |triangle: usize| {
            let [a, b, c] = surface.corners(surface.triangles[triangle]);
            a[axis] + b[axis] + c[axis]
        };
        self.triangles[range.clone()]
            .sort_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
        let half = range.start + range.len() / 2;
        self.divide(range.start..half);
        self.boxes[index].content = Content::Second(self.boxes.len());
        self.divide(half..range.end);
    }

    /// Reports whether a triangle that does not contain the point lies between the point and `target`.
    pub(super) fn is_hidden(&self, point: usize, target: DVec3) -> bool {
        let from = self.surface.points[point];
        let direction = target - from;
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let bounds = &self.boxes[index];
            if !bounds.intersects(from, direction) {
                continue;
            }
            match &bounds.content {
                Content::Second(second) => stack.extend([index + 1, *second]),
                Content::Triangles(range) => {
                    let mut inside = self.triangles[range.clone()].iter();
                    let crosses = |&triangle: &usize| {
                        let corners = self.surface.triangles[triangle];
                        !corners.contains(&point)
                            && crosses(from, direction, self.surface.corners(corners))
                    };
                    if inside.any(crosses) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

impl Bounds {
    /// Reports whether from + s direction is in the box for some s in [0, 1].
    fn intersects(&self, from: DVec3, direction: DVec3) -> bool {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let [low, high] = [self.low, self.high].map(|end| end[axis] - from[axis]);
            if direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
            } else {
                let [a, b] = [low / direction[axis], high / direction[axis]];
                first = first.max(a.min(b));
                last = last.min(a.max(b));
            }
        }
        first <= last
    }
}

/// Reports whether from + s direction crosses a triangle for some s in (0, 1), by determinants (Möller & Trumbore
/// 1997). Segments parallel to the triangle do not.
fn crosses(from: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    let normal = direction.cross(ac);
    let determinant = ab.dot(normal);
    let to = from - a;
    let across = to.cross(ab);
    let sign = determinant.signum();
    let size = determinant.abs();
    let u = sign * to.dot(normal);
    let v = sign * direction.dot(across);
    let s = sign * ac.dot(across);
    size > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= size && s > 0.0 && s < size
}
