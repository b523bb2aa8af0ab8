//! Promise: a drag follows its targets on one branch. No joint jumps when a target becomes unreachable, enters limits
//! or returns. Only a requested search may jump, and the jump is reported. A frame that misses costs no more than a few
//! frames that reach.

use kinopt::Scalar;
use kinopt::ik::{Drag, Restarts};
use kinopt::model::{Limits, Model};
use kinopt::problem::{Problem, TaskId};
use kinopt::skeleton::Skeleton;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity, Task};
use support::bones::RandomRig;
use support::path_steps::largest_difference;
use support::planar_arm;
use support::random::{Random, case_count};
use support::tasks::{Curve, OfJoint};

/// Largest joint displacement in a frame, radians, with rounding.
const MAX_MOVE: f64 = 0.15 + 1e-12;
/// Largest number of evaluations in a frame: its steps, a perturbation's steps and the estimation of curvature.
const MAX_EVALUATIONS: usize = 400;

/// Drag of a rig's second tip with the other tips pinned.
fn drag(rig: &RandomRig, start: &[f64]) -> (Drag, TaskId<Point>, Vector3<f64>) {
    let (skeleton, size) = (&rig.skeleton, rig.skeleton.size());
    let mut builder = Problem::builder(skeleton.model());
    builder.tolerance(Quantity::Metres, 1e-6 * size);
    let pose = skeleton.pose(start).unwrap();
    let tasks: Vec<_> = (rig.tips.iter())
        .map(|&tip| {
            builder.add(Point::new(
                skeleton.tip(tip),
                pose.tip(skeleton, tip).unwrap(),
            ))
        })
        .collect();
    let from = pose.tip(skeleton, rig.tips[1]).unwrap();
    let drag = Drag::new(builder.build().unwrap(), start).unwrap();
    (drag, tasks[1], from)
}

/// Configuration with every bend slightly off zero.
fn slightly_bent(skeleton: &Skeleton) -> Vec<f64> {
    let limits = skeleton.model().limits().enumerate();
    limits
        .map(|(k, l)| l.clamp(if k % 3 == 1 { 0.3 } else { 0.0 }))
        .collect()
}

/// Active limits are the model's limits, whatever ended the frame. Bounds on the move of a frame are reported
/// separately.
#[test]
fn frame_reports_limits_of_the_model() {
    let rig = RandomRig::new(3);
    let start = slightly_bent(&rig.skeleton);
    let (drag, hand, from) = drag(&rig, &start);
    // Frames of one step end by the iteration limit.
    let once = kinopt::solver::Stopping::default().with_max_iterations(1);
    let mut drag = drag.with_solver(kinopt::Solver::default(), once).unwrap();
    let target = from + Vector3::new(0.7, 0.5, -0.6) * rig.skeleton.size();
    let model = rig.skeleton.model();
    let (mut limits_told, mut moves_told) = (0, 0);
    for _ in 0..40 {
        drag.target_mut(hand).unwrap().set_target(target);
        let solution = drag.advance();
        for held in solution.active_limits() {
            if held.kind == kinopt::ik::BoundKind::Move {
                moves_told += 1;
                continue;
            }
            limits_told += 1;
            let is_limit = |l: Limits| held.value == l.lower || held.value == l.upper;
            assert!(model.limits().any(is_limit), "{held:?}");
        }
    }
    assert!(limits_told + moves_told > 0);
}

#[test]
fn drag_beyond_reach_and_back_never_jumps() {
    // KINOPT_CASES sets the number of rigs.
    for seed in 0..case_count(4, 1) as u64 {
        let rig = RandomRig::new(seed);
        let start = slightly_bent(&rig.skeleton);
        let (mut drag, hand, from) = drag(&rig, &start);
        let size = rig.skeleton.size();
        let frames = 120;
        let (mut q, mut missed) = (drag.q().to_vec(), 0);
        for frame in 0..=frames {
            let turn = std::f64::consts::TAU * f64::from(frame) / f64::from(frames);
            let aside = Vector3::new((2.0 * turn).sin(), (3.0 * turn).sin(), turn.sin());
            drag.target_mut(hand)
                .unwrap()
                .set_target(from + aside * size);
            let solution = drag.advance();
            assert!(
                largest_difference(&solution.q, &q) <= MAX_MOVE,
                "{seed}, frame {frame}"
            );
            assert!(
                solution.counts.residuals <= MAX_EVALUATIONS,
                "{:?}",
                solution.counts
            );
            for (value, limits) in solution.q.iter().zip(rig.skeleton.model().limits()) {
                assert!(limits.contains(*value));
            }
            missed += usize::from(!solution.reached);
            q.copy_from_slice(&solution.q);
            assert_eq!(drag.jump(), None);
            assert_eq!(drag.q(), q);
        }
        assert!(missed > 30, "{seed}: only {missed} frames out of reach");
        // Back at its initial position: the following frames catch up.
        let mut frames = 0;
        while !drag.advance().reached {
            frames += 1;
            assert!(frames < 60, "{seed}: {}", drag.solution().explain());
        }
    }
}

#[test]
fn drag_rests_at_unreachable_target() {
    let rig = RandomRig::new(2);
    let (mut drag, hand, from) = drag(&rig, &slightly_bent(&rig.skeleton));
    let target = from + Vector3::new(2.0, 1.0, 0.5) * rig.skeleton.size();
    drag.target_mut(hand).unwrap().set_target(target);
    for _ in 0..150 {
        drag.advance();
    }
    let settled = drag.q().to_vec();
    for _ in 0..20 {
        let solution = drag.advance();
        assert!(!solution.reached && largest_difference(&solution.q, &settled) < 1e-6);
        assert!(!drag.is_speed_limited());
    }
}

#[test]
fn frame_in_progress_has_a_short_explanation() {
    let chain = planar_arm(&[0.5; 8], Some((-3.0, 3.0)));
    let mut builder = Problem::builder(&chain);
    builder.add(Point::new(chain.frame("tip").unwrap(), [-1.0, 2.0, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.1; 8]).unwrap();
    let mut frames = 0;
    while !drag.advance().reached {
        let words = drag.solution().explain();
        assert!(!words.contains("Only one attempt"), "{words}");
        let moves = drag.solution().active_limits().count();
        if moves > 3 {
            assert!(
                words.contains(&format!(" and {} more joints.", moves - 2)),
                "{words}"
            );
        }
        assert!(words.matches("allowed move").count() <= 3, "{words}");
        assert!(drag.is_speed_limited() && frames < 60, "{words}");
        frames += 1;
    }
    assert!(frames > 0);
    let words = drag.solution().explain();
    assert!(
        words.starts_with("Reached") && words.lines().count() == 1,
        "{words}"
    );
}

#[test]
fn jumping_target_is_followed_with_reported_lag() {
    let model = planar_arm(&[1.0, 0.8], Some((-3.0, 3.0)));
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(model.frame("tip").unwrap(), [1.2, 0.5, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.5]).unwrap();
    while !drag.advance().reached {}
    drag.target_mut(hand).unwrap().set_target([-1.2, 0.5, 0.0]);
    let mut q = drag.q().to_vec();
    let mut frames = 0;
    while !drag.advance().reached {
        assert!(drag.is_speed_limited(), "{}", drag.solution().explain());
        assert!(drag.solution().explain().contains("allowed move"));
        assert!(largest_difference(drag.q(), &q) <= MAX_MOVE);
        q.copy_from_slice(drag.q());
        frames += 1;
        assert!(frames < 60);
    }
    assert!(frames > 5 && !drag.is_speed_limited());
}

#[test]
fn stretched_arm_bends_for_a_returning_target() {
    // Exactly stretched: the gradient of a target on the arm's line is zero.
    let mut builder = Model::builder("arm and another joint");
    let (origin, z) = (Placement::identity(), Vector3::new(0.0, 0.0, 1.0));
    let link = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    let limits = Limits::new(-2.8, 2.8);
    let shoulder = builder.revolute("shoulder", None, origin, z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), link(1.0), z, limits);
    builder.revolute("other", None, origin, z, limits);
    let tip = builder.frame("tip", Some(elbow), link(0.8));
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(tip, [2.5, 0.0, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0, 0.7]).unwrap();
    assert!(!drag.advance().reached);
    let mut q = drag.q().to_vec();
    for frame in 0..60 {
        let x = (2.5 - 0.02 * f64::from(frame)).max(1.5);
        drag.target_mut(hand).unwrap().set_target([x, 0.0, 0.0]);
        drag.advance();
        assert!(largest_difference(drag.q(), &q) <= MAX_MOVE);
        // A joint without influence on any task keeps its value.
        assert_eq!(drag.q()[2], 0.7);
        q.copy_from_slice(drag.q());
    }
    assert!(drag.solution().reached, "{}", drag.solution().explain());
}

#[test]
fn drag_jumps_only_with_search_and_reports_it() {
    // The elbow's limit blocks the branch on which the target is reachable.
    let model = planar_arm(&[1.0, 0.8], Some((-2.3, 2.3)));
    let tip = model.frame("tip").unwrap();
    let drag = || {
        let mut builder = Problem::builder(&model);
        // With this bend of the elbow the shoulder's upper limit blocks; with the opposite bend it does not.
        builder.add(Point::new(tip, [-1.2, 0.3, 0.0]));
        Drag::new(builder.build().unwrap(), &[-1.5, -0.5]).unwrap()
    };
    let mut calm = drag();
    for _ in 0..60 {
        assert!(!calm.advance().reached);
        assert_eq!(calm.jump(), None);
    }
    let mut keen = drag().with_search(Restarts::default()).unwrap();
    let mut jumps = 0;
    for _ in 0..60 {
        let before = keen.q().to_vec();
        keen.advance();
        let moved = largest_difference(keen.q(), &before);
        if moved > MAX_MOVE {
            let jump = keen.jump().expect("a leap is told");
            assert_eq!(jump.distance, moved);
            jumps += 1;
        } else {
            assert_eq!(keen.jump(), None);
        }
    }
    assert!(jumps == 1 && keen.solution().reached, "{jumps}");
}

#[test]
fn drag_is_reproducible_and_validates_starts() {
    let rig = RandomRig::new(3);
    let start = slightly_bent(&rig.skeleton);
    let run = || {
        let (mut drag, hand, from) = drag(&rig, &start);
        for frame in 0..20 {
            let aside = Vector3::new(0.1, 0.05, -0.02) * f64::from(frame);
            drag.target_mut(hand).unwrap().set_target(from + aside);
            drag.advance();
        }
        drag.q().to_vec()
    };
    assert_eq!(run(), run());
    let (mut drag, hand, _) = drag(&rig, &start);
    assert!(drag.set_configuration(&[0.0]).is_err());
    assert!(
        drag.set_configuration(&vec![f64::NAN; start.len()])
            .is_err()
    );
    // A NaN target moves no joint.
    drag.target_mut(hand)
        .unwrap()
        .set_target([f64::NAN, 0.0, 0.0]);
    let before = drag.q().to_vec();
    assert!(!drag.advance().reached);
    assert_eq!(drag.q(), before);
}

/// The bound of a prismatic joint: the displacement by which a rotation moves a point at a quarter of the reach.
#[test]
fn prismatic_joint_moves_by_scaled_bound() {
    let mut builder = Model::builder("slide and arm");
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let (origin, link) = (Placement::identity(), Placement::translation(x));
    let slide = builder.prismatic("slide", None, origin, x, Limits::new(-50.0, 50.0));
    let arm = builder.revolute("arm", Some(slide), origin, z, Limits::new(-0.1, 0.1));
    let tip = builder.frame("tip", Some(arm), link);
    let model = builder.build().unwrap();
    assert_eq!(model.reach(), 1.0);
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [30.0, 0.0, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
    for most in [0.15, 0.04] {
        drag = drag.with_max_move(most).unwrap();
        let before = drag.q()[0];
        drag.advance();
        let moved = drag.q()[0] - before;
        assert!((moved - 0.25 * most).abs() < 1e-12, "{most}: {moved}");
        assert!(drag.is_speed_limited());
    }
}

/// Two minima along a prismatic joint: at −3 with a residual of 0.6, and at 3 with none.
#[derive(Clone)]
struct Valleys;

impl Curve for Valleys {
    fn at<S: Scalar>(&self, s: S) -> S {
        let c = S::constant;
        let shifted = s + c(3.0);
        (s - c(3.0)) * (shifted * shifted + c(0.1))
    }
}

/// A jump report names the joint and the displacement in its unit. A larger allowed displacement gives no report.
#[test]
fn jump_of_prismatic_joint_is_in_metres() {
    let mut builder = Model::builder("slide beside an arm");
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let (origin, link) = (Placement::identity(), Placement::translation(x));
    let slide = builder.prismatic("slide", None, origin, x, Limits::new(-4.0, 4.0));
    let arm = builder.revolute("arm", Some(slide), origin, z, Limits::new(-1.0, 1.0));
    builder.frame("tip", Some(arm), link);
    let model = builder.build().unwrap();
    let drag = |search: bool, most: f64| {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(OfJoint(slide, Valleys)).tolerance(Quantity::Ratio, 1e-6));
        let drag = Drag::new(builder.build().unwrap(), &[-2.99, 0.3]).unwrap();
        let drag = drag.with_max_move(most).unwrap();
        match search {
            true => drag
                .with_search(Restarts::default().with_attempts(20))
                .unwrap(),
            false => drag,
        }
    };
    let frames = |mut drag: Drag| {
        let mut leaps = Vec::new();
        let mut most_attempts = 0;
        for _ in 0..12 {
            let before = drag.q()[0];
            drag.advance();
            most_attempts = most_attempts.max(drag.solution().attempts);
            // The arm has no influence on any task.
            assert_eq!(drag.q()[1], 0.3);
            if let Some(jump) = drag.jump() {
                let moved = (drag.q()[0] - before).abs();
                let joint = model.moving_joints()[jump.joint];
                assert_eq!(model.joints()[joint.index()].name, "slide");
                assert!((jump.distance - moved).abs() < 1e-12 && jump.reconfiguration);
                leaps.push(jump.distance);
            }
        }
        (drag.q()[0], leaps, most_attempts)
    };
    let (at, leaps, attempts) = frames(drag(false, 0.15));
    assert!((at + 2.99).abs() < 0.01 && leaps.is_empty());
    // A frame and its perturbation.
    assert_eq!(attempts, 2);
    let (at, leaps, attempts) = frames(drag(true, 0.15));
    assert!(
        (at - 3.0).abs() < 1e-5 && leaps.len() == 1 && leaps[0] > 5.9,
        "{at} {leaps:?}"
    );
    assert!(attempts > 2, "{attempts}");
    // The bound of 30 times a quarter of the reach exceeds the jump.
    let (at, leaps, _) = frames(drag(true, 30.0));
    assert!(
        (at - 3.0).abs() < 1e-5 && leaps.is_empty(),
        "{at} {leaps:?}"
    );
}

/// A drag that is set to another configuration continues bitwise like a new drag from there, however long it was at
/// rest against limits.
#[test]
fn stand_at_equals_a_new_drag() {
    let model = planar_arm(&[1.0, 0.8], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let drag = |target: [f64; 3]| {
        let mut builder = Problem::builder(&model);
        let hand = builder.add(Point::new(tip, target));
        let drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
        (drag, hand)
    };
    // Stretched, with the target on its line.
    let near = [1.6, 0.0, 0.0];
    let run = |drag: &mut Drag| -> Vec<Vec<f64>> {
        let frame = |_| {
            drag.advance();
            drag.q().to_vec()
        };
        (0..12).map(frame).collect()
    };
    let expected = run(&mut drag(near).0);
    for rest in 0..5 {
        let (mut moved, hand) = drag([-1.0, 0.5, 0.0]);
        for _ in 0..20 + rest {
            assert!(!moved.advance().reached);
        }
        moved.set_configuration(&[0.0, 0.0]).unwrap();
        moved.target_mut(hand).unwrap().set_target(near);
        assert_eq!(run(&mut moved), expected, "{rest}");
    }
}

#[test]
fn settled_drag_continues_in_small_steps() {
    let rig = RandomRig::new(4);
    let start = slightly_bent(&rig.skeleton);
    for distance in [0.05, 0.6] {
        let (mut body, hand, from) = drag(&rig, &start);
        let target = from + Vector3::new(1.0, 0.5, 0.2) * (distance * rig.skeleton.size());
        body.target_mut(hand).unwrap().set_target(target);
        let settled = body.settle(200).clone();
        assert_eq!(settled.reached, distance < 0.1, "{}", settled.explain());
        assert!(body.is_at_rest() && !body.is_speed_limited() && settled.iterations > 0);
        assert_eq!(body.jump(), None);
        // The following frames start from there, in small steps again.
        for _ in 0..8 {
            body.advance();
            assert!(largest_difference(body.q(), &settled.q) < 1e-5);
        }
        let back = from - Vector3::new(1.0, 0.5, 0.2) * (0.3 * rig.skeleton.size());
        body.target_mut(hand).unwrap().set_target(back);
        let before = body.q().to_vec();
        body.advance();
        assert!(largest_difference(body.q(), &before) <= MAX_MOVE);
    }
}

/// `settle` ends where a drag with unbounded moves rests, or where a drag by frames rests.
#[test]
fn settle_ends_where_frames_come_to_rest() {
    for (seed, by_strides) in [(0, true), (8, false)] {
        let rig = RandomRig::new(seed);
        let start = slightly_bent(&rig.skeleton);
        let direction = Vector3::from(Random::new(seed).vector(rig.skeleton.size()));
        let (mut body, hand, from) = drag(&rig, &start);
        body.target_mut(hand).unwrap().set_target(from + direction);
        let rest = |mut body: Drag| {
            let mut rests = || {
                body.advance();
                body.is_at_rest()
            };
            assert!((0..400).any(|_| rests()), "{seed}");
            body.q().to_vec()
        };
        let unbounded = body.clone().with_max_move(f64::INFINITY).unwrap();
        let [of_strides, of_frames] = [unbounded, body.clone()].map(rest);
        assert_ne!(of_strides, of_frames);
        let expected = if by_strides { of_strides } else { of_frames };
        assert_eq!(body.settle(400).q, expected, "{seed}");
    }
}

/// A drag of zero frames computes one frame, so that it has a solution.
#[test]
fn drag_of_no_frames_returns_a_solution() {
    let model = support::planar_arm(&[1.0, 1.0], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    for settles in [true, false] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [1.0, 1.0, 0.0]));
        let mut drag = Drag::new(builder.build().unwrap(), &[0.1, 0.5]).unwrap();
        let solution = match settles {
            true => drag.settle(0),
            false => drag.follow(0),
        };
        assert_eq!(solution.q.len(), 2);
    }
}
