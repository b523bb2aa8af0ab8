//! Promise: every reachable pose is solved, on arms of all sizes and kinds.

use kinopt::simd_ik::{
    AxisGoal, Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::{Matrix3, Placement};
use support::random::Random;
use support::simd_chains::{errors, panda, planar, random_chain, target, tip, ur5, within_bounds};

fn all_solved(chain: &Chain, options: LaneOptions, seed: u64, count: usize) {
    let solver = PoseSolver::new(chain, options).unwrap();
    let n = solver.joints();
    let mut random = Random::split_mix(seed);
    let goals: Vec<_> = (0..count)
        .map(|_| target(chain, &random.chain_configuration(chain)))
        .collect();
    let starts: Vec<f64> = (0..count)
        .flat_map(|_| random.chain_configuration(chain))
        .collect();
    let mut q = vec![0.0; n * count];
    let mut outcomes = vec![PoseOutcome::default(); count];
    for search in [Prefer::First, Prefer::Start] {
        solver
            .solve_batch(&goals, &starts, search, &mut q, &mut outcomes)
            .unwrap();
        for (q, goal) in q.chunks(n).zip(&goals) {
            let (position, orientation) = errors(chain, q, goal);
            assert!(
                position <= 1e-6 && orientation <= 1e-6,
                "{position} {orientation}"
            );
            assert!(within_bounds(chain, q));
        }
        let mut one = vec![0.0; n];
        for (goal, start) in goals.iter().zip(starts.chunks(n)).take(count / 2) {
            assert!(
                solver
                    .solve(goal, start, search, None, &mut one)
                    .unwrap()
                    .reached
            );
            let (position, orientation) = errors(chain, &one, goal);
            assert!(
                position <= 1e-6 && orientation <= 1e-6,
                "{position} {orientation}"
            );
        }
    }
}

fn without_atlas() -> LaneOptions {
    LaneOptions::default().with_atlas(false).with_attempts(1000)
}

#[test]
fn known_arms_are_solved() {
    all_solved(&panda(), LaneOptions::default(), 1, 200);
    all_solved(&ur5(), LaneOptions::default(), 2, 200);
}

/// Arm that rotates about the axis of the lift beneath it, or next to it. The atlas's four seeds for a goal suffice in
/// most cases, although the lift is too short to correct the height of a sample.
#[test]
fn arm_on_a_lift_is_solved_from_the_atlas() {
    for aside in [0.0, 0.12] {
        let mut joints = panda().joints().to_vec();
        joints[0].parent_from_joint.translation.x += aside;
        joints.insert(
            0,
            ChainJoint {
                parent_from_joint: Placement::identity(),
                axis: [0.0, 0.0, 1.0].into(),
                kind: JointKind::Prismatic,
                lower: 0.0,
                upper: 0.3,
            },
        );
        let chain = Chain::new(joints, Placement::identity()).unwrap();
        all_solved(&chain, LaneOptions::default(), 3, 60);

        let solver = PoseSolver::new(&chain, LaneOptions::default().with_attempts(4)).unwrap();
        let (mut random, mut reached) = (Random::split_mix(5), 0);
        for _ in 0..200 {
            let goal = target(&chain, &random.chain_configuration(&chain));
            let start = random.chain_configuration(&chain);
            let outcome = solver.solve(&goal, &start, Prefer::First, None, &mut [0.0; 8]);
            reached += usize::from(outcome.unwrap().reached);
        }
        assert!(reached >= 190, "{reached} of 200 from the atlas alone");
    }
}

#[test]
fn random_arms_of_six_to_ten_joints_are_solved() {
    for (seed, joints) in [(1, 6), (2, 7), (3, 8), (4, 10)] {
        all_solved(
            &random_chain(seed, joints, 0, false),
            without_atlas(),
            seed,
            20,
        );
    }
}

#[test]
fn random_arms_with_an_atlas_are_solved() {
    for (seed, joints, slides) in [(5, 6, 0), (6, 7, 1)] {
        all_solved(
            &random_chain(seed, joints, slides, false),
            LaneOptions::default(),
            seed,
            40,
        );
    }
}

#[test]
fn prismatic_and_unbounded_joints_are_solved() {
    for (seed, joints, slides) in [(7, 7, 2), (8, 8, 1), (9, 6, 0)] {
        all_solved(
            &random_chain(seed, joints, slides, true),
            without_atlas(),
            seed,
            20,
        );
    }
}

#[test]
fn thirty_two_joints_are_solved() {
    all_solved(&random_chain(10, 32, 2, true), without_atlas(), 10, 8);
}

#[test]
fn fewer_joints_than_components_are_solved() {
    for joints in 1..=5 {
        all_solved(
            &random_chain(20 + joints as u64, joints, 0, false),
            without_atlas(),
            3,
            12,
        );
    }
}

#[test]
fn planar_arm_reaches_positions() {
    let chain = planar();
    let options = without_atlas().with_axes(AxisGoal::position_only());
    let solver = PoseSolver::new(&chain, options).unwrap();
    let mut random = Random::split_mix(4);
    for _ in 0..30 {
        let truth = random.chain_configuration(&chain);
        let mut goal = target(&chain, &truth);
        goal.rotation = Matrix3::identity().rotated_about_x(1.0f64.sin_cos());
        let mut q = [0.0; 2];
        let start = random.chain_configuration(&chain);
        let outcome = solver
            .solve(&goal, &start, Prefer::Start, None, &mut q)
            .unwrap();
        let (position, _) = errors(&chain, &q, &goal);
        assert!(
            outcome.reached && position <= 1e-6,
            "{outcome:?} {position}"
        );
        assert!((outcome.position_error - position).abs() < 1e-12);
    }
}

/// The tool's z axis must have the target's direction; any rotation about it is accepted.
#[test]
fn free_rotation_about_the_tool_axis_is_used() {
    let chain = panda();
    let axes = AxisGoal {
        orientation_weights: [1.0, 1.0, 0.0],
        ..AxisGoal::full_pose()
    };
    let solver = PoseSolver::new(&chain, without_atlas().with_axes(axes)).unwrap();
    let mut random = Random::split_mix(5);
    let mut spun = 0;
    for _ in 0..30 {
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start = random.chain_configuration(&chain);
        let mut q = [0.0; 7];
        let outcome = solver
            .solve(&goal, &start, Prefer::Start, None, &mut q)
            .unwrap();
        let at = Placement::from(&tip(&chain, &q));
        assert!(outcome.reached, "{outcome:?}");
        assert!((at.translation - goal.translation).norm() <= 1e-6);
        assert!(at.rotation.z.cross(goal.rotation.z).norm() <= 1.1e-6);
        assert!(at.rotation.z.dot(goal.rotation.z) > 0.0);
        spun += usize::from(at.rotation.x.dot(goal.rotation.x) < 0.99);
    }
    assert!(spun > 15, "the freedom was not used: {spun}");
}

/// A position component may deviate by its half width, the others may not.
#[test]
fn position_half_width_bounds_one_component() {
    let chain = panda();
    let axes = AxisGoal {
        position_half_widths: [0.0, 0.0, 0.05],
        ..AxisGoal::full_pose()
    };
    let solver = PoseSolver::new(&chain, without_atlas().with_axes(axes)).unwrap();
    let mut random = Random::split_mix(6);
    for _ in 0..20 {
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start = random.chain_configuration(&chain);
        let mut q = [0.0; 7];
        let outcome = solver
            .solve(&goal, &start, Prefer::Start, None, &mut q)
            .unwrap();
        assert!(outcome.reached, "{outcome:?}");
        let at = goal.inverse() * Placement::from(&tip(&chain, &q));
        assert!(at.translation.x.hypot(at.translation.y) <= 1e-6);
        assert!(at.translation.z.abs() <= 0.05 + 1e-6);
    }
}

/// Whole turns are added towards the start.
#[test]
fn unbounded_joints_stay_near_the_start() {
    let chain = random_chain(9, 6, 0, true);
    let solver = PoseSolver::new(&chain, without_atlas()).unwrap();
    let mut random = Random::split_mix(7);
    let mut q = [0.0; 6];
    for _ in 0..10 {
        let truth = random.chain_configuration(&chain);
        let goal = target(&chain, &truth);
        let mut start = random.chain_configuration(&chain);
        start[0] += 40.0 * std::f64::consts::TAU;
        let outcome = solver
            .solve(&goal, &start, Prefer::First, None, &mut q)
            .unwrap();
        assert!(outcome.reached);
        assert!((q[0] - start[0]).abs() <= std::f64::consts::PI + 1e-9);
    }
}
