//! Rules of configurations, and an independent check of them. The only library type used is the pair of limits.

use std::f64::consts::{PI, TAU};

use kinopt::model::Limits;

/// Tolerance of the norm of a unit quaternion.
const NORM_TOLERANCE: f64 = 1e-12;
/// Tolerance of a ball's angles, in radians and relative to its cone.
const ANGLE_TOLERANCE: f64 = 1e-10;

/// Limits of a ball joint.
#[derive(Clone, Debug)]
pub struct Cone {
    /// Twist axis. It has unit length, as does `about`, which is perpendicular to it.
    pub axis: [f64; 3],
    pub about: [f64; 3],
    pub swing: [f64; 2],
    pub twist: Limits,
    /// Largest total angle, radians.
    pub angle: f64,
}

/// Rule for the configuration values of one joint.
#[derive(Clone, Debug)]
pub enum Rule {
    /// Number exactly within limits.
    Number(Limits),
    /// Unit quaternion w, x, y, z, optionally within a cone.
    Ball(Option<Cone>),
}

impl Rule {
    pub fn coordinates(&self) -> usize {
        match self {
            Self::Number(_) => 1,
            Self::Ball(_) => 4,
        }
    }
}

/// Rule for configuration values that are not free.
#[derive(Clone, Debug)]
pub enum Role {
    /// Locked joint: the values from this index on.
    Held(usize, Vec<f64>),
    /// Mimic joint: the first index has `ratio` times the value at the second index, plus `offset`.
    Follows(usize, usize, f64, f64),
}

/// First broken rule of a configuration, if any.
pub fn broken(rules: &[Rule], roles: &[Role], q: &[f64]) -> Option<String> {
    let mut at = 0;
    for (joint, rule) in rules.iter().enumerate() {
        let joint_values = &q[at..at + rule.coordinates()];
        let held = |role: &Role| matches!(role, Role::Held(first, _) if *first == at);
        let fault = match rule {
            Rule::Number(limits) => {
                let within = limits.lower <= joint_values[0] && joint_values[0] <= limits.upper;
                (!within).then(|| format!("{:?} is outside {limits:?}", joint_values[0]))
            }
            // The limits of a locked ball are not checked.
            Rule::Ball(cone) => length_fault(joint_values).or_else(|| {
                let cone = cone.as_ref().filter(|_| !roles.iter().any(held));
                cone.and_then(|cone| cone.fault(joint_values))
            }),
        };
        if let Some(fault) = fault {
            return Some(format!("joint {joint} of the configuration: {fault}"));
        }
        at += rule.coordinates();
    }
    assert_eq!(at, q.len());
    roles.iter().find_map(|role| {
        let (first, expected) = match role {
            Role::Held(first, values) => (*first, values.clone()),
            Role::Follows(mimic, source, ratio, offset) => {
                (*mimic, vec![ratio * q[*source] + offset])
            }
        };
        let pairs = expected.iter().zip(&q[first..]);
        let off = pairs.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs()));
        (off > 1e-13).then(|| format!("number {first} is {off:e} from where it is tied to"))
    })
}

fn length_fault(q: &[f64]) -> Option<String> {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let off = (length - 1.0).abs();
    (off.is_nan() || off > NORM_TOLERANCE)
        .then(|| format!("a quaternion's length is off by {off:e}"))
}

impl Cone {
    /// First exceeded limit, if any. The swing is the shortest rotation from the twist axis to its rotated direction;
    /// the twist is the remaining rotation about the axis.
    pub fn fault(&self, q: &[f64]) -> Option<String> {
        let angle = angle_between(&[1.0, 0.0, 0.0, 0.0], q);
        if angle > self.angle + ANGLE_TOLERANCE {
            return Some(format!("turned by {angle:?} of {:?}", self.angle));
        }
        let (axis, about) = (self.axis, self.about);
        let (tipped, turned) = (rotated(q, axis), rotated(q, about));
        let across = cross(axis, tipped);
        let (sin, cos) = (norm(across), dot(axis, tipped));
        let angle = sin.atan2(cos);
        // The direction of a tiny swing has no effect. The direction near half a turn is ill-conditioned.
        let direction = match sin > 0.0 {
            true => across.map(|v| v / sin),
            false => about,
        };
        let blur = match cos < 0.0 {
            true => 4e-15 / sin.max(1e-15),
            false => 0.0,
        };
        let swing = [about, cross(axis, about)].map(|along| angle * dot(direction, along));
        let share = (swing[0] / self.swing[0]).hypot(swing[1] / self.swing[1]);
        if share > 1.0 + ANGLE_TOLERANCE + blur {
            return Some(format!("swung to {share:?} of its cone"));
        }
        // Rodrigues' rotation of the perpendicular axes, as a frame without and with the twist.
        let (s, c) = angle.sin_cos();
        let along = (1.0 - c) * dot(direction, about);
        let side = cross(direction, about);
        let untwisted = [0, 1, 2].map(|k| c * about[k] + s * side[k] + along * direction[k]);
        let twist = dot(tipped, cross(untwisted, turned)).atan2(dot(untwisted, turned));
        let Limits { lower, upper } = self.twist;
        let slack = ANGLE_TOLERANCE + blur;
        let out = [twist, twist - TAU, twist + TAU]
            .iter()
            .all(|twist| *twist < lower - slack || *twist > upper + slack);
        (out && blur < 1.0).then(|| format!("twisted by {twist:?}, outside {:?}", self.twist))
    }

    /// Quaternion at fractions of its limits: of the swing by direction, and of the twist.
    pub fn at(&self, [first, second]: [f64; 2], twist: f64) -> [f64; 4] {
        let second_axis = cross(self.axis, self.about);
        let swing = [0, 1, 2].map(|k| {
            self.swing[0] * first * self.about[k] + self.swing[1] * second * second_axis[k]
        });
        let (lower, upper) = (self.twist.lower.max(-PI), self.twist.upper.min(PI));
        let angle = lower + (upper - lower) * twist;
        product(
            exponential(swing),
            exponential(self.axis.map(|a| a * angle)),
        )
    }
}

/// First joint that moved further between two configurations than `max_step` allows, by number of the configuration.
pub fn moved_too_far(rules: &[Rule], max_step: &[f64], from: &[f64], to: &[f64]) -> Option<String> {
    let mut at = 0;
    rules.iter().enumerate().find_map(|(joint, rule)| {
        let range = at..at + rule.coordinates();
        at = range.end;
        let moved = match rule {
            Rule::Number(_) => (to[range.start] - from[range.start]).abs(),
            Rule::Ball(_) => angle_between(&from[range.clone()], &to[range.clone()]),
        };
        let size = from[range.start].abs().max(1.0);
        let max_step = max_step[range.start];
        let is_within = moved <= max_step + 1e-12 * size;
        (!is_within).then(|| {
            format!("joint {joint} of the configuration moved by {moved:?}, not {max_step:?}")
        })
    })
}

/// Angle between two rotations, radians.
pub fn angle_between(a: &[f64], b: &[f64]) -> f64 {
    let back = [a[0], -a[1], -a[2], -a[3]];
    let [w, x, y, z] = product(back, [b[0], b[1], b[2], b[3]]);
    2.0 * norm([x, y, z]).atan2(w.abs())
}

/// Quaternion exponential: cos and sin of half the vector's length, along the vector.
pub fn exponential(v: [f64; 3]) -> [f64; 4] {
    let angle = norm(v);
    let along = match angle > 0.0 {
        true => (0.5 * angle).sin() / angle,
        false => 0.5,
    };
    [
        (0.5 * angle).cos(),
        v[0] * along,
        v[1] * along,
        v[2] * along,
    ]
}

/// Hamilton product.
pub fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Rotated vector, v + 2 u × (u × v + w v).
fn rotated(q: &[f64], v: [f64; 3]) -> [f64; 3] {
    let u = [q[1], q[2], q[3]];
    let once = cross(u, v);
    let twice = cross(u, [0, 1, 2].map(|k| once[k] + q[0] * v[k]));
    [0, 1, 2].map(|k| v[k] + 2.0 * twice[k])
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
