//! Check of a path's steps by smaller steps of the arm along the straight segment of the tool.

use kinopt::Arm;
use kinopt::arm::Search;
use kinopt::spatial::Placement;
use nalgebra::Isometry3;

/// Largest difference of a joint between two configurations.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}

/// True if small steps along the tool's straight segment connect two configurations. No step may move a joint by more
/// than half of a step of 0.2 rad. Of a hundred parts, longer ones are divided into twenty. The null space motion is
/// distributed evenly.
pub fn is_led(arm: &Arm, ends: [Placement<f64>; 2], [from, to]: [&[f64]; 2]) -> bool {
    const PARTS_PER_SEGMENT: u32 = 100;
    const STEPS_PER_PART: u32 = 20;
    let [begin, end] = ends.map(Isometry3::from);
    let arm = arm.with_search(Search::Start).unwrap();
    // Step from one fraction of the segment to a later one.
    let go = |q: &[f64], at: f64, next: f64| {
        let target = begin.lerp_slerp(&end, next);
        let along = (next - at) / (1.0 - at);
        let start = q.iter().zip(to).map(|(q, to)| q + along * (to - q));
        let start: Vec<f64> = start.collect();
        let gone = arm.solve(Placement::from(target), &start).unwrap();
        // A straight segment near a stretched arm may be unreachable by some micrometres.
        let near = gone.position_error().is_some_and(|metres| metres < 1e-4);
        (near && largest_difference(q, &gone.q) <= 0.1).then_some(gone.q)
    };
    let share = |smaller: u32| f64::from(smaller) / f64::from(PARTS_PER_SEGMENT * STEPS_PER_PART);
    let mut q = from.to_vec();
    for part in 0..PARTS_PER_SEGMENT - 1 {
        let begin = part * STEPS_PER_PART;
        let single_step = go(&q, share(begin), share(begin + STEPS_PER_PART));
        let gone = single_step.or_else(|| {
            let mut steps = begin..begin + STEPS_PER_PART;
            steps.try_fold(q.clone(), |q, at| go(&q, share(at), share(at + 1)))
        });
        let Some(gone) = gone else {
            return false;
        };
        q = gone;
    }
    largest_difference(&q, to) <= 0.1
}
