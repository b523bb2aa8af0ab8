//! The seed atlas: where in joint space to begin for a given goal.
//!
//! Turning the first joint turns the whole arm about its axis, and turning the last one turns the
//! tool about its own: neither needs to be tabulated. What remains of a goal is four numbers, its
//! key: distance from the first axis and height along it, and the direction of the last axis seen
//! in the half plane through the goal. A grid over the keys holds in every cell a few
//! configurations found there by sampling, each with the derivative of the joint values by the
//! key. A seed is then a table look-up, a first-order correction and two angles.

use super::chain::JointKind;
use super::lane::LaneScalar;
use super::links::Links;
use super::seeds::mix;
use super::trigonometry::{ROUNDER, rough_atan2};
use crate::scalar::Scalar;
use crate::spatial::{Matrix3, Placement, Vector3};
use std::f64::consts::TAU;

/// Configurations a cell holds.
pub(crate) const PER_CELL: usize = 4;

/// Number of cells along each coordinate of the key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolution {
    pub(crate) radius: usize,
    pub(crate) height: usize,
    pub(crate) direction: usize,
    /// Samples a cell, on average.
    pub(crate) samples: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            radius: 8,
            height: 12,
            direction: 8,
            samples: 16,
        }
    }
}

/// One number of the cell's configurations each.
type Row = [f32; PER_CELL];

/// The table.
#[derive(Debug)]
pub(crate) struct Atlas {
    joints: usize,
    resolution: Resolution,
    low: [f64; 2],
    scale: [f64; 2],
    /// Per cell: joint values (one row a joint), key (five rows), derivative (four rows a joint).
    rows: Vec<Row>,
    /// Number of configurations, by cell.
    counts: Vec<u8>,
    first_turns: bool,
    last_turns: bool,
    /// Middle of the range of the first and last joint.
    middles: [f64; 2],
}

/// A goal reduced by the symmetries of the first and last joint.
#[derive(Clone, Copy)]
struct Key {
    /// What a sliding first joint adds, metres.
    shift: f64,
    /// Distance and height (or the two coordinates across a sliding first joint), metres.
    place: [f64; 2],
    /// Last axis, in the half plane's frame.
    axis: Vector3<f64>,
    /// First column of the orientation, in the half plane's frame.
    side: Vector3<f64>,
}

/// What a look-up gives: seeds in the order in which they should be tried.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidates {
    pub(crate) count: usize,
    q: [[f64; PER_CELL]; MAX_ATLAS_JOINTS],
    order: [u8; PER_CELL],
}

/// Longer chains have no atlas: random restarts suffice there.
pub(crate) const MAX_ATLAS_JOINTS: usize = 12;

impl Candidates {
    pub(crate) fn none() -> Self {
        Self {
            count: 0,
            q: [[0.0; PER_CELL]; MAX_ATLAS_JOINTS],
            order: [0; PER_CELL],
        }
    }

    /// Writes candidate `index` into `q`, unclamped.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill(&self, index: usize, q: &mut [f64]) {
        let slot = usize::from(self.order[index % PER_CELL]) % PER_CELL;
        for (value, row) in q.iter_mut().zip(&self.q) {
            *value = row[slot];
        }
    }
}

impl Atlas {
    pub(crate) fn new(links: &Links, resolution: Resolution, seed: u64) -> Option<Self> {
        let n = links.links.len();
        if !(4..=MAX_ATLAS_JOINTS).contains(&n) {
            return None;
        }
        let middle = |i: usize| {
            let link = &links.links[i];
            let sum = 0.5 * (link.lower + link.upper);
            if sum.is_finite() { sum } else { 0.0 }
        };
        let cells = resolution.radius * resolution.height * resolution.direction.pow(2);
        let rows_per_cell = n + 5 + 4 * n;
        let mut atlas = Self {
            joints: n,
            resolution,
            low: [0.0; 2],
            scale: [1.0; 2],
            rows: vec![[0.0; PER_CELL]; cells * rows_per_cell],
            counts: vec![0; cells],
            first_turns: links.links[0].kind == JointKind::Revolute,
            last_turns: links.links[n - 1].kind == JointKind::Revolute,
            middles: [middle(0), middle(n - 1)],
        };
        let samples = cells * resolution.samples;
        let mut state = mix(seed ^ 0xA71A5);
        let mut draw = |q: &mut [f64]| {
            for (i, (q, link)) in q.iter_mut().zip(&links.links).enumerate() {
                state = mix(state);
                let unit = (state >> 11) as f64 * (0.5f64).powi(53);
                let lower = if link.lower.is_finite() {
                    link.lower
                } else {
                    -TAU / 2.0
                };
                let upper = if link.upper.is_finite() {
                    link.upper
                } else {
                    TAU / 2.0
                };
                *q = if i == 0 || i == n - 1 && links.links[i].kind == JointKind::Revolute {
                    0.0
                } else {
                    lower + unit * (upper - lower)
                };
            }
        };
        // The range of the keys, from a first few samples.
        let mut q = vec![0.0; n];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for _ in 0..2000 {
            draw(&mut q);
            let key = atlas.key(&forward(links, &q).0);
            for k in 0..2 {
                low[k] = low[k].min(key.place[k]);
                high[k] = high[k].max(key.place[k]);
            }
        }
        atlas.low = low;
        let counts = [resolution.radius, resolution.height];
        for k in 0..2 {
            atlas.scale[k] = counts[k] as f64 / (high[k] - low[k]).max(1e-9);
        }
        for _ in 0..samples {
            draw(&mut q);
            let (place, joints) = forward(links, &q);
            let key = atlas.key(&place);
            let cell = atlas.cell(&key);
            let count = usize::from(atlas.counts[cell]);
            if count < PER_CELL {
                atlas.store(cell, count, &key, &q, &place, &joints, links);
                atlas.counts[cell] += 1;
            }
        }
        Some(atlas)
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(self.rows.as_slice()) + self.counts.len()
    }

    fn store(
        &mut self,
        cell: usize,
        slot: usize,
        key_in: &Key,
        q: &[f64],
        place: &Placement<f64>,
        joints: &[(Vector3<f64>, Vector3<f64>)],
        links: &Links,
    ) {
        let n = self.joints;
        let (centre, h) = self.direction_frame(cell);
        let mut shifted = *key_in;
        if self.first_turns {
            shifted.shift = place.translation.y.atan2(place.translation.x);
        }
        let key = &shifted;
        // The sample, turned so that its shift and roll are zero.
        let (roll_y, roll_x) = self.roll_parts(key, h);
        let roll = if self.last_turns {
            roll_y.atan2(roll_x)
        } else {
            0.0
        };
        let mut canonical = q.to_vec();
        canonical[0] -= key.shift;
        if self.last_turns {
            canonical[n - 1] -= roll;
        }
        // Geometry in the half plane's frame.
        let turn = if self.first_turns { -key.shift } else { 0.0 };
        let turned = Matrix3::identity().rotated_about_z(turn.sin_cos());
        let lift = if self.first_turns { 0.0 } else { -key.shift };
        let origin = turned * place.translation + Vector3::new(0.0, 0.0, lift);
        let columns: Vec<[f64; 6]> = joints
            .iter()
            .zip(&links.links)
            .map(|(&(axis, point), link)| {
                let axis = turned * axis;
                let point = turned * point + Vector3::new(0.0, 0.0, lift);
                if link.kind == JointKind::Revolute {
                    let v = axis.cross(origin - point);
                    [v.x, v.y, v.z, axis.x, axis.y, axis.z]
                } else {
                    [axis.x, axis.y, axis.z, 0.0, 0.0, 0.0]
                }
            })
            .collect();
        let a = key.axis;
        let side = h - a * h.dot(a);
        let length = side.norm().max(1e-6);
        let x = side * length.recip();
        let turn_towards = |direction: Vector3<f64>| {
            let tangent = direction - a * direction.dot(a);
            let omega = a.cross(tangent) + a * (-x.dot(tangent.cross(h)) / length);
            [0.0, 0.0, 0.0, omega.x, omega.y, omega.z]
        };
        let along = if self.first_turns {
            [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        } else {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        };
        let twists = [
            [along[0][0], along[0][1], along[0][2], 0.0, 0.0, 0.0],
            [along[1][0], along[1][1], along[1][2], 0.0, 0.0, 0.0],
            turn_towards(h),
            turn_towards(centre.cross(h)),
        ];
        let mut m = [[0.0; 6]; 6];
        for column in &columns {
            for r in 0..6 {
                for c in 0..6 {
                    m[r][c] += column[r] * column[c];
                }
            }
        }
        for (k, row) in m.iter_mut().enumerate() {
            row[k] += if k < 3 { 1e-4 } else { 1e-3 };
        }
        let base = cell * (n + 5 + 4 * n);
        for (i, value) in canonical.iter().enumerate() {
            self.rows[base + i][slot] = *value as f32;
        }
        let numbers = [key.place[0], key.place[1], a.x, a.y, a.z];
        for (i, value) in numbers.iter().enumerate() {
            self.rows[base + n + i][slot] = *value as f32;
        }
        for (k, twist) in twists.iter().enumerate() {
            let y = super::kernel::solve(m, *twist);
            for (i, column) in columns.iter().enumerate() {
                let value: f64 = column.iter().zip(&y).map(|(a, b)| a * b).sum();
                self.rows[base + n + 5 + 4 * i + k][slot] = value as f32;
            }
        }
    }

    /// Reduces a goal, given as the placement of the frame after the last turn.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn key(&self, place: &Placement<f64>) -> Key {
        let p = place.translation;
        let r = &place.rotation;
        if self.first_turns {
            let radius = (p.x * p.x + p.y * p.y).sqrt();
            let (sin, cos) = if radius > 1e-12 {
                (p.y / radius, p.x / radius)
            } else {
                (0.0, 1.0)
            };
            let back =
                |v: Vector3<f64>| Vector3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z);
            Key {
                shift: 0.0,
                place: [radius, p.z],
                axis: back(r.z),
                side: back(r.x),
            }
        } else {
            Key {
                shift: p.z,
                place: [p.x, p.y],
                axis: r.z,
                side: r.x,
            }
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cell(&self, key: &Key) -> usize {
        let bin = |value: f64, count: usize| (value.max(0.0) as usize).min(count - 1);
        let r = &self.resolution;
        let i = bin((key.place[0] - self.low[0]) * self.scale[0], r.radius);
        let j = bin((key.place[1] - self.low[1]) * self.scale[1], r.height);
        // Octahedral map of the direction.
        let a = key.axis;
        let size = (a.x.abs() + a.y.abs() + a.z.abs()).max(1e-12);
        let (mut u, mut v) = (a.x / size, a.y / size);
        if a.z < 0.0 {
            (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
        }
        let half = 0.5 * r.direction as f64;
        let k = bin((u + 1.0) * half, r.direction);
        let l = bin((v + 1.0) * half, r.direction);
        ((i * r.height + j) * r.direction + k) * r.direction + l
    }

    /// The middle direction of a cell and a unit vector across it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn direction_frame(&self, cell: usize) -> (Vector3<f64>, Vector3<f64>) {
        let d = self.resolution.direction;
        let (k, l) = (cell / d % d, cell % d);
        let to = |i: usize| (i as f64 + 0.5) * 2.0 / d as f64 - 1.0;
        let (u, v) = (to(k), to(l));
        let z = 1.0 - u.abs() - v.abs();
        let (x, y) = if z < 0.0 {
            ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v))
        } else {
            (u, v)
        };
        let length = (x * x + y * y + z * z).sqrt();
        let centre = Vector3::new(x / length, y / length, z / length);
        (centre, super::links::frame_along(centre).x)
    }

    /// Sine and cosine, times a common factor, of the turn about the last axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn roll_parts(&self, key: &Key, h: Vector3<f64>) -> (f64, f64) {
        let x = key.side;
        (x.dot(key.axis.cross(h)), x.dot(h))
    }

    /// Seeds for a goal, best first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn look_up<V: LaneScalar>(
        &self,
        links: &Links,
        goal_from_first: &Placement<f64>,
    ) -> Candidates {
        let c = V::Four::constant;
        let n = self.joints;
        let mut place = goal_from_first.inverse();
        let Some(last) = links.links.last() else {
            return Candidates::none();
        };
        place.translation =
            place.translation - (place.rotation.x * last.along_x + place.rotation.y * last.along_y);
        let key = self.key(&place);
        let cell = self.cell(&key);
        let count = usize::from(self.counts[cell]);
        let mut found = Candidates::none();
        if count == 0 {
            return found;
        }
        found.count = count;
        let (_, h) = self.direction_frame(cell);
        let (roll_y, roll_x) = self.roll_parts(&key, h);
        let (mut y, mut x) = (V::Four::zero(), V::Four::zero());
        if self.first_turns {
            y.set_lane(0, place.translation.y);
            x.set_lane(0, place.translation.x);
        }
        y.set_lane(1, roll_y);
        x.set_lane(1, roll_x);
        let angles = rough_atan2(y, x);
        let shift = if self.first_turns {
            angles.lane(0)
        } else {
            key.shift
        };
        let roll = if self.last_turns { angles.lane(1) } else { 0.0 };
        let (centre, _) = self.direction_frame(cell);
        let across = centre.cross(h);

        let stride = n + 5 + 4 * n;
        let Some(rows) = self.rows.get(cell * stride..(cell + 1) * stride) else {
            return Candidates::none();
        };
        let (q_rows, rest) = rows.split_at(n);
        let (key_rows, slopes) = rest.split_at(5);
        let row = |row: &Row| V::Four::from_singles(row);
        let axis = Vector3::<V::Four>::constant(key.axis)
            - Vector3::new(row(&key_rows[2]), row(&key_rows[3]), row(&key_rows[4]));
        let delta = [
            c(key.place[0]) - row(&key_rows[0]),
            c(key.place[1]) - row(&key_rows[1]),
            axis.dot(Vector3::constant(h)),
            axis.dot(Vector3::constant(across)),
        ];
        let mut score = V::Four::zero();
        let per_joint = links.links.iter().zip(q_rows).zip(slopes.chunks_exact(4));
        for (i, ((link, q_row), slope)) in per_joint.enumerate() {
            let mut step = row(&slope[0]) * delta[0];
            for k in 1..4 {
                step = row(&slope[k]).mul_add(delta[k], step);
            }
            let mut q = row(q_row) + step;
            let ends = (i == 0 && self.first_turns, i == n - 1 && self.last_turns);
            if i == 0 {
                q += c(shift);
            } else if i == n - 1 {
                q += c(roll);
            }
            if ends.0 || ends.1 {
                let middle = self.middles[usize::from(i != 0)];
                let turns = (q - c(middle)).mul_add(c(1.0 / TAU), c(ROUNDER)) - c(ROUNDER);
                q = turns.mul_add(c(-TAU), q);
            }
            let out = (c(link.lower) - q)
                .max(q - c(link.upper))
                .max(V::Four::zero());
            score = step.mul_add(step, out.mul_add(c(4.0), score));
            for s in 0..PER_CELL {
                found.q[i][s] = q.lane(s);
            }
        }
        // Sorting network for four; the index makes keys differ, empty slots come last.
        let mut keys = [(0.0, 0u8); PER_CELL];
        for (s, key) in keys.iter_mut().enumerate() {
            let score = if s < count {
                score.lane(s)
            } else {
                f64::INFINITY
            };
            *key = (score, s as u8);
        }
        for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            if keys[b].0 < keys[a].0 {
                keys.swap(a, b);
            }
        }
        found.order = keys.map(|key| key.1);
        found
    }
}

/// The placement of the frame after the last turn, its origin on the last axis, in the frame of the
/// first joint; and every joint's axis and a point on it.
fn forward(links: &Links, q: &[f64]) -> (Placement<f64>, Vec<(Vector3<f64>, Vector3<f64>)>) {
    let mut r = Matrix3::identity();
    let mut p = Vector3::zero();
    let mut joints = Vec::with_capacity(q.len());
    let last = q.len() - 1;
    for (i, (link, &q)) in links.links.iter().zip(q).enumerate() {
        joints.push((r.z, p));
        if link.kind == JointKind::Revolute {
            r = r.rotated_about_z((q + link.offset).sin_cos());
        } else {
            p += r.z * q;
            r = r.rotated_about_z(link.offset_sin_cos);
        }
        if i < last {
            p = p + r.x * link.along_x + r.y * link.along_y;
            r = r.rotated_about_x(link.twist);
        }
    }
    (Placement::new(r, p), joints)
}
