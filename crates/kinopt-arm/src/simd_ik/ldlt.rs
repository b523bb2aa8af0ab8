//! Solution of the 6 × 6 linear system of a step.

use kinopt_kinematics::scalar::Scalar;

/// Solves a symmetric positive definite system by LDLᵀ for K right-hand sides. Reads only the lower triangle.
///
/// Unrolled by macros, as the compiler keeps nested loops.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn solve<V: Scalar, const K: usize>(
    mut m: [[V; 6]; 6],
    mut sides: [[V; 6]; K],
) -> [[V; 6]; K] {
    let mut inverse = [V::zero(); 6];
    // Index loop: an iterator is several calls in a debug build.
    macro_rules! each_side {
        ($b:ident, $body:expr) => {
            let mut side = 0;
            while side < K {
                let $b = &mut sides[side];
                $body;
                side += 1;
            }
        };
    }
    // Rows below the pivot, each with its columns right of the pivot.
    macro_rules! eliminate {
        ($j:literal: $($i:literal [$($k:literal)*])*) => {
            inverse[$j] = V::one() / m[$j][$j];
            $(
                let factor = -(m[$i][$j] * inverse[$j]);
                $(m[$i][$k] = factor.mul_add(m[$k][$j], m[$i][$k]);)*
                each_side!(b, b[$i] = factor.mul_add(b[$j], b[$i]));
            )*
        };
    }
    eliminate!(0: 1 [1] 2 [1 2] 3 [1 2 3] 4 [1 2 3 4] 5 [1 2 3 4 5]);
    eliminate!(1: 2 [2] 3 [2 3] 4 [2 3 4] 5 [2 3 4 5]);
    eliminate!(2: 3 [3] 4 [3 4] 5 [3 4 5]);
    eliminate!(3: 4 [4] 5 [4 5]);
    eliminate!(4: 5 [5]);
    eliminate!(5:);
    macro_rules! substitute {
        ($i:literal: $($k:literal)*) => {
            each_side!(b, {
                $(b[$i] = (-m[$k][$i]).mul_add(b[$k], b[$i]);)*
                b[$i] *= inverse[$i];
            });
        };
    }
    substitute!(5:);
    substitute!(4: 5);
    substitute!(3: 5 4);
    substitute!(2: 5 4 3);
    substitute!(1: 5 4 3 2);
    substitute!(0: 5 4 3 2 1);
    sides
}
