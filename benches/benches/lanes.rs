//! Pose IK of the shipped Panda and UR5e, through `Arm` and on the SIMD solver: single queries, a batch, a path, and
//! one iteration. Throughput is in poses, or in iterations if the name says so.
#![allow(missing_docs, clippy::expect_used)]

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use kinopt::arm::{self, Arm};
use kinopt::ik::Solution;
use kinopt::robot::Robot;
use kinopt::simd_ik::{Chain, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use kinopt_benches::{ArmPoses, Sequence, chain, random_poses, smooth_path};

const POSES: usize = 2000;

const ARMS: [(&str, &str, &str); 2] = [
    ("franka_panda", "base", "hand"),
    ("universal_ur5e", "base", "flange"),
];

const FIRST: &str = "whichever solution is fastest";
const START: &str = "the start's own solution first";

fn arm_queries(group: &mut BenchmarkGroup<WallTime>, arm: &Arm, queries: &ArmPoses, words: &str) {
    let joints = arm.joint_count();
    let mut solution = Solution::default();
    let mut next = 0;
    group.throughput(Throughput::Elements(1));
    group.bench_function(format!("one query, {words}"), |bencher| {
        bencher.iter(|| {
            next = (next + 1) % POSES;
            let start = &queries.starts[next * joints..(next + 1) * joints];
            arm.solve_into(queries.targets[next], start, &mut solution)
                .expect("a valid query");
            solution.reached
        });
    });
    let mut q = vec![0.0; joints * POSES];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function(format!("batch of 2000, {words}"), |bencher| {
        bencher.iter(|| {
            arm.solve_batch_into(&queries.targets, &queries.starts, &mut q, &mut outcomes)
                .expect("a valid batch");
        });
    });
}

fn engine(
    group: &mut BenchmarkGroup<WallTime>,
    solver: &PoseSolver,
    queries: &ArmPoses,
    path: &ArmPoses,
) {
    let joints = solver.joints();
    let mut q = vec![0.0; joints * POSES];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    for (search, words) in [(Prefer::First, FIRST), (Prefer::Start, START)] {
        let mut next = 0;
        group.throughput(Throughput::Elements(1));
        group.bench_function(format!("engine, one query, {words}"), |bencher| {
            bencher.iter(|| {
                next = (next + 1) % POSES;
                let start = &queries.starts[next * joints..(next + 1) * joints];
                let solved = solver.solve(
                    &queries.targets[next],
                    start,
                    search,
                    None,
                    &mut q[..joints],
                );
                solved.expect("a valid query").reached
            });
        });
        group.throughput(Throughput::Elements(POSES as u64));
        group.bench_function(format!("engine, batch of 2000, {words}"), |bencher| {
            bencher.iter(|| {
                solver
                    .solve_batch(
                        &queries.targets,
                        &queries.starts,
                        search,
                        &mut q,
                        &mut outcomes,
                    )
                    .expect("a valid batch");
            });
        });
    }
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function("engine, path of 2000 steps", |bencher| {
        bencher.iter(|| {
            solver
                .track(&path.targets, &path.starts, &mut q, &mut outcomes)
                .expect("a valid path");
        });
    });
}

/// One attempt for each query, from a random start: nearly all time is in iterations.
fn iterations(group: &mut BenchmarkGroup<WallTime>, chain: &Chain, queries: &ArmPoses) {
    let options = LaneOptions::default().with_atlas(false).with_attempts(1);
    let solver = PoseSolver::new(chain, options).expect("valid options");
    let mut q = vec![0.0; solver.joints() * POSES];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    let mut attempt = |outcomes: &mut [PoseOutcome]| {
        solver
            .solve_batch(
                &queries.targets,
                &queries.starts,
                Prefer::Start,
                &mut q,
                outcomes,
            )
            .expect("a valid batch");
    };
    attempt(&mut outcomes);
    let iterations = outcomes.iter().map(|o| u64::from(o.iterations)).sum();
    group.throughput(Throughput::Elements(iterations));
    group.bench_function("engine, iterations of 2000 attempts", |bencher| {
        bencher.iter(|| attempt(&mut outcomes));
    });
}

fn poses(criterion: &mut Criterion) {
    for (name, base, tip) in ARMS {
        let file = format!("{}/../models/{name}.urdf", env!("CARGO_MANIFEST_DIR"));
        let robot = Robot::read(&file).expect("a shipped robot");
        let chain = chain(&robot, base, tip).expect("an arm");
        let queries = random_poses(&chain, POSES, &mut Sequence::new(0.5));
        let path = smooth_path(&chain, POSES);
        let mut group = criterion.benchmark_group(name);
        for (search, words) in [(arm::Search::First, FIRST), (arm::Search::Start, START)] {
            let arm = Arm::builder(&robot, base, tip);
            let arm = arm.with_search(search).build().expect("an arm");
            arm_queries(&mut group, &arm, &queries, words);
        }
        let arm = Arm::new(&robot, base, tip).expect("an arm");
        group.bench_function("path of 2000 steps", |bencher| {
            bencher.iter(|| {
                arm.track(&path.targets, &path.starts)
                    .expect("a valid path")
            });
        });
        let solver = PoseSolver::new(&chain, LaneOptions::default()).expect("valid options");
        engine(&mut group, &solver, &queries, &path);
        iterations(&mut group, &chain, &queries);
        group.finish();
    }
}

criterion_group!(benches, poses);
criterion_main!(benches);
