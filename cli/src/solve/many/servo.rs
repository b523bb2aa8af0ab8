//! Targets at a fixed rate, one in each control cycle, under velocity limits.

use std::collections::BTreeMap;
use std::time::Instant;

use kinopt::arm::{HeldBy, ServoStatus};
use kinopt::collision::Collision;
use kinopt::ik::Side;
use serde::{Serialize, Serializer};

use super::super::arguments::ServoOptions;
use super::super::arm_backend::ArmBackend;
use super::super::backend::microseconds;
use super::super::job::Job;
use super::super::query::Query;
use super::summary::{median, percentile};
use crate::collision_document::{CollisionDocument, depth};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_format::{magnitude, six_digits, time};
use crate::output;

/// State of the arm after a control cycle, in radians, metres and seconds.
#[derive(Clone, Debug, Serialize)]
struct Tick {
    /// Values of all moving joints of the robot.
    q: Vec<f64>,
    /// Velocities of the joints from base to tip.
    velocity: Vec<f64>,
    #[serde(serialize_with = "in_words")]
    status: ServoStatus,
    position_error: f64,
    orientation_error: f64,
    /// Joints that a limit holds back, with the limit.
    held: BTreeMap<String, &'static str>,
    /// Obstacles that block the arm or are in contact with it.
    #[serde(serialize_with = "documents")]
    collisions: Vec<Collision>,
}

/// Result of all control cycles.
#[derive(Clone, Debug, Serialize)]
struct Document<'a> {
    /// Joint names of every `q`.
    joints: Option<Vec<&'a str>>,
    /// Joint names of every `velocity`.
    arm_joints: Vec<&'a str>,
    velocity_limits: Vec<Option<f64>>,
    ticks: Vec<Tick>,
    summary: Summary,
}

#[derive(Clone, Debug, Serialize)]
struct Summary {
    ticks_a_second: f64,
    total: usize,
    /// Number of control cycles by status.
    statuses: BTreeMap<&'static str, usize>,
    /// Largest speed of each joint from base to tip.
    top_speeds: Vec<f64>,
    micros_median: Option<f64>,
    micros_p99: Option<f64>,
}

/// Follows the targets from the start of the first, at the rate of the options, and prints the result.
pub(in super::super) fn run(
    job: &Job<'_>,
    loaded: &LoadedModel,
    backend: &ArmBackend<'_>,
    (queries, options): (&[Query], &ServoOptions),
    json: bool,
) -> Outcome<()> {
    let document = follow(loaded, backend, queries, options)?;
    output::result(json, || &document, || document.text())?;
    let last = document.ticks.last();
    let missed = last.is_some_and(|tick| tick.status != ServoStatus::OnTarget);
    job.fail_on_misses(usize::from(missed), 1)
}

fn follow<'a>(
    loaded: &'a LoadedModel,
    backend: &'a ArmBackend<'_>,
    queries: &[Query],
    options: &ServoOptions,
) -> Outcome<Document<'a>> {
    let Some(first) = queries.first() else {
        return Err(failure!("there are no targets to follow"));
    };
    let mut servo = backend.servo(first, options)?;
    let arm_joints = backend.joint_names();
    let limits = servo.velocity_limits().iter();
    let velocity_limits = limits.map(|limit| limit.is_finite().then_some(*limit));
    let velocity_limits = velocity_limits.collect();
    let mut ticks = Vec::with_capacity(queries.len());
    let mut micros = Vec::with_capacity(queries.len());
    let mut statuses = BTreeMap::new();
    let mut top_speeds = vec![0.0_f64; arm_joints.len()];
    for query in queries {
        let target = backend.target(query);
        let started = Instant::now();
        let step = servo.step(target)?;
        micros.push(microseconds(started));
        *statuses.entry(words(step.status)).or_default() += 1;
        for (top, velocity) in top_speeds.iter_mut().zip(step.velocity) {
            *top = top.max(velocity.abs());
        }
        let held = step.held().map(|(joint, by)| (joint.to_owned(), limit(by)));
        ticks.push(Tick {
            q: backend.configuration(query, step.q)?,
            velocity: step.velocity.to_vec(),
            status: step.status,
            position_error: step.position_error,
            orientation_error: step.orientation_error,
            held: held.collect(),
            collisions: step.collisions.to_vec(),
        });
    }
    micros.sort_by(f64::total_cmp);
    Ok(Document {
        joints: loaded.documented_joints(),
        arm_joints,
        velocity_limits,
        summary: Summary {
            ticks_a_second: options.rate,
            total: ticks.len(),
            statuses,
            top_speeds,
            micros_median: median(&micros),
            micros_p99: percentile(&micros, 99),
        },
        ticks,
    })
}

impl Document<'_> {
    fn text(&self) -> String {
        let summary = &self.summary;
        let (total, rate) = (summary.total, summary.ticks_a_second);
        let mut text = format!("cycles    {total} at {rate} Hz\n");
        for (status, count) in &summary.statuses {
            text.push_str(&format!("          {count} {status}\n"));
        }
        if let Some(last) = self.ticks.last() {
            text.push_str(&format!(
                "end       {}, {} m and {} rad from the target\n",
                words(last.status),
                magnitude(last.position_error),
                magnitude(last.orientation_error),
            ));
        }
        for pair in self.ticks.last().iter().flat_map(|last| &last.collisions) {
            text.push_str(&format!("          {pair}, {}\n", depth(pair)));
        }
        let joints = self.arm_joints.iter().zip(&self.velocity_limits);
        for ((joint, limit), top) in joints.zip(&summary.top_speeds) {
            let (top, max_speed) = (six_digits(*top), limit.map(six_digits));
            let max_speed = max_speed.as_deref().unwrap_or("no limit");
            text.push_str(&format!(
                "top speed {joint}: {top} of {max_speed} per second\n"
            ));
        }
        if let (Some(median), Some(p99)) = (summary.micros_median, summary.micros_p99) {
            let [median, p99] = [median, p99].map(time);
            text.push_str(&format!("time      median {median}, 99 % within {p99}\n"));
        }
        text
    }
}

fn in_words<S: Serializer>(status: &ServoStatus, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(words(*status))
}

fn documents<S: Serializer>(pairs: &[Collision], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(pairs.iter().map(CollisionDocument::of))
}

fn words(status: ServoStatus) -> &'static str {
    match status {
        ServoStatus::OnTarget => "on target",
        ServoStatus::SpeedLimited => "limited by velocity, acceleration or jerk",
        ServoStatus::Nearest => "at rest at the closest pose",
        ServoStatus::Blocked => "stopped before a collision",
        ServoStatus::Touching => "in contact",
        _ => "settling",
    }
}

fn limit(by: HeldBy) -> &'static str {
    match by {
        HeldBy::Limit(Side::Lower) => "lower limit",
        HeldBy::Limit(Side::Upper) => "upper limit",
        HeldBy::Speed(Side::Lower) => "velocity limit, downwards",
        HeldBy::Speed(Side::Upper) => "velocity limit, upwards",
        HeldBy::Acceleration(Side::Lower) => "acceleration limit, downwards",
        HeldBy::Acceleration(Side::Upper) => "acceleration limit, upwards",
        HeldBy::Outside(Side::Lower) => "below its lower limit",
        HeldBy::Outside(Side::Upper) => "above its upper limit",
        _ => "another bound",
    }
}
