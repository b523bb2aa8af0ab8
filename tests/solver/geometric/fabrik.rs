//! Promise: FABRIK keeps every length, reaches reachable targets, and detects unreachable ones in advance.

use std::ops::ControlFlow;

use kinopt::Problem;
use kinopt::geometric::{Fabrik, Geometric, Span, fabrik};
use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::Model;
use kinopt::solver::{Iteration, Termination};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity, Task};
use nalgebra as na;
use support::bones::humanoid;
use support::random::Random;
use support::{planar_arm, vector};

/// The lecture's demo: joints at 0, 2, 3.5 and 4.5 on x, target (3, 3), tolerance 0.001. Its listing in plain Python
/// makes 14 passes and ends here.
const DEMO: [[f64; 2]; 4] = [
    [0.0, 0.0],
    [1.808_501_001_284_189_1, 0.854_004_758_976_251_4],
    [2.732_758_442_009_802_6, 2.035_422_628_852_672_3],
    [2.999_756_134_851_218, 2.999_119_797_063_392_5],
];

fn on_x(at: &[f64]) -> Vec<Vector3<f64>> {
    at.iter().map(|&x| Vector3::new(x, 0.0, 0.0)).collect()
}

fn lengths(points: &[Vector3<f64>]) -> Vec<f64> {
    points.windows(2).map(|p| (p[1] - p[0]).norm()).collect()
}

#[test]
fn lecture_demo_is_reproduced() {
    let mut points = on_x(&[0.0, 2.0, 3.5, 4.5]);
    let done = fabrik(&mut points, Vector3::new(3.0, 3.0, 0.0), 1e-3, 50);
    assert_eq!((done.passes, done.span), (14, Span::Within));
    assert!((done.miss - 0.000_913_360_509_548_685_4).abs() < 1e-12);
    for (ours, [x, y]) in points.iter().zip(DEMO) {
        assert!((*ours - Vector3::new(x, y, 0.0)).norm() < 1e-12);
    }
}

/// The same chain as a model: the joints match the points exactly in every pass.
#[test]
fn lecture_demo_on_a_model_is_reproduced() {
    let model = planar_arm(&[2.0, 1.5, 1.0], Some((-3.0, 3.0)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Task::new(Point::new(tip, [3.0, 3.0, 0.0])).tolerance(Quantity::Metres, 1e-3));
    let problem = builder.build().unwrap();
    let solution = Fabrik::default().solve(&problem, &[0.0; 3]).unwrap();
    assert!(solution.reached);
    assert_eq!((solution.iterations, solution.attempts), (14, 1));
    let mut angle = 0.0;
    let mut at = na::Vector2::zeros();
    for ((turn, link), [x, y]) in solution.q.iter().zip([2.0, 1.5, 1.0]).zip(&DEMO[1..]) {
        angle += turn;
        at += na::Vector2::new(f64::cos(angle), f64::sin(angle)) * link;
        assert!((at - na::Vector2::new(*x, *y)).norm() < 1e-9);
    }
}

/// The lecture's test compares with the total length only, and uses all its passes here.
#[test]
fn too_near_target_is_detected_at_once() {
    let mut points = on_x(&[0.0, 2.0, 2.5, 3.0]);
    let done = fabrik(&mut points, Vector3::new(0.0, 0.4, 0.0), 1e-9, 50);
    assert_eq!(done.passes, 0);
    assert!(matches!(done.span, Span::TooNear(by) if (by - 0.6).abs() < 1e-12));
    // The tip is as near as possible: at 1 from the root, towards the target.
    assert!((points[3] - Vector3::new(0.0, 1.0, 0.0)).norm() < 1e-12);
    assert!((done.miss - 0.6).abs() < 1e-12);
}

#[test]
fn chains_keep_lengths_and_reach_targets() {
    let mut random = Random::new(7);
    let mut seen = [0; 3];
    for k in 0..300 {
        let root = random.vector(1.0);
        let mut points = vec![vector(root)];
        for _ in 0..5 {
            let last: na::Vector3<f64> = (*points.last().unwrap()).into();
            let length = if random.below(4) == 0 {
                2.0
            } else {
                random.within(0.1, 0.6)
            };
            points.push(vector(last + random.direction().into_inner() * length));
        }
        let before = lengths(&points);
        let distance = random.within(0.0, 1.3) * before.iter().sum::<f64>();
        let target = root + random.direction().into_inner() * distance;
        let done = fabrik(&mut points, vector(target), 1e-9, 5000);
        for (now, was) in lengths(&points).iter().zip(&before) {
            assert!((now - was).abs() < 1e-12, "chain {k}");
        }
        assert!((points[0] - vector(root)).norm() == 0.0);
        // Bounds of the triangle inequality for a chain.
        let total: f64 = before.iter().sum();
        let longest = before.iter().copied().fold(0.0, f64::max);
        let nearest = (2.0 * longest - total).max(0.0);
        let least = (distance - total).max(nearest - distance).max(0.0);
        assert!(done.miss >= least - 1e-9, "chain {k}");
        assert!(
            done.miss <= least + 1e-8,
            "chain {k}: {} for {least}",
            done.miss
        );
        seen[match done.span {
            Span::Within => 0,
            Span::TooFar(_) => 1,
            Span::TooNear(_) => 2,
        }] += 1;
    }
    assert!(seen.iter().all(|&count| count > 10), "{seen:?}");
}

/// Five bones in space, random targets: the points between passes are the complete state, and each pass comes nearer.
#[test]
fn passes_can_be_observed() {
    let mut random = Random::new(11);
    for k in 0..100 {
        let mut start = vec![Vector3::zero()];
        for _ in 0..5 {
            let last: na::Vector3<f64> = start[start.len() - 1].into();
            let length = random.within(0.3, 1.0);
            start.push(vector(last + random.direction().into_inner() * length));
        }
        let total: f64 = lengths(&start).iter().sum();
        let target = vector(random.direction().into_inner() * random.within(0.2, 0.95) * total);
        let mut at_once = start.clone();
        let done = fabrik(&mut at_once, target, 1e-4, 1000);
        let mut points = start.clone();
        let mut miss = (points[5] - target).norm();
        let mut passes = 0;
        while miss > 1e-4 && passes < 1000 {
            let one = fabrik(&mut points, target, 1e-4, 1);
            assert!(one.passes == 1 && one.miss < miss, "chain {k}: {miss}");
            (miss, passes) = (one.miss, passes + 1);
        }
        assert_eq!(passes, done.passes, "chain {k}");
        for (watched, expected) in points.iter().zip(&at_once) {
            assert!((*watched - *expected).norm() < 1e-9, "chain {k}");
        }
    }
}

#[test]
fn degenerate_chains_are_unchanged() {
    let target = Vector3::new(1.0, 2.0, 3.0);
    for count in 0..2 {
        let mut points = on_x(&[0.0, 1.0][..count]);
        let before = points.clone();
        assert_eq!(fabrik(&mut points, target, 1e-6, 10).passes, 0);
        assert_eq!(points, before);
    }
    // All points coincide with the target.
    let mut points = vec![target; 4];
    assert_eq!(fabrik(&mut points, target, 1e-6, 10).miss, 0.0);
}

#[test]
fn unreachable_target_stretches_or_folds() {
    let links = [1.6, 0.5, 0.3];
    let model = planar_arm(&links, None);
    let tip = model.frame("tip").unwrap();
    let mut kinematics = ForwardKinematics::of_frames(&model, &[tip]).unwrap();
    for (distance, miss) in [(4.0, 1.6), (2.4 + 1e-3, 1e-3), (0.5, 0.3), (0.01, 0.79)] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [0.0, -distance, 0.0]));
        let solver = Fabrik::default().with_restarts(Restarts::none());
        let solution = solver
            .solve(&builder.build().unwrap(), &[0.3, 0.4, 0.5])
            .unwrap();
        assert!(!solution.reached);
        assert_ne!(solution.termination, Termination::Reached);
        let at = kinematics.place(&solution.q).unwrap()[0].translation;
        let missed = (at - Vector3::new(0.0, -distance, 0.0)).norm();
        assert!(
            (missed - miss).abs() < 1e-9,
            "{missed} for {miss}, {:?}",
            solution.q
        );
        assert!((solution.cost - 0.5 * miss * miss).abs() < 1e-9);
        assert_eq!(solution.active_limits().count(), 0);
    }
}

/// Links beyond a pinned frame do not affect the test of its reach.
#[test]
fn frame_in_mid_chain_ignores_later_links() {
    let mut builder = Model::builder("long forearm");
    let about_z = Vector3::new(0.0, 0.0, 1.0);
    let along_x = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    let mut parent = None;
    let mut joints = Vec::new();
    for (joint, from_last) in [0.0, 1.0, 1.0, 5.0].into_iter().enumerate() {
        let name = format!("joint {joint}");
        parent = Some(builder.continuous(name, parent, along_x(from_last), about_z));
        joints.push(parent);
    }
    let elbow = builder.frame("elbow", joints[1], along_x(1.0));
    builder.frame("tip", parent, along_x(1.0));
    let model = builder.build().unwrap();
    let mut problem = Problem::builder(&model);
    problem.add(Point::new(elbow, [0.0, 1.0, 0.0]));
    let solver = Fabrik::default().with_restarts(Restarts::none());
    let solution = solver
        .solve(&problem.build().unwrap(), &[0.1, 0.2, 0.3, 0.4])
        .unwrap();
    assert!(solution.reached, "{}", solution.explain());
}

/// The left hand of the shipped humanoid with targets from random poses within limits: at least nine of ten with
/// restarts.
#[test]
fn hand_of_the_humanoid_is_reached() {
    let rig = humanoid();
    let (skeleton, model) = (&rig.skeleton, rig.skeleton.model());
    let hand = skeleton.bone("left_hand").unwrap();
    let mut reached = 0;
    for seed in 0..10 {
        let pose = skeleton.pose(&model.random_configuration(seed)).unwrap();
        let target = pose.tip(skeleton, hand).unwrap();
        let mut builder = Problem::builder(model);
        builder.tolerance(Quantity::Metres, 1e-6);
        builder.add(Point::new(skeleton.tip(hand), target));
        let problem = builder.build().unwrap();
        let solution = Fabrik::default().solve(&problem, &model.neutral()).unwrap();
        let missed = (skeleton
            .pose(&solution.q)
            .unwrap()
            .tip(skeleton, hand)
            .unwrap()
            - target)
            .norm();
        assert_eq!(solution.reached, missed <= 1e-6);
        reached += usize::from(solution.reached);
    }
    assert!(reached >= 9, "{reached} of 10");
}

/// Five tips at once: limits prevent convergence, but the error is at least halved.
#[test]
fn five_tips_of_the_humanoid_come_nearer() {
    let rig = humanoid();
    let (skeleton, model) = (&rig.skeleton, rig.skeleton.model());
    let neutral = model.neutral();
    let tips = &rig.constrained;
    for seed in 0..5 {
        let random_q = model.random_configuration(seed);
        let goal = random_q
            .iter()
            .zip(&neutral)
            .map(|(f, n)| n + 0.3 * (f - n));
        let pose = skeleton.pose(&goal.collect::<Vec<f64>>()).unwrap();
        let mut builder = Problem::builder(model);
        for &tip in tips {
            builder.add(Point::new(
                skeleton.tip(tip),
                pose.tip(skeleton, tip).unwrap(),
            ));
        }
        let solver = Fabrik::default().with_restarts(Restarts::none());
        let solution = solver.solve(&builder.build().unwrap(), &neutral).unwrap();
        let missed = |q: &[f64]| {
            let at = skeleton.pose(q).unwrap();
            let misses = tips
                .iter()
                .map(|&t| at.tip(skeleton, t).unwrap() - pose.tip(skeleton, t).unwrap());
            misses.map(|miss| miss.norm_squared()).sum::<f64>().sqrt()
        };
        assert!(missed(&solution.q) < 0.5 * missed(&neutral), "{seed}");
    }
}

/// Two hands on one trunk: one slightly off its target, and another with a large weight on its target. Both are within
/// tolerance a few passes later, at a higher cost than at first. The first such iterate is returned.
#[test]
fn success_with_a_higher_cost_is_returned() {
    let mut builder = Model::builder("fork");
    let (origin, z) = (Placement::identity(), Vector3::UNITS[2]);
    let link = Placement::translation(Vector3::UNITS[0]);
    let trunk = builder.continuous("trunk", None, origin, z);
    let tips = ["left", "right"].map(|name| {
        let elbow = builder.continuous(name, Some(trunk), link, z);
        builder.frame(format!("{name} hand"), Some(elbow), link)
    });
    let model = builder.build().unwrap();
    let start = [0.0, 0.7, -0.7];
    let mut kinematics = ForwardKinematics::<f64>::new(&model);
    let mut hands = |q: &[f64]| {
        let placed = kinematics.place(q).unwrap();
        tips.map(|tip| placed[tip.index()].translation)
    };
    let mut aims = hands(&start);
    aims[0] += Vector3::new(0.008, 0.008, 0.0);
    let (near, much) = (0.01, 100.0);
    let mut tasks = Problem::builder(&model);
    for ((tip, aim), weight) in tips.into_iter().zip(aims).zip([1.0, much]) {
        let task = Task::new(Point::new(tip, aim)).scale(weight);
        tasks.add(task.tolerance(Quantity::Metres, near));
    }
    let problem = tasks.build().unwrap();
    let mut costs = Vec::new();
    let mut arrived = None;
    let mut watch = |seen: &Iteration<'_>| {
        let is_near = hands(seen.x)
            .iter()
            .zip(aims)
            .all(|(a, b)| (*a - b).norm() <= near);
        arrived = arrived.or(is_near.then_some(seen.index));
        costs.push(seen.cost);
        ControlFlow::Continue(())
    };
    let bare = Fabrik::default().with_restarts(Restarts::none());
    let solution = bare.solve_observed(&problem, &start, &mut watch).unwrap();
    assert!(solution.reached);
    assert_eq!(Some(solution.iterations), arrived);
    assert_eq!(costs.len(), solution.iterations + 1);
    assert!(costs[solution.iterations] > costs[0]);
}

/// A joint that several bones share moves to the mean of their positions, for any placement of the skeleton. A few
/// passes give equal angles here and five metres away.
#[test]
fn placed_skeleton_bends_equally() {
    let rig = humanoid();
    let displacement = Vector3::new(3.0, -4.0, 1.0);
    let placement = kinopt::spatial::Placement::translation(displacement);
    let bent = |skeleton: &kinopt::Skeleton, shift: Vector3<f64>| {
        let mut builder = Problem::builder(skeleton.model());
        for (name, at) in [
            ("left_hand", [0.35, 0.45, 1.5]),
            ("right_hand", [0.2, -0.3, 1.7]),
            ("head", [0.1, 0.05, 1.6]),
        ] {
            let bone = skeleton.bone(name).unwrap();
            let at = Vector3::from(at) + shift;
            builder.add(Point::new(skeleton.tip(bone), at));
        }
        let stopping = kinopt::solver::Stopping::default().with_max_iterations(2);
        let solver = Fabrik::default().with_stopping(stopping);
        let solver = solver.with_restarts(Restarts::none());
        let problem = builder.build().unwrap();
        solver
            .solve(&problem, &skeleton.model().neutral())
            .unwrap()
            .q
    };
    let original_q = bent(&rig.skeleton, Vector3::zero());
    let placed_q = bent(&rig.skeleton.placed(placement).unwrap(), displacement);
    for (a, b) in original_q.iter().zip(&placed_q) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}
