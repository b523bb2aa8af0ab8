//! Three revolute joints that move a point to a point.

use super::angle::{Angle, LinearRoots, solve_linear};
use super::screw::{Relation, Screw, common_normal, relation};
use super::trigonometric::{RootFinder, Trigonometric};
use kinopt_kinematics::spatial::Vector3;

/// Halvings of an arc before close roots of a quartic count as one: arcs of 3e-6 rad.
pub(super) const QUARTIC_HALVINGS: u32 = 20;

/// Structure of three axes that decides the closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AxisPair {
    Parallel,
    Intersecting,
    /// A quartic equation.
    Skew,
}

/// Solver of E₁(q₁)·E₂(q₂)·E₃(q₃)·w = p for a constant point w.
#[derive(Clone, Debug)]
pub(super) struct PositionSolver {
    /// The axes, in the order in which they are solved.
    axes: [Screw; 3],
    /// True if the order is that of the reversed chain, which exchanges w and p.
    reversed: bool,
    pair: AxisPair,
    w: Vector3<f64>,
    quartic: RootFinder,
}

impl PositionSolver {
    /// Chooses the order of the axes; `None` if the first two coincide or all three are parallel.
    pub(super) fn new(axes: [Screw; 3], w: Vector3<f64>, tolerance: f64) -> Option<Self> {
        let reversed_axes = [axes[2].reversed(), axes[1].reversed(), axes[0].reversed()];
        let forward = relation(&axes[0], &axes[1], tolerance);
        let backward = relation(&axes[1], &axes[2], tolerance);
        if forward == Relation::Parallel && backward == Relation::Parallel {
            return None;
        }
        let is_simple = |relation: Relation| relation != Relation::Skew;
        let (axes, reversed, relation) = match (is_simple(forward), is_simple(backward)) {
            (true, _) | (false, false) => (axes, false, forward),
            (false, true) => (reversed_axes, true, backward),
        };
        let [mut first, mut second, third] = axes;
        let pair = match relation {
            Relation::Parallel => {
                second.point = first.point + second.across(second.point - first.point);
                if (second.point - first.point).norm() <= tolerance {
                    return None;
                }
                AxisPair::Parallel
            }
            Relation::Intersecting(point) => {
                (first.point, second.point) = (point, point);
                AxisPair::Intersecting
            }
            Relation::Skew => {
                [first.point, second.point] = common_normal(&first, &second);
                AxisPair::Skew
            }
        };
        Some(Self {
            axes: [first, second, third],
            reversed,
            pair,
            w,
            quartic: RootFinder::new(2, QUARTIC_HALVINGS),
        })
    }

    /// Visits the angles (q₁, q₂, q₃) that move w to `p`. Returns true if there is a continuous family.
    pub(super) fn solve(&self, p: Vector3<f64>, visit: impl FnMut([Angle; 3])) -> bool {
        let (w, p) = match self.reversed {
            true => (p, self.w),
            false => (self.w, p),
        };
        let [first, second, third] = self.axes;
        let (h1, h2, h3) = (first.direction, second.direction, third.direction);
        // y(q₃) − r₂ = constant + cos·q₃ + sin·q₃.
        let arm = w - third.point;
        let across = third.across(arm);
        let around = h3.cross(across);
        let constant = third.point + (arm - across) - second.point;
        // Squared length of u = y − r₂, and its component along the second axis.
        let squared = [
            constant.norm_squared() + across.norm_squared(),
            2.0 * constant.dot(across),
            2.0 * constant.dot(around),
        ];
        let along = [h2.dot(constant), h2.dot(across), h2.dot(around)];
        let offset = second.point - first.point;
        let k1 = h1.dot(p - first.point) - h1.dot(offset);
        let k2 = (p - first.point).norm_squared() - offset.norm_squared();
        let cos12 = h1.dot(h2);
        let mut candidates = PositionCandidates {
            solver: self,
            w,
            p,
            visit,
            family: false,
        };
        match self.pair {
            AxisPair::Parallel => {
                let d = cos12 * k1 - along[0];
                candidates.each_linear(along[1], along[2], d, |candidates, q3, u| {
                    // In the plane across the axes: offset · v = (k2 − |u|²) / 2.
                    let length = offset.norm();
                    let e2 = offset * length.recip();
                    let e1 = e2.cross(h2);
                    let v2 = 0.5 * (k2 - u.norm_squared()) / length;
                    candidates.each_second(q3, u, e2, e1, v2);
                });
            }
            AxisPair::Intersecting => {
                let d = k2 - squared[0];
                candidates.each_linear(squared[1], squared[2], d, |candidates, q3, u| {
                    let normal = second.across(h1);
                    let sin = normal.norm();
                    let e1 = normal * sin.recip();
                    let e2 = h2.cross(e1);
                    let v1 = (k1 - cos12 * h2.dot(u)) / sin;
                    candidates.each_second(q3, u, e1, e2, v1);
                });
            }
            AxisPair::Skew => {
                let normal = second.across(h1);
                let sin = normal.norm();
                let e1 = normal * sin.recip();
                let e2 = h2.cross(e1);
                let length = offset.dot(e2);
                // v₁ = (k₁ − cos·u_z)/sin, v₂ = (k₂ − |u|²)/(2·length), v₁² + v₂² = |u|² − u_z².
                let v = |q3: Angle| {
                    let at = |f: &[f64; 3]| f[0] + f[1] * q3.cos + f[2] * q3.sin;
                    let (z, square) = (at(&along), at(&squared));
                    let v1 = k1 - cos12 * z;
                    let v2 = 0.5 * (k2 - square);
                    (v1, v2, square - z * z)
                };
                let f = |q3: Angle| {
                    let (v1, v2, square) = v(q3);
                    let (v1, v2) = (v1 * length, v2 * sin);
                    v1 * v1 + v2 * v2 - square * (sin * length) * (sin * length)
                };
                let (quartic, _) = Trigonometric::fit(2, 0, f);
                self.quartic.visit(&quartic, 0.0, |root| {
                    let q3 = root.angle;
                    let u = constant + across * q3.cos + around * q3.sin;
                    let (v1, v2, _) = v(q3);
                    let to = e1 * (v1 / sin) + e2 * (v2 / length);
                    match second.angle_between(u, to) {
                        Some(q2) => candidates.push(q2, q3),
                        None => {
                            candidates.family = true;
                            candidates.push(Angle::ZERO, q3);
                        }
                    }
                });
            }
        }
        candidates.family
    }
}

/// Candidates of one position.
struct PositionCandidates<'a, F> {
    solver: &'a PositionSolver,
    w: Vector3<f64>,
    p: Vector3<f64>,
    visit: F,
    family: bool,
}

impl<F: FnMut([Angle; 3])> PositionCandidates<'_, F> {
    /// Visits the solutions q₃ of a linear equation, with the point u(q₃) from the second axis.
    fn each_linear(
        &mut self,
        a: f64,
        b: f64,
        d: f64,
        mut solve_second: impl FnMut(&mut Self, Angle, Vector3<f64>),
    ) {
        let roots = match solve_linear(a, b, d, 1.0) {
            LinearRoots::None => return,
            LinearRoots::Two(roots) => roots,
            LinearRoots::All => {
                self.family = true;
                [Angle::ZERO; 2]
            }
        };
        let [_, second, third] = self.solver.axes;
        for q3 in roots {
            solve_second(self, q3, third.move_point(self.w, q3) - second.point);
        }
    }

    /// Solves the second joint: rotated u has the component `value` along `e1`, an axis of its plane.
    fn each_second(
        &mut self,
        q3: Angle,
        u: Vector3<f64>,
        e1: Vector3<f64>,
        e2: Vector3<f64>,
        value: f64,
    ) {
        let h2 = self.solver.axes[1].direction;
        let (x, y) = (u.dot(e1), u.dot(e2));
        // e1, e2 is right-handed about ±h2.
        let sign = h2.dot(e1.cross(e2)).signum();
        match solve_linear(x, -y * sign, value, 1.0) {
            LinearRoots::None => {}
            LinearRoots::Two(roots) => {
                for q2 in roots {
                    self.push(q2, q3);
                }
            }
            LinearRoots::All => {
                self.family = true;
                self.push(Angle::ZERO, q3);
            }
        }
    }

    /// Solves the first joint and adds the candidate.
    fn push(&mut self, q2: Angle, q3: Angle) {
        let [first, second, third] = self.solver.axes;
        let x = second.move_point(third.move_point(self.w, q3), q2);
        let q1 = first.angle_between(x - first.point, self.p - first.point);
        self.family |= q1.is_none();
        let q1 = q1.unwrap_or(Angle::ZERO);
        (self.visit)(match self.solver.reversed {
            true => [q3, q2, q1],
            false => [q1, q2, q3],
        });
    }
}
