//! Elimination for arms of six revolute joints without a closed form, after Raghavan and Roth.
//!
//! M. Raghavan and B. Roth, "Inverse kinematics of the general 6R manipulator and related linkages", Journal of
//! Mechanical Design 115 (1993). The loop of six joints is cut into F₃·F₄·F₅·L₆ = F₂⁻¹·F₁⁻¹·L₆, where L₆ is the line of
//! the sixth axis. Fourteen functions of a line are affine under displacements. The right-hand side has eight monomials
//! of two joints, whose elimination leaves six equations of the joints 3, 4 and 5. The half angles of the joints 4 and
//! 5 leave a determinant of twelve rows. It is a trigonometric polynomial of degree 8 of joint 3.
//!
//! The loop is cyclic, and can be numbered from any joint in either direction. The joints 6, 1 and 2 of the loop are
//! neighbours in the chain, so that the elimination does not depend on the target.

use super::angle::{Angle, LinearRoots, solve_linear};
use super::screw::Screw;
use super::trigonometric::{RootFinder, Trigonometric};
use kinopt_kinematics::random::RandomStream;
use kinopt_kinematics::spatial::{Placement, Vector3};
use nalgebra::DMatrix;

/// Functions of a line: direction, point, moment, the quadratic vector, the point's square, point times direction.
const FUNCTIONS: usize = 14;
/// Equations after the elimination of the right-hand side.
const EQUATIONS: usize = 6;
/// Columns of the final matrix: monomials of degree 3 in the half angle of joint 4, and 2 in that of joint 5.
const COLUMNS: usize = 12;
/// Degree of the determinant in joint 3.
const DEGREE: usize = 8;
/// Degree of three equations in joint 4.
const FOURTH_DEGREE: usize = 3;
/// Halvings before close roots of joint 3 count as one: arcs of 0.01 rad. A perturbation may move a double root off the
/// real axis, so that both ends of such arcs are candidates.
const DETERMINANT_HALVINGS: u32 = 8;
/// Halvings at which an extremum near zero counts as a root of joint 3: arcs of 0.1 rad.
const TOUCHING_HALVINGS: u32 = 5;
/// Halvings before close roots of joint 4 count as one.
const FOURTH_HALVINGS: u32 = 10;
/// Samples of the determinant beyond those that determine it, so that the deviation measures rounding.
const EXTRA_SAMPLES: usize = 4;
/// Residual of the equations, relative to their size, above which a root of joint 4 is dropped: for a simple root of
/// joint 3, and for another one, which is known less precisely.
const MAX_RESIDUAL: f64 = 1e-4;
const MAX_DOUBLE_RESIDUAL: f64 = 0.03;

/// Numbering of the loop's joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbering {
    /// Joint of the chain that is joint 6 of the loop: 0 to 3. The next two are the loop's joints 1 and 2.
    pub(super) sixth: usize,
    /// True if the chain is numbered from the tool to the base.
    pub(super) reversed: bool,
}

impl Numbering {
    /// All numberings.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..4).flat_map(|sixth| [false, true].map(|reversed| Self { sixth, reversed }))
    }
}

/// Conditioning of one elimination.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditioning {
    /// Deviation of the determinant's samples from a polynomial of degree 8, relative to the largest.
    pub(super) deviation: f64,
    simple_roots: [Angle; 2 * DEGREE],
    simple_count: usize,
    /// Number of roots that are not simple: double roots, and arcs on which the determinant is below its rounding.
    pub(super) other_roots: usize,
}

impl Conditioning {
    /// Simple roots of the determinant: values of the joint [`third`](Elimination::third).
    pub(super) fn simple_roots(&self) -> &[Angle] {
        &self.simple_roots[..self.simple_count]
    }
}

/// Solver by elimination, for one numbering.
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    numbering: Numbering,
    /// Axes of the chain, or of the reversed chain.
    axes: [Screw; 6],
    /// Point about which the functions are taken.
    origin: Vector3<f64>,
    /// Combinations of the functions that vanish on all monomials of the right-hand side.
    rows: [[f64; FUNCTIONS]; EQUATIONS],
    /// These combinations of the right-hand side's constant.
    constant: [f64; EQUATIONS],
    determinant_roots: RootFinder,
    fourth_roots: RootFinder,
}

/// Equations by half-angle monomials of the joints 4 and 5, for the constant, cosine and sine of joint 3.
type Equations = [[[f64; 9]; EQUATIONS]; 3];
type EliminationMatrix = [[f64; COLUMNS]; COLUMNS];

/// Functions of a line about `origin`.
fn functions(
    direction: Vector3<f64>,
    point: Vector3<f64>,
    origin: Vector3<f64>,
) -> [f64; FUNCTIONS] {
    let (l, p) = (direction, point - origin);
    let m = p.cross(l);
    let (pp, pl) = (p.norm_squared(), p.dot(l));
    let n = l * pp - p * (2.0 * pl);
    [
        l.x, l.y, l.z, p.x, p.y, p.z, m.x, m.y, m.z, n.x, n.y, n.z, pp, pl,
    ]
}

/// Angles 0, π and π/2.
const SAMPLED: [Angle; 3] = [
    Angle { cos: 1.0, sin: 0.0 },
    Angle {
        cos: -1.0,
        sin: 0.0,
    },
    Angle { cos: 0.0, sin: 1.0 },
];

/// Fixed weights of the equations in three combinations.
const COMBINATIONS: [[f64; EQUATIONS]; 3] = [
    [1.0, 0.3, -0.7, 0.5, 0.2, -0.9],
    [-0.4, 1.0, 0.6, 0.1, -0.8, 0.3],
    [0.5, -0.2, 1.0, -0.9, 0.6, 0.7],
];

/// Coefficients of 1, cos, sin by values at the sampled angles.
fn harmonics([zero, half, quarter]: [f64; 3]) -> [f64; 3] {
    let constant = 0.5 * (zero + half);
    [constant, 0.5 * (zero - half), quarter - constant]
}

/// Coefficients of c², c·s, s² of the half angle by values at the sampled angles.
fn half_angle([zero, half, quarter]: [f64; 3]) -> [f64; 3] {
    [zero, 2.0 * quarter - zero - half, half]
}

impl Elimination {
    /// Solver for axes perturbed by `perturbation` lengths and radians; `None` if numbers are not finite.
    pub(super) fn new(axes: &[Screw; 6], numbering: Numbering, perturbation: f64) -> Option<Self> {
        let axes = &perturbed(axes, perturbation);
        let axes = match numbering.reversed {
            false => *axes,
            true => std::array::from_fn(|i| axes[5 - i].reversed()),
        };
        let sixth = numbering.sixth;
        let (line, first, second) = (axes[sixth], axes[sixth + 1], axes[sixth + 2]);
        let origin = axes[(sixth + 3).min(5)].point;
        // F₂⁻¹·F₁⁻¹·L₆.
        let mut samples = [[[0.0; 3]; 3]; FUNCTIONS];
        for (i, q1) in SAMPLED.iter().map(|q| q.negative()).enumerate() {
            for (j, q2) in SAMPLED.iter().map(|q| q.negative()).enumerate() {
                let direction = second.rotate(first.rotate(line.direction, q1), q2);
                let point = second.move_point(first.move_point(line.point, q1), q2);
                let values = functions(direction, point, origin);
                for (sample, value) in samples.iter_mut().zip(values) {
                    sample[i][j] = value;
                }
            }
        }
        let monomials = samples.map(|sample| {
            let inner = sample.map(harmonics);
            let outer: [[f64; 3]; 3] =
                std::array::from_fn(|j| harmonics([inner[0][j], inner[1][j], inner[2][j]]));
            outer
        });
        // The constant is left out; columns of zeros make the matrix square.
        let matrix = DMatrix::from_fn(FUNCTIONS, FUNCTIONS, |f, m| match m < 8 {
            true => monomials[f][(m + 1) / 3][(m + 1) % 3],
            false => 0.0,
        });
        let svd = matrix.svd(true, false);
        let u = svd.u.as_ref()?;
        let values = &svd.singular_values;
        let mut order: Vec<usize> = (0..FUNCTIONS).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        let mut rows = [[0.0; FUNCTIONS]; EQUATIONS];
        for (e, row) in rows.iter_mut().enumerate() {
            *row = std::array::from_fn(|f| u[(f, order[FUNCTIONS - EQUATIONS + e])]);
        }
        let constant = rows.map(|row| (0..FUNCTIONS).map(|f| row[f] * monomials[f][0][0]).sum());
        Some(Self {
            numbering,
            axes,
            origin,
            rows,
            constant,
            determinant_roots: RootFinder::new(DEGREE, DETERMINANT_HALVINGS)
                .with_touching(TOUCHING_HALVINGS),
            fourth_roots: RootFinder::new(FOURTH_DEGREE, FOURTH_HALVINGS),
        })
    }

    /// The final matrix: the equations times the cosine, then times the sine of half of joint 4.
    fn matrix_at(&self, equations: &Equations, q3: Angle) -> EliminationMatrix {
        let mut rows = [[0.0; COLUMNS]; COLUMNS];
        for (e, equation) in self.equations_at(equations, q3).iter().enumerate() {
            rows[e][..9].copy_from_slice(equation);
            rows[e + EQUATIONS][3..].copy_from_slice(equation);
        }
        rows
    }

    /// Value of joint 3 of the loop in a configuration of the chain.
    pub(super) fn third(&self, q: &[Angle; 6]) -> Angle {
        let [third, ..] = self.left_joints();
        match self.numbering.reversed {
            false => q[third],
            true => q[5 - third],
        }
    }

    /// Joints 3, 4 and 5 of the loop, as joints of the numbered chain.
    fn left_joints(&self) -> [usize; 3] {
        let sixth = self.numbering.sixth;
        [3, 4, 5].map(|i| (sixth + i) % 6)
    }

    /// Direction and point of the line after the joint of the loop with index `done` from the inside.
    fn moved(
        &self,
        joint: usize,
        angle: Angle,
        (direction, point): (Vector3<f64>, Vector3<f64>),
    ) -> (Vector3<f64>, Vector3<f64>) {
        let axis = &self.axes[joint];
        (axis.rotate(direction, angle), axis.move_point(point, angle))
    }

    /// The six equations for a target, by the inverse of its displacement in the chain's direction.
    fn equations(&self, inverse: &Placement<f64>) -> Equations {
        let [third, fourth, fifth] = self.left_joints();
        let sixth = self.numbering.sixth;
        let back =
            |step: usize, (direction, point): (Vector3<f64>, Vector3<f64>)| match step == sixth {
                true => (inverse.rotation * direction, inverse.apply(point)),
                false => (direction, point),
            };
        let line = &self.axes[sixth];
        let line = back(0, (line.direction, line.point));
        // Values at [joint 3][joint 4][joint 5].
        let mut values = [[[[0.0; EQUATIONS]; 3]; 3]; 3];
        for (i5, &q5) in SAMPLED.iter().enumerate() {
            let line = back(1, self.moved(fifth, q5, line));
            for (i4, &q4) in SAMPLED.iter().enumerate() {
                let line = back(2, self.moved(fourth, q4, line));
                for (i3, &q3) in SAMPLED.iter().enumerate() {
                    let (direction, point) = back(3, self.moved(third, q3, line));
                    let f = functions(direction, point, self.origin);
                    for ((value, row), constant) in values[i3][i4][i5]
                        .iter_mut()
                        .zip(&self.rows)
                        .zip(&self.constant)
                    {
                        *value = row.iter().zip(&f).map(|(a, b)| a * b).sum::<f64>() - constant;
                    }
                }
            }
        }
        let mut equations = [[[0.0; 9]; EQUATIONS]; 3];
        for e in 0..EQUATIONS {
            let mut by_third = [[0.0; 9]; 3];
            for (i3, by_half_angles) in by_third.iter_mut().enumerate() {
                let inner: [[f64; 3]; 3] = std::array::from_fn(|i4| {
                    half_angle(std::array::from_fn(|i5| values[i3][i4][i5][e]))
                });
                for m5 in 0..3 {
                    let outer = half_angle([inner[0][m5], inner[1][m5], inner[2][m5]]);
                    for (m4, value) in outer.into_iter().enumerate() {
                        by_half_angles[3 * m4 + m5] = value;
                    }
                }
            }
            for m in 0..9 {
                let column = harmonics([by_third[0][m], by_third[1][m], by_third[2][m]]);
                for (k, value) in column.into_iter().enumerate() {
                    equations[k][e][m] = value;
                }
            }
        }
        equations
    }

    /// Appends candidates for a displacement of the last link.
    pub(super) fn solve(
        &self,
        displacement: &Placement<f64>,
        found: &mut Vec<[Angle; 6]>,
    ) -> Conditioning {
        let inverse = match self.numbering.reversed {
            false => displacement.inverse(),
            true => *displacement,
        };
        let equations = self.equations(&inverse);
        let (determinant, deviation) = self.determinant(&equations);
        let mut conditioning = Conditioning {
            deviation,
            simple_roots: [Angle::ZERO; 2 * DEGREE],
            simple_count: 0,
            other_roots: 0,
        };
        self.determinant_roots
            .visit(&determinant, deviation, |root| {
                match conditioning.simple_roots.get_mut(conditioning.simple_count) {
                    Some(simple) if root.is_simple => {
                        *simple = root.angle;
                        conditioning.simple_count += 1;
                    }
                    _ => conditioning.other_roots += 1,
                }
                let max_residual = match root.is_simple {
                    true => MAX_RESIDUAL,
                    false => MAX_DOUBLE_RESIDUAL,
                };
                let equations = self.equations_at(&equations, root.angle);
                self.each_pair(&equations, max_residual, |q4, q5| {
                    self.complete(&inverse, [root.angle, q4, q5], found);
                });
            });
        conditioning
    }

    /// The determinant as a polynomial of joint 3, and its relative deviation from its samples.
    fn determinant(&self, equations: &Equations) -> (Trigonometric, f64) {
        Trigonometric::fit(DEGREE, EXTRA_SAMPLES, |q3| {
            determinant_of(self.matrix_at(equations, q3))
        })
    }

    /// The equations at a value of joint 3.
    fn equations_at(&self, equations: &Equations, q3: Angle) -> [[f64; 9]; EQUATIONS] {
        let [constant, cos, sin] = equations;
        let mut at = [[0.0; 9]; EQUATIONS];
        for e in 0..EQUATIONS {
            for m in 0..9 {
                at[e][m] = constant[e][m] + cos[e][m] * q3.cos + sin[e][m] * q3.sin;
            }
        }
        at
    }

    /// Visits the joints 4 and 5 that solve the equations of a value of joint 3.
    fn each_pair(
        &self,
        equations: &[[f64; 9]; EQUATIONS],
        max_residual: f64,
        mut visit: impl FnMut(Angle, Angle),
    ) {
        let size = equations
            .iter()
            .flatten()
            .map(|v| v * v)
            .sum::<f64>()
            .sqrt();
        // Three combinations of the equations, by monomials of both joints.
        let mut combined = [[0.0; 9]; 3];
        for (k, row) in combined.iter_mut().enumerate() {
            for (e, equation) in equations.iter().enumerate() {
                let weight = COMBINATIONS[k][e];
                for (sum, value) in row.iter_mut().zip(equation) {
                    *sum += weight * value;
                }
            }
        }
        let at = |equation: &[f64; 9], q4: Angle| -> [f64; 3] {
            // Squares and the product of the half angle's cosine and sine.
            let (cc, cs, ss) = (0.5 * (1.0 + q4.cos), 0.5 * q4.sin, 0.5 * (1.0 - q4.cos));
            std::array::from_fn(|m| equation[m] * cc + equation[3 + m] * cs + equation[6 + m] * ss)
        };
        let (fourth, _) = Trigonometric::fit(FOURTH_DEGREE, 0, |q4| {
            let [a, b, c] = combined.map(|row| Vector3::from(at(&row, q4)));
            a.dot(b.cross(c))
        });
        self.fourth_roots.visit(&fourth, 0.0, |root| {
            // The null vector of the equations: the smallest eigenvector of their squares.
            let mut squares = [[0.0; 3]; 3];
            for equation in equations {
                let row = at(equation, root.angle);
                for i in 0..3 {
                    for j in 0..3 {
                        squares[i][j] += row[i] * row[j];
                    }
                }
            }
            let [x, y, z] = squares.map(Vector3::from);
            let products = [x.cross(y), y.cross(z), z.cross(x)];
            let longest =
                (products.into_iter()).max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
            let Some(null) = longest.filter(|v| v.norm_squared() > 0.0) else {
                return;
            };
            let null = null * null.norm().recip();
            let residual = [x, y, z].map(|row| row.dot(null));
            let residual =
                (residual[0] * null.x + residual[1] * null.y + residual[2] * null.z).abs();
            if residual.sqrt() > max_residual * size {
                return;
            }
            // The null vector is (c², c·s, s²) of joint 5.
            let (c, s) = match null.x.abs() > null.z.abs() {
                true => (null.x, null.y),
                false => (null.y, null.z),
            };
            visit(root.angle, Angle::of_point(c * c - s * s, 2.0 * c * s));
        });
    }

    /// Estimated error of the root of joint 3 at a known solution, radians.
    pub(super) fn root_error(&self, displacement: &Placement<f64>, q: &[Angle; 6]) -> f64 {
        let inverse = match self.numbering.reversed {
            false => displacement.inverse(),
            true => *displacement,
        };
        let q3 = self.third(q);
        let equations = self.equations(&inverse);
        let (determinant, deviation) = self.determinant(&equations);
        let noise = determinant.at(q3).abs() + deviation * determinant.size();
        noise / determinant.slope_at(q3).abs()
    }

    /// Solves the joints 1, 2 and 6 of the loop, and adds the candidate.
    fn complete(
        &self,
        inverse: &Placement<f64>,
        [q3, q4, q5]: [Angle; 3],
        found: &mut Vec<[Angle; 6]>,
    ) {
        let [third, fourth, fifth] = self.left_joints();
        let sixth = self.numbering.sixth;
        let axis = self.axes[sixth];
        let left = |(direction, point): (Vector3<f64>, Vector3<f64>)| {
            let mut line = (direction, point);
            let steps = [(fifth, q5), (fourth, q4), (third, q3)];
            for step in 0..4 {
                if step == sixth {
                    line = (inverse.rotation * line.0, inverse.apply(line.1));
                }
                if let Some(&(joint, angle)) = steps.get(step) {
                    line = self.moved(joint, angle, line);
                }
            }
            line
        };
        let (first, second) = (self.axes[sixth + 1], self.axes[sixth + 2]);
        let (l, x) = left((axis.direction, axis.point));
        let (l0, p0) = (axis.direction, axis.point - first.point);
        // E₁·E₂ moves (l, x) to (l₀, p₀). Four equations, linear in the second joint.
        let (h, offset, y) = (
            first.direction,
            second.point - first.point,
            x - second.point,
        );
        let row = |w: Vector3<f64>, v: Vector3<f64>, d: f64| {
            let across = second.across(v);
            let along = w.dot(v - across);
            [
                w.dot(across),
                w.dot(second.direction.cross(across)),
                d - along,
            ]
        };
        let equations = [
            row(h, l, h.dot(l0)),
            row(h, y, h.dot(p0 - offset)),
            row(
                offset,
                y,
                0.5 * (p0.norm_squared() - offset.norm_squared() - y.norm_squared()),
            ),
            row(offset, l, p0.dot(l0) - y.dot(l)),
        ];
        let sum = |i: usize, j: usize| equations.iter().map(|e| e[i] * e[j]).sum::<f64>();
        let (aa, ab, bb, ad, bd) = (sum(0, 0), sum(0, 1), sum(1, 1), sum(0, 2), sum(1, 2));
        let determinant = aa * bb - ab * ab;
        let mut add = |q2: Angle| {
            let (l, x) = (second.rotate(l, q2), second.move_point(x, q2) - first.point);
            let (l, x) = (first.across(l), first.across(x));
            let (lc, xc) = (first.direction.cross(l), first.direction.cross(x));
            let q1 = Angle::of_point(l.dot(l0) + x.dot(p0), lc.dot(l0) + xc.dot(p0));
            // E₆⁻¹ = E₁·E₂·B.
            let side = perpendicular(axis.direction);
            let (moved, _) = left((side, axis.point));
            let moved = first.rotate(second.rotate(moved, q2), q1);
            let q6 = axis.angle_between(moved, side).unwrap_or(Angle::ZERO);
            let mut q = [Angle::ZERO; 6];
            let joints = [sixth, sixth + 1, sixth + 2, third, fourth, fifth];
            for (joint, angle) in joints.into_iter().zip([q6, q1, q2, q3, q4, q5]) {
                q[joint] = angle;
            }
            if self.numbering.reversed {
                q.reverse();
            }
            found.push(q);
        };
        if determinant > 1e-10 * (aa + bb) * (aa + bb) {
            add(Angle::of_point(ad * bb - bd * ab, bd * aa - ad * ab));
            return;
        }
        let longest = equations.iter().max_by(|a, b| {
            let square = |e: &[f64; 3]| e[0] * e[0] + e[1] * e[1];
            square(a).total_cmp(&square(b))
        });
        if let Some(&[a, b, d]) = longest
            && let LinearRoots::Two(roots) = solve_linear(a, b, d, 1.0)
        {
            roots.into_iter().for_each(add);
        }
    }
}

/// A unit vector across a direction.
fn perpendicular(h: Vector3<f64>) -> Vector3<f64> {
    let axis = match h.x.abs() < 0.6 {
        true => Vector3::new(1.0, 0.0, 0.0),
        false => Vector3::new(0.0, 1.0, 0.0),
    };
    let side = h.cross(axis);
    side * side.norm().recip()
}

/// Determinant by elimination with row pivots.
fn determinant_of(mut rows: EliminationMatrix) -> f64 {
    let mut determinant = 1.0;
    for k in 0..COLUMNS {
        let mut pivot = k;
        for i in k + 1..COLUMNS {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            rows.swap(k, pivot);
            determinant = -determinant;
        }
        let pivot_row = rows[k];
        determinant *= pivot_row[k];
        if pivot_row[k] == 0.0 {
            return 0.0;
        }
        let scale = pivot_row[k].recip();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] * scale;
            if factor != 0.0 {
                for j in k + 1..COLUMNS {
                    row[j] -= factor * pivot_row[j];
                }
            }
        }
    }
    determinant
}

/// The axes with directions and points displaced by about `size`.
///
/// Parallel, perpendicular and intersecting axes make the determinant vanish for every target. Its leading term in a
/// perturbation does not. The isolated solutions of an arm are limits of solutions of perturbed arms.
fn perturbed(axes: &[Screw; 6], size: f64) -> [Screw; 6] {
    let mut random = RandomStream::new(0, 0);
    let mut signed = || 2.0 * random.unit() - 1.0;
    axes.map(|axis| {
        let mut offset = || Vector3::new(signed(), signed(), signed()) * size;
        let direction = axis.direction + offset();
        Screw {
            direction: direction * direction.norm().recip(),
            point: axis.point + offset(),
        }
    })
}
