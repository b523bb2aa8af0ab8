//! Forward kinematics of all lanes, Jacobian columns, and J Jᵀ.

use super::evaluation::Evaluation;
use super::group::LaneGroup;
use super::lane::LaneScalar;
use super::links::Links;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Runs the body for each joint; unrolled if their number is known and code is optimised.
macro_rules! each_joint {
    ($n:expr, $i:ident, $body:block) => {
        if JOINTS != 0 && !cfg!(debug_assertions) {
            each_joint!(@ $i, $body, 0 1 2 3 4 5 6)
        } else {
            for $i in 0..$n $body
        }
    };
    (@ $i:ident, $body:block, $($k:literal)*) => {{
        $(if $k < JOINTS { let $i = $k; $body })*
    }};
}

/// Computes the tip's pose and the Jacobian's columns in the goal frame.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn evaluate<V: LaneScalar, const N: usize, const JOINTS: usize>(
    group: &mut LaneGroup<V, N>,
    links: &Links,
) -> Evaluation<V> {
    let n = group.joints::<JOINTS>();
    let c = V::constant;
    for i in 0..n {
        let link = &links.links[i];
        group.sin_cos[i] = if JOINTS != 0 || link.kind.turns() {
            (group.q[i] + c(link.offset)).sin_cos()
        } else {
            (c(link.offset_sin_cos.0), c(link.offset_sin_cos.1))
        };
    }
    group.frames[0] = group.goal_from_first;
    for i in 0..n {
        let link = &links.links[i];
        let Placement {
            rotation: mut r,
            translation: mut p,
        } = group.frames[link.from & 1];
        if JOINTS != 0 || link.kind.turns() {
            group.angular[i] = r.z;
            group.linear[i] = p.cross(r.z);
        } else {
            group.linear[i] = r.z;
            group.angular[i] = Vector3::zero();
            p = r.z.mul_add(group.q[i], p);
        }
        let sin_cos = group.sin_cos[i];
        r = r.rotated_about_z(sin_cos);
        p =
            r.x.mul_add(c(link.along_x), r.y.mul_add(c(link.along_y), p));
        r = r.rotated_about_x((c(link.twist.0), c(link.twist.1)));
        group.frames[link.to & 1] = Placement::new(r, p);
    }
    let Placement {
        rotation: r,
        translation: p,
    } = group.frames[links.links[n - 1].to & 1];
    Evaluation {
        position: p,
        rotation: r,
    }
}

/// Computes the lower triangle of J Jᵀ, in three blocks whose sums fit the registers.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn normal_equations<V: LaneScalar, const N: usize, const JOINTS: usize>(
    group: &mut LaneGroup<V, N>,
) {
    let n = group.joints::<JOINTS>();
    macro_rules! block {
        ($left:ident, $right:ident, $row:literal, $column:literal, $($r:literal $k:literal),*) => {{
            let mut sum = [[V::zero(); 3]; 3];
            each_joint!(n, i, {
                let (left, right) = (group.$left[i].to_array(), group.$right[i].to_array());
                $(sum[$r][$k] = left[$r].mul_add(right[$k], sum[$r][$k]);)*
            });
            $(group.normal[$row + $r][$column + $k] = sum[$r][$k];)*
        }};
    }
    block!(linear, linear, 0, 0, 0 0, 1 0, 1 1, 2 0, 2 1, 2 2);
    block!(angular, linear, 3, 0, 0 0, 0 1, 0 2, 1 0, 1 1, 1 2, 2 0, 2 1, 2 2);
    block!(angular, angular, 3, 3, 0 0, 1 0, 1 1, 2 0, 2 1, 2 2);
}
