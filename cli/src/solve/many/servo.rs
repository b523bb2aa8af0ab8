//! `--servo`: targets that come at a fixed rate, one a tick, under velocity limits.

use std::collections::BTreeMap;
use std::time::Instant;

use kinopt::arm::{HeldBy, Servo, ServoStatus};
use kinopt::ik::Side;
use serde::Serialize;

use super::super::answer::Question;
use super::super::arm_door::{ArmDoor, microseconds};
use super::summary::{median, percentile, short_time};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_format::{magnitude, six_digits};

/// Where the arm stands after a tick. Radians, metres and seconds.
#[derive(Clone, Debug, Serialize)]
struct Tick {
    /// All moving joints of the robot.
    q: Vec<f64>,
    /// The joints from base to tip.
    velocity: Vec<f64>,
    status: &'static str,
    position_error: f64,
    orientation_error: f64,
    /// The joints that would go on, and what keeps them.
    held: BTreeMap<String, &'static str>,
}

/// What came of all ticks.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Servoed<'a> {
    /// The names that belong to every q.
    joints: Option<Vec<&'a str>>,
    /// The names that belong to every velocity, and their limits; none where there is no limit.
    arm_joints: Vec<String>,
    velocity_limits: Vec<Option<f64>>,
    ticks: Vec<Tick>,
    summary: Summary,
}

#[derive(Clone, Debug, Serialize)]
struct Summary {
    ticks_a_second: f64,
    total: usize,
    /// How many ticks ended so.
    statuses: BTreeMap<&'static str, usize>,
    /// The fastest that each joint from base to tip moved.
    top_speeds: Vec<f64>,
    micros_median: Option<f64>,
    micros_p99: Option<f64>,
}

/// Follows the targets from the first one's start.
pub(super) fn follow<'a>(
    loaded: &'a LoadedModel,
    door: &ArmDoor<'_>,
    mut servo: Servo<'_>,
    questions: &[Question],
    ticks_a_second: f64,
) -> Outcome<Servoed<'a>> {
    let arm_joints: Vec<String> = door.joint_names().into_iter().map(str::to_owned).collect();
    let limits = servo.velocity_limits().iter();
    let velocity_limits = limits.map(|limit| limit.is_finite().then_some(*limit));
    let velocity_limits = velocity_limits.collect();
    let mut ticks = Vec::with_capacity(questions.len());
    let mut micros = Vec::with_capacity(questions.len());
    for question in questions {
        let target = door.target(question);
        let started = Instant::now();
        let step = servo.step(target)?;
        micros.push(microseconds(started));
        let held = step.held().map(|(joint, by)| (joint.to_owned(), word(by)));
        ticks.push(Tick {
            q: door.configuration(question, step.q)?,
            velocity: step.velocity.to_vec(),
            status: status(step.status),
            position_error: step.position_error,
            orientation_error: step.orientation_error,
            held: held.collect(),
        });
    }
    micros.sort_by(f64::total_cmp);
    let mut statuses = BTreeMap::new();
    let mut top_speeds = vec![0.0_f64; arm_joints.len()];
    for tick in &ticks {
        *statuses.entry(tick.status).or_default() += 1;
        for (top, velocity) in top_speeds.iter_mut().zip(&tick.velocity) {
            *top = top.max(velocity.abs());
        }
    }
    Ok(Servoed {
        joints: loaded.documented_joints(),
        arm_joints,
        velocity_limits,
        summary: Summary {
            ticks_a_second,
            total: ticks.len(),
            statuses,
            top_speeds,
            micros_median: median(&micros),
            micros_p99: percentile(&micros, 99),
        },
        ticks,
    })
}

impl Servoed<'_> {
    /// Whether the last target is not reached.
    pub(super) fn missed(&self) -> bool {
        let last = self.ticks.last();
        last.is_some_and(|tick| tick.status != status(ServoStatus::OnTarget))
    }

    pub(super) fn text(&self) -> String {
        let Summary {
            total,
            ticks_a_second,
            statuses,
            ..
        } = &self.summary;
        let mut text = format!("ticks     {total} at {ticks_a_second} a second\n");
        for (status, count) in statuses {
            text.push_str(&format!("          {count} {status}\n"));
        }
        if let Some(last) = self.ticks.last() {
            text.push_str(&format!(
                "at last   {}, {} m and {} rad from the target\n",
                last.status,
                magnitude(last.position_error),
                magnitude(last.orientation_error),
            ));
        }
        let joints = self.arm_joints.iter().zip(&self.velocity_limits);
        for ((joint, limit), top) in joints.zip(&self.summary.top_speeds) {
            let of = limit.map_or("no limit".to_owned(), six_digits);
            text.push_str(&format!(
                "top speed {joint}: {} of {of} a second\n",
                six_digits(*top)
            ));
        }
        if let (Some(one), Some(p99)) = (self.summary.micros_median, self.summary.micros_p99) {
            let [one, p99] = [one, p99].map(short_time);
            text.push_str(&format!("time      median {one}, 99 % within {p99}\n"));
        }
        text
    }
}

fn status(status: ServoStatus) -> &'static str {
    match status {
        ServoStatus::OnTarget => "on target",
        ServoStatus::SpeedLimited => "held by a velocity limit",
        ServoStatus::Nearest => "at rest as near as it comes",
        _ => "settling",
    }
}

fn word(by: HeldBy) -> &'static str {
    match by {
        HeldBy::Limit(Side::Lower) => "lower limit",
        HeldBy::Limit(Side::Upper) => "upper limit",
        HeldBy::Speed(Side::Lower) => "velocity limit, downwards",
        HeldBy::Speed(Side::Upper) => "velocity limit, upwards",
    }
}
