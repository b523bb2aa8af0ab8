//! Image in linear light.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use glam::{DVec2, DVec3};

use crate::Failure;

/// Pixels in rows from the top.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub(crate) size: [usize; 2],
    pub(crate) pixels: Vec<DVec3>,
}

/// Linear value of an sRGB colour such as 0xffcc00.
pub(crate) fn linear(rgb: u32) -> DVec3 {
    let channel = |shift: u32| {
        let value = f64::from((rgb >> shift) & 0xff) / 255.0;
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    DVec3::new(channel(16), channel(8), channel(0))
}

/// sRGB byte of a linear value (IEC 61966-2-1).
fn encoded(value: f64) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let value = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    };
    (value * 255.0).round() as u8
}

impl Image {
    pub(crate) fn new(size: [usize; 2], colour: DVec3) -> Self {
        Self {
            size,
            pixels: vec![colour; size[0] * size[1]],
        }
    }

    /// Averages each block of `by` × `by` pixels.
    pub(crate) fn reduced(&self, by: usize) -> Self {
        let size = self.size.map(|pixels| pixels / by);
        let mut small = Self::new(size, DVec3::ZERO);
        for (index, pixel) in self.pixels.iter().enumerate() {
            let (x, y) = (index % self.size[0] / by, index / self.size[0] / by);
            // Values above 1 are clipped before averaging, which would otherwise leave jagged edges.
            small.pixels[y * size[0] + x] += pixel.min(DVec3::ONE) / (by * by) as f64;
        }
        small
    }

    /// Draws a line with round ends and a soft edge of one pixel; `radii` at both ends are in pixels.
    pub(crate) fn stroke(
        &mut self,
        [a, b]: [DVec2; 2],
        radii: [f64; 2],
        colour: DVec3,
        cover: f64,
    ) {
        let reach = radii[0].max(radii[1]) + 1.0;
        let low = (a.min(b) - reach).max(DVec2::ZERO);
        let high = a.max(b) + reach;
        for y in low.y as usize..(high.y.max(0.0) as usize).min(self.size[1]) {
            for x in low.x as usize..(high.x.max(0.0) as usize).min(self.size[0]) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let share =
                    ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
                let radius = radii[0] + share * (radii[1] - radii[0]);
                let cover = cover * (radius + 0.5 - p.distance(a.lerp(b, share))).clamp(0.0, 1.0);
                let pixel = &mut self.pixels[y * self.size[0] + x];
                *pixel = pixel.lerp(colour, cover);
            }
        }
    }

    /// sRGB bytes of each pixel.
    pub(crate) fn rgb(&self) -> Vec<[u8; 3]> {
        let encoded = |p: &DVec3| p.to_array().map(encoded);
        self.pixels.iter().map(encoded).collect()
    }

    pub(crate) fn write(&self, path: &Path) -> Result<(), Failure> {
        let mut encoder = png::Encoder::new(
            BufWriter::new(File::create(path)?),
            self.size[0] as u32,
            self.size[1] as u32,
        );
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::High);
        let bytes = self.rgb().concat();
        encoder.write_header()?.write_image_data(&bytes)?;
        Ok(())
    }
}
