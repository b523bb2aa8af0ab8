//! GIF files with one palette. After the first frame, pixels that do not change are transparent.

use std::collections::HashMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use super::palette::{COLOURS, Palette};
use crate::Failure;

/// Index of the transparent entry.
const TRANSPARENT: u8 = COLOURS as u8;
/// Largest distance of a pixel from its shown colour at which it stays unchanged, in sRGB bytes.
const TOLERANCE: f64 = 6.0;

/// Writes a film that repeats forever.
pub(super) fn write(
    path: &Path,
    size: [usize; 2],
    frames: &[Vec<[u8; 3]>],
    frames_per_second: usize,
) -> Result<(), Failure> {
    let palette = Palette::new(frames);
    let [width, height] = [u16::try_from(size[0])?, u16::try_from(size[1])?];
    let file = BufWriter::new(File::create(path)?);
    let mut encoder = Encoder::new(file, width, height, &palette.bytes())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut nearest = HashMap::new();
    let mut displayed: Option<Vec<u8>> = None;
    for (number, pixels) in frames.iter().enumerate() {
        let mut indices = Vec::with_capacity(pixels.len());
        for pixel in pixels {
            let find = || palette.nearest(pixel.map(f64::from)) as u8;
            indices.push(*nearest.entry(*pixel).or_insert_with(find));
        }
        let buffer = match &mut displayed {
            Some(displayed) => changes(displayed, &indices, pixels, &palette),
            None => indices.clone(),
        };
        displayed.get_or_insert(indices);
        // The format counts hundredths of a second.
        let end = |number: usize| (number * 100 + frames_per_second / 2) / frames_per_second;
        encoder.write_frame(&Frame {
            delay: u16::try_from(end(number + 1) - end(number))?,
            dispose: DisposalMethod::Keep,
            transparent: Some(TRANSPARENT),
            width,
            height,
            buffer: buffer.into(),
            ..Frame::default()
        })?;
    }
    Ok(())
}

/// Updates the shown indices, and returns those that changed.
fn changes(displayed: &mut [u8], next: &[u8], pixels: &[[u8; 3]], palette: &Palette) -> Vec<u8> {
    let mut changes = Vec::with_capacity(displayed.len());
    for ((displayed, &next), pixel) in displayed.iter_mut().zip(next).zip(pixels) {
        let error = palette.squared_error(usize::from(*displayed), pixel.map(f64::from));
        changes.push(match error > TOLERANCE * TOLERANCE {
            true => {
                *displayed = next;
                next
            }
            false => TRANSPARENT,
        });
    }
    changes
}
