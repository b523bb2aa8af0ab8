//! The same question has the same answer, run after run and on any number of threads.
#![cfg(all(feature = "urdf", feature = "rayon"))]
#![allow(clippy::unwrap_used)]

mod arm_support;

use arm_support::{Random, panda};
use kinopt::Solution;
use kinopt::arm::{Arm, Outcome, Search};

fn bits(solutions: &[Solution]) -> Vec<u64> {
    solutions
        .iter()
        .flat_map(|s| s.q.iter().map(|v| v.to_bits()))
        .collect()
}

#[test]
fn at_one_two_and_eight_threads() {
    let (robot, base, tip) = panda();
    for search in [Search::Start, Search::First, Search::Nearest] {
        let arm = Arm::builder(&robot, base, tip)
            .unwrap()
            .with_search(search)
            .build()
            .unwrap();
        let mut random = Random(8);
        let count = if search == Search::Nearest { 12 } else { 300 };
        let mut goals: Vec<_> = (0..count)
            .map(|_| arm.base_from_tool(&random.configuration(&arm)).unwrap())
            .collect();
        goals[1].translation.x += 5.0;
        let starts: Vec<f64> = (0..count)
            .flat_map(|_| random.configuration(&arm))
            .collect();
        let alone: Vec<_> = goals
            .iter()
            .zip(starts.chunks(7))
            .map(|(goal, start)| arm.solve(goal, start).unwrap())
            .collect();
        let together = arm.solve_batch(&goals, &starts).unwrap();
        assert!(!together[1].reached && !alone[1].reached);
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let parallel = pool
                .install(|| arm.solve_batch_parallel(&goals, &starts))
                .unwrap();
            assert_eq!(bits(&parallel), bits(&together));
            let mut q = vec![0.0; starts.len()];
            let mut outcomes = vec![Outcome::default(); count];
            pool.install(|| arm.solve_batch_into_parallel(&goals, &starts, &mut q, &mut outcomes))
                .unwrap();
            let flat: Vec<u64> = q.iter().map(|v| v.to_bits()).collect();
            assert_eq!(flat, bits(&together));
            let chunk = count.div_ceil(threads);
            let by_threads: Vec<u64> = std::thread::scope(|scope| {
                let arm = &arm;
                let workers: Vec<_> = goals
                    .chunks(chunk)
                    .zip(starts.chunks(chunk * 7))
                    .map(|(goals, starts)| {
                        scope.spawn(move || {
                            goals
                                .iter()
                                .zip(starts.chunks(7))
                                .map(|(goal, start)| arm.solve(goal, start).unwrap())
                                .collect::<Vec<_>>()
                        })
                    })
                    .collect();
                workers
                    .into_iter()
                    .flat_map(|w| bits(&w.join().unwrap()))
                    .collect()
            });
            assert_eq!(by_threads, bits(&alone));
        }
    }
}
