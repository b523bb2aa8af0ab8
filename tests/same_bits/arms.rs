//! Promise: so it is for arms and for the lane engine under all their options: which attempt wins, after how
//! many steps, and where the answer stands. What follows and what misses has promises of its own.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use kinopt::arm::{Arm, ArmBuilder, Axis, PoseBounds, Search};
use kinopt::robot::Robot;
use kinopt::simd_ik::{
    AxisGoal, Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;

use crate::digest::{Digest, Value, check};
use support::random::Random;

impl Digest {
    fn outcome(&mut self, outcome: &PoseOutcome) {
        self.doubles([outcome.position_error, outcome.orientation_error]);
        self.word(outcome.iterations.into());
        self.word(outcome.attempts.into());
        self.word(outcome.winner.map_or(u64::MAX, u64::from));
    }
}

/// A rotation by products and roots only, of numbers within 0 and 1.
pub(crate) fn turned(mut random: impl FnMut() -> f64) -> Matrix3<f64> {
    let mut unit = || {
        let v = [(); 3].map(|()| 2.0 * random() - 1.0);
        let v = Vector3::from(v);
        v * v.norm().recip()
    };
    let (x, other) = (unit(), unit());
    let z = x.cross(other);
    let z = z * z.norm().recip();
    Matrix3::from_columns(x, z.cross(x), z)
}

/// Chains of odd placements and axes: turning joints with and without ends, wide ones, slides.
pub(crate) fn odd_chain(random: &mut Random, joints: usize, slides: usize) -> Chain {
    let between = |random: &mut Random, low: f64, high: f64| low + (high - low) * random.unit();
    let list = (0..joints).map(|i| {
        let place = Vector3::from([(); 3].map(|()| between(random, -0.3, 0.3)));
        let axis = [(); 3].map(|()| between(random, -2.0, 2.0));
        let (kind, lower, upper) = match i % 4 {
            1 if i / 3 < slides => (JointKind::Prismatic, -0.3, between(random, 0.2, 0.5)),
            0 => (JointKind::Revolute, f64::NEG_INFINITY, f64::INFINITY),
            2 => (JointKind::Revolute, -2.0 * PI, between(random, 3.0, 7.0)),
            _ => (
                JointKind::Revolute,
                between(random, -3.0, -1.0),
                between(random, 1.0, 3.0),
            ),
        };
        ChainJoint {
            parent_from_joint: Placement::new(turned(|| random.unit()), place),
            axis: axis.into(),
            kind,
            lower,
            upper,
        }
    });
    let list = list.collect();
    Chain::new(
        list,
        Placement::new(turned(|| random.unit()), [0.02, -0.05, 0.1].into()),
    )
    .unwrap()
}

/// Every way to ask the engine, for chains of every shape.
fn lanes() -> [Value; 2] {
    let (mut plain, mut weighted, mut random) =
        (Digest::new(), Digest::new(), Random::split_mix(21));
    let shapes = [(2, 0), (4, 1), (6, 0), (6, 2), (7, 0), (8, 2)];
    for (shape, (joints, slides)) in shapes.into_iter().enumerate() {
        let chain = odd_chain(&mut random, joints, slides);
        let draw = |random: &mut Random| -> Vec<f64> {
            let ends = chain
                .joints()
                .iter()
                .map(|j| (j.lower.max(-4.0), j.upper.min(4.0)));
            ends.map(|(low, high)| low + (high - low) * random.unit())
                .collect()
        };
        let mut free = AxisGoal::full_pose();
        free.orientation_weights[shape % 3] = 0.0;
        free.position_weights[(shape + 1) % 3] = 0.5;
        free.position_half_widths[shape % 3] = 0.02;
        free.orientation_half_widths[(shape + 1) % 3] = 0.1;
        for axes in [AxisGoal::full_pose(), free, AxisGoal::position_only()] {
            let digest = if axes.is_full_pose() {
                &mut plain
            } else {
                &mut weighted
            };
            // The smallest atlas, which is soon made.
            let options = LaneOptions::default()
                .with_attempts(12)
                .with_iterations(30)
                .with_total_iterations(160)
                .with_metres_per_radian(0.3)
                .with_seed(5)
                .with_atlas(joints == 4)
                .with_axes(axes);
            let solver = PoseSolver::new(&chain, options).unwrap();
            let targets: Vec<_> = (0..6)
                .map(|_| chain.base_from_tip(&draw(&mut random)).unwrap())
                .collect();
            let starts: Vec<f64> = (0..6).flat_map(|_| draw(&mut random)).collect();
            let (mut q, mut outcomes) = (vec![0.0; 6 * joints], vec![PoseOutcome::default(); 6]);
            for search in [Prefer::Start, Prefer::First] {
                for (target, start) in targets.iter().zip(starts.chunks(joints)).take(3) {
                    let q = &mut q[..joints];
                    digest.outcome(&solver.solve(target, start, search, None, q).unwrap());
                    digest.doubles(q.iter().copied());
                }
                solver
                    .solve_batch(&targets, &starts, search, &mut q, &mut outcomes)
                    .unwrap();
                digest.doubles(q.iter().copied());
                outcomes.iter().for_each(|outcome| digest.outcome(outcome));
            }
            let start = &starts[..joints];
            let search = Prefer::Start;
            solver
                .run_attempts(&targets[0], start, search, 3, &mut q, &mut outcomes)
                .unwrap();
            digest.doubles(q.iter().copied());
            outcomes.iter().for_each(|outcome| digest.outcome(outcome));
            solver
                .track(&targets, start, &mut q, &mut outcomes)
                .unwrap();
            digest.doubles(q.iter().copied());
        }
    }
    [plain.value(), weighted.value()]
}

/// What an arm answers to poses within reach.
fn reached(digest: &mut Digest, arm: &Arm, random: &mut Random, count: usize) {
    let mut draw = || random.configuration(arm);
    let targets: Vec<_> = (0..count)
        .map(|_| arm.base_from_tool(&draw()).unwrap())
        .collect();
    let starts: Vec<f64> = (0..count).flat_map(|_| draw()).collect();
    let mut all = arm.solve_batch(&targets, &starts).unwrap();
    for (target, start) in targets.iter().zip(starts.chunks(arm.joint_count())) {
        all.push(arm.solve(target, start).unwrap());
    }
    all.extend(
        arm.solve_all(targets[0], &starts[..arm.joint_count()])
            .unwrap(),
    );
    for solution in all {
        // What is missed has promises of its own.
        digest.word(solution.reached.into());
        if solution.reached {
            digest.solution(&solution);
        }
    }
}

fn built(builder: ArmBuilder<'_>) -> Arm {
    builder.build().unwrap()
}

/// Of robots with six and seven joints, under every search and option.
fn options() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(22));
    let [iiwa, cobra] = ["kuka_iiwa14", "adept_cobra_s600"].map(robot);
    let builder = || Arm::builder(&iiwa, "base", "flange").with_atlas(false);
    let distinct = Search::Distinct {
        k: 4,
        distance: 0.4,
    };
    let weights = [1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.7];
    let arms = [
        builder().with_search(Search::Nearest).with_attempts(16),
        builder()
            .with_search(Search::Nearest)
            .with_attempts(20)
            .with_joint_weights(&weights),
        builder()
            .with_search(distinct)
            .with_attempts(16)
            .with_iterations(600),
        builder()
            .with_posture(&[0.3; 7])
            .with_joint_weights(&weights),
        builder().with_max_move(&[0.9; 7]).with_seed(3),
        builder().with_goal(PoseBounds::within([0.01, 0.0, 0.2, 0.2, 0.0, 0.3])),
        builder()
            .with_goal(PoseBounds::free_about(Axis::Z))
            .with_search(Search::Nearest)
            .with_attempts(16),
        builder()
            .with_goal(PoseBounds::position())
            .with_metres_per_radian(0.1),
        builder().with_locked(iiwa.model().joints()[2].name.as_str(), 0.4),
    ];
    for arm in arms {
        reached(&mut digest, &built(arm), &mut random, 2);
    }
    let ur = robot("universal_ur5e");
    let builder = || Arm::builder(&ur, "base", "flange").with_atlas(false);
    let room = PoseBounds::within([0.05, 0.0, 0.02, 0.2, 0.1, 0.3]);
    let loose = builder()
        .with_position_tolerance(1e-6)
        .with_orientation_tolerance(0.6);
    for arm in [
        builder()
            .with_goal(room)
            .with_search(Search::Nearest)
            .with_attempts(16),
        loose,
        builder()
            .with_position_tolerance(0.1)
            .with_orientation_tolerance(1e-5),
    ] {
        reached(&mut digest, &built(arm), &mut random, 3);
    }
    let bounded = Arm::builder(&cobra, "base", "flange").with_max_move(&[0.6, 0.6, 0.2, 0.9]);
    reached(&mut digest, &built(bounded), &mut random, 6);
    digest.value()
}

/// With an atlas, of turning joints and with a slide, and what shares it.
fn atlases() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(23));
    let robots: [(Robot, &str); 2] = [
        (robot("adept_cobra_s600"), "flange"),
        (robot("universal_ur5e"), "flange"),
    ];
    for (robot, tip) in &robots {
        let arm = built(Arm::builder(robot, "base", tip).with_search(Search::First));
        reached(&mut digest, &arm, &mut random, 10);
        let tool = Placement::new(turned(|| random.unit()), [0.03, -0.02, 0.11].into());
        let tooled = arm.with_tool(tool).unwrap();
        reached(&mut digest, &tooled, &mut random, 6);
        // So long that lengths are counted in another unit.
        let long = Placement::new(turned(|| random.unit()), [0.4, -0.9, 1.3].into());
        reached(&mut digest, &arm.with_tool(long).unwrap(), &mut random, 4);
        reached(
            &mut digest,
            &tooled.with_goal(PoseBounds::free_about(Axis::Z)).unwrap(),
            &mut random,
            4,
        );
    }
    digest.value()
}

/// Legs whose joints follow one another go through the core.
fn followers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(24));
    let nao = robot("aldebaran_nao");
    let builder = Arm::builder(&nao, "left_sole", "right_sole");
    reached(&mut digest, &built(builder.with_seed(2)), &mut random, 3);
    let builder = Arm::builder(&nao, "torso", "left_hand");
    let nearest = builder
        .with_goal(PoseBounds::position())
        .with_search(Search::Nearest);
    reached(
        &mut digest,
        &built(nearest.with_attempts(8)),
        &mut random,
        2,
    );
    digest.value()
}

#[test]
fn of_the_engine() {
    let [plain, weighted] = lanes();
    check(&[
        ("lane engine, chains of every shape, counted", plain),
        ("lane engine, goals that leave room, counted", weighted),
    ]);
}

#[test]
fn of_arms_under_options() {
    check(&[("arms under every option, counted", options())]);
}

#[test]
fn of_arms_with_an_atlas() {
    check(&[("arms with an atlas, counted", atlases())]);
}

#[test]
fn of_arms_whose_joints_follow() {
    check(&[("arms whose joints follow, counted", followers())]);
}
