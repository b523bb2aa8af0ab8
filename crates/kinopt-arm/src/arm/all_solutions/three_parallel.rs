//! Closed form of arms whose second, third and fourth axes are parallel.

use super::angle::{Angle, LinearRoots, solve_linear};
use super::branches::BranchSigns;
use super::position::QUARTIC_HALVINGS;
use super::screw::{Relation, Screw, common_normal, relation};
use super::trigonometric::{RootFinder, Trigonometric};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Solver of an arm whose axes 2, 3 and 4 are parallel.
#[derive(Clone, Debug)]
pub(super) struct ThreeParallel {
    axes: [Screw; 6],
    /// Directions of the axes 2, 3 and 4 relative to the second: 1 or −1.
    signs: [f64; 3],
    /// True if the last two axes intersect; otherwise the first joint is a root of a quartic equation.
    is_intersecting: bool,
    quartic: RootFinder,
}

impl ThreeParallel {
    /// `None` if the axes 2, 3 and 4 are not parallel, or 4 and 5, 5 and 6, or 1 and 2 are.
    pub(super) fn new(mut axes: [Screw; 6], tolerance: f64) -> Option<Self> {
        let is_parallel = |a: usize, b: usize, tolerance: f64| {
            axes[a].direction.cross(axes[b].direction).norm() <= tolerance
        };
        let parallel = is_parallel(1, 2, tolerance) && is_parallel(1, 3, tolerance);
        let others = [(0, 1), (3, 4), (4, 5)];
        if !parallel
            || others
                .iter()
                .any(|&(a, b)| is_parallel(a, b, 100.0 * tolerance))
        {
            return None;
        }
        let is_apart =
            |a: usize, b: usize| axes[a].across(axes[b].point - axes[a].point).norm() > tolerance;
        if !(is_apart(1, 2) && is_apart(2, 3)) {
            return None;
        }
        let is_intersecting = match relation(&axes[4], &axes[5], tolerance) {
            Relation::Intersecting(point) => {
                (axes[4].point, axes[5].point) = (point, point);
                true
            }
            _ => {
                [axes[4].point, axes[5].point] = common_normal(&axes[4], &axes[5]);
                false
            }
        };
        let sign = |a: usize| axes[1].direction.dot(axes[a].direction).signum();
        Some(Self {
            signs: [1.0, sign(2), sign(3)],
            axes,
            is_intersecting,
            quartic: RootFinder::new(2, QUARTIC_HALVINGS),
        })
    }

    /// Branches of the structure.
    pub(super) fn branch_signs(&self) -> BranchSigns {
        let meeting = self.is_intersecting.then_some(self.axes[5].point);
        BranchSigns::ThreeParallel { meeting }
    }

    /// Appends candidates for the displacement of the last link. Returns true if there is a continuous family.
    pub(super) fn solve(&self, displacement: &Placement<f64>, found: &mut Vec<[Angle; 6]>) -> bool {
        let [first, second, .., fifth, sixth] = self.axes;
        let (h, h5, h6) = (second.direction, fifth.direction, sixth.direction);
        // h · R1ᵀ·v = Σ of coefficients · (1, cos q1, sin q1).
        let rotated = |v: Vector3<f64>| {
            let along = first.direction * first.direction.dot(v);
            [
                h.dot(along),
                h.dot(v - along),
                -h.dot(first.direction.cross(v)),
            ]
        };
        // h · R5·v.
        let moved = |v: Vector3<f64>| {
            let along = h5 * h5.dot(v);
            [h.dot(along), h.dot(v - along), h.dot(h5.cross(v))]
        };
        let goal = rotated(displacement.rotation * h6);
        let tilt = moved(h6);
        let point = displacement.apply(sixth.point);
        let height = rotated(point - first.point);
        let offset = moved(sixth.point - fifth.point);
        // h · (E5·r6 − r1) = h · R1ᵀ·(p − r1), with E5·r6 = r5 + R5·(r6 − r5).
        let constant = h.dot(fifth.point - first.point);
        let mut family = false;
        if self.is_intersecting {
            let d = constant + offset[0] + offset[1] - height[0];
            let LinearRoots::Two(first_roots) = solve_linear(height[1], height[2], d, 1.0) else {
                return false;
            };
            for q1 in first_roots {
                let d = goal[0] + goal[1] * q1.cos + goal[2] * q1.sin - tilt[0];
                if let LinearRoots::Two(roots) = solve_linear(tilt[1], tilt[2], d, 1.0) {
                    for q5 in roots {
                        family |= self.solve_plane(q1, q5, displacement, found);
                    }
                }
            }
            return family;
        }
        // Two equations that are linear in q5, with constant coefficients.
        let determinant = tilt[1] * offset[2] - tilt[2] * offset[1];
        let right = |q1: Angle| {
            let at = |f: &[f64; 3]| f[0] + f[1] * q1.cos + f[2] * q1.sin;
            let (a, b) = (at(&goal) - tilt[0], at(&height) - constant - offset[0]);
            (a * offset[2] - b * tilt[2], tilt[1] * b - offset[1] * a)
        };
        let (quartic, _) = Trigonometric::fit(2, 0, |q1| {
            let (x, y) = right(q1);
            x * x + y * y - determinant * determinant
        });
        self.quartic.visit(&quartic, 0.0, |root| {
            let (x, y) = right(root.angle);
            let sign = determinant.signum();
            let q5 = Angle::of_point(x * sign, y * sign);
            family |= self.solve_plane(root.angle, q5, displacement, found);
        });
        family
    }

    /// Solves the sixth joint, then the parallel axes.
    fn solve_plane(
        &self,
        q1: Angle,
        q5: Angle,
        displacement: &Placement<f64>,
        found: &mut Vec<[Angle; 6]>,
    ) -> bool {
        let [first, second, third, fourth, fifth, sixth] = self.axes;
        let h = second.direction;
        // R6ᵀ·R5ᵀ·h = Rᵀ·R1·h.
        let from = fifth.rotate(h, q5.negative());
        let to = displacement.rotation.transpose() * first.rotate(h, q1);
        let q6 = sixth.angle_between(to, from);
        let mut family = q6.is_none();
        let q6 = q6.unwrap_or(Angle::ZERO);
        // x ↦ E1⁻¹·G·E6⁻¹·E5⁻¹·x, the displacement of the parallel joints.
        let back = |x: Vector3<f64>| {
            let x = sixth.move_point(fifth.move_point(x, q5.negative()), q6.negative());
            first.move_point(displacement.apply(x), q1.negative())
        };
        let origin = back(fourth.point);
        let side = fifth.direction.cross(h);
        let sum = second
            .angle_between(side, back(fourth.point + side) - origin)
            .unwrap_or(Angle::ZERO);
        let upper = second.across(third.point - second.point);
        let lower = second.across(fourth.point - third.point);
        let reach = second.across(origin - second.point);
        // |R3·lower + upper|² = |reach|².
        let (a, b) = (2.0 * upper.dot(lower), 2.0 * upper.dot(h.cross(lower)));
        let d = reach.norm_squared() - upper.norm_squared() - lower.norm_squared();
        let LinearRoots::Two(roots) = solve_linear(a, b, d, 1.0) else {
            return family;
        };
        for q3 in roots {
            let elbow = Screw {
                direction: h,
                point: third.point,
            };
            let to_elbow = upper + elbow.rotate(lower, q3);
            let q2 = second.angle_between(to_elbow, reach);
            family |= q2.is_none();
            let q2 = q2.unwrap_or(Angle::ZERO);
            let q4 = sum.plus(q2.negative()).plus(q3.negative());
            let [s2, s3, s4] = self.signs;
            found.push([q1, q2.signed(s2), q3.signed(s3), q4.signed(s4), q5, q6]);
        }
        family
    }
}
