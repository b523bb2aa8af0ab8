//! Promise: a straight segment that an arm can follow without a reconfiguration is solved so with few distant points.
//! Its two ends alone suffice, also as a closed path. At most one in two hundred may fail.
//!
//! Debug builds solve a few cases of each arm; `KINOPT_CASES` sets another number.

use std::ops::Range;

use kinopt::Arm;
use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathReport, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;
use support::path_steps::{is_led, largest_difference};
use support::random::{Random, case_count, few};

/// A straight segment of at most 35 cm with a rotation of at most 1.5 rad, from a random pose.
struct StraightSegment {
    begin: Placement<f64>,
    displacement: Vector3<f64>,
    turn: Vector3<f64>,
}

impl StraightSegment {
    fn random(arm: &Arm, random: &mut Random) -> Self {
        let q = random.configuration(arm);
        let q: Vec<f64> = q.iter().map(|q| 0.6 * q).collect();
        let mut within = |radius: f64| {
            let [x, y, z] = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
            Vector3::new(x, y, z) * (radius / 3.0_f64.sqrt())
        };
        Self {
            begin: arm.base_from_tool(&q).unwrap(),
            displacement: within(0.35),
            turn: within(1.5),
        }
    }

    fn points(&self, steps: u32) -> Vec<Placement<f64>> {
        let point = |k: u32| {
            let share = f64::from(k) / f64::from(steps);
            let rotation = rotation_exp(self.turn * share) * self.begin.rotation;
            Placement::new(rotation, self.begin.translation + self.displacement * share)
        };
        (0..=steps).map(point).collect()
    }

    fn solved(&self, arm: &Arm, steps: u32) -> JointPath<PathReport> {
        let path = CartesianPath::new(self.points(steps)).unwrap();
        PathSolver::new(arm).solve(&path).unwrap()
    }

    /// Out and back as a closed path, with `steps` steps each way.
    fn solved_as_ring(&self, arm: &Arm, steps: u32) -> JointPath<PathReport> {
        let mut points = self.points(steps);
        let back: Vec<_> = points[1..points.len() - 1].iter().rev().copied().collect();
        points.extend(back);
        let path = CartesianPath::new(points).unwrap();
        let path = path.with_traversal(Traversal::Cyclic);
        PathSolver::new(arm).solve(&path).unwrap()
    }
}

fn arm(name: &str) -> Arm {
    let robot = robot(name);
    let builder = Arm::builder(&robot, "base", "flange");
    builder.with_atlas(false).build().unwrap()
}

/// The random segments with these numbers.
fn segments(arm: &Arm, cases: &Range<usize>) -> impl Iterator<Item = (usize, StraightSegment)> {
    let mut random = Random::split_mix(12);
    let all = (0..cases.end).map(move |case| (case, StraightSegment::random(arm, &mut random)));
    all.skip(cases.start)
}

/// Number of reachable segments with a reconfiguration for this many steps, but none for 210.
fn count_left_by_few_steps(name: &str, steps: u32, cases: &Range<usize>) -> usize {
    let arm = arm(name);
    let (mut within_reach, mut left) = (0, 0);
    for (case, segment) in segments(&arm, cases) {
        let few = segment.solved(&arm, steps);
        if !few.report.missed.is_empty() {
            continue;
        }
        within_reach += 1;
        if !few.jumps.is_empty() {
            left += usize::from(segment.solved(&arm, 210).reached());
        }
        // Every step without a reported reconfiguration is continuous.
        let (points, rows) = (segment.points(steps), few.rows().collect::<Vec<_>>());
        for row in 1..rows.len() {
            let steps = [rows[row - 1], rows[row]];
            let reported = few.jumps.iter().any(|reported| reported.index == row);
            let short = largest_difference(steps[0], steps[1]) <= 0.2 + 1e-9;
            assert!(
                reported || short || is_led(&arm, [points[row - 1], points[row]], steps),
                "{name} {case}: {row}"
            );
        }
    }
    assert!(within_reach * 4 > cases.len(), "{within_reach}");
    left
}

/// All segments, or a few that include those for which a Panda had reconfigurations with the two ends alone.
fn case_range() -> Range<usize> {
    match few() {
        true => 69..84,
        false => 0..case_count(300, 0),
    }
}

#[test]
fn few_points_need_no_more_reconfigurations() {
    let cases = case_range();
    for name in ["franka_panda", "kuka_iiwa14", "universal_ur5e"] {
        for steps in [7, 1] {
            let left = count_left_by_few_steps(name, steps, &cases);
            assert!(left * 200 <= cases.len(), "{name} in {steps}: {left}");
        }
    }
}

#[test]
fn closed_paths_of_few_points_stay_on_their_branch() {
    let cases = case_range();
    for name in ["franka_panda", "universal_ur5e"] {
        let arm = arm(name);
        let mut left = 0;
        for (_, segment) in segments(&arm, &cases) {
            let few = segment.solved_as_ring(&arm, 1);
            if few.report.missed.is_empty() && !few.jumps.is_empty() {
                left += usize::from(segment.solved_as_ring(&arm, 105).reached());
            }
        }
        assert!(left * 200 <= cases.len(), "{name}: {left}");
    }
}
