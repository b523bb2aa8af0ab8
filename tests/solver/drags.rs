//! Promise: a drag follows its targets on one branch: no joint leaps, neither where a target goes
//! out of reach, nor into limits, nor back, unless a search was asked for, and then it is told; a
//! frame that misses costs no more than a few that reach.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::Scalar;
use kinopt::ik::{Drag, Restarts};
use kinopt::model::{Limits, Model};
use kinopt::problem::{Problem, TaskId};
use kinopt::skeleton::Skeleton;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity, Task};
use support::bones::RandomRig;
use support::planar_arm;
use support::random::Random;
use support::tasks::{Curve, OfJoint};

/// The most that a joint moves in a frame, and what rounding may add.
const MOST_MOVE: f64 = 0.15 + 1e-12;
/// Evaluations of a frame at most: its steps, a nudge's, and what learning curvature takes.
const EVALUATIONS: usize = 400;

/// The second tip of a rig goes, the others stay.
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

/// Every bend a little off zero.
fn at_ease(skeleton: &Skeleton) -> Vec<f64> {
    let limits = skeleton.model().limits().enumerate();
    limits
        .map(|(k, l)| l.clamp(if k % 3 == 1 { 0.3 } else { 0.0 }))
        .collect()
}

fn furthest(a: &[f64], b: &[f64]) -> f64 {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}

/// What is told to be a joint's limit is the model's, however a frame ended: the most that a joint may move in a
/// frame is told apart.
#[test]
fn a_frame_tells_limits_as_the_model_has_them() {
    let rig = RandomRig::new(3);
    let start = at_ease(&rig.skeleton);
    let (drag, hand, from) = drag(&rig, &start);
    // Frames of a single step end by their count.
    let once = kinopt::solver::Stopping::default().with_max_iterations(1);
    let mut drag = drag.with_solver(kinopt::Solver::default(), once).unwrap();
    let far = from + Vector3::new(0.7, 0.5, -0.6) * rig.skeleton.size();
    let model = rig.skeleton.model();
    let (mut limits_told, mut moves_told) = (0, 0);
    for _ in 0..40 {
        drag.target_mut(hand).unwrap().set_target(far);
        let solution = drag.advance();
        for held in solution.active_limits() {
            if held.kind == kinopt::ik::BoundKind::Move {
                moves_told += 1;
                continue;
            }
            limits_told += 1;
            let known = |l: Limits| held.value == l.lower || held.value == l.upper;
            assert!(model.limits().any(known), "{held:?}");
        }
    }
    assert!(limits_told + moves_told > 0);
}

#[test]
fn out_of_reach_into_limits_and_back_without_a_leap() {
    // KINOPT_CASES=… for more rigs.
    for seed in 0..support::sample::cases(4, 1) as u64 {
        let rig = RandomRig::new(seed);
        let start = at_ease(&rig.skeleton);
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
                furthest(&solution.q, &q) <= MOST_MOVE,
                "{seed}, frame {frame}"
            );
            assert!(
                solution.counts.residuals <= EVALUATIONS,
                "{:?}",
                solution.counts
            );
            for (value, limits) in solution.q.iter().zip(rig.skeleton.model().limits()) {
                assert!(limits.contains(*value));
            }
            missed += usize::from(!solution.reached);
            q.copy_from_slice(&solution.q);
            assert_eq!(drag.leap(), None);
            assert_eq!(drag.q(), q);
        }
        assert!(missed > 30, "{seed}: only {missed} frames out of reach");
        // Back where it was: the frames that follow catch up.
        let mut frames = 0;
        while !drag.advance().reached {
            frames += 1;
            assert!(frames < 60, "{seed}: {}", drag.solution().explain());
        }
    }
}

#[test]
fn a_target_that_rests_out_of_reach_brings_the_body_to_rest() {
    let rig = RandomRig::new(2);
    let (mut drag, hand, from) = drag(&rig, &at_ease(&rig.skeleton));
    let far = from + Vector3::new(2.0, 1.0, 0.5) * rig.skeleton.size();
    drag.target_mut(hand).unwrap().set_target(far);
    for _ in 0..150 {
        drag.advance();
    }
    let settled = drag.q().to_vec();
    for _ in 0..20 {
        let solution = drag.advance();
        assert!(!solution.reached && furthest(&solution.q, &settled) < 1e-6);
        assert!(!drag.catching_up());
    }
}

#[test]
fn a_frame_on_its_way_is_told_in_few_words() {
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
        assert!(drag.catching_up() && frames < 60, "{words}");
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
fn a_target_that_leaps_is_followed_and_the_lag_is_told() {
    let model = planar_arm(&[1.0, 0.8], Some((-3.0, 3.0)));
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(model.frame("tip").unwrap(), [1.2, 0.5, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.5]).unwrap();
    while !drag.advance().reached {}
    drag.target_mut(hand).unwrap().set_target([-1.2, 0.5, 0.0]);
    let mut q = drag.q().to_vec();
    let mut frames = 0;
    while !drag.advance().reached {
        assert!(drag.catching_up(), "{}", drag.solution().explain());
        assert!(drag.solution().explain().contains("allowed move"));
        assert!(furthest(drag.q(), &q) <= MOST_MOVE);
        q.copy_from_slice(drag.q());
        frames += 1;
        assert!(frames < 60);
    }
    assert!(frames > 5 && !drag.catching_up());
}

#[test]
fn a_stretched_arm_comes_back_along_the_line_it_left_by() {
    // Stretched out to the bit: no joint feels a target that comes straight back.
    let mut builder = Model::builder("arm and another joint");
    let (here, z) = (Placement::identity(), Vector3::new(0.0, 0.0, 1.0));
    let link = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    let limits = Limits::new(-2.8, 2.8);
    let shoulder = builder.revolute("shoulder", None, here, z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), link(1.0), z, limits);
    builder.revolute("other", None, here, z, limits);
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
        assert!(furthest(drag.q(), &q) <= MOST_MOVE);
        // What no task feels stays.
        assert_eq!(drag.q()[2], 0.7);
        q.copy_from_slice(drag.q());
    }
    assert!(drag.solution().reached, "{}", drag.solution().explain());
}

#[test]
fn a_search_leaps_only_where_asked_for_and_is_told() {
    // A stop keeps the elbow from the other side, where the target could be reached.
    let model = planar_arm(&[1.0, 0.8], Some((-2.3, 2.3)));
    let tip = model.frame("tip").unwrap();
    let drag = || {
        let mut builder = Problem::builder(&model);
        // Beyond the shoulder's upper stop with the elbow bent that way, not with the other.
        builder.add(Point::new(tip, [-1.2, 0.3, 0.0]));
        Drag::new(builder.build().unwrap(), &[-1.5, -0.5]).unwrap()
    };
    let mut calm = drag();
    for _ in 0..60 {
        assert!(!calm.advance().reached);
        assert_eq!(calm.leap(), None);
    }
    let mut keen = drag().with_search(Restarts::default()).unwrap();
    let mut leaps = 0;
    for _ in 0..60 {
        let before = keen.q().to_vec();
        keen.advance();
        let moved = furthest(keen.q(), &before);
        if moved > MOST_MOVE {
            let leap = keen.leap().expect("a leap is told");
            assert_eq!(leap.distance, moved);
            leaps += 1;
        } else {
            assert_eq!(keen.leap(), None);
        }
    }
    assert!(leaps == 1 && keen.solution().reached, "{leaps}");
}

#[test]
fn the_same_drag_twice_is_the_same_to_the_bit_and_starts_are_checked() {
    let rig = RandomRig::new(3);
    let start = at_ease(&rig.skeleton);
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
    assert!(drag.stand_at(&[0.0]).is_err());
    assert!(drag.stand_at(&vec![f64::NAN; start.len()]).is_err());
    // A target that is no number moves nothing.
    drag.target_mut(hand)
        .unwrap()
        .set_target([f64::NAN, 0.0, 0.0]);
    let before = drag.q().to_vec();
    assert!(!drag.advance().reached);
    assert_eq!(drag.q(), before);
}

/// A slide goes as far in a frame as a joint would carry what is a quarter of the reach away.
#[test]
fn slides_move_by_their_own_measure() {
    let mut builder = Model::builder("slide and arm");
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let (here, link) = (Placement::identity(), Placement::translation(x));
    let slide = builder.prismatic("slide", None, here, x, Limits::new(-50.0, 50.0));
    let arm = builder.revolute("arm", Some(slide), here, z, Limits::new(-0.1, 0.1));
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
        assert!(drag.catching_up());
    }
}

/// Two valleys along a slide: one at −3 that misses by 0.6, one at 3 that does not.
#[derive(Clone)]
struct Valleys;

impl Curve for Valleys {
    fn at<S: Scalar>(&self, s: S) -> S {
        let c = S::constant;
        let beside = s + c(3.0);
        (s - c(3.0)) * (beside * beside + c(0.1))
    }
}

/// What is told of a leap: the joint, and its move in its own unit; none where a joint may go so far.
#[test]
fn a_leap_along_a_slide_is_told_in_metres() {
    let mut builder = Model::builder("slide beside an arm");
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let (here, link) = (Placement::identity(), Placement::translation(x));
    let slide = builder.prismatic("slide", None, here, x, Limits::new(-4.0, 4.0));
    let arm = builder.revolute("arm", Some(slide), here, z, Limits::new(-1.0, 1.0));
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
            // No task feels the arm.
            assert_eq!(drag.q()[1], 0.3);
            if let Some(leap) = drag.leap() {
                let moved = (drag.q()[0] - before).abs();
                assert!((leap.distance - moved).abs() < 1e-12 && leap.joint == "slide");
                leaps.push(leap.distance);
            }
        }
        (drag.q()[0], leaps, most_attempts)
    };
    let (at, leaps, attempts) = frames(drag(false, 0.15));
    assert!((at + 2.99).abs() < 0.01 && leaps.is_empty());
    // A frame and its nudge.
    assert_eq!(attempts, 2);
    let (at, leaps, attempts) = frames(drag(true, 0.15));
    assert!(
        (at - 3.0).abs() < 1e-5 && leaps.len() == 1 && leaps[0] > 5.9,
        "{at} {leaps:?}"
    );
    assert!(attempts > 2, "{attempts}");
    // 30 times a quarter of the reach is further than that.
    let (at, leaps, _) = frames(drag(true, 30.0));
    assert!(
        (at - 3.0).abs() < 1e-5 && leaps.is_empty(),
        "{at} {leaps:?}"
    );
}

/// From another configuration a drag goes on as one that begins there, to the bit, however long it rested
/// against its limits before.
#[test]
fn standing_elsewhere_is_beginning_there() {
    let model = planar_arm(&[1.0, 0.8], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let drag = |target: [f64; 3]| {
        let mut builder = Problem::builder(&model);
        let hand = builder.add(Point::new(tip, target));
        let drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
        (drag, hand)
    };
    // Stretched out towards a target on its line.
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
        moved.stand_at(&[0.0, 0.0]).unwrap();
        moved.target_mut(hand).unwrap().set_target(near);
        assert_eq!(run(&mut moved), expected, "{rest}");
    }
}

#[test]
fn a_body_settles_on_its_own_way() {
    let rig = RandomRig::new(4);
    let start = at_ease(&rig.skeleton);
    for far in [0.05, 0.6] {
        let (mut body, hand, from) = drag(&rig, &start);
        let target = from + Vector3::new(1.0, 0.5, 0.2) * (far * rig.skeleton.size());
        body.target_mut(hand).unwrap().set_target(target);
        let settled = body.settle(200).clone();
        assert_eq!(settled.reached, far < 0.1, "{}", settled.explain());
        assert!(body.rests() && !body.catching_up() && settled.iterations > 0);
        assert_eq!(body.leap(), None);
        // What follows takes it from there, in small steps again.
        for _ in 0..8 {
            body.advance();
            assert!(furthest(body.q(), &settled.q) < 1e-5);
        }
        let back = from - Vector3::new(1.0, 0.5, 0.2) * (0.3 * rig.skeleton.size());
        body.target_mut(hand).unwrap().set_target(back);
        let before = body.q().to_vec();
        body.advance();
        assert!(furthest(body.q(), &before) <= MOST_MOVE);
    }
}

/// A body that settles ends where one of unbounded moves rests, or where one that is dragged a frame at a time does.
#[test]
fn where_a_body_settles_a_drag_of_its_frames_rests() {
    for (seed, by_strides) in [(0, true), (8, false)] {
        let rig = RandomRig::new(seed);
        let start = at_ease(&rig.skeleton);
        let way = Vector3::from(Random::new(seed).vector(rig.skeleton.size()));
        let (mut body, hand, from) = drag(&rig, &start);
        body.target_mut(hand).unwrap().set_target(from + way);
        let rest = |mut body: Drag| {
            let mut rests = || {
                body.advance();
                body.rests()
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

/// A drag of no frames computes one, so that its solution is one.
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
