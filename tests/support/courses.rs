//! Target courses for servos: poses over time, and forbidden reversals of joints.

use std::f64::consts::TAU;

use kinopt::arm::Arm;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_exp, rotation_log};

use crate::random::Random;

/// Kinds of courses that [`course`] cycles through.
pub const KINDS: [&str; 8] = [
    "line",
    "circle",
    "steps",
    "noisy hand",
    "line out of reach",
    "circle out of reach",
    "along limits",
    "singularity",
];

/// Speed above which a change of sign counts as a reversal, rad/s or m/s.
const REVERSAL_SPEED: f64 = 0.1;
/// Damping of the reference, radians.
const REFERENCE_DAMPING: f64 = 0.01;
/// Reference samples per servo cycle.
const REFERENCE_RATE: usize = 10;

/// Start configuration and the poses that a servo receives over time.
pub struct Course {
    pub kind: &'static str,
    pub start: Vec<f64>,
    /// Duration, seconds.
    pub duration: f64,
    first: Placement<f64>,
    shape: Shape,
}

enum Shape {
    /// Out at a constant speed, a pause, back, and a pause.
    Line {
        direction: Vector3<f64>,
        length: f64,
        turn: Vector3<f64>,
        speed: f64,
    },
    Circle {
        right: Vector3<f64>,
        up: Vector3<f64>,
        radius: f64,
        rate: f64,
    },
    /// Constant poses, each for a period.
    Steps(Vec<Placement<f64>>),
    /// Sum of sines with noise, sampled at 30 Hz.
    Hand {
        amplitudes: Vec<Vector3<f64>>,
        rates: Vec<f64>,
        noise: f64,
        seed: u64,
    },
}

const STEP_PERIOD: f64 = 0.6;
const PAUSE_TIME: f64 = 0.4;
const HAND_RATE: f64 = 30.0;

impl Course {
    /// Placement base_from_tool at a time in seconds.
    pub fn at(&self, time: f64) -> Placement<f64> {
        let moved = |offset: Vector3<f64>, turn: Vector3<f64>| {
            Placement::new(
                self.first.rotation * rotation_exp(turn),
                self.first.translation + offset,
            )
        };
        match &self.shape {
            Shape::Line {
                direction,
                length,
                turn,
                speed,
            } => {
                let travel_time = length / speed;
                let fraction = match time {
                    t if t < travel_time => t / travel_time,
                    t if t < travel_time + PAUSE_TIME => 1.0,
                    t if t < 2.0 * travel_time + PAUSE_TIME => {
                        1.0 - (t - travel_time - PAUSE_TIME) / travel_time
                    }
                    _ => 0.0,
                };
                moved(*direction * (fraction * length), *turn * fraction)
            }
            Shape::Circle {
                right,
                up,
                radius,
                rate,
            } => {
                let angle = rate * time;
                let offset = *right * (radius * angle.sin()) + *up * (radius * (1.0 - angle.cos()));
                moved(offset, Vector3::zero())
            }
            Shape::Steps(poses) => poses[((time / STEP_PERIOD) as usize).min(poses.len() - 1)],
            Shape::Hand {
                amplitudes,
                rates,
                noise,
                seed,
            } => {
                let sample = (time * HAND_RATE + 1e-9).floor();
                let time = sample / HAND_RATE;
                let mut random = Random::split_mix(seed.wrapping_add(sample as u64));
                let mut jitter = || vector(&mut random) * *noise;
                let mut offset = jitter();
                for (amplitude, rate) in amplitudes.iter().zip(rates) {
                    offset += *amplitude * (TAU * rate * time).sin();
                }
                moved(offset, jitter() * 3.0)
            }
        }
    }
}

fn vector(random: &mut Random) -> Vector3<f64> {
    let mut unit = || 2.0 * random.unit() - 1.0;
    Vector3::new(unit(), unit(), unit())
}

fn direction(random: &mut Random) -> Vector3<f64> {
    let v = vector(random);
    v * v.norm().max(1e-9).recip()
}

/// Course number `index` of an arm. The kind cycles with the index; everything else is random.
pub fn course(arm: &Arm, index: usize) -> Course {
    let kind = KINDS[index % KINDS.len()];
    let mut random = Random::split_mix(0x5eed + 7919 * index as u64);
    for _ in 0..3 {
        random.unit();
    }
    let mut start: Vec<f64> = arm
        .limits()
        .map(|l| {
            let (lower, upper) = (l.lower.max(-3.0), l.upper.min(3.0));
            lower + (0.15 + 0.7 * random.unit()) * (upper - lower)
        })
        .collect();
    let n = start.len();
    if kind == "along limits" {
        let joint = (random.unit() * n as f64) as usize % n;
        let limits = arm.limits().nth(joint).unwrap();
        let end = if random.unit() < 0.5 {
            limits.lower
        } else {
            limits.upper
        };
        start[joint] = if end.is_finite() { end } else { start[joint] };
    }
    if kind == "singularity" && n >= 5 {
        // The course passes a singularity of the wrist or the elbow, because that joint starts near zero.
        let joint = [n - 2, n / 2][usize::from(random.unit() < 0.4)];
        let limits = arm.limits().nth(joint).unwrap();
        start[joint] = (0.12 * (2.0 * random.unit() - 1.0))
            .max(limits.lower)
            .min(limits.upper);
    }
    let first = arm.base_from_tool(&start).unwrap();
    // Size of the course, metres: 0.5 m for most arms.
    let size = first.translation.norm().clamp(0.15, 0.8);
    let shape = match kind {
        "line" | "along limits" | "singularity" => Shape::Line {
            direction: direction(&mut random),
            length: size * (0.1 + 0.4 * random.unit()),
            turn: vector(&mut random) * (0.6 * random.unit()),
            speed: size * (0.15 + 0.35 * random.unit()),
        },
        "line out of reach" => Shape::Line {
            direction: direction(&mut random),
            length: size * (0.8 + random.unit()),
            turn: Vector3::zero(),
            speed: size * (0.2 + 0.8 * random.unit()),
        },
        "circle" | "circle out of reach" => {
            let right = direction(&mut random);
            let other = direction(&mut random);
            let up = right.cross(other);
            let radius = if kind == "circle" {
                0.05 + 0.15 * random.unit()
            } else {
                0.4 + 0.6 * random.unit()
            };
            let radius = size * radius;
            Shape::Circle {
                right,
                up: up * up.norm().max(1e-9).recip(),
                radius,
                rate: size * (0.2 + 0.5 * random.unit()) / radius,
            }
        }
        "steps" => {
            let pose = |random: &mut Random, near: bool| {
                let size_factor = if near { 0.1 } else { 0.5 };
                let offset = vector(random) * (size_factor * size);
                let turn = vector(random) * size_factor;
                Placement::new(
                    first.rotation * rotation_exp(turn),
                    first.translation + offset,
                )
            };
            Shape::Steps((0..5).map(|k| pose(&mut random, k % 2 == 0)).collect())
        }
        _ => Shape::Hand {
            amplitudes: (0..3)
                .map(|_| vector(&mut random) * (0.12 * size))
                .collect(),
            rates: (0..3).map(|_| 0.2 + 1.3 * random.unit()).collect(),
            noise: 1e-3 * size,
            seed: index as u64 * 977,
        },
    };
    let duration = match &shape {
        Shape::Line { length, speed, .. } => 2.0 * (length / speed + PAUSE_TIME),
        Shape::Steps(poses) => poses.len() as f64 * STEP_PERIOD,
        Shape::Circle { .. } | Shape::Hand { .. } => 3.0,
    };
    Course {
        kind,
        start,
        duration: duration.min(6.0),
        first,
        shape,
    }
}

/// Reversal of a joint: the cycle, the joint, and its velocities before and after in rad/s or m/s.
#[derive(Clone, Copy, Debug)]
pub struct Reversal {
    pub cycle: usize,
    pub joint: usize,
    pub before: f64,
    pub after: f64,
}

/// Reversals in rows of velocities: a joint has velocities of opposite signs in consecutive rows, and both exceed 0.1.
pub fn reversals(velocities: &[Vec<f64>]) -> Vec<Reversal> {
    let mut found = Vec::new();
    for (cycle, pair) in velocities.windows(2).enumerate() {
        for (joint, (&before, &after)) in pair[0].iter().zip(&pair[1]).enumerate() {
            if before * after < 0.0 && before.abs().min(after.abs()) > REVERSAL_SPEED {
                found.push(Reversal {
                    cycle: cycle + 1,
                    joint,
                    before,
                    after,
                });
            }
        }
    }
    found
}

/// Velocities of plain damped least squares on a course, at ten times the rate.
pub fn reference(arm: &Arm, course: &Course, time_step: f64) -> Vec<Vec<f64>> {
    let step = time_step / REFERENCE_RATE as f64;
    let limits: Vec<_> = arm.limits().collect();
    let mut jacobian = arm.jacobian().unwrap();
    let mut q = course.start.clone();
    let cycles = (course.duration / step) as usize;
    let mut velocities = Vec::with_capacity(cycles);
    for k in 1..=cycles {
        let target = course.at(k as f64 * step);
        let base_from_tool = arm.base_from_tool(&q).unwrap();
        let turn: Matrix3<f64> = target.rotation * base_from_tool.rotation.transpose();
        let (position_error, turn) = (
            target.translation - base_from_tool.translation,
            rotation_log(&turn),
        );
        let error = nalgebra::Vector6::new(
            position_error.x,
            position_error.y,
            position_error.z,
            turn.x,
            turn.y,
            turn.z,
        );
        let j = jacobian.at(&q).unwrap();
        let mut normal = j * j.transpose();
        for i in 0..6 {
            normal[(i, i)] += REFERENCE_DAMPING * REFERENCE_DAMPING;
        }
        let solved = normal.cholesky().unwrap().solve(&error);
        let mut velocity = vec![0.0; q.len()];
        for i in 0..q.len() {
            let moved = q[i] + j.column(i).dot(&solved);
            let moved = moved.max(limits[i].lower).min(limits[i].upper);
            velocity[i] = (moved - q[i]) / step;
            q[i] = moved;
        }
        velocities.push(velocity);
    }
    velocities
}

/// Reversals without a reversal of the reference within two servo cycles.
pub fn unexcused(found: &[Reversal], reference: &[Vec<f64>]) -> Vec<Reversal> {
    if found.is_empty() {
        return Vec::new();
    }
    let excuses = reversals(reference);
    let excused = |reversal: &&Reversal| {
        !excuses.iter().any(|other| {
            let cycle = other.cycle as f64 / REFERENCE_RATE as f64;
            other.joint == reversal.joint && (cycle - reversal.cycle as f64).abs() <= 2.0
        })
    };
    found.iter().filter(excused).copied().collect()
}
