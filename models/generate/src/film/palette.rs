//! One palette for all frames of a film, by variance cut and k-means.

use std::collections::BTreeMap;

/// Number of colours. A GIF palette has one more entry, which is transparent.
pub(super) const COLOURS: usize = 255;
/// Rounds of k-means after the cuts.
const ROUNDS: usize = 6;

/// A colour in sRGB bytes, and its weight.
type Weighted = ([f64; 3], f64);

/// Colours that differ little from those of the frames.
pub(super) struct Palette {
    colours: Vec<[f64; 3]>,
}

impl Palette {
    pub(super) fn new(frames: &[Vec<[u8; 3]>]) -> Self {
        let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
        for pixel in frames.iter().flatten() {
            *counts.entry(*pixel).or_default() += 1;
        }
        // Square roots of the counts keep the background from taking most colours.
        let weighted =
            |(colour, count): (&[u8; 3], &u32)| (colour.map(f64::from), f64::from(*count).sqrt());
        let colours: Vec<Weighted> = counts.iter().map(weighted).collect();
        let cells = Cell::new(colours.clone()).cut();
        let mut palette = Self {
            colours: cells.iter().map(|cell| cell.mean).collect(),
        };
        for _ in 0..ROUNDS {
            palette.move_to_means(&colours);
        }
        for colour in &mut palette.colours {
            *colour = colour.map(f64::round);
        }
        palette
    }

    /// One round of k-means.
    fn move_to_means(&mut self, colours: &[Weighted]) {
        let mut sums = vec![([0.0; 3], 0.0); self.colours.len()];
        for (colour, weight) in colours {
            let (sum, total) = &mut sums[self.nearest(*colour)];
            for (sum, value) in sum.iter_mut().zip(colour) {
                *sum += weight * value;
            }
            *total += weight;
        }
        for (colour, (sum, total)) in self.colours.iter_mut().zip(sums) {
            if total > 0.0 {
                *colour = sum.map(|value| value / total);
            }
        }
    }

    /// Index of the nearest colour.
    pub(super) fn nearest(&self, colour: [f64; 3]) -> usize {
        let mut best = (0, f64::INFINITY);
        for (index, entry) in self.colours.iter().enumerate() {
            let distance = squared_distance(*entry, colour);
            if distance < best.1 {
                best = (index, distance);
            }
        }
        best.0
    }

    /// Squared distance of a colour from that of an index.
    pub(super) fn squared_error(&self, index: usize, colour: [f64; 3]) -> f64 {
        squared_distance(self.colours[index], colour)
    }

    /// The bytes of all colours and of the transparent entry.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.colours.iter().flatten().map(|v| *v as u8).collect();
        bytes.resize(3 * (COLOURS + 1), 0);
        bytes
    }
}

fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// Colours that share one palette entry.
struct Cell {
    colours: Vec<Weighted>,
    mean: [f64; 3],
    /// Channel with the largest squared error.
    channel: usize,
    /// Weighted sum of squared distances from the mean.
    error: f64,
}

impl Cell {
    fn new(colours: Vec<Weighted>) -> Self {
        let total: f64 = colours.iter().map(|(_, weight)| weight).sum();
        let sum = |value: &dyn Fn(&[f64; 3]) -> f64| -> f64 {
            colours.iter().map(|(c, weight)| weight * value(c)).sum()
        };
        let mean: [f64; 3] = std::array::from_fn(|k| sum(&|c| c[k]) / total.max(1e-9));
        let errors: [f64; 3] =
            std::array::from_fn(|k| sum(&|c| (c[k] - mean[k]) * (c[k] - mean[k])));
        let channel = (1..3).fold(0, |best, k| if errors[k] > errors[best] { k } else { best });
        Self {
            colours,
            mean,
            channel,
            error: errors.iter().sum(),
        }
    }

    /// Splits the cell with the largest error until there are enough.
    fn cut(self) -> Vec<Self> {
        let mut cells = vec![self];
        while cells.len() < COLOURS {
            let mut widest = 0;
            for (index, cell) in cells.iter().enumerate() {
                if cell.error > cells[widest].error {
                    widest = index;
                }
            }
            let cell = cells.swap_remove(widest);
            if cell.error <= 0.0 {
                cells.push(cell);
                break;
            }
            let (channel, middle) = (cell.channel, cell.mean[cell.channel]);
            let is_below = |colour: &Weighted| colour.0[channel] < middle;
            let (below, above) = cell.colours.into_iter().partition(is_below);
            cells.extend([below, above].map(Self::new));
        }
        cells
    }
}
