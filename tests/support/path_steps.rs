//! Steps of a path's joints, judged by steps of the arm's own along the tool's straight way.

use kinopt::Arm;
use kinopt::arm::Search;
use kinopt::spatial::Placement;
use nalgebra::Isometry3;

/// The furthest that a joint goes.
pub fn longest(a: &[f64], b: &[f64]) -> f64 {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}

/// Whether small parts of the tool's way lead from one configuration to the other, of which none is longer than half of a step of 0.2
/// rad. What the arm has to spare goes to the other end evenly.
pub fn is_led(arm: &Arm, ends: [Placement<f64>; 2], [from, to]: [&[f64]; 2]) -> bool {
    const PARTS: u32 = 100;
    let [begin, end] = ends.map(Isometry3::from);
    let arm = arm.with_search(Search::Start).unwrap();
    let mut q = from.to_vec();
    for part in 1..PARTS {
        let target = begin.lerp_slerp(&end, f64::from(part) / f64::from(PARTS));
        let left = f64::from(PARTS + 1 - part);
        let start = q.iter().zip(to).map(|(q, to)| q + (to - q) / left);
        let start: Vec<f64> = start.collect();
        let next = arm.solve(Placement::from(target), &start).unwrap();
        // Where the arm is stretched out, the straight way may be some micrometres out of reach.
        let near = next.position_error().is_some_and(|metres| metres < 1e-4);
        if !near || longest(&q, &next.q) > 0.1 {
            return false;
        }
        q = next.q;
    }
    longest(&q, to) <= 0.1
}
