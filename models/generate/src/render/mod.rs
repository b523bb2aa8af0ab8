//! Pictures of triangles: daylight from all round, a sun with a soft edge, paper that takes shadow.

mod depth_map;
mod image;
mod view;

pub(crate) use image::{Image, linear};
pub(crate) use view::View;

use depth_map::DepthMap;
use glam::DVec3;

/// Directions of the sky, and points of the sun's disc.
const SKY: usize = 160;
const SUN: usize = 24;
/// Texels along a side of each depth map.
const TEXELS: usize = 1000;
/// How much of the light comes from the sun.
const SUN_SHARE: f64 = 0.6;

/// Triangles with smooth normals and a colour each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scene {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) triangles: Vec<([u32; 3], DVec3)>,
    /// Height of the paper on which everything stands.
    pub(crate) ground: f64,
    /// The colour of the paper.
    pub(crate) paper: DVec3,
}

impl Scene {
    /// Adds a mesh; `normals` are of unit length.
    pub(crate) fn add(
        &mut self,
        positions: &[DVec3],
        normals: &[DVec3],
        triangles: &[[u32; 3]],
        colour: DVec3,
    ) {
        let first = self.positions.len() as u32;
        self.positions.extend(positions);
        self.normals.extend(normals);
        self.triangles
            .extend(triangles.iter().map(|t| (t.map(|v| v + first), colour)));
    }
}

/// Who sees the sky from where.
struct Lights {
    sky: Vec<DepthMap>,
    sun: Vec<DepthMap>,
}

impl Lights {
    fn new(scene: &Scene) -> Self {
        // Spread over a disc by the golden angle; lifted to the hemisphere that is an even light
        // after Lambert's law, and small it is the sun.
        let disc = |index: usize, count: usize| {
            let radius = ((index as f64 + 0.5) / count as f64).sqrt();
            let (sin, cos) = (index as f64 * 2.399_963_229_728_653).sin_cos();
            (radius * cos, radius * sin)
        };
        let sky = (0..SKY).map(|index| {
            let (x, y) = disc(index, SKY);
            DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
        });
        let sun = (0..SUN).map(|index| {
            let (x, y) = disc(index, SUN);
            DVec3::new(0.5 + 0.1 * x, -0.75 + 0.1 * y, 1.0).normalize()
        });
        let map = |direction| DepthMap::new(scene, direction, TEXELS);
        Self {
            sky: sky.map(map).collect(),
            sun: sun.map(map).collect(),
        }
    }

    /// The light on a point, 1 in the open with the normal up.
    fn on(&self, p: DVec3, normal: DVec3, on_ground: bool) -> DVec3 {
        let lit = |maps: &[DepthMap], flat: bool| {
            let each = maps.iter().map(|map| {
                let slope = if flat {
                    1.0
                } else {
                    normal.dot(map.direction).max(0.0)
                };
                if slope > 0.0 && map.sees(p + normal * 0.004) {
                    slope
                } else {
                    0.0
                }
            });
            each.sum::<f64>() / maps.len() as f64
        };
        if on_ground {
            return DVec3::splat((1.0 - 0.42) * lit(&self.sky, true) + 0.42 * lit(&self.sun, true));
        }
        // The sky's sample directions already follow the cosine to the vertical.
        let mut sky = 0.0;
        for map in &self.sky {
            let slope = normal.dot(map.direction).max(0.0);
            if slope > 0.0 && map.sees(p + normal * 0.004) {
                sky += slope / map.direction.z.max(0.15);
            }
        }
        let sky = sky / self.sky.len() as f64;
        let bounce = 0.22 * (0.5 - 0.5 * normal.z);
        let cool = DVec3::new(0.93, 0.98, 1.07) * ((1.0 - SUN_SHARE) * sky + bounce);
        let warm = DVec3::new(1.05, 1.0, 0.93) * (SUN_SHARE * 1.3 * lit(&self.sun, false));
        cool + warm
    }
}

/// The scene through a view, `samples`² samples a pixel.
pub(crate) fn render(scene: &Scene, view: &View, size: [usize; 2], samples: usize) -> Image {
    let lights = Lights::new(scene);
    let fine = size.map(|pixels| pixels * samples);
    let hits = view.cast(scene, fine);
    let mut image = Image::new(fine, scene.paper);
    for (index, (hit, pixel)) in hits.iter().zip(&mut image.pixels).enumerate() {
        *pixel = match hit {
            Some(hit) => {
                let light = lights.on(hit.position, hit.normal, false);
                // A faint rim, so that forms stand off from each other.
                let grazing = 1.0 - hit.normal.dot(-view.forward()).clamp(0.0, 1.0);
                hit.colour * light + DVec3::splat(0.10 * grazing.powi(3))
            }
            None => {
                let at = [index % fine[0], index / fine[0]];
                match view.ground(at, fine, scene.ground) {
                    Some(p) => scene.paper * lights.on(p, DVec3::Z, true),
                    None => scene.paper,
                }
            }
        };
    }
    image.reduced(samples)
}
