//! Pose IK of the shipped Panda and UR5e on the lane engine: single queries, a batch, a path, and
//! what one iteration costs. Throughput counts poses, or iterations where the name says so.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kinopt::lanes::{LaneOptions, Outcome, PoseSolver, Search};
use kinopt::robot::Robot;
use kinopt_benches::{Sequence, chain, random_poses, smooth_path};

const POSES: usize = 2000;

const ARMS: [(&str, &str, &str); 2] = [
    ("franka_panda", "base", "hand"),
    ("universal_ur5e", "base", "flange"),
];

fn poses(criterion: &mut Criterion) {
    for (name, base, tip) in ARMS {
        let path = format!("{}/../models/{name}.urdf", env!("CARGO_MANIFEST_DIR"));
        let robot = Robot::read(&path).expect("a shipped robot");
        let chain = chain(&robot, base, tip).expect("an arm");
        let solver = PoseSolver::new(&chain, LaneOptions::default()).expect("valid options");
        let joints = solver.joints();
        let ask = random_poses(&chain, POSES, &mut Sequence::new(0.5));
        let mut q = vec![0.0; joints * POSES];
        let mut outcomes = vec![Outcome::default(); POSES];
        let mut group = criterion.benchmark_group(name);

        group.throughput(Throughput::Elements(1));
        for (search, words) in [
            (Search::First, "one query, whichever solution is fastest"),
            (Search::Start, "one query, the start's own solution first"),
        ] {
            let mut next = 0;
            group.bench_function(words, |bencher| {
                bencher.iter(|| {
                    next = (next + 1) % POSES;
                    let start = &ask.starts[next * joints..(next + 1) * joints];
                    let solved =
                        solver.solve(&ask.targets[next], start, search, None, &mut q[..joints]);
                    solved.expect("a valid query").reached
                });
            });
        }

        group.throughput(Throughput::Elements(POSES as u64));
        for (search, words) in [
            (Search::First, "batch of 2000, whichever is fastest"),
            (Search::Start, "batch of 2000, the start's own first"),
        ] {
            group.bench_function(words, |bencher| {
                bencher.iter(|| {
                    solver
                        .solve_batch(&ask.targets, &ask.starts, search, &mut q, &mut outcomes)
                        .expect("a valid batch");
                });
            });
        }

        // One attempt a query, all from random starts: hardly anything but iterations.
        let plain = LaneOptions {
            atlas: false,
            attempts: 1,
            ..LaneOptions::default()
        };
        let plain = PoseSolver::new(&chain, plain).expect("valid options");
        let mut attempt = |outcomes: &mut [Outcome]| {
            plain
                .solve_batch(&ask.targets, &ask.starts, Search::Start, &mut q, outcomes)
                .expect("a valid batch");
        };
        attempt(&mut outcomes);
        let iterations = outcomes.iter().map(|o| u64::from(o.iterations)).sum();
        group.throughput(Throughput::Elements(iterations));
        group.bench_function("iterations of 2000 attempts in a batch", |bencher| {
            bencher.iter(|| attempt(&mut outcomes));
        });

        let path = smooth_path(&chain, POSES);
        group.throughput(Throughput::Elements(POSES as u64));
        group.bench_function("path of 2000 steps", |bencher| {
            bencher.iter(|| {
                solver
                    .track(&path.targets, &path.starts, &mut q, &mut outcomes)
                    .expect("a valid path");
            });
        });
        group.finish();
    }
}

criterion_group!(benches, poses);
criterion_main!(benches);
