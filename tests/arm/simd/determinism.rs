//! Promise: the same target and start have bitwise the same result, however a batch is split.

use kinopt::simd_ik::{
    AxisGoal, Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::Placement;
use support::random::Random;
use support::simd_chains::{far_away, panda, random_chain, target};

type Results = (Vec<u64>, Vec<PoseOutcome>);

fn work(chain: &Chain, count: usize) -> (Vec<Placement<f64>>, Vec<f64>) {
    let mut random = Random::split_mix(3);
    let goals = (0..count)
        .map(|k| {
            if k % 17 == 5 {
                far_away()
            } else {
                target(chain, &random.chain_configuration(chain))
            }
        })
        .collect();
    let starts = (0..count)
        .flat_map(|_| random.chain_configuration(chain))
        .collect();
    (goals, starts)
}

fn split(solver: &PoseSolver, goals: &[Placement<f64>], starts: &[f64], size: usize) -> Results {
    let n = solver.joints();
    let mut q = vec![0.0; starts.len()];
    let mut outcomes = vec![PoseOutcome::default(); goals.len()];
    let parts = goals
        .chunks(size)
        .zip(starts.chunks(size * n))
        .zip(q.chunks_mut(size * n))
        .zip(outcomes.chunks_mut(size));
    for (((goals, starts), q), outcomes) in parts {
        solver
            .solve_batch(goals, starts, Prefer::Start, q, outcomes)
            .unwrap();
    }
    (q.into_iter().map(f64::to_bits).collect(), outcomes)
}

fn check(chain: &Chain, atlas: bool) {
    let options = LaneOptions::default().with_atlas(atlas).with_attempts(8);
    let solver = PoseSolver::new(chain, options.clone()).unwrap();
    let (goals, starts) = work(chain, 60);
    let whole = split(&solver, &goals, &starts, 60);
    for size in [1, 2, 7, 8, 31] {
        assert!(
            split(&solver, &goals, &starts, size) == whole,
            "chunks of {size}"
        );
    }
    // A new solver, and threads.
    let again = PoseSolver::new(chain, options).unwrap();
    assert!(split(&again, &goals, &starts, 60) == whole);
    for threads in [2, 8] {
        let n = solver.joints();
        let size = 60usize.div_ceil(threads);
        let joined: Vec<Results> = std::thread::scope(|scope| {
            let handles: Vec<_> = goals
                .chunks(size)
                .zip(starts.chunks(size * n))
                .map(|(goals, starts)| scope.spawn(|| split(&solver, goals, starts, 5)))
                .collect();
            handles
                .into_iter()
                .map(|handle| handle.join().unwrap())
                .collect()
        });
        let bits: Vec<u64> = joined.iter().flat_map(|part| part.0.clone()).collect();
        assert!(bits == whole.0, "{threads} threads");
    }
    // Rayon's threads, each with at most 128 queries of the batch.
    let (many, from) = (goals.repeat(3), starts.repeat(3));
    let mut q = vec![0.0; from.len()];
    let mut outcomes = vec![PoseOutcome::default(); many.len()];
    solver
        .solve_batch_parallel(&many, &from, Prefer::Start, &mut q, &mut outcomes)
        .unwrap();
    let bits: Vec<u64> = q.into_iter().map(f64::to_bits).collect();
    assert!(bits == whole.0.repeat(3) && outcomes == whole.1.repeat(3));
    // Single queries, independently of those before.
    let n = solver.joints();
    let ask = |k: usize| {
        let mut q = vec![0.0; n];
        let start = &starts[k * n..(k + 1) * n];
        let outcome = solver
            .solve(&goals[k], start, Prefer::First, None, &mut q)
            .unwrap();
        (q, outcome)
    };
    let forwards: Vec<_> = (0..20).map(ask).collect();
    let backwards: Vec<_> = (0..20).rev().map(ask).collect();
    assert!(forwards.iter().eq(backwards.iter().rev()));
}

#[test]
fn results_are_bitwise_equal_for_splits_and_threads() {
    check(&panda(), true);
    check(&random_chain(5, 8, 1, true), false);
}

/// Numbered attempts equal those of a batch: the winner is the lowest number that reaches the target.
#[test]
fn numbered_attempts_equal_those_of_a_batch() {
    let chain = panda();
    let options = LaneOptions::default().with_atlas(false);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let (goals, starts) = work(&chain, 12);
    let (bits, outcomes) = split(&solver, &goals, &starts, 12);
    for (k, goal) in goals.iter().enumerate() {
        let start = &starts[7 * k..7 * k + 7];
        let (mut q, mut each) = (vec![0.0; 7 * 24], vec![PoseOutcome::default(); 24]);
        solver
            .run_attempts(
                goal,
                start,
                Prefer::Start,
                0,
                &mut q[..7 * 20],
                &mut each[..20],
            )
            .unwrap();
        solver
            .run_attempts(
                goal,
                start,
                Prefer::Start,
                20,
                &mut q[7 * 20..],
                &mut each[20..],
            )
            .unwrap();
        let lowest = each.iter().position(|outcome| outcome.reached);
        match lowest {
            Some(lowest) => {
                assert_eq!(outcomes[k].winner, Some(lowest as u32));
                let q: Vec<u64> = q[7 * lowest..7 * lowest + 7]
                    .iter()
                    .map(|v| v.to_bits())
                    .collect();
                assert_eq!(q, bits[7 * k..7 * k + 7]);
            }
            None => assert!(!outcomes[k].reached || outcomes[k].winner > Some(23)),
        }
    }
}

/// Of attempts that reach the target after equally many steps, the lowest number wins.
#[test]
fn ties_go_to_the_lowest_attempt() {
    let chain = panda();
    let solver = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
    let (mut random, mut ties) = (Random::split_mix(5), 0);
    let (mut q, mut all) = (vec![0.0; 7], vec![0.0; 28]);
    for _ in 0..60 {
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start = random.chain_configuration(&chain);
        let raced = solver
            .solve(&goal, &start, Prefer::First, None, &mut q)
            .unwrap();
        let mut alone = [PoseOutcome::default(); 4];
        solver
            .run_attempts(&goal, &start, Prefer::First, 0, &mut all, &mut alone)
            .unwrap();
        let reached = (0..4u32).filter(|&k| alone[k as usize].reached);
        let key = |k: &u32| (alone[*k as usize].iterations, *k);
        let Some(first) = reached.clone().min_by_key(key) else {
            continue;
        };
        // No attempt was abandoned before, so no other one was started.
        let steps = alone[first as usize].iterations;
        if raced.attempts == 4 {
            assert_eq!(raced.winner, Some(first));
            let as_fast = reached.filter(|&k| alone[k as usize].iterations == steps);
            ties += usize::from(as_fast.count() > 1);
        }
    }
    assert!(ties > 5, "{ties} ties");
}

/// Further attempts for prismatic joints without limits begin near the start. Where two such joints cancel each other,
/// the results stay near the start too.
#[test]
fn unbounded_prismatic_joints_start_nearby() {
    let slide = ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: [1.0, 0.0, 0.0].into(),
        kind: JointKind::Prismatic,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
    let chain = Chain::new(vec![slide; 2], Placement::identity()).unwrap();
    let solver = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
    let goal = Placement::translation([100.0, 0.0, 0.0].into());
    let start = [1000.0, -902.0];
    let (mut q, mut outcomes) = ([0.0; 10], [PoseOutcome::default(); 5]);
    solver
        .run_attempts(&goal, &start, Prefer::Start, 1, &mut q, &mut outcomes)
        .unwrap();
    for (q, outcome) in q.chunks(2).zip(outcomes) {
        assert!(outcome.reached, "{outcome:?}");
        assert!((q[0] - start[0]).abs() < 4.0, "{q:?}");
    }
}

/// A parallel search counts the iterations of all its attempts, none of which exceeds its limit. A batch makes at most
/// the allowed number of attempts, and exactly that number if nothing is reached.
#[test]
fn iterations_and_attempts_are_counted() {
    let chain = panda();
    let options = LaneOptions::default()
        .with_atlas(false)
        .with_attempts(7)
        .with_iterations(5)
        .with_stall_limit(40);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let (mut random, goal) = (Random::split_mix(6), far_away());
    for _ in 0..4 {
        let start = random.chain_configuration(&chain);
        let (mut q, mut each) = (vec![0.0; 49], vec![PoseOutcome::default(); 7]);
        solver
            .run_attempts(&goal, &start, Prefer::Start, 0, &mut q, &mut each)
            .unwrap();
        assert!(each.iter().all(|outcome| outcome.iterations == 5));
        let raced = solver.solve(&goal, &start, Prefer::Start, None, &mut q[..7]);
        let raced = raced.unwrap();
        let mut together = [PoseOutcome::default()];
        solver
            .solve_batch(&[goal], &start, Prefer::Start, &mut q[..7], &mut together)
            .unwrap();
        for outcome in [raced, together[0]] {
            assert!(!outcome.reached && outcome.winner.is_none());
            assert_eq!((outcome.attempts, outcome.iterations), (7, 35));
        }
    }
}

/// If any orientation is accepted, the target's orientation only affects rounding.
#[test]
fn free_target_orientation_has_no_effect() {
    let chain = panda();
    let options = LaneOptions::default().with_axes(AxisGoal::position_only());
    let solver = PoseSolver::new(&chain, options).unwrap();
    let mut random = Random::split_mix(7);
    let (mut alike, mut q) = (0, [[0.0; 7]; 2]);
    for _ in 0..20 {
        let [goal, other] = [(); 2].map(|()| target(&chain, &random.chain_configuration(&chain)));
        let turned = Placement::new(other.rotation, goal.translation);
        let start = random.chain_configuration(&chain);
        for (goal, q) in [goal, turned].iter().zip(&mut q) {
            let outcome = solver.solve(goal, &start, Prefer::First, None, q);
            assert!(outcome.unwrap().reached);
        }
        let apart = (0..7).map(|i| (q[0][i] - q[1][i]).abs());
        alike += usize::from(apart.fold(0.0, f64::max) < 1e-6);
    }
    assert!(alike >= 18, "{alike} of 20");
}

/// Goals for whose position the atlas has no seeds use no seeds of earlier goals.
#[test]
fn goals_without_seeds_use_none_of_other_goals() {
    let chain = panda();
    let options = LaneOptions::default().with_attempts(6);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let (mut goals, starts) = work(&chain, 40);
    let mut random = Random::split_mix(29);
    for goal in goals.iter_mut().skip(1).step_by(2) {
        let [x, y, z] = [(); 3].map(|()| random.within(-1.2, 1.2));
        goal.translation = [x, y, z].into();
    }
    let results = |size: usize| {
        let mut results = Vec::new();
        for (goals, starts) in goals.chunks(size).zip(starts.chunks(7 * size)) {
            let mut q = vec![0.0; starts.len()];
            let mut outcomes = vec![PoseOutcome::default(); goals.len()];
            solver
                .solve_batch(goals, starts, Prefer::First, &mut q, &mut outcomes)
                .unwrap();
            results.extend(outcomes.into_iter().zip(q.chunks(7).map(<[f64]>::to_vec)));
        }
        results
    };
    assert!(results(40) == results(1));
}
