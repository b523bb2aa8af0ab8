//! Lines out of the reach and back at 1 kHz, on every shipped robot, by a servo and by a follower.
//!
//! `cargo run --release -p kinopt-benches --example servoing [LINES] [FOLDER]` counts the cycles with a jump or a
//! violated velocity limit. It also measures the difference between the paths out and back, and the chatter at rest.
//! With a folder, the targets and the servo's commands are written there, one JSON file per robot, for
//! benches/rivals/helpers/pink_servo.py.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::time::Instant;

use kinopt::Solution;
use kinopt::arm::{Arm, ServoStatus};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Quaternion, Vector3};
use serde_json::json;
use support::lines::{ROBOTS, STEP};
use support::random::Random;

const CYCLE_TIME: f64 = 1e-3;
/// Control cycles from the start of a line to its end; below, cycles at rest there.
const MOVING_CYCLES: usize = 400;
const REST_CYCLES: usize = 1500;
/// Last cycles at rest, which are measured.
const MEASURED_CYCLES: usize = 100;

fn max_difference(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// Start and targets of a line that leaves its branch halfway: out, at rest, back and at rest, one target per cycle.
fn line(arm: &Arm, random: &mut Random) -> Option<(Vec<f64>, Vec<Placement<f64>>)> {
    let interpolate = |l: kinopt::model::Limits, share: f64| {
        let (lower, upper) = (l.lower.max(-3.0), l.upper.min(3.0));
        lower + (0.2 + 0.6 * share) * (upper - lower)
    };
    let q: Vec<f64> = arm
        .limits()
        .map(|l| interpolate(l, random.unit()))
        .collect();
    let first = arm.base_from_tool(&q).unwrap();
    let mut unit = || 2.0 * random.unit() - 1.0;
    let direction = Vector3::new(unit(), unit(), unit());
    let direction = direction * direction.norm().recip();
    let target_at =
        |metres: f64| Placement::new(first.rotation, first.translation + direction * metres);
    let mut follower = arm.follower(&q).unwrap();
    let (mut configurations, mut solution) = (vec![q.clone()], Solution::default());
    let coarse = 5e-3;
    let half = 0.5 * MOVING_CYCLES as f64 * STEP;
    for k in 1..300 {
        let jump = follower.advance(target_at(k as f64 * coarse), &mut solution);
        if solution.reached && jump.unwrap().is_none() {
            configurations.push(solution.q.clone());
            continue;
        }
        let last = configurations
            .len()
            .checked_sub(1 + (half / coarse) as usize)?;
        let outward_target = |tick: usize| target_at(last as f64 * coarse + tick as f64 * STEP);
        let mut targets: Vec<_> = (0..MOVING_CYCLES).map(outward_target).collect();
        targets.extend([outward_target(MOVING_CYCLES - 1); REST_CYCLES]);
        targets.extend((0..MOVING_CYCLES).rev().map(outward_target));
        targets.extend([outward_target(0); REST_CYCLES]);
        return Some((configurations[last].clone(), targets));
    }
    None
}

#[derive(Default)]
struct Statistics {
    ticks: usize,
    missed: usize,
    jumps: usize,
    too_fast: usize,
    /// Lines without an active limit; of these, lines that end more than 1e-3 rad from their start, and the largest
    /// such distance.
    free: usize,
    ended_elsewhere: usize,
    max_end_distance: f64,
    /// Peak-to-peak velocity at rest, rad/s or m/s.
    chatter: f64,
    unsettled: usize,
    micros: Vec<f64>,
}

impl Statistics {
    fn print(&mut self, label: &str) {
        self.micros.sort_by(f64::total_cmp);
        let quantile = |share: f64| self.micros[(share * (self.micros.len() - 1) as f64) as usize];
        println!(
            "  {label}: {} ticks, {} missed, {} jumps, {} too fast; of {} lines free of limits {} end elsewhere, \
             {:.1e} from their start at most; {} not at rest, chatter {:.1e} /s; {:.1} us median, {:.1} p99",
            self.ticks,
            self.missed,
            self.jumps,
            self.too_fast,
            self.free,
            self.ended_elsewhere,
            self.max_end_distance,
            self.unsettled,
            self.chatter,
            quantile(0.5),
            quantile(0.99),
        );
    }

    /// Counts one line: the configuration at each cycle, and whether it was reached.
    fn line(&mut self, arm: &Arm, start: &[f64], steps: &[(Vec<f64>, bool)], limits: &[f64]) {
        let mut from = start;
        let on_limit = |q: &[f64]| {
            arm.limits()
                .zip(q)
                .any(|(l, q)| *q <= l.lower || *q >= l.upper)
        };
        let mut is_free = true;
        for (q, reached) in steps {
            self.ticks += 1;
            self.missed += usize::from(!reached);
            self.jumps += usize::from(max_difference(from, q) > 0.2);
            let moves = from.iter().zip(q).zip(limits);
            self.too_fast += usize::from(
                moves
                    .into_iter()
                    .any(|((a, b), v)| (b - a).abs() > v * CYCLE_TIME),
            );
            is_free &= !on_limit(q);
            from = q;
        }
        if is_free && !steps[MOVING_CYCLES + REST_CYCLES - 1].1 {
            self.free += 1;
            let end_distance = max_difference(&steps[0].0, &steps[steps.len() - 1].0);
            self.ended_elsewhere += usize::from(end_distance > 1e-3);
            self.max_end_distance = self.max_end_distance.max(end_distance);
        }
        for end in [MOVING_CYCLES + REST_CYCLES, steps.len()] {
            let measured = &steps[end - MEASURED_CYCLES..end];
            let speeds = |i: usize| {
                measured
                    .windows(2)
                    .map(move |w| (w[1].0[i] - w[0].0[i]) / CYCLE_TIME)
            };
            let extents = (0..start.len()).map(|i| {
                let ends = speeds(i).fold((f64::MAX, f64::MIN), |(l, u), v| (l.min(v), u.max(v)));
                (ends.1 - ends.0, ends.0.abs().max(ends.1.abs()))
            });
            let extents = extents.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
            // An arm that is still moving has a constant velocity, up to its limit.
            self.unsettled += usize::from(extents.1 > 1e-3);
            self.chatter = self.chatter.max(extents.0);
        }
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(200, |n| n.parse().unwrap());
    let folder = arguments.next();
    for (name, base, tip) in ROBOTS {
        let robot = Robot::read(format!("models/{name}.urdf")).unwrap();
        let arm = Arm::new(&robot, base, tip).unwrap();
        let limits = arm.velocity_limits().to_vec();
        let mut random = Random::split_mix(7);
        let (mut servoed, mut followed) = (Statistics::default(), Statistics::default());
        let mut written = Vec::new();
        let mut lines = 0;
        while lines < count {
            let Some((start, targets)) = line(&arm, &mut random) else {
                continue;
            };
            lines += 1;
            let mut servo = arm.servo(&start, CYCLE_TIME).unwrap();
            let mut steps = Vec::with_capacity(targets.len());
            for target in &targets {
                let started = Instant::now();
                let step = servo.step(*target).unwrap();
                servoed
                    .micros
                    .push(started.elapsed().as_nanos() as f64 / 1e3);
                steps.push((step.q.to_vec(), step.status == ServoStatus::OnTarget));
            }
            servoed.line(&arm, &start, &steps, &limits);
            if folder.is_some() {
                let pose = |p: &Placement<f64>| {
                    let (t, r) = (p.translation, Quaternion::from_matrix(&p.rotation));
                    [t.x, t.y, t.z, r.w, r.v.x, r.v.y, r.v.z]
                };
                let targets: Vec<_> = targets.iter().map(pose).collect();
                let q: Vec<_> = steps.iter().map(|(q, _)| q).collect();
                written.push(json!({"start": start, "targets": targets, "kinopt": q}));
            }
            steps.clear();
            let mut follower = arm.follower(&start).unwrap();
            let mut solution = Solution::default();
            for target in &targets {
                let started = Instant::now();
                follower.advance(*target, &mut solution).unwrap();
                followed
                    .micros
                    .push(started.elapsed().as_nanos() as f64 / 1e3);
                steps.push((solution.q.clone(), solution.reached));
            }
            followed.line(&arm, &start, &steps, &vec![f64::INFINITY; start.len()]);
        }
        println!("{name}: {count} lines");
        servoed.print("servo");
        followed.print("follower");
        if let Some(folder) = &folder {
            let joints: Vec<_> = arm.joints().collect();
            let document = json!({
                "robot": name, "base": base, "tip": tip, "joints": joints, "tick": CYCLE_TIME,
                "velocity_limits": limits, "way": MOVING_CYCLES, "rest": REST_CYCLES, "lines": written,
            });
            let file = std::fs::File::create(format!("{folder}/{name}.json")).unwrap();
            serde_json::to_writer(file, &document).unwrap();
        }
    }
}
