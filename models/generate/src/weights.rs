//! Skin weights: each vertex first belongs to the bone of its nearest part; then the weights
//! spread along the skin as heat would, so that they fall off smoothly across every joint and never
//! jump through the air from a hand to a thigh.

use crate::polygonise::Soup;
use crate::surface::Surface;

/// Steps of the heat flow.
const STEPS: usize = 120;
/// Weights below this are dropped, and all but the largest so many.
const LEAST: f64 = 0.004;
const MOST_INFLUENCES: usize = 6;

/// For each vertex the (bone, weight) pairs, largest weight first, summing to 1.
pub(crate) fn weights(soup: &Soup, surface: &Surface, bones: usize) -> Vec<Vec<(usize, f64)>> {
    let mut near = vec![Vec::new(); soup.positions.len()];
    for &[a, b, c] in &soup.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // Each directed edge is one triangle's, so every neighbour is listed once.
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
        // One step of share s carries weight with a variance of s/2 edge lengths squared.
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
