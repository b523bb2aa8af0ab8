//! Lines out of the reach and back at 1 kHz, on every shipped robot, by a servo and by a follower.
//!
//! `cargo run --release --features urdf --example servoing [LINES] [FOLDER]` counts the cycles with a jump or a
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
use support::arms::Random;
use support::lines::{ROBOTS, STEP};

const TICK: f64 = 1e-3;
/// Control cycles from the start of a line to its end; below, cycles at rest there.
const WAY: usize = 400;
const REST: usize = 1500;
/// Last cycles at rest, which are measured.
const WATCHED: usize = 100;

fn longest(a: &[f64], b: &[f64]) -> f64 {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}

/// Start and targets of a line that leaves its branch halfway: out, at rest, back and at rest, one target per cycle.
fn line(arm: &Arm, random: &mut Random) -> Option<(Vec<f64>, Vec<Placement<f64>>)> {
    let within = |l: kinopt::model::Limits, share: f64| {
        let (lower, upper) = (l.lower.max(-3.0), l.upper.min(3.0));
        lower + (0.2 + 0.6 * share) * (upper - lower)
    };
    let q: Vec<f64> = arm.limits().map(|l| within(l, random.unit())).collect();
    let first = arm.base_from_tool(&q).unwrap();
    let mut unit = || 2.0 * random.unit() - 1.0;
    let way = Vector3::new(unit(), unit(), unit());
    let way = way * way.norm().recip();
    let at = |metres: f64| Placement::new(first.rotation, first.translation + way * metres);
    let mut follower = arm.follower(&q).unwrap();
    let (mut known, mut solution) = (vec![q.clone()], Solution::default());
    let coarse = 5e-3;
    let half = 0.5 * WAY as f64 * STEP;
    for k in 1..300 {
        let jump = follower.advance(at(k as f64 * coarse), &mut solution);
        if solution.reached && jump.unwrap().is_none() {
            known.push(solution.q.clone());
            continue;
        }
        let place = known.len().checked_sub(1 + (half / coarse) as usize)?;
        let out = |tick: usize| at(place as f64 * coarse + tick as f64 * STEP);
        let mut targets: Vec<_> = (0..WAY).map(out).collect();
        targets.extend([out(WAY - 1); REST]);
        targets.extend((0..WAY).rev().map(out));
        targets.extend([out(0); REST]);
        return Some((known[place].clone(), targets));
    }
    None
}

#[derive(Default)]
struct Seen {
    ticks: usize,
    missed: usize,
    jumps: usize,
    too_fast: usize,
    /// Lines without an active limit; of these, lines that end more than 1e-3 rad from their start, and the largest
    /// such distance.
    free: usize,
    elsewhere: usize,
    apart: f64,
    /// Peak-to-peak velocity at rest, rad/s or m/s.
    chatter: f64,
    unsettled: usize,
    micros: Vec<f64>,
}

impl Seen {
    fn told(&mut self, who: &str) {
        self.micros.sort_by(f64::total_cmp);
        let at = |share: f64| self.micros[(share * (self.micros.len() - 1) as f64) as usize];
        println!(
            "  {who}: {} ticks, {} missed, {} jumps, {} too fast; of {} lines free of limits {} end elsewhere, \
             {:.1e} from their start at most; {} not at rest, chatter {:.1e} /s; {:.1} us median, {:.1} p99",
            self.ticks,
            self.missed,
            self.jumps,
            self.too_fast,
            self.free,
            self.elsewhere,
            self.apart,
            self.unsettled,
            self.chatter,
            at(0.5),
            at(0.99),
        );
    }

    /// Counts one line: the configuration at each cycle, and whether it was reached.
    fn line(&mut self, arm: &Arm, start: &[f64], ways: &[(Vec<f64>, bool)], limits: &[f64]) {
        let mut from = start;
        let on_limit = |q: &[f64]| {
            arm.limits()
                .zip(q)
                .any(|(l, q)| *q <= l.lower || *q >= l.upper)
        };
        let mut free = true;
        for (q, reached) in ways {
            self.ticks += 1;
            self.missed += usize::from(!reached);
            self.jumps += usize::from(longest(from, q) > 0.2);
            let moves = from.iter().zip(q).zip(limits);
            self.too_fast += usize::from(
                moves
                    .into_iter()
                    .any(|((a, b), v)| (b - a).abs() > v * TICK),
            );
            free &= !on_limit(q);
            from = q;
        }
        if free && !ways[WAY + REST - 1].1 {
            self.free += 1;
            let apart = longest(&ways[0].0, &ways[ways.len() - 1].0);
            self.elsewhere += usize::from(apart > 1e-3);
            self.apart = self.apart.max(apart);
        }
        for end in [WAY + REST, ways.len()] {
            let watched = &ways[end - WATCHED..end];
            let speeds = |i: usize| {
                watched
                    .windows(2)
                    .map(move |w| (w[1].0[i] - w[0].0[i]) / TICK)
            };
            let widest = (0..start.len()).map(|i| {
                let ends = speeds(i).fold((f64::MAX, f64::MIN), |(l, u), v| (l.min(v), u.max(v)));
                (ends.1 - ends.0, ends.0.abs().max(ends.1.abs()))
            });
            let widest = widest.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
            // An arm that is still moving has a constant velocity, up to its limit.
            self.unsettled += usize::from(widest.1 > 1e-3);
            self.chatter = self.chatter.max(widest.0);
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
        let mut random = Random(7);
        let (mut servoed, mut followed) = (Seen::default(), Seen::default());
        let mut written = Vec::new();
        let mut lines = 0;
        while lines < count {
            let Some((start, targets)) = line(&arm, &mut random) else {
                continue;
            };
            lines += 1;
            let mut servo = arm.servo(&start, TICK).unwrap();
            let mut ways = Vec::with_capacity(targets.len());
            for target in &targets {
                let begun = Instant::now();
                let step = servo.step(*target).unwrap();
                servoed.micros.push(begun.elapsed().as_nanos() as f64 / 1e3);
                ways.push((step.q.to_vec(), step.status == ServoStatus::OnTarget));
            }
            servoed.line(&arm, &start, &ways, &limits);
            if folder.is_some() {
                let pose = |p: &Placement<f64>| {
                    let (t, r) = (p.translation, Quaternion::from_matrix(&p.rotation));
                    [t.x, t.y, t.z, r.w, r.v.x, r.v.y, r.v.z]
                };
                let targets: Vec<_> = targets.iter().map(pose).collect();
                let q: Vec<_> = ways.iter().map(|(q, _)| q).collect();
                written.push(json!({"start": start, "targets": targets, "kinopt": q}));
            }
            ways.clear();
            let mut follower = arm.follower(&start).unwrap();
            let mut solution = Solution::default();
            for target in &targets {
                let begun = Instant::now();
                follower.advance(*target, &mut solution).unwrap();
                followed
                    .micros
                    .push(begun.elapsed().as_nanos() as f64 / 1e3);
                ways.push((solution.q.clone(), solution.reached));
            }
            followed.line(&arm, &start, &ways, &vec![f64::INFINITY; start.len()]);
        }
        println!("{name}: {count} lines");
        servoed.told("servo");
        followed.told("follower");
        if let Some(folder) = &folder {
            let joints: Vec<_> = arm.joints().collect();
            let document = json!({
                "robot": name, "base": base, "tip": tip, "joints": joints, "tick": TICK,
                "velocity_limits": limits, "way": WAY, "rest": REST, "lines": written,
            });
            let file = std::fs::File::create(format!("{folder}/{name}.json")).unwrap();
            serde_json::to_writer(file, &document).unwrap();
        }
    }
}
