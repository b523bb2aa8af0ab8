//! Skin weights by heat diffusion along the skin.
//!
//! Each vertex starts with the bone of its nearest part. Diffusion makes weights smooth across every joint, and no
//! weight jumps through the air, as from a hand to a thigh.

use crate::polygonise::Soup;
use crate::surface::Surface;

/// Number of diffusion steps.
const STEPS: usize = 120;
/// Smallest weight that is kept, and maximum number of influences per vertex.
const LEAST: f64 = 0.004;
const MOST_INFLUENCES: usize = 6;

/// (bone, weight) pairs of each vertex, largest weight first, with a sum of 1.
pub(crate) fn weights(soup: &Soup, surface: &Surface, bones: usize) -> Vec<Vec<(usize, f64)>> {
    let mut near = vec![Vec::new(); soup.positions.len()];
    for &[a, b, c] in &soup.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // Each directed edge belongs to one triangle, so every neighbour occurs once.
            near[from as usize].push(to as usize);
        }
    }
    let mut values = vec![vec![0.0; bones]; soup.positions.len()];
    let mut share = Vec::with_capacity(soup.positions.len());
    for ((&p, near), value) in soup.positions.iter().zip(&near).zip(&mut values) {
        let Some(part) = surface.part_at(p) else {
            continue;
        };
        value[part.bone] = 1.0;
        // One step with fraction s transports weight with a variance of s/2 squared edge lengths.
        let squares = near.iter().map(|&n| p.distance_squared(soup.positions[n]));
        let squared = squares.sum::<f64>() / near.len() as f64;
        share.push((2.0 * part.softness.powi(2) / (STEPS as f64 * squared)).min(0.5));
    }
    for _ in 0..STEPS {
        let each = values.iter().zip(&near).zip(&share);
        let next = each.map(|((own, near), &share)| {
            let mean = |bone: usize| -> f64 {
                near.iter().map(|&n| values[n][bone]).sum::<f64>() / near.len() as f64
            };
            let mixed = own.iter().enumerate();
            mixed
                .map(|(bone, w)| w + share * (mean(bone) - w))
                .collect()
        });
        values = next.collect();
    }
    values.into_iter().map(|value| largest(&value)).collect()
}

fn largest(value: &[f64]) -> Vec<(usize, f64)> {
    let mut kept: Vec<(usize, f64)> = value.iter().copied().enumerate().collect();
    kept.retain(|(_, weight)| *weight >= LEAST);
    kept.sort_by(|a, b| b.1.total_cmp(&a.1));
    kept.truncate(MOST_INFLUENCES);
    let sum: f64 = kept.iter().map(|(_, weight)| weight).sum();
    kept.iter()
        .map(|(bone, weight)| (*bone, weight / sum))
        .collect()
}
