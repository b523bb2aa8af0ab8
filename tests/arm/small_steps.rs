//! Promise: a solve from a start near its target returns the result of the attempt from the start, also with joints on
//! their limits.
//!
//! Longer run of 10 000 steps for each arm: `KINOPT_CASES=10000 cargo test --release --test arm small_steps`.
#![allow(clippy::print_stdout)]

use kinopt::arm::{Arm, ArmBuilder, Search};
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot};
use support::path_steps::largest_difference;
use support::random::{Random, case_count, cases};
use support::shipped_arms::{SHIPPED_ARMS, matrix_placement, numbers, recorded};

/// Largest joint displacement that a reachable target is taken from, radians or metres.
const JOINT_STEP: f64 = 5e-3;
/// Interval at which `Nearest` and `solve_all` solve as well.
const COMPARISON_INTERVAL: usize = 10;

/// One arm per search.
struct Searches {
    start: Arm,
    first_attempt: Arm,
    nearest: Arm,
}

impl Searches {
    fn of(builder: &ArmBuilder<'_>) -> Self {
        let start = builder.clone().build().unwrap();
        let search = |search| start.with_search(search).unwrap();
        Self {
            first_attempt: builder.clone().with_attempts(1).build().unwrap(),
            nearest: search(Search::Nearest),
            start,
        }
    }

    /// Solves one step by every search. True if the first attempt reaches the target.
    fn check(&self, target: Placement<f64>, start: &[f64], compares: bool, case: &str) -> bool {
        let first = self.first_attempt.solve(target, start).unwrap();
        if !first.reached {
            return false;
        }
        let found = self.start.solve(target, start).unwrap();
        assert_eq!(found.q, first.q, "{case}: from {start:?}");
        if compares {
            let farthest = distance(&first.q, start) + 1e-9;
            let nearest = self.nearest.solve(target, start).unwrap();
            assert!(nearest.reached, "{case}: from {start:?}");
            let apart = distance(&nearest.q, start);
            assert!(apart <= farthest, "{case}: from {start:?}, {apart}");
        }
        true
    }
}

/// Random configuration with `count` joints on one of their limits.
fn on_limits(arm: &Arm, count: usize, random: &mut Random) -> Vec<f64> {
    let mut q = random.configuration(arm);
    let limits: Vec<_> = arm.limits().collect();
    let mut joints: Vec<usize> = (0..q.len()).collect();
    for _ in 0..count {
        let joint = joints.remove((random.unit() * joints.len() as f64) as usize);
        let limit = match random.unit() < 0.5 {
            true => limits[joint].lower,
            false => limits[joint].upper,
        };
        if limit.is_finite() {
            q[joint] = limit;
        }
    }
    q
}

/// Pose after a small step of all joints.
fn joint_step(arm: &Arm, start: &[f64], random: &mut Random) -> Placement<f64> {
    let moved = start.iter().zip(arm.limits());
    let moved = moved.map(|(q, limits)| limits.clamp(q + JOINT_STEP * (2.0 * random.unit() - 1.0)));
    arm.base_from_tool(&moved.collect::<Vec<_>>()).unwrap()
}

/// Pose of the tool after a translation by 2 to 5 mm, possibly unreachable.
fn tool_step(arm: &Arm, start: &[f64], random: &mut Random) -> Placement<f64> {
    let tool_pose = arm.base_from_tool(start).unwrap();
    let mut aside = || 2.0 * random.unit() - 1.0;
    let aside = Vector3::new(aside(), aside(), aside());
    let metres = 2e-3 + 3e-3 * random.unit();
    let offset = aside * (metres / aside.norm());
    Placement::new(tool_pose.rotation, tool_pose.translation + offset)
}

#[test]
fn recorded_steps_from_limits_stay_near() {
    let cases = recorded("starts_on_limits.json");
    for (file, case) in cases.as_object().unwrap() {
        let robot = robot(file.strip_suffix(".urdf").unwrap());
        let frame = |name: &str| case[name].as_str().unwrap();
        let searches = Searches::of(&Arm::builder(&robot, frame("base"), frame("tip")));
        let (start, target) = (numbers(&case["start"]), matrix_placement(&case["target"]));
        assert!(searches.check(target, &start, true, file), "{file}");
        let arms = [&searches.first_attempt, &searches.start, &searches.nearest];
        for arm in arms {
            let moved = largest_difference(&arm.solve(target, &start).unwrap().q, &start);
            assert!(moved < 5e-3, "{file}: {moved}");
        }
    }
}

#[test]
fn small_steps_from_limits_return_the_first_attempt() {
    let cases = case_count(200, 30);
    for [model, base, tip] in SHIPPED_ARMS {
        let robot = robot(model);
        let searches = Searches::of(&Arm::builder(&robot, base, tip));
        let arm = &searches.start;
        let (mut random, mut missed, mut shifts) = (Random::split_mix(49), 0, 0);
        for case in 0..cases {
            let on_limits = on_limits(arm, [1, 3][case % 2], &mut random);
            let name = format!("{model} {tip} {case}");
            let compares = case % COMPARISON_INTERVAL < 2;
            let target = joint_step(arm, &on_limits, &mut random);
            missed += usize::from(!searches.check(target, &on_limits, compares, &name));
            let target = tool_step(arm, &on_limits, &mut random);
            shifts += usize::from(searches.check(target, &on_limits, false, &name));
        }
        println!(
            "{model} {base} {tip}: the first attempt misses {missed} of {cases} steps of the joints, and \
             reaches {shifts} of {cases} shifts of the tool"
        );
        assert!(missed * 1000 <= cases, "{model} {tip}: {missed}");
    }
}

/// Batches equal single solves.
#[test]
fn batch_steps_from_limits_return_the_first_attempt() {
    for model in ["franka_panda", "universal_ur10e"] {
        let robot = robot(model);
        let searches = Searches::of(&Arm::builder(&robot, "base", "flange"));
        let arm = &searches.start;
        let mut random = Random::split_mix(50);
        let (mut targets, mut starts) = (Vec::new(), Vec::new());
        for case in cases(2000, 400) {
            let start = on_limits(arm, [1, 3][case % 2], &mut random);
            targets.push(joint_step(arm, &start, &mut random));
            starts.extend(start);
        }
        let batch = arm.solve_batch(&targets, &starts).unwrap();
        let steps = targets.iter().zip(starts.chunks(arm.joint_count()));
        for ((target, start), found) in steps.zip(batch) {
            let first = searches.first_attempt.solve(*target, start).unwrap();
            assert!(first.reached);
            assert_eq!(found.q, first.q, "{model}: from {start:?}");
        }
    }
}

/// Also with a posture or with move limits.
#[test]
fn steps_with_other_options_return_the_first_attempt() {
    let robot = robot("universal_ur10e");
    let builder = Arm::builder(&robot, "base", "flange").with_atlas(false);
    let posture = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    for builder in [
        builder.clone().with_posture(&posture),
        builder.clone().with_max_move(&[3.0; 6]),
        builder.clone().with_iterations(5000),
    ] {
        let searches = Searches::of(&Arm::builder(&robot, "base", "flange").with_atlas(false));
        let arm = builder.clone().build().unwrap();
        let first = builder.with_attempts(1).build().unwrap();
        let mut random = Random::split_mix(51);
        for _ in cases(400, 200) {
            let start = on_limits(&searches.start, 3, &mut random);
            let target = joint_step(&arm, &start, &mut random);
            let first = first.solve(target, &start).unwrap();
            assert!(first.reached);
            assert_eq!(arm.solve(target, &start).unwrap().q, first.q, "{start:?}");
        }
    }
}

/// Random targets: the nearest solution is no farther than the first attempt's.
#[test]
fn nearest_random_targets_beat_the_first_attempt() {
    for [model, base, tip] in SHIPPED_ARMS {
        let robot = robot(model);
        let searches = Searches::of(&Arm::builder(&robot, base, tip).with_atlas(false));
        let mut random = Random::split_mix(52);
        let mut reached = 0;
        for case in cases(60, 12) {
            let start = random.configuration(&searches.start);
            let target_q = random.configuration(&searches.start);
            let target = searches.start.base_from_tool(&target_q).unwrap();
            let first = searches.first_attempt.solve(target, &start).unwrap();
            if first.reached {
                reached += 1;
                let nearest = searches.nearest.solve(target, &start).unwrap();
                let [apart, first] = [&nearest, &first].map(|found| distance(&found.q, &start));
                assert!(
                    nearest.reached && apart <= first + 1e-9,
                    "{model} {tip} {case}: {apart}, the first attempt {first}"
                );
            }
        }
        assert!(reached > 0, "{model} {tip}");
    }
}
