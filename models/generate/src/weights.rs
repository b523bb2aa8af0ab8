//! Skin weights by heat diffusion along the skin.
//!
//! Each vertex starts with the bone of its nearest part. Diffusion makes weights smooth across every joint, and no
//! weight jumps through the air, as from a hand to a thigh.

use crate::polygonise::Soup;
use crate::surface::Surface;

/// Number of diffusion steps.
const STEPS: usize = 120;
/// Smallest weight that is kept, and maximum number of influences per vertex.
const MIN_WEIGHT: f64 = 0.004;
const MAX_INFLUENCES: usize = 6;

/// (bone, weight) pairs of each vertex, largest weight first, with a sum of 1.
pub(crate) fn weights(soup: &Soup, surface: &Surface, bones: usize) -> Vec<Vec<(usize, f64)>> {
    let mut neighbours = vec![Vec::new(); soup.positions.len()];
    for &[a, b, c] in &soup.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // Each directed edge belongs to one triangle, so every neighbour occurs once.
            neighbours[from as usize].push(to as usize);
        }
    }
    let mut values = vec![vec![0.0; bones]; soup.positions.len()];
    let mut fractions = Vec::with_capacity(soup.positions.len());
    for ((&p, neighbours), value) in soup.positions.iter().zip(&neighbours).zip(&mut values) {
        let Some(part) = surface.part_at(p) else {
            continue;
        };
        value[part.bone] = 1.0;
        // One step with fraction s transports weight with a variance of s/2 squared edge lengths.
        let squares = neighbours
            .iter()
            .map(|&n| p.distance_squared(soup.positions[n]));
        let squared = squares.sum::<f64>() / neighbours.len() as f64;
        fractions.push((2.0 * part.softness.powi(2) / (STEPS as f64 * squared)).min(0.5));
    }
    for _ in 0..STEPS {
        let vertices = values.iter().zip(&neighbours).zip(&fractions);
        let next = vertices.map(|((weights, neighbours), &fraction)| {
            let mean = |bone: usize| -> f64 {
                neighbours.iter().map(|&n| values[n][bone]).sum::<f64>() / neighbours.len() as f64
            };
            let mixed = weights.iter().enumerate();
            mixed
                .map(|(bone, w)| w + fraction * (mean(bone) - w))
                .collect()
        });
        values = next.collect();
    }
    values.into_iter().map(|value| largest(&value)).collect()
}

fn largest(value: &[f64]) -> Vec<(usize, f64)> {
    let mut influences: Vec<(usize, f64)> = value.iter().copied().enumerate().collect();
    influences.retain(|(_, weight)| *weight >= MIN_WEIGHT);
    influences.sort_by(|a, b| b.1.total_cmp(&a.1));
    influences.truncate(MAX_INFLUENCES);
    let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
    influences
        .iter()
        .map(|(bone, weight)| (*bone, weight / sum))
        .collect()
}
