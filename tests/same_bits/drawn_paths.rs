//! Promise: so it is for paths whose options are drawn at random, together, for their times and for the tables that they are read from.
#![allow(clippy::unwrap_used)]

use kinopt::Arm;
use kinopt::arm::{Axis, PoseBounds};
use kinopt::model::Limits;
use kinopt::motion::path::{
    CartesianPath, PathSolver, QuaternionOrder, TimingLimits, Trajectory, Traversal,
};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{planar_with_hand, robot};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::{at_times, one_of};
use crate::paths::{add, bare_arm, circle, placement, some, through, two_links_by_a_wall};
use crate::robot_texts::add_text;

/// Arms of which one keeps clear, and of which some have room at the tool.
fn arms() -> Vec<Arm> {
    let scara = robot("adept_cobra_s600");
    let flange = |goal| {
        let builder = Arm::builder(&scara, "base", "flange").with_atlas(false);
        builder.with_goal(goal).build().unwrap()
    };
    vec![
        planar_with_hand(Limits::new(-3.0, 3.0)),
        planar_with_hand(Limits::new(-0.4, 0.9)),
        two_links_by_a_wall(),
        bare_arm(&scara, "base", "flange"),
        flange(PoseBounds::free_about(Axis::Z)),
        flange(PoseBounds::position()),
        flange(PoseBounds::within([0.02, 0.0, 0.01, 0.0, 0.0, 0.4])),
        bare_arm(&robot("universal_ur5e"), "base", "flange"),
        bare_arm(&robot("franka_panda"), "base", "flange"),
    ]
}

/// Where the tool goes, the joints that it begins and ends with, and whether it goes straight from the one to the other.
fn way(arm: &Arm, random: &mut Random) -> (Vec<Placement<f64>>, [Vec<f64>; 2], bool) {
    let mut first = some(arm, random, None);
    let near = at_times(random, 0.7);
    let mut last = some(arm, random, near.then_some(first.as_slice()));
    for q in [&mut first, &mut last] {
        for (q, limits) in q.iter_mut().zip(arm.limits()) {
            if limits.lower.is_finite() && at_times(random, 0.3) {
                *q = one_of(random, &[limits.lower, limits.upper]);
            }
        }
    }
    let steps = one_of(random, &[1, 2, 5, 9]);
    let begin = arm.base_from_tool(&first).unwrap();
    let kind = random.below(5);
    let mut points = match kind {
        0 => circle(&begin, 0.1, 9, 0.0),
        1 => circle(&begin, 0.03, 7, 1.0),
        _ => through(arm, &[first.clone(), last.clone()], steps),
    };
    if points.len() > 4 && at_times(random, 0.2) {
        let far = 1 + random.below(points.len() - 2);
        points[far].translation.x += 3.0;
    }
    (points, [first, last], kind > 1)
}

fn options() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2031));
    let arms = arms();
    for case in 0..100 {
        // Those of six and seven joints take more time.
        let arm = &arms[match case % 20 {
            7 => 7,
            19 => 8,
            cheap => cheap % 7,
        }];
        let (mut points, [first, last], straight) = way(arm, &mut random);
        let count = points.len();
        let mut solver = PathSolver::new(arm).with_samples(one_of(&mut random, &[4, 8, 16]));
        let tool = Placement::new(
            rotation_exp(Vector3::new(0.0, 0.0, 0.3)),
            Vector3::new(0.03, 0.02, 0.0),
        );
        let other = arm.with_tool(tool).unwrap();
        let tooled = at_times(&mut random, 0.3);
        let tools: Vec<usize> = (0..count).map(|_| random.below(2)).collect();
        if tooled {
            // So that its ends are where the joints are with those tools.
            let at =
                |point: usize, q: &[f64]| [arm, &other][tools[point]].base_from_tool(q).unwrap();
            points[0] = at(0, &first);
            if straight {
                points[count - 1] = at(count - 1, &last);
            }
        }
        let mut path = CartesianPath::new(points).unwrap();
        if tooled || at_times(&mut random, 0.03) {
            path = path.with_tools(tools).unwrap();
        }
        if tooled {
            solver = solver.with_tools([&other]);
        }
        let goes_round = at_times(&mut random, 0.35);
        let in_time = at_times(&mut random, if goes_round { 0.03 } else { 0.35 });
        if in_time || at_times(&mut random, 0.2) {
            let every = one_of(&mut random, &[0.02, 0.1, 1.0]);
            let times: Vec<f64> = (0..count).map(|k| every * k as f64 - 0.3).collect();
            path = path.with_times(times).unwrap();
        }
        if in_time || at_times(&mut random, 0.02) {
            solver = solver.with_times_kept(true);
        }
        if goes_round {
            path = path.with_traversal(one_of(
                &mut random,
                &[Traversal::Cyclic, Traversal::AnyStart],
            ));
        }
        if at_times(&mut random, 0.4) {
            let mut weights: Vec<f64> = first.iter().map(|_| random.within(0.2, 3.0)).collect();
            if at_times(&mut random, 0.1) {
                weights[0] = one_of(&mut random, &[0.0, f64::NAN]);
            }
            solver = solver.with_joint_weights(&weights);
        }
        if at_times(&mut random, 0.5) {
            let steps = [0.05, 0.05, 0.4, 0.4, 1.5, 1.5, 1.5, 0.0, f64::INFINITY];
            solver = solver.with_max_step(one_of(&mut random, &steps));
        }
        if at_times(&mut random, 0.4) {
            let own = &first;
            let odd = first[1..].to_vec();
            let starts = [own, own, own, own, own, own, &last, &odd];
            let start: &Vec<f64> = one_of(&mut random, &starts);
            solver = solver.with_start(start);
        }
        if at_times(&mut random, if goes_round { 0.03 } else { 0.4 }) {
            let own = &last;
            let odd = vec![9.0; first.len()];
            let ends = [own, own, own, own, own, own, &first, &odd];
            let end: &Vec<f64> = one_of(&mut random, &ends);
            solver = solver.with_end(end);
        }
        if at_times(&mut random, 0.05) {
            solver = solver.with_samples(one_of(&mut random, &[0, 3, 4097]));
        }
        if let Some(found) = digest.answer(solver.solve(&path)) {
            add(&mut digest, &found);
            let mut limits = || -> Vec<f64> {
                let joints = 0..found.joint_count;
                joints.map(|_| random.within(0.3, 3.0)).collect()
            };
            let (velocities, accelerations) = (limits(), limits());
            if let Some(times) = digest.answer(found.times(&velocities, &accelerations)) {
                digest.doubles(times);
            }
        }
    }
    digest.value()
}

/// Rings that are entered anywhere, round and round.
fn rings() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2035));
    let arms = arms();
    for case in 0..60 {
        let arm = &arms[[0, 1][case % 2]];
        let begin = arm.base_from_tool(&some(arm, &mut random, None)).unwrap();
        let (count, turns) = (
            6 + random.below(5) as u32,
            one_of(&mut random, &[0.0, 1.0, -1.0, 2.0]),
        );
        let radius = one_of(&mut random, &[0.0, 0.05, 0.2, 0.5]);
        let ring = CartesianPath::new(circle(&begin, radius, count, turns)).unwrap();
        let way = one_of(
            &mut random,
            &[Traversal::AnyStart, Traversal::AnyStart, Traversal::Cyclic],
        );
        let step = one_of(&mut random, &[0.3, 0.9, 1.5]);
        let solver = PathSolver::new(arm).with_samples(8).with_max_step(step);
        if let Some(found) = digest.answer(solver.solve(&ring.with_traversal(way))) {
            add(&mut digest, &found);
        }
    }
    digest.value()
}

/// Rows of joints that may rest anywhere, under limits of some of them.
fn times() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2032));
    for _ in 0..40 {
        let (joints, count) = (1 + random.below(3), random.below(7));
        let mut q = vec![0.0; joints];
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for _ in 0..count {
            if at_times(&mut random, 0.8) {
                q.iter_mut()
                    .for_each(|q| *q += one_of(&mut random, &[0.0, 0.3, -0.7]));
            }
            rows.push(q.clone());
        }
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let mut rests: Vec<usize> = (0..random.below(3)).map(|_| random.below(9)).collect();
        rests.sort_unstable();
        let mut limits = |odd: f64| {
            let given = joints + usize::from(at_times(&mut random, 0.05));
            let values = [0.5, 1.0, 2.5, 0.5, 1.0, 2.5, odd];
            (0..given)
                .map(|_| one_of(&mut random, &values))
                .collect::<Vec<f64>>()
        };
        let (velocities, accelerations) = (limits(f64::INFINITY), limits(0.0));
        if let Some(times) = digest.answer(row_times(&rows, &rests, &velocities, &accelerations)) {
            digest.doubles(times);
        }
    }
    digest.value()
}

/// Times of rows of joint values.
pub(crate) fn row_times(
    rows: &[&[f64]],
    rests: &[usize],
    velocities: &[f64],
    accelerations: &[f64],
) -> Result<Vec<f64>, kinopt::motion::path::PathError> {
    let joints = rows.first().map_or(velocities.len(), |row| row.len());
    let limits = TimingLimits::new(velocities, accelerations);
    let trajectory = Trajectory::through(&rows.concat(), joints, rests, &limits)?;
    Ok(trajectory.times().to_vec())
}

/// Keys of splines, and what a path keeps.
fn splines() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2033));
    for _ in 0..24 {
        let count = random.below(5);
        let mut keys: Vec<_> = (0..count).map(|_| placement(&mut random, 1.0)).collect();
        if let Some(key) = keys.last_mut().filter(|_| at_times(&mut random, 0.15)) {
            key.translation.y = f64::NAN;
        }
        let given = count + usize::from(at_times(&mut random, 0.1));
        let mut times: Vec<f64> = (0..given)
            .map(|k| k as f64 * random.within(1.0, 1.4))
            .collect();
        if at_times(&mut random, 0.1) {
            times.reverse();
        }
        let times = at_times(&mut random, 0.6).then_some(times.as_slice());
        let steps = one_of(&mut random, &[0, 1, 1, 3, 4]);
        let Some(mut path) = digest.answer(CartesianPath::spline(keys, times, steps)) else {
            continue;
        };
        if at_times(&mut random, 0.5) {
            path = path.moved(&placement(&mut random, 2.0));
        }
        add_text(
            &mut digest,
            &format!("{path:?} {:?} {:?}", path.times(), path.tools()),
        );
        let wrong = one_of(&mut random, &[0, 1, 2]);
        digest.answer(path.clone().with_tools(vec![0; wrong]));
        digest.answer(path.with_times(vec![0.5; wrong]));
    }
    digest.value()
}

/// Tables of drawn columns in any order, with a cell changed at times.
fn tables() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2034));
    let turns = [
        "1,0,0,0",
        "0.6,0.8,0,0",
        "0,0.6,0,0.8",
        "0.5,0.5,0.5,0.5",
        "0.5,0.5,0.5,0.5004",
        "0,0,0,0",
    ];
    for _ in 0..120 {
        let mut columns: Vec<(&str, usize)> = ["x", "y", "z"].into_iter().zip(0..).collect();
        if at_times(&mut random, 0.7) {
            let names = one_of(
                &mut random,
                &[
                    ["qw", "qx", "qy", "qz"],
                    ["w", "rot_x", "QUAT-Y", "oz"],
                    ["rw", "rx", "ry", "q_z"],
                ],
            );
            columns.extend(names.into_iter().zip(3..));
        }
        let extra: [(&str, usize); 5] = [
            ("time", 7),
            ("timestamp", 7),
            ("tool", 8),
            ("Tool Number", 8),
            ("note", 9),
        ];
        for _ in 0..random.below(3) {
            columns.push(one_of(&mut random, &extra));
        }
        if at_times(&mut random, 0.6) {
            for k in (1..columns.len()).rev() {
                columns.swap(k, random.below(k + 1));
            }
        }
        let sign = one_of(&mut random, &[",", ";", "\t", " ", ", "]);
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let mut lines = vec![names.join(sign)];
        let step = one_of(&mut random, &[1.0, 0.25, -1.0, 0.0]);
        for row in 0..random.below(4) {
            let turn = one_of(&mut random, &turns);
            let turn: Vec<&str> = turn.split(',').collect();
            let cells = columns.iter().map(|(_, kind)| match kind {
                3..=6 => turn[kind - 3].to_owned(),
                7 => (step * row as f64).to_string(),
                8 => one_of(&mut random, &["0", "1", "255", "0", "2.5"]).to_owned(),
                _ => one_of(&mut random, &["0.5", "-2", "1e3", "7"]).to_owned(),
            });
            let mut cells: Vec<String> = cells.collect();
            if at_times(&mut random, 0.08) {
                let cell = random.below(cells.len());
                cells[cell] = one_of(&mut random, &["nan", "", "x", "1e999", "\"3\""]).to_owned();
            }
            if at_times(&mut random, 0.04) {
                cells.pop();
            }
            lines.push(cells.join(sign));
            if at_times(&mut random, 0.1) {
                lines.push(one_of(&mut random, &["", "# between", "  "]).to_owned());
            }
        }
        if at_times(&mut random, 0.3) {
            lines.remove(0);
        }
        let order = one_of(
            &mut random,
            &[QuaternionOrder::WFirst, QuaternionOrder::WLast],
        );
        let text = lines.join(one_of(&mut random, &["\n", "\r\n"]));
        if let Some((path, columns)) =
            digest.answer(CartesianPath::from_csv(text.as_bytes(), "drawn.csv", order))
        {
            add_text(&mut digest, &format!("{path:?} {columns}"));
        }
    }
    digest.value()
}

#[test]
fn of_drawn_paths() {
    check(&[
        ("drawn paths, of drawn options", options()),
        ("drawn rings", rings()),
        ("drawn rows, and their times", times()),
        ("drawn splines", splines()),
        ("drawn tables of paths", tables()),
    ]);
}
