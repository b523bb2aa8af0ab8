//! Renderer of triangles: light of the sky, a sun with soft shadows, and paper that receives shadows.

mod depth_map;
mod image;
mod view;

pub(crate) use image::{Image, linear};
pub(crate) use view::View;

use depth_map::DepthMap;
use glam::{BVec3, DVec3};

/// Fraction of the light that comes from the sun.
const SUN_SHARE: f64 = 0.6;

/// Number of samples of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quality {
    /// Samples along a side of each pixel.
    pub(crate) samples: usize,
    /// Samples along a side of each pixel of the paper; divides `samples`.
    pub(crate) paper_samples: usize,
    /// Number of sky light directions.
    pub(crate) sky: usize,
    /// Number of points on the sun's disc.
    pub(crate) sun: usize,
    /// Texels along a side of each depth map.
    pub(crate) texels: usize,
}

impl Quality {
    /// Quality of a single picture.
    pub(crate) const STILL: Self = Self {
        samples: 3,
        paper_samples: 3,
        sky: 160,
        sun: 24,
        texels: 1000,
    };
}

/// Triangles with smooth normals and a colour each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scene {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) triangles: Vec<([u32; 3], DVec3)>,
    /// Height of the paper below the scene.
    pub(crate) ground: f64,
    /// Colour of the paper, linear.
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

    /// Extends the bounds of the scene to a box. Scenes of equal bounds have equal depth maps of their equal parts.
    pub(crate) fn extend_bounds(&mut self, low: DVec3, high: DVec3) {
        for corner in 0..8 {
            let upper = BVec3::new(corner & 1 > 0, corner & 2 > 0, corner & 4 > 0);
            self.positions.push(DVec3::select(upper, high, low));
            self.normals.push(DVec3::Z);
        }
    }
}

/// Point on which light falls.
struct Receiver {
    position: DVec3,
    normal: DVec3,
    on_paper: bool,
}

/// Light on each receiver; 1 for an unoccluded receiver with the normal up.
fn lights(scene: &Scene, receivers: &[Receiver], quality: Quality) -> Vec<DVec3> {
    // Points on a disc by the golden angle. Lifted to the hemisphere they give uniform light by Lambert's law; scaled
    // down they are the sun.
    let disc = |index: usize, count: usize| {
        let radius = ((index as f64 + 0.5) / count as f64).sqrt();
        let (sin, cos) = (index as f64 * 2.399_963_229_728_653).sin_cos();
        (radius * cos, radius * sin)
    };
    let mut sky = vec![0.0; receivers.len()];
    for index in 0..quality.sky {
        let (x, y) = disc(index, quality.sky);
        let direction = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
        // The directions already have a density proportional to the cosine to the vertical.
        let density = direction.z.max(0.15);
        let map = DepthMap::new(scene, direction, quality.texels);
        add_light(&map, density, receivers, &mut sky);
    }
    let mut sun = vec![0.0; receivers.len()];
    for index in 0..quality.sun {
        let (x, y) = disc(index, quality.sun);
        let direction = DVec3::new(0.5 + 0.1 * x, -0.75 + 0.1 * y, 1.0).normalize();
        let map = DepthMap::new(scene, direction, quality.texels);
        add_light(&map, 1.0, receivers, &mut sun);
    }
    let means = sky.iter().zip(&sun);
    let means = means.map(|(sky, sun)| (sky / quality.sky as f64, sun / quality.sun as f64));
    let mixed = receivers.iter().zip(means).map(|(receiver, (sky, sun))| {
        if receiver.on_paper {
            return DVec3::splat((1.0 - 0.42) * sky + 0.42 * sun);
        }
        let bounce = 0.22 * (0.5 - 0.5 * receiver.normal.z);
        let cool = DVec3::new(0.93, 0.98, 1.07) * ((1.0 - SUN_SHARE) * sky + bounce);
        let warm = DVec3::new(1.05, 1.0, 0.93) * (SUN_SHARE * 1.3 * sun);
        cool + warm
    });
    mixed.collect()
}

/// Adds the light from the direction of a map; `density` divides it on all but the paper.
fn add_light(map: &DepthMap, density: f64, receivers: &[Receiver], sums: &mut [f64]) {
    for (receiver, sum) in receivers.iter().zip(sums) {
        let slope = receiver.normal.dot(map.direction);
        if slope > 0.0 && map.sees(receiver.position + receiver.normal * 0.004) {
            *sum += match receiver.on_paper {
                true => 1.0,
                false => slope / density,
            };
        }
    }
}

/// Renders the scene through a view.
pub(crate) fn render(scene: &Scene, view: &View, size: [usize; 2], quality: Quality) -> Image {
    let fine = size.map(|pixels| pixels * quality.samples);
    let step = quality.samples / quality.paper_samples;
    let coarse = fine.map(|samples| samples / step);
    let hits = view.cast(scene, fine);
    let mut receivers = Vec::new();
    let mut on_paper = vec![None; coarse[0] * coarse[1]];
    // Receiver of each sample; `None` if its ray misses the scene and the paper.
    let mut receiver_of_sample = Vec::with_capacity(hits.len());
    for (index, hit) in hits.iter().enumerate() {
        let at = [index % fine[0] / step, index / fine[0] / step];
        let paper = &mut on_paper[at[1] * coarse[0] + at[0]];
        let receiver = match hit {
            Some(hit) => Some(Receiver {
                position: hit.position,
                normal: hit.normal,
                on_paper: false,
            }),
            None if paper.is_some() => {
                receiver_of_sample.push(*paper);
                continue;
            }
            None => {
                let position = view.ground(at, coarse, scene.ground);
                position.map(|position| Receiver {
                    position,
                    normal: DVec3::Z,
                    on_paper: true,
                })
            }
        };
        let number = receiver.is_some().then_some(receivers.len());
        if hit.is_none() {
            *paper = number;
        }
        receivers.extend(receiver);
        receiver_of_sample.push(number);
    }
    let lights = lights(scene, &receivers, quality);
    let mut image = Image::new(fine, scene.paper);
    for ((hit, receiver_of_sample), pixel) in
        hits.iter().zip(receiver_of_sample).zip(&mut image.pixels)
    {
        let light = receiver_of_sample.map_or(DVec3::ONE, |receiver| lights[receiver]);
        *pixel = match hit {
            Some(hit) => {
                // Faint rim light that separates overlapping forms.
                let grazing = 1.0 - hit.normal.dot(-view.forward()).clamp(0.0, 1.0);
                hit.colour * light + DVec3::splat(0.10 * grazing.powi(3))
            }
            None => scene.paper * light,
        };
    }
    image.reduced(quality.samples)
}
