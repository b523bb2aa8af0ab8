//! Depth map of a distant light: the height of the nearest triangle in each texel.

use glam::DVec3;

use super::Scene;
use super::view::fill;

/// Parallel projection along −`direction`.
pub(super) struct DepthMap {
    /// Direction towards the light, unit length.
    pub(super) direction: DVec3,
    across: DVec3,
    up: DVec3,
    low: [f64; 2],
    scale: f64,
    texels: usize,
    heights: Vec<f32>,
}

impl DepthMap {
    pub(super) fn new(scene: &Scene, direction: DVec3, texels: usize) -> Self {
        let across = direction.any_orthonormal_vector();
        let up = direction.cross(across);
        let flat: Vec<DVec3> = scene
            .positions
            .iter()
            .map(|p| DVec3::new(p.dot(across), p.dot(up), p.dot(direction)))
            .collect();
        let low = flat.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
        let high = flat
            .iter()
            .fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
        let span = (high - low).truncate().max_element().max(1e-9);
        let scale = (texels - 1) as f64 / span;
        let mut heights = vec![f32::NEG_INFINITY; texels * texels];
        for (triangle, _) in &scene.triangles {
            let corners = triangle.map(|v| {
                let p = flat[v as usize];
                DVec3::new((p.x - low.x) * scale, (p.y - low.y) * scale, p.z)
            });
            fill(corners, [texels, texels], |index, [a, b, c]| {
                let height = a * corners[0].z + b * corners[1].z + c * corners[2].z;
                heights[index] = heights[index].max(height as f32);
            });
        }
        Self {
            direction,
            across,
            up,
            low: [low.x, low.y],
            scale,
            texels,
            heights,
        }
    }

    /// Returns `true` if nothing is between the light and `p`.
    pub(super) fn sees(&self, p: DVec3) -> bool {
        let x = (p.dot(self.across) - self.low[0]) * self.scale + 0.5;
        let y = (p.dot(self.up) - self.low[1]) * self.scale + 0.5;
        let inside = |v: f64| v >= 0.0 && v < self.texels as f64;
        if !inside(x) || !inside(y) {
            return true;
        }
        let height = self.heights[y as usize * self.texels + x as usize];
        p.dot(self.direction) >= f64::from(height) - 0.006
    }
}
