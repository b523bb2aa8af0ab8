//! Closest point of a simplex to the origin.

use kinopt_kinematics::spatial::Vector3;

use super::core_and_radius::Corner;

/// Up to four vertices, with the weights of the point of their hull that is closest to the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    corners: [Corner; 4],
    weights: [f64; 4],
    len: usize,
}

impl Simplex {
    pub(super) fn point(corner: Corner) -> Self {
        Self {
            corners: [corner; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            len: 1,
        }
    }

    pub(super) fn corners(&self) -> &[Corner] {
        &self.corners[..self.len]
    }

    /// The weighted point of A − B, as its points on A and B.
    pub(super) fn nearest(&self) -> Corner {
        let sum = |part: fn(&Corner) -> Vector3<f64>| {
            let weighted = self.corners().iter().zip(&self.weights);
            weighted.fold(Vector3::zero(), |sum, (corner, &weight)| {
                part(corner).mul_add(weight, sum)
            })
        };
        Corner {
            on_a: sum(|c| c.on_a),
            on_b: sum(|c| c.on_b),
        }
    }

    /// The face that holds the closest point to the origin, among those of this simplex extended by a vertex.
    ///
    /// All faces are tried, those with the fewest vertices first, so that a degenerate face is never needed.
    pub(super) fn with(&self, corner: Corner) -> Self {
        let mut all = *self;
        all.corners[all.len] = corner;
        all.len += 1;
        let mut best = Self::point(corner);
        let mut min_squared = corner.difference().norm_squared();
        for mask in 1_u32..1 << all.len {
            let mut face = all;
            face.len = 0;
            for i in (0..all.len).filter(|i| mask >> i & 1 == 1) {
                face.corners[face.len] = all.corners[i];
                face.len += 1;
            }
            if let Some(weights) = face.inner_weights() {
                face.weights = weights;
                let squared = face.length_squared();
                // A larger face must be closer by more than rounding.
                if squared < min_squared * (1.0 - 1e-15)
                    || (squared <= min_squared && face.len <= best.len)
                {
                    (best, min_squared) = (face, squared);
                }
            }
        }
        best
    }

    fn length_squared(&self) -> f64 {
        let weighted = self.corners().iter().zip(&self.weights);
        let nearest = weighted.fold(Vector3::zero(), |sum, (corner, &weight)| {
            corner.difference().mul_add(weight, sum)
        });
        nearest.norm_squared()
    }

    /// Weights of the closest point to the origin in the affine hull of all vertices, if it is strictly inside.
    fn inner_weights(&self) -> Option<[f64; 4]> {
        let corner = |i: usize| self.corners[i].difference();
        let sides = [1, 2, 3].map(|i| corner(i.min(self.len - 1)) - corner(0));
        let weights = match self.len {
            1 => return Some([1.0, 0.0, 0.0, 0.0]),
            2 => {
                let t = -corner(0).dot(sides[0]) / sides[0].norm_squared();
                [1.0 - t, t, 0.0, 0.0]
            }
            3 => {
                let normal = sides[0].cross(sides[1]);
                let scale = normal.norm_squared().recip();
                let u = sides[1].cross(corner(0)).dot(normal) * scale;
                let v = corner(0).cross(sides[0]).dot(normal) * scale;
                [1.0 - u - v, u, v, 0.0]
            }
            _ => {
                let volume = sides[0].dot(sides[1].cross(sides[2]));
                let scale = -volume.recip();
                let u = corner(0).dot(sides[1].cross(sides[2])) * scale;
                let v = corner(0).dot(sides[2].cross(sides[0])) * scale;
                let w = corner(0).dot(sides[0].cross(sides[1])) * scale;
                [1.0 - u - v - w, u, v, w]
            }
        };
        let inner = |w: &f64| *w > 0.0 && w.is_finite();
        weights[..self.len].iter().all(inner).then_some(weights)
    }
}
