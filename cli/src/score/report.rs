//! Report of a score as text.

use std::fmt::Write;

use kinopt::counted;
use kinopt::motion::score::{MotionScore, Spread};

use crate::table::Table;

/// Text of a score: errors next to the subject, the motion by itself, and the terms of the total.
pub(super) fn text(file: &str, score: &MotionScore) -> String {
    let mut text = format!(
        "{file}: {}, {} per second",
        counted(score.frames, "frame"),
        // Frame times in files are rounded: 0.033333 s are 30 frames a second.
        (1e3 * score.frame_rate).round() / 1e3
    );
    // Writing into a string cannot fail.
    if score.heading != 0.0 {
        let _ = write!(text, "; heading {:.1}°", score.heading);
    }
    text.push('\n');
    let mut limbs = Table::new("direction error, ° | >mean | >95 % | >max");
    for limb in &score.limbs {
        limbs.row(row(&limb.limb, &limb.angle, 1.0, 2));
    }
    let mut ends = Table::new("position error, % of the limb | >mean | >95 % | >max");
    for end in &score.ends {
        ends.row(row(&end.end, &end.error, 100.0, 2));
    }
    let mut motion = Table::new("motion | >mean | >95 % | >max");
    if let Some(feet) = &score.feet {
        motion.row(row("foot sliding, mm", &feet.sliding, 1e3, 2));
        motion.row(row("foot sliding, cm/s", &feet.sliding_speed, 100.0, 2));
    }
    motion.row(row(
        "ground penetration, mm",
        &score.penetration.depth,
        1e3,
        2,
    ));
    motion.row(row("joint jerk, rad/s³", &score.jerk.joints, 1.0, 1));
    motion.row(row("end jerk, m/s³", &score.jerk.ends, 1.0, 1));
    if let Some(subject) = &score.jerk.subject_ends {
        motion.row(row("end jerk of the subject, m/s³", subject, 1.0, 1));
    }
    let tables = [limbs, ends, motion].map(|table| table.text());
    for table in tables.iter().filter(|table| !table.is_empty()) {
        let _ = write!(text, "{table}");
    }
    text += &shares(score);
    let mut terms = Table::new("term | >value | >weight | >points");
    for term in &score.terms {
        terms.row([
            format!("{}, {}", term.name, term.unit),
            format!("{:.3}", term.value),
            format!("{}", term.weight),
            format!("{:.3}", term.points),
        ]);
    }
    terms.row([
        "total".to_owned(),
        String::new(),
        String::new(),
        format!("{:.3}", score.total),
    ]);
    text + &terms.text()
}

fn row(name: &str, spread: &Spread, scale: f64, decimals: usize) -> Vec<String> {
    let number = |value: f64| format!("{:.decimals$}", scale * value);
    vec![
        name.to_owned(),
        number(spread.mean),
        number(spread.p95),
        number(spread.max),
    ]
}

/// Lines of contacts, and of shares of the samples.
fn shares(score: &MotionScore) -> String {
    let percent = |share: f64| format!("{:.1} % of the frames", 100.0 * share);
    let mut lines = Vec::new();
    if let Some(feet) = &score.feet {
        let lost = match feet.of_subject {
            true => format!("; {} lost", feet.lost_contacts.len()),
            false => String::new(),
        };
        lines.push(format!("contacts: {}{lost}", feet.contacts));
    }
    lines.push(format!(
        "below the ground: {}",
        percent(score.penetration.share)
    ));
    let limits = &score.limits;
    let mut outside = format!("outside limits: {}", percent(limits.share));
    if !limits.joints.is_empty() {
        let _ = write!(
            outside,
            "; position by {:.4}, velocity {:.2} times its limit; joints {}",
            limits.position,
            limits.velocity_ratio,
            limits.joints.join(", ")
        );
    }
    lines.push(outside);
    if let Some(collisions) = &score.collisions {
        let depth = 1e3 * collisions.depth;
        lines.push(format!(
            "in collision: {}; depth {depth:.1} mm",
            percent(collisions.share)
        ));
    }
    lines.iter().map(|line| format!("  {line}\n")).collect()
}
