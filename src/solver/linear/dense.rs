//! The two loops that everything here is made of, in a shape that compilers turn into SIMD.

/// How many sums run side by side: a single one would wait for each addition.
const WAYS: usize = 4;

/// aᵀb over the shorter length.
#[inline]
pub(in crate::solver) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let shorter = a.len().min(b.len());
    let (a_chunks, b_chunks) = (
        a[..shorter].chunks_exact(WAYS),
        b[..shorter].chunks_exact(WAYS),
    );
    let (a_rest, b_rest) = (a_chunks.remainder(), b_chunks.remainder());
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

#[cfg(test)]
mod tests {
    use super::dot;

    #[test]
    fn the_shorter_length_counts_whichever_it_is() {
        let numbers: Vec<f64> = (1..12).map(f64::from).collect();
        for longer in 0..11 {
            for shorter in 0..=longer {
                let squares = numbers[..shorter].iter().map(|v| v * v);
                let expected: f64 = squares.sum();
                assert_eq!(dot(&numbers[..longer], &numbers[..shorter]), expected);
                assert_eq!(dot(&numbers[..shorter], &numbers[..longer]), expected);
            }
        }
    }
}
