//! Straight lines that leave an arm's reach.

use kinopt::Solution;
use kinopt::arm::Arm;
use kinopt::spatial::{Placement, Vector3};

use crate::random::{Random, few};

/// Shipped robots: file, base, tip.
pub const ROBOTS: [(&str, &str, &str); 7] = [
    ("franka_panda", "base", "flange"),
    ("universal_ur5e", "base", "flange"),
    ("kuka_iiwa14", "base", "flange"),
    ("universal_ur10e", "base", "flange"),
    ("rethink_baxter", "torso", "left_tool"),
    ("adept_cobra_s600", "base", "flange"),
    ("aldebaran_nao", "torso", "right_sole"),
];

/// Robots of a test: a debug build takes one of each kind unless `KINOPT_CASES` is set.
pub fn robots() -> impl Iterator<Item = &'static str> {
    let is_reduced = few();
    let all = ROBOTS.into_iter().map(|(name, ..)| name);
    all.filter(move |name| {
        let kinds = ["franka_panda", "universal_ur5e", "adept_cobra_s600"];
        !is_reduced || kinds.contains(name)
    })
}

/// Distance between consecutive targets of a line, metres: 0.3 m/s at 1 kHz.
pub const STEP: f64 = 3e-4;

/// Line that ends out of reach of its first branch.
pub struct Line {
    /// Configuration that reaches the first target.
    pub start: Vec<f64>,
    /// Targets of one orientation, [`STEP`] apart.
    pub out: Vec<Placement<f64>>,
}

/// `count` lines in random directions; each branch ends near the middle of its line.
pub fn lines(arm: &Arm, random: &mut Random, count: usize) -> Vec<Line> {
    let mut lines = Vec::new();
    while lines.len() < count {
        lines.extend(line(arm, random));
    }
    lines
}

/// Line from a random configuration; none if the branch does not end within 1.5 m.
fn line(arm: &Arm, random: &mut Random) -> Option<Line> {
    /// Step of the search for the end of the branch, metres.
    const COARSE_STEP: f64 = 5e-3;
    // Length of the line before and after the end of the branch, metres.
    let half_length = if few() { 0.015 } else { 0.03 };
    let q = inner(arm, random);
    let first = arm.base_from_tool(&q).ok()?;
    let mut unit = || 2.0 * random.unit() - 1.0;
    let direction = Vector3::new(unit(), unit(), unit());
    let direction = direction * direction.norm().recip();
    let at = |metres: f64| Placement::new(first.rotation, first.translation + direction * metres);
    let mut configurations = vec![q];
    let mut solution = Solution::default();
    let mut follower = arm.follower(&configurations[0]).ok()?;
    for k in 1..300 {
        let metres = f64::from(k) * COARSE_STEP;
        let jump = follower.advance(at(metres), &mut solution).ok()?;
        if solution.reached && jump.is_none() {
            configurations.push(solution.q.clone());
            continue;
        }
        let steps_back = (half_length / COARSE_STEP) as usize;
        let start_index = configurations.len().checked_sub(1 + steps_back)?;
        let start_distance = start_index as f64 * COARSE_STEP;
        let steps = (2.0 * half_length / STEP) as usize;
        return Some(Line {
            start: configurations[start_index].clone(),
            out: (0..steps)
                .map(|k| at(start_distance + k as f64 * STEP))
                .collect(),
        });
    }
    None
}

/// Random configuration in the middle of the ranges.
fn inner(arm: &Arm, random: &mut Random) -> Vec<f64> {
    let within = |l: kinopt::model::Limits| {
        let (lower, upper) = (l.lower.max(-3.0), l.upper.min(3.0));
        lower + (0.2 + 0.6 * random.unit()) * (upper - lower)
    };
    arm.limits().map(within).collect()
}
