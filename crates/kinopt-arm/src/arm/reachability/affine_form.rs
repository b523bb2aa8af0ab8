//! Affine forms of points: their positions over a box of joint values, as a sum of terms with bounded factors.
//!
//! See Stolfi and de Figueiredo, "Self-Validated Numerical Methods and Applications", 1997.

use std::ops::Range;

use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::axis_chain::{AxisChain, AxisMotion};
use super::joint_box::{JointBox, MAX_ARM_JOINTS, MAX_JOINTS};

/// Largest number of points of the tool that a proof compares with the target.
pub(super) const MAX_POINTS: usize = 4;

/// Most joints with terms of second order: those of an arm and the rotations of a cell, whose translations are outermost.
const MAX_INNER: usize = MAX_ARM_JOINTS + 3;
/// Most terms of second order: two for each rotation, and one for each pair of joints of one half of the arm.
const MAX_NOISES: usize = 2 * MAX_INNER + MAX_INNER * (MAX_INNER - 1) / 2;

/// Terms of second and third order below which division cannot exclude a box, in metres summed over the points.
const NEGLIGIBLE: f64 = 1e-10;

/// A vector for each compared point.
pub(super) type PointVectors = [Vector3<f64>; MAX_POINTS];

const ZERO: PointVectors = [Vector3 {
    x: 0.0,
    y: 0.0,
    z: 0.0,
}; MAX_POINTS];

/// Vector with a factor between −1 and 1 of its own, and the two joints that cause it.
#[derive(Clone, Copy, Debug)]
struct NoiseTerm {
    vectors: PointVectors,
    joints: [usize; 2],
}

/// Positions `centre + Σ linear_j·δ_j + Σ noise_k·ε_k + r`, with all factors δ and ε between −1 and 1 and ‖r‖ at most
/// `remainder`. A factor δ_j is the deviation of joint j from the box's centre, divided by the half width.
#[derive(Clone, Debug)]
pub(super) struct AffineForm {
    pub(super) points: usize,
    pub(super) centre: PointVectors,
    pub(super) linear: [PointVectors; MAX_JOINTS],
    noises: [NoiseTerm; MAX_NOISES],
    noise_count: usize,
    pub(super) remainder: [f64; MAX_POINTS],
    /// Share of each joint in the remainders.
    nonlinearity: [f64; MAX_JOINTS],
    /// Joints that the terms depend on.
    inner: Range<usize>,
}

/// Bounds of a rotation by `centre ± half_width`: `cos = mean_cos ± cos_error` and `sin = slope·δ ± sin_error` of the
/// deviation from the centre.
struct Turn {
    sin_centre: f64,
    cos_centre: f64,
    mean_cos: f64,
    cos_error: f64,
    slope: f64,
    sin_error: f64,
}

impl Turn {
    fn new(centre: f64, half_width: f64) -> Self {
        let (sin_centre, cos_centre) = elementary::sin_cos(centre);
        let (sin, cos) = elementary::sin_cos(half_width);
        // Nearly the line of least largest error, whose slope is 1 − h²/8 + O(h⁴).
        let slope_per_radian = match half_width > 1e-4 {
            true => 0.25 + 0.75 * sin / half_width,
            false => 1.0 - 0.125 * half_width * half_width,
        };
        let slope = slope_per_radian * half_width;
        // The error of sin x − slope·x is largest where its derivative is zero, or at the end.
        let extreme = elementary::acos(slope_per_radian.min(1.0)).min(half_width);
        let inner_error = (elementary::sin(extreme) - slope_per_radian * extreme).abs();
        Self {
            sin_centre,
            cos_centre,
            mean_cos: 0.5 * (1.0 + cos),
            cos_error: 0.5 * (1.0 - cos),
            slope,
            sin_error: inner_error.max((sin - slope).abs()),
        }
    }

    fn at_centre(&self, v: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            v.x * self.cos_centre - v.y * self.sin_centre,
            v.x * self.sin_centre + v.y * self.cos_centre,
            v.z,
        )
    }

    /// Factor of the cosine at the centre: the vector without its part along z.
    fn of_cos(&self, v: Vector3<f64>) -> Vector3<f64> {
        let turned = self.at_centre(v);
        Vector3::new(turned.x, turned.y, 0.0)
    }

    /// Factor of the sine at the centre.
    fn of_sin(&self, v: Vector3<f64>) -> Vector3<f64> {
        let turned = self.at_centre(v);
        Vector3::new(-turned.y, turned.x, 0.0)
    }

    fn mean(&self, v: Vector3<f64>) -> Vector3<f64> {
        let turned = self.at_centre(v);
        Vector3::new(turned.x * self.mean_cos, turned.y * self.mean_cos, turned.z)
    }

    /// Norm of the largest error of the rotation, per length across the axis.
    fn error(&self) -> f64 {
        (self.cos_error * self.cos_error + self.sin_error * self.sin_error).sqrt()
    }
}

fn across_z(v: Vector3<f64>) -> f64 {
    (v.x * v.x + v.y * v.y).sqrt()
}

impl AffineForm {
    fn of_points(points: &[Vector3<f64>], first_joint: usize) -> Self {
        let mut centre = ZERO;
        centre[..points.len()].copy_from_slice(points);
        Self {
            points: points.len(),
            centre,
            linear: [ZERO; MAX_JOINTS],
            noises: [NoiseTerm {
                vectors: ZERO,
                joints: [0; 2],
            }; MAX_NOISES],
            noise_count: 0,
            remainder: [0.0; MAX_POINTS],
            nonlinearity: [0.0; MAX_JOINTS],
            inner: first_joint..first_joint,
        }
    }

    /// Positions of the points in the base frame if the first `cut` joints carry them.
    pub(super) fn of_arm(
        chain: &AxisChain,
        cut: usize,
        points: &[Vector3<f64>],
        joint_box: &JointBox,
    ) -> Self {
        let mut form = Self::of_points(points, cut);
        for (index, joint) in chain.joints[..cut].iter().enumerate().rev() {
            form.move_joint(index, joint.motion, joint_box, 1.0);
            form.place(&joint.parent_from_joint);
        }
        form
    }

    /// Positions of the points in the base frame if the joints after the first `cut` hang on the target.
    pub(super) fn of_target(
        chain: &AxisChain,
        cut: usize,
        points: &[Vector3<f64>],
        joint_box: &JointBox,
        base_from_last_joint: &Placement<f64>,
    ) -> Self {
        let mut form = Self::of_points(points, cut);
        for (index, joint) in chain.joints.iter().enumerate().skip(cut) {
            form.place(&joint.joint_from_parent);
            form.move_joint(index, joint.motion, joint_box, -1.0);
        }
        form.place(base_from_last_joint);
        form
    }

    /// Difference of two forms of different joints.
    pub(super) fn minus(mut self, other: &Self) -> Self {
        for point in 0..self.points {
            self.centre[point] -= other.centre[point];
            self.remainder[point] += other.remainder[point];
        }
        for joint in other.inner.clone() {
            self.linear[joint] = other.linear[joint].map(|vector| -vector);
            self.nonlinearity[joint] += other.nonlinearity[joint];
        }
        let end = self.noise_count + other.noise_count;
        // A noise has either sign.
        self.noises[self.noise_count..end].copy_from_slice(other.noises());
        self.noise_count = end;
        self.inner = self.inner.start..other.inner.end;
        self
    }

    fn noises(&self) -> &[NoiseTerm] {
        &self.noises[..self.noise_count]
    }

    /// Adds a distance in any direction to each point.
    pub(super) fn widen(&mut self, distance: f64) {
        for remainder in &mut self.remainder[..self.points] {
            *remainder += distance;
        }
    }

    /// The joint with the largest share in the terms of second and third order; `None` if all are negligible.
    pub(super) fn most_nonlinear(&self) -> Option<usize> {
        let mut shares = self.nonlinearity;
        for NoiseTerm { vectors, joints } in self.noises() {
            let size: f64 = vectors[..self.points].iter().map(|v| v.norm()).sum();
            for joint in joints {
                shares[*joint] += 0.5 * size;
            }
        }
        let largest = shares
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1))?;
        (*largest.1 > NEGLIGIBLE).then_some(largest.0)
    }

    /// Returns true if a coordinate of a point is nowhere zero: its centre exceeds the sum of all other terms.
    pub(super) fn is_away_along_an_axis(&self) -> bool {
        let absolute = |v: Vector3<f64>| v.to_array().map(f64::abs);
        (0..self.points).any(|point| {
            let mut spread = [self.remainder[point]; 3];
            let linear = self.inner.clone().map(|joint| self.linear[joint][point]);
            let noises = self.noises().iter().map(|noise| noise.vectors[point]);
            for term in linear.chain(noises) {
                for (spread, size) in spread.iter_mut().zip(absolute(term)) {
                    *spread += size;
                }
            }
            let centre = absolute(self.centre[point]);
            centre
                .iter()
                .zip(&spread)
                .any(|(centre, spread)| centre > spread)
        })
    }

    /// Largest value of `Σ weights·(noises + r)` over all points.
    pub(super) fn spread_along(&self, weights: &PointVectors) -> f64 {
        let along = |vectors: &PointVectors| {
            let points = weights[..self.points].iter().zip(vectors);
            points
                .map(|(weight, vector)| weight.dot(*vector))
                .sum::<f64>()
        };
        let noises = self
            .noises()
            .iter()
            .map(|noise| along(&noise.vectors).abs());
        let remainders = weights[..self.points].iter().zip(&self.remainder);
        noises.sum::<f64>() + remainders.map(|(weight, r)| weight.norm() * r).sum::<f64>()
    }

    fn place(&mut self, placement: &Placement<f64>) {
        for centre in &mut self.centre[..self.points] {
            *centre = placement.apply(*centre);
        }
        self.for_each_term(|vector| placement.rotation * vector);
    }

    /// Changes all vectors of all terms but the centre.
    fn for_each_term(&mut self, change: impl Fn(Vector3<f64>) -> Vector3<f64>) {
        let points = self.points;
        for joint in self.inner.clone() {
            for vector in &mut self.linear[joint][..points] {
                *vector = change(*vector);
            }
        }
        for noise in &mut self.noises[..self.noise_count] {
            for vector in &mut noise.vectors[..points] {
                *vector = change(*vector);
            }
        }
    }

    /// Moves the points by a joint outside of all joints so far, in the direction of `sign`.
    fn move_joint(&mut self, joint: usize, motion: AxisMotion, joint_box: &JointBox, sign: f64) {
        let (centre, half_width) = (joint_box.centre[joint], joint_box.half_width[joint]);
        match motion {
            AxisMotion::Rotation => self.rotate(joint, &Turn::new(sign * centre, half_width), sign),
            AxisMotion::Translation => {
                for point in &mut self.centre[..self.points] {
                    point.z += sign * centre;
                }
                self.linear[joint] = [Vector3::new(0.0, 0.0, sign * half_width); MAX_POINTS];
            }
        }
        self.inner = self.inner.start.min(joint)..self.inner.end.max(joint + 1);
    }

    /// Multiplies the form by `mean + slope·δ·sine ± errors`. Products of a noise with another factor, and errors of
    /// linear terms, go to the remainder.
    fn rotate(&mut self, joint: usize, turn: &Turn, sign: f64) {
        let points = self.points;
        let error = turn.error();
        let deviation = turn.slope + error;
        for point in 0..points {
            let mut of_linear = 0.0;
            for inner in self.inner.clone() {
                let length = error * across_z(self.linear[inner][point]);
                self.nonlinearity[inner] += length / 3.0;
                of_linear += length;
            }
            let mut of_noises = 0.0;
            for noise in &self.noises[..self.noise_count] {
                let length = deviation * across_z(noise.vectors[point]);
                for inner in noise.joints {
                    self.nonlinearity[inner] += length / 3.0;
                }
                of_noises += length;
            }
            self.remainder[point] += of_linear + of_noises;
            self.nonlinearity[joint] += of_linear * (2.0 / 3.0) + of_noises / 3.0;
        }
        let of_centre = self.centre;
        let of_sin = of_centre.map(|centre| turn.of_sin(centre));
        let of_cos = of_centre.map(|centre| turn.of_cos(centre) * turn.cos_error);
        let mut new_noises = self.noise_count;
        let mut write = |joints, vectors| {
            self.noises[new_noises] = NoiseTerm { vectors, joints };
            new_noises += 1;
        };
        write([joint; 2], of_cos);
        write([joint; 2], of_sin.map(|vector| vector * turn.sin_error));
        for inner in self.inner.clone() {
            let linear = self.linear[inner];
            let of_pair = linear.map(|vector| turn.of_sin(vector) * turn.slope);
            write([joint, inner], of_pair);
        }
        self.for_each_term(|vector| turn.mean(vector));
        self.noise_count = new_noises;
        self.linear[joint] = of_sin.map(|vector| vector * (turn.slope * sign));
        self.centre = of_centre.map(|centre| turn.mean(centre));
    }
}
