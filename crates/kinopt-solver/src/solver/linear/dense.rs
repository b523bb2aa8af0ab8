//! Vector kernels in a form that compilers vectorise.
//!
//! They use no iterators, which are calls in a debug build.

/// aᵀb over the shorter length. Four parallel sums avoid waiting for each addition.
#[inline]
#[doc(hidden)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let shorter = if a.len() < b.len() { a.len() } else { b.len() };
    let (mut a, mut b) = (&a[..shorter], &b[..shorter]);
    let mut sums = [0.0; 4];
    while let ([p0, p1, p2, p3, p_rest @ ..], [q0, q1, q2, q3, q_rest @ ..]) = (a, b) {
        sums[0] += p0 * q0;
        sums[1] += p1 * q1;
        sums[2] += p2 * q2;
        sums[3] += p3 * q3;
        (a, b) = (p_rest, q_rest);
    }
    // Initial value of `Iterator::sum`.
    let mut rest = -0.0;
    while let ([p, p_rest @ ..], [q, q_rest @ ..]) = (a, b) {
        rest += p * q;
        (a, b) = (p_rest, q_rest);
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// [`dot`] of vectors of equal length, restricted to the chunks of four given by the bits of `chunks`.
///
/// The products of all other chunks must be zero.
#[inline]
pub(in crate::solver) fn dot_of_chunks(a: &[f64], b: &[f64], mut chunks: u64) -> f64 {
    let mut sums = [0.0; 4];
    let mut rest = 0.0;
    while chunks != 0 {
        let from = 4 * chunks.trailing_zeros() as usize;
        chunks &= chunks - 1;
        match (&a[from..], &b[from..]) {
            ([p0, p1, p2, p3, ..], [q0, q1, q2, q3, ..]) => {
                sums[0] += p0 * q0;
                sums[1] += p1 * q1;
                sums[2] += p2 * q2;
                sums[3] += p3 * q3;
            }
            (a, b) => {
                for (p, q) in a.iter().zip(b) {
                    rest += p * q;
                }
            }
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// ‖a‖∞; NaN entries are left out.
#[doc(hidden)]
pub fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |most, part| part.abs().max(most))
}

/// Computes y ← y + factor · x over the shorter length.
#[inline]
pub(in crate::solver) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    let shorter = if y.len() < x.len() { y.len() } else { x.len() };
    let (y, x) = (&mut y[..shorter], &x[..shorter]);
    let mut k = 0;
    while k < shorter {
        y[k] += factor * x[k];
        k += 1;
    }
}

/// Computes y ← (y + f₀ · x₀) + f₁ · x₁ over the shortest length.
///
/// Bitwise equal to two additions in sequence, but y passes through memory once.
#[inline]
pub(in crate::solver) fn add_two_scaled(y: &mut [f64], factors: [f64; 2], x: [&[f64]; 2]) {
    let shortest = y.len().min(x[0].len()).min(x[1].len());
    let y = &mut y[..shortest];
    let x = [&x[0][..shortest], &x[1][..shortest]];
    let mut k = 0;
    while k < shortest {
        y[k] = (y[k] + factors[0] * x[0][k]) + factors[1] * x[1][k];
        k += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::dot;

    #[test]
    fn dot_uses_the_shorter_length() {
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
