//! Reach maps of three arms: time to build, shares of cells, time of a query, and poses that contradict a proof.
//!
//! `cargo run --release -p kinopt-benches --features rayon --example reach_maps -- [position step, m] [orientation step, deg] [poses]`
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::TAU;
use std::time::Instant;

use kinopt::arm::{Arm, ReachMap};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement};
use support::random::Random;

const ARMS: [(&str, &str); 3] = [
    ("Panda", "franka_panda"),
    ("UR5e", "universal_ur5e"),
    ("iiwa 14", "kuka_iiwa14"),
];
/// Poses of one batch of exact inverse kinematics.
const BATCH: usize = 10_000;

fn share(count: usize, all: usize) -> f64 {
    100.0 * count as f64 / all.max(1) as f64
}

/// Poses with uniform rotations and positions within a cube of half an edge `half`, metres.
fn random_poses(
    unit: &mut impl FnMut() -> f64,
    centre: [f64; 3],
    half: f64,
) -> Vec<Placement<f64>> {
    let pose = |_| {
        let position = centre.map(|centre| centre + half * (2.0 * unit() - 1.0));
        // Shoemake's uniform quaternion.
        let (u, a, b) = (unit(), TAU * unit(), TAU * unit());
        let (r, s) = ((1.0 - u).sqrt(), u.sqrt());
        let [w, x, y, z] = [s * b.cos(), r * a.sin(), r * a.cos(), s * b.sin()];
        let columns = [
            [
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y + w * z),
                2.0 * (x * z - w * y),
            ],
            [
                2.0 * (x * y - w * z),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z + w * x),
            ],
            [
                2.0 * (x * z + w * y),
                2.0 * (y * z - w * x),
                1.0 - 2.0 * (x * x + y * y),
            ],
        ];
        let [x, y, z] = columns.map(Into::into);
        Placement::new(Matrix3::from_columns(x, y, z), position.into())
    };
    (0..BATCH).map(pose).collect()
}

fn count(statuses: &[Option<bool>], status: Option<bool>) -> usize {
    statuses.iter().filter(|&&other| other == status).count()
}

fn measure(name: &str, arm: &Arm, position_step: f64, orientation_step: f64, poses: usize) {
    let started = Instant::now();
    let builder = ReachMap::builder(arm)
        .with_position_step(position_step)
        .with_orientation_step(orientation_step);
    let map = builder.build_parallel().unwrap();
    let seconds = started.elapsed().as_secs_f64();
    let data = map.data();
    let blocks = data
        .cubes
        .iter()
        .filter(|&&block| block < u32::MAX - 1)
        .count();
    let bins = data.cells.len() / blocks.max(1);
    let cells = bins * data.cubes.len();
    let reached = data.configurations.len() / data.arm.joints.len();
    let unknown = data
        .cells
        .iter()
        .filter(|&&cell| cell == u32::MAX - 1)
        .count();
    let bytes = 4 * (data.cubes.len() + data.cells.len()) + 2 * data.configurations.len();
    println!(
        "| {name} | {cells} | {seconds:.1} s | {} MB | {:.1} % | {:.1} % | {:.1} % |",
        bytes / 1_000_000,
        share(reached, cells),
        share(cells - reached - unknown, cells),
        share(unknown, cells)
    );

    // Poses that the arm reaches.
    let mut statuses = vec![None; BATCH];
    let mut q = vec![0.0; BATCH * arm.joint_count()];
    let (mut contradictions, mut hits, mut exact, mut nanoseconds) = (0, 0, 0, 0);
    let mut seconds_exact = 0.0;
    for batch in 0..poses / BATCH {
        let seeds = (batch * BATCH) as u64..((batch + 1) * BATCH) as u64;
        let tools: Vec<Placement<f64>> = seeds
            .map(|seed| arm.base_from_tool(&arm.random_configuration(seed)).unwrap())
            .collect();
        let started = Instant::now();
        map.query_into(&tools, &mut q, &mut statuses).unwrap();
        nanoseconds += started.elapsed().as_nanos();
        contradictions += count(&statuses, Some(false));
        hits += count(&statuses, Some(true));
        let started = Instant::now();
        map.decide_into_parallel(arm, &tools, 0, &mut q, &mut statuses)
            .unwrap();
        seconds_exact += started.elapsed().as_secs_f64();
        exact += count(&statuses, Some(true));
    }
    let of_one = seconds_exact / poses as f64;
    println!(
        "  reachable poses: {:.0} ns a look-up on one core, {:.1} % with a configuration, {contradictions} proven \
         unreachable; {:.2} us an exact query on all cores, {:.3} % reached: 10^9 in {:.0} s, on ten machines {:.0} s",
        nanoseconds as f64 / poses as f64,
        share(hits, poses),
        1e6 * of_one,
        share(exact, poses),
        1e9 * of_one,
        1e8 * of_one,
    );

    // Poses of the whole grid.
    let half = 0.5 * data.position_step * f64::from(data.cubes_per_axis);
    let mut random = Random::new(1);
    let mut unit = || random.unit();
    let (mut known, mut undecided, mut excluded, mut wrong) = (0, 0, 0, 0);
    let starts = arm.default_start().repeat(BATCH);
    for _ in 0..poses / BATCH {
        let targets = random_poses(&mut unit, data.centre, half);
        map.query_into(&targets, &mut q, &mut statuses).unwrap();
        known += count(&statuses, Some(true));
        undecided += count(&statuses, None);
        let pairs = targets.iter().zip(&statuses);
        let proven = pairs.filter(|(_, status)| **status == Some(false));
        let proven: Vec<Placement<f64>> = proven.map(|(target, _)| *target).collect();
        excluded += proven.len();
        let starts = &starts[..proven.len() * arm.joint_count()];
        let found = arm.solve_batch_parallel(&proven, starts).unwrap();
        wrong += found.iter().filter(|solution| solution.reached).count();
    }
    println!(
        "  random poses: {:.1} % reached cells, {:.1} % unreachable, {:.1} % unknown; {wrong} of {excluded} proven \
         unreachable are solved",
        share(known, poses),
        share(excluded, poses),
        share(undecided, poses)
    );
}

fn main() {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse().unwrap())
        .collect();
    let number = |index: usize, default: f64| arguments.get(index).copied().unwrap_or(default);
    let (position_step, orientation_step) = (number(0, 0.1), number(1, 45.0).to_radians());
    let poses = (number(2, 100_000.0) as usize).next_multiple_of(BATCH);
    println!("| arm | cells | build | size | reached | unreachable | unknown |");
    println!("|---|---:|---:|---:|---:|---:|---:|");
    for (name, file) in ARMS {
        let robot = Robot::read(format!("models/{file}.urdf")).unwrap();
        let arm = Arm::builder(&robot, "base", "flange")
            .with_attempts(8)
            .build()
            .unwrap();
        measure(name, &arm, position_step, orientation_step, poses);
    }
}
