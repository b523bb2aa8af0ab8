//! The two loops that everything here is made of, in a shape that compilers turn into SIMD.

/// How many sums run side by side: a single one would wait for each addition.
const WAYS: usize = 4;

/// aᵀb over the shorter length.
#[inline]
pub(in crate::solver) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_chunks, b_chunks) = (a.chunks_exact(WAYS), b.chunks_exact(WAYS));
    let (a_rest, b_rest) = (
        a_chunks.remainder(),
        &b[a.len().min(b.len()) / WAYS * WAYS..],
    );
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(p, q)| p * q).sum();
    let mut sums = [0.0; WAYS];
    for (p, q) in a_chunks.zip(b_chunks) {
        for k in 0..WAYS {
            sums[k] += p[k] * q[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// y ← y + factor · x over the shorter length.
#[inline]
pub(in crate::solver) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (own, &other) in y.iter_mut().zip(x) {
        *own += factor * other;
    }
}
