//! Promise: a straight way that an arm can go in one piece is solved without a reconfiguration by few points that are far apart too, and by
//! its two ends alone, also round and round, but for one of two hundred; in a debug build a few of each arm, `KINOPT_CASES` asks for another number.

use std::ops::Range;

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolution, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{Random, robot};
use support::path_steps::{is_led, longest};
use support::sample::{cases, few};

/// A straight way of 35 cm at most, turned by 1.5 rad at most, from a random place.
struct StraightWay {
    begin: Placement<f64>,
    by: Vector3<f64>,
    turn: Vector3<f64>,
}

impl StraightWay {
    fn random(arm: &Arm, random: &mut Random) -> Self {
        let q = random.configuration(arm);
        let q: Vec<f64> = q.iter().map(|q| 0.6 * q).collect();
        let mut within = |radius: f64| {
            let [x, y, z] = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
            Vector3::new(x, y, z) * (radius / 3.0_f64.sqrt())
        };
        Self {
            begin: arm.base_from_tool(&q).unwrap(),
            by: within(0.35),
            turn: within(1.5),
        }
    }

    fn points(&self, steps: u32) -> Vec<Placement<f64>> {
        let point = |k: u32| {
            let share = f64::from(k) / f64::from(steps);
            let rotation = rotation_exp(self.turn * share) * self.begin.rotation;
            Placement::new(rotation, self.begin.translation + self.by * share)
        };
        (0..=steps).map(point).collect()
    }

    fn solved(&self, arm: &Arm, steps: u32) -> PathSolution {
        let path = CartesianPath::new(self.points(steps)).unwrap();
        PathSolver::new(arm).solve(&path).unwrap()
    }

    /// Out and back again, round and round, in so many steps each way.
    fn solved_as_ring(&self, arm: &Arm, steps: u32) -> PathSolution {
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

/// The random ways of these numbers.
fn ways(arm: &Arm, cases: &Range<usize>) -> impl Iterator<Item = (usize, StraightWay)> {
    let mut random = Random(12);
    let all = (0..cases.end).map(move |case| (case, StraightWay::random(arm, &mut random)));
    all.skip(cases.start)
}

/// How many of these ways that are within reach are left in no step by two hundred points, but in one of so few.
fn left_by_few_steps(name: &str, steps: u32, cases: &Range<usize>) -> usize {
    let arm = arm(name);
    let (mut within_reach, mut left) = (0, 0);
    for (case, way) in ways(&arm, cases) {
        let few = way.solved(&arm, steps);
        if !few.missed.is_empty() {
            continue;
        }
        within_reach += 1;
        if !few.reconfigurations.is_empty() {
            left += usize::from(way.solved(&arm, 210).is_whole());
        }
        // What is told as going on does.
        let (points, rows) = (way.points(steps), few.rows().collect::<Vec<_>>());
        for row in 1..rows.len() {
            let steps = [rows[row - 1], rows[row]];
            let told = few.reconfigurations.iter().any(|told| told.index == row);
            let short = longest(steps[0], steps[1]) <= 0.2 + 1e-9;
            assert!(
                told || short || is_led(&arm, [points[row - 1], points[row]], steps),
                "{name} {case}: {row}"
            );
        }
    }
    assert!(within_reach * 4 > cases.len(), "{within_reach}");
    left
}

/// All of them, or the few among which are those that a Panda left by their ends alone.
fn asked() -> Range<usize> {
    match few() {
        true => 69..84,
        false => 0..cases(300, 0),
    }
}

#[test]
fn few_points_leave_no_branch_that_many_do_not() {
    let cases = asked();
    for name in ["franka_panda", "kuka_iiwa14", "universal_ur5e"] {
        for steps in [7, 1] {
            let left = left_by_few_steps(name, steps, &cases);
            assert!(left * 200 <= cases.len(), "{name} in {steps}: {left}");
        }
    }
}

#[test]
fn rings_of_few_points_leave_no_branch_that_those_of_many_do_not() {
    let cases = asked();
    for name in ["franka_panda", "universal_ur5e"] {
        let arm = arm(name);
        let mut left = 0;
        for (_, way) in ways(&arm, &cases) {
            let few = way.solved_as_ring(&arm, 1);
            if few.missed.is_empty() && !few.reconfigurations.is_empty() {
                left += usize::from(way.solved_as_ring(&arm, 105).is_whole());
            }
        }
        assert!(left * 200 <= cases.len(), "{name}: {left}");
    }
}
