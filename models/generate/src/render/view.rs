//! Perspective view: the triangle of each pixel, and overlaid lines.

use glam::{DMat3, DVec2, DVec3};

use super::{Image, Scene};

/// Eye position and viewing direction; z is up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    eye: DVec3,
    /// Columns: right, up, backward.
    axes: DMat3,
    /// Half of the picture's height at distance 1.
    half_height: f64,
}

/// Surface point of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) position: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) colour: DVec3,
}

impl View {
    /// View in which `height` metres at the distance of `centre` fill the picture vertically.
    pub(crate) fn new(eye: DVec3, centre: DVec3, height: f64) -> Self {
        let back = (eye - centre).normalize();
        let right = DVec3::Z.cross(back).normalize();
        Self {
            eye,
            axes: DMat3::from_cols(right, back.cross(right), back),
            half_height: 0.5 * height / eye.distance(centre),
        }
    }

    pub(crate) fn forward(&self) -> DVec3 {
        -self.axes.z_axis
    }

    /// Unit vectors to the right and upwards in the picture.
    pub(crate) fn across(&self) -> (DVec3, DVec3) {
        (self.axes.x_axis, self.axes.y_axis)
    }

    /// Pixel coordinates and inverse distance, which is linear on the screen.
    pub(crate) fn project(&self, p: DVec3, size: [usize; 2]) -> DVec3 {
        let q = self.axes.transpose() * (p - self.eye);
        let scale = 0.5 * size[1] as f64 / self.half_height / -q.z;
        DVec3::new(
            0.5 * size[0] as f64 + q.x * scale,
            0.5 * size[1] as f64 - q.y * scale,
            1.0 / -q.z,
        )
    }

    /// Intersection of a pixel's ray with the horizontal plane at this height.
    pub(crate) fn ground(&self, pixel: [usize; 2], size: [usize; 2], height: f64) -> Option<DVec3> {
        let [x, y] = [0, 1].map(|k| {
            (pixel[k] as f64 + 0.5 - 0.5 * size[k] as f64) * 2.0 * self.half_height / size[1] as f64
        });
        let ray = self.axes * DVec3::new(x, -y, -1.0);
        let along = (height - self.eye.z) / ray.z;
        (along > 0.0).then(|| self.eye + ray * along)
    }

    pub(crate) fn cast(&self, scene: &Scene, size: [usize; 2]) -> Vec<Option<Hit>> {
        let flat: Vec<DVec3> = scene
            .positions
            .iter()
            .map(|&p| self.project(p, size))
            .collect();
        let mut nearest = vec![0.0; size[0] * size[1]];
        let mut hits = vec![None; nearest.len()];
        for (triangle, colour) in &scene.triangles {
            let corners = triangle.map(|v| flat[v as usize]);
            fill(corners, size, |index, shares| {
                let weights: [f64; 3] = std::array::from_fn(|k| shares[k] * corners[k].z);
                let depth: f64 = weights.iter().sum();
                if depth > nearest[index] {
                    nearest[index] = depth;
                    let interpolate = |values: &[DVec3]| -> DVec3 {
                        (0..3)
                            .map(|k| values[triangle[k] as usize] * (weights[k] / depth))
                            .sum()
                    };
                    hits[index] = Some(Hit {
                        position: interpolate(&scene.positions),
                        normal: interpolate(&scene.normals).normalize_or_zero(),
                        colour: *colour,
                    });
                }
            });
        }
        hits
    }

    /// Draws an overlaid line, `width` metres wide.
    pub(crate) fn line(
        &self,
        image: &mut Image,
        ends: [DVec3; 2],
        width: f64,
        colour: DVec3,
        cover: f64,
    ) {
        let size = image.size;
        let [a, b] = ends.map(|p| self.project(p, size));
        let pixel = 0.5 * size[1] as f64 / self.half_height;
        image.stroke(
            [a, b].map(|p| DVec2::new(p.x, p.y)),
            [a, b].map(|p| 0.5 * width * pixel * p.z),
            colour,
            cover,
        );
    }
}

/// Calls `each` for every pixel centre in a triangle, with the index and barycentric coordinates.
pub(super) fn fill(corners: [DVec3; 3], size: [usize; 2], mut each: impl FnMut(usize, [f64; 3])) {
    let [a, b, c] = corners.map(DVec3::truncate);
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let low = a.min(b).min(c).floor().max(DVec2::ZERO);
    let high = a.max(b).max(c).ceil();
    for y in low.y as usize..(high.y.max(0.0) as usize).min(size[1]) {
        for x in low.x as usize..(high.x.max(0.0) as usize).min(size[0]) {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let shares = [
                (c - b).perp_dot(p - b),
                (a - c).perp_dot(p - c),
                (b - a).perp_dot(p - a),
            ]
            .map(|twice| twice / area);
            if shares.iter().all(|share| *share >= 0.0) {
                each(y * size[0] + x, shares);
            }
        }
    }
}
