//! Construction of the seed atlas from random configurations.
//!
//! Each sample goes into the cell of its key until that cell is full.

use std::f64::consts::TAU;

use super::key::Key;
use super::table::{Atlas, KeyResolution, MAX_ATLAS_JOINTS, PER_CELL};
use crate::simd_ik::ldlt;
use crate::simd_ik::links::{Link, Links};
use kinopt_kinematics::random::mix;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Axis of a joint and a point on it.
type JointLine = (Vector3<f64>, Vector3<f64>);

/// A sampled configuration with its key and the pose of its last frame.
struct SampledConfiguration<'a> {
    key: Key,
    q: &'a [f64],
    pose: Placement<f64>,
    joints: &'a [JointLine],
}

impl Atlas {
    /// Samples the configurations of a chain. Returns `None` unless it has 4 to `MAX_ATLAS_JOINTS` joints.
    pub(crate) fn new(links: &Links, resolution: KeyResolution, seed: u64) -> Option<Self> {
        let n = links.links.len();
        if !(4..=MAX_ATLAS_JOINTS).contains(&n) {
            return None;
        }
        let middle = |i: usize| {
            let link = &links.links[i];
            let sum = 0.5 * (link.lower + link.upper);
            if sum.is_finite() { sum } else { 0.0 }
        };
        let (lead, lead_point) = leading_joint(&links.links);
        let cells = resolution.radius * resolution.height * resolution.direction.pow(2);
        let rows_per_cell = n + 5 + 4 * n;
        let mut atlas = Self {
            joints: n,
            resolution,
            low: [0.0; 2],
            scale: [1.0; 2],
            rows: vec![[0.0; PER_CELL]; cells * rows_per_cell],
            counts: vec![0; cells],
            lead,
            lead_point,
            lead_turns: links.links[lead].kind.turns(),
            last_turns: links.links[n - 1].kind.turns(),
            middles: [middle(lead), middle(n - 1)],
        };
        let samples = cells * resolution.samples;
        let mut state = mix(seed ^ 0xA71A5);
        // Lower end and width of each joint's range; zero for the joints that the key factors out.
        let ranges: Vec<(f64, f64)> = (links.links.iter().enumerate())
            .map(|(i, link)| {
                if i == lead || i == n - 1 && link.kind.turns() {
                    return (0.0, 0.0);
                }
                let finite =
                    |bound: f64, fallback: f64| if bound.is_finite() { bound } else { fallback };
                let lower = finite(link.lower, -TAU / 2.0);
                (lower, finite(link.upper, TAU / 2.0) - lower)
            })
            .collect();
        let mut fill_sample = |q: &mut [f64]| {
            for (q, &(lower, span)) in q.iter_mut().zip(&ranges) {
                state = mix(state);
                let unit = (state >> 11) as f64 / (1u64 << 53) as f64;
                *q = lower + unit * span;
            }
        };
        // Range of the keys, estimated from a few samples.
        let mut q = vec![0.0; n];
        let mut joints = vec![(Vector3::zero(), Vector3::zero()); n];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for _ in 0..2000 {
            fill_sample(&mut q);
            let key = atlas.key(&forward(links, lead_point, &q, &mut joints));
            for k in 0..2 {
                low[k] = low[k].min(key.position[k]);
                high[k] = high[k].max(key.position[k]);
            }
        }
        atlas.low = low;
        let counts = [resolution.radius, resolution.height];
        for k in 0..2 {
            atlas.scale[k] = counts[k] as f64 / (high[k] - low[k]).max(1e-9);
        }
        for _ in 0..samples {
            fill_sample(&mut q);
            let pose = forward(links, lead_point, &q, &mut joints);
            let key = atlas.key(&pose);
            let cell = atlas.cell(&key);
            let count = usize::from(atlas.counts[cell]);
            if count < PER_CELL {
                let sample = SampledConfiguration {
                    key,
                    q: &q,
                    pose,
                    joints: &joints,
                };
                atlas.store(cell, count, &sample, links);
                atlas.counts[cell] += 1;
            }
        }
        Some(atlas)
    }

    /// Stores a sample in a cell, with the derivative of its joint values with respect to the key.
    fn store(&mut self, cell: usize, slot: usize, sample: &SampledConfiguration, links: &Links) {
        let n = self.joints;
        let (centre, h) = self.direction_frame(cell);
        let (pose, mut key) = (&sample.pose, sample.key);
        if self.lead_turns {
            key.shift = elementary::atan2(pose.translation.y, pose.translation.x);
        }
        // The sample, rotated so that its shift and roll are zero.
        let (roll_y, roll_x) = self.roll_parts(&key, h);
        let roll = if self.last_turns {
            elementary::atan2(roll_y, roll_x)
        } else {
            0.0
        };
        let mut canonical = [0.0; MAX_ATLAS_JOINTS];
        canonical[..n].copy_from_slice(sample.q);
        canonical[self.lead] -= key.shift;
        if self.last_turns {
            canonical[n - 1] -= roll;
        }
        // Geometry in the frame of the half plane.
        let rotation_angle = if self.lead_turns { -key.shift } else { 0.0 };
        let rotation = Matrix3::identity().rotated_about_z(elementary::sin_cos(rotation_angle));
        let lift = if self.lead_turns { 0.0 } else { -key.shift };
        let origin = rotation * pose.translation + Vector3::new(0.0, 0.0, lift);
        let mut columns = [[0.0; 6]; MAX_ATLAS_JOINTS];
        let per_joint = columns.iter_mut().zip(sample.joints).zip(&links.links);
        for ((column, &(axis, point)), link) in per_joint {
            let axis = rotation * axis;
            let point = rotation * point + Vector3::new(0.0, 0.0, lift);
            *column = if link.kind.turns() {
                let v = axis.cross(origin - point);
                [v.x, v.y, v.z, axis.x, axis.y, axis.z]
            } else {
                [axis.x, axis.y, axis.z, 0.0, 0.0, 0.0]
            };
        }
        let columns = &columns[..n];
        let a = key.axis;
        let side = h - a * h.dot(a);
        let length = side.norm().max(1e-6);
        let x = side * length.recip();
        let rotation_towards = |direction: Vector3<f64>| {
            let tangent = direction - a * direction.dot(a);
            let omega = a.cross(tangent) + a * (-x.dot(tangent.cross(h)) / length);
            [0.0, 0.0, 0.0, omega.x, omega.y, omega.z]
        };
        let along = if self.lead_turns {
            [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        } else {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        };
        let twists = [
            [along[0][0], along[0][1], along[0][2], 0.0, 0.0, 0.0],
            [along[1][0], along[1][1], along[1][2], 0.0, 0.0, 0.0],
            rotation_towards(h),
            rotation_towards(centre.cross(h)),
        ];
        // Lower triangle of J Jᵀ. Index loops, as iterators are slow in a debug build.
        let mut m = [[0.0; 6]; 6];
        let mut r = 0;
        while r < 6 {
            let row = &mut m[r];
            let mut c = 0;
            while c <= r {
                let (mut sum, mut i) = (0.0, 0);
                while i < n {
                    let column = &columns[i];
                    sum += column[r] * column[c];
                    i += 1;
                }
                row[c] = sum;
                c += 1;
            }
            r += 1;
        }
        for (k, row) in m.iter_mut().enumerate() {
            row[k] += if k < 3 { 1e-4 } else { 1e-3 };
        }
        let base = cell * (n + 5 + 4 * n);
        for (i, value) in canonical[..n].iter().enumerate() {
            self.rows[base + i][slot] = *value as f32;
        }
        let numbers = [key.position[0], key.position[1], a.x, a.y, a.z];
        for (i, value) in numbers.iter().enumerate() {
            self.rows[base + n + i][slot] = *value as f32;
        }
        let slopes = ldlt::solve(m, twists);
        for (i, column) in columns.iter().enumerate() {
            for (k, y) in slopes.iter().enumerate() {
                let [a, b, c, d, e, f] = column;
                let value = a * y[0] + b * y[1] + c * y[2] + d * y[3] + e * y[4] + f * y[5];
                self.rows[base + n + 5 + 4 * i + k][slot] = value as f32;
            }
        }
    }
}

/// Index of the leading joint, whose symmetry reduces goals, and a point of its axis in the first joint's frame.
fn leading_joint(links: &[Link]) -> (usize, Vector3<f64>) {
    let (first, second) = (&links[0], &links[1]);
    let share_axis = first.twist.0.abs() < 1e-9 && first.twist.1 > 0.0;
    let length = |link: &Link| elementary::hypot(link.along_x, link.along_y);
    let is_short = first.upper - first.lower < links.iter().map(length).sum();
    if !(first.kind.slides() && second.kind.turns() && share_axis && is_short) {
        return (0, Vector3::zero());
    }
    let turned = Matrix3::identity().rotated_about_z(first.offset_sin_cos);
    let lead_point = turned.x * first.along_x + turned.y * first.along_y;
    (1, lead_point)
}

/// Pose of the last joint's frame after its rotation, relative to the point `lead_point` in the first joint's frame.
///
/// Writes the axis of every joint and a point on it to `joints`.
fn forward(
    links: &Links,
    lead_point: Vector3<f64>,
    q: &[f64],
    joints: &mut [JointLine],
) -> Placement<f64> {
    let mut r = Matrix3::<f64>::identity();
    let mut p = Vector3::<f64>::zero() - lead_point;
    let last = q.len() - 1;
    let mut i = 0;
    while i <= last {
        let (link, q) = (&links.links[i], q[i]);
        joints[i] = (r.z, p);
        if link.kind.turns() {
            rotate_columns(&mut r.x, &mut r.y, elementary::sin_cos(q + link.offset));
        } else {
            add_scaled(&mut p, &r.z, q);
            rotate_columns(&mut r.x, &mut r.y, link.offset_sin_cos);
        }
        if i < last {
            add_scaled(&mut p, &r.x, link.along_x);
            add_scaled(&mut p, &r.y, link.along_y);
            rotate_columns(&mut r.y, &mut r.z, link.twist);
        }
        i += 1;
    }
    Placement::new(r, p)
}

/// Rotates two columns of a rotation matrix about the third, in place.
///
/// Operators on vectors and matrices are calls and copies in a debug build.
fn rotate_columns(a: &mut Vector3<f64>, b: &mut Vector3<f64>, (sin, cos): (f64, f64)) {
    (a.x, b.x) = (a.x * cos + b.x * sin, b.x * cos - a.x * sin);
    (a.y, b.y) = (a.y * cos + b.y * sin, b.y * cos - a.y * sin);
    (a.z, b.z) = (a.z * cos + b.z * sin, b.z * cos - a.z * sin);
}

/// Adds `by · along` to `p` in place.
fn add_scaled(p: &mut Vector3<f64>, along: &Vector3<f64>, factor: f64) {
    p.x += along.x * factor;
    p.y += along.y * factor;
    p.z += along.z * factor;
}
