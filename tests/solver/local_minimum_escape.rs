//! Promise: a drag at rest short of a target that is reachable on its branch moves on to it. The motion keeps the
//! frame's move bound and the pinned tips. A drag without such an escape stays at rest, and none flips.

use kinopt::ik::Drag;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Limits, Model};
use kinopt::problem::TaskId;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture};
use kinopt::{Problem, Solver};
use support::bones::humanoid;
use support::random::{Random, case_count};

/// Skeleton with a dragged left hand and its other tips pinned.
struct Scene {
    drag: Drag,
    hand: TaskId<Point>,
    from: Vector3<f64>,
    pinned: Vec<(FrameId, Vector3<f64>)>,
    kinematics: ForwardKinematics<f64>,
    /// Largest joint displacement in a frame (radians) and largest distance of a pinned tip (metres).
    largest: [f64; 2],
}

impl Scene {
    fn new() -> Self {
        let rig = humanoid();
        let (model, rest) = (rig.skeleton.model(), rig.skeleton.model().neutral());
        let hand = rig.skeleton.bone("left_hand").unwrap();
        let tips: Vec<FrameId> = (rig.constrained.iter())
            .map(|&bone| rig.skeleton.tip(bone))
            .collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &tips).unwrap();
        let places: Vec<Vector3<f64>> = (kinematics.place(&rest).unwrap().iter())
            .map(|placed| placed.translation)
            .collect();
        let mut tasks = Problem::builder(model);
        let mut dragged = None;
        let mut pinned = Vec::new();
        for (&tip, &position) in tips.iter().zip(&places) {
            let task = tasks.add(Point::new(tip, position));
            match tip == rig.skeleton.tip(hand) {
                true => dragged = Some((task, position)),
                false => pinned.push((tip, position)),
            }
        }
        tasks.add(Posture::new(model, &rest));
        let (hand, from) = dragged.unwrap();
        let frames: Vec<FrameId> = pinned.iter().map(|(tip, _)| *tip).collect();
        Self {
            drag: Drag::new(tasks.build().unwrap(), &rest).unwrap(),
            hand,
            from,
            pinned,
            kinematics: ForwardKinematics::of_frames(model, &frames).unwrap(),
            largest: [0.0; 2],
        }
    }

    fn advance(&mut self, up: f64) {
        let before = self.drag.q().to_vec();
        let target = self.from + Vector3::new(0.0, 0.0, up);
        let point = self.drag.target_mut(self.hand).unwrap();
        point.set_target(target);
        self.drag.advance();
        let moves = self.drag.q().iter().zip(&before);
        let furthest = moves.map(|(a, b)| (a - b).abs());
        let placed = self.kinematics.place(self.drag.q()).unwrap();
        let deviations = self.pinned.iter().zip(placed);
        let deviation = deviations.map(|((_, target), now)| (now.translation - *target).norm());
        self.largest[0] = furthest.fold(self.largest[0], f64::max);
        self.largest[1] = deviation.fold(self.largest[1], f64::max);
    }

    /// Advances until the drag rests, with a stationary target. Returns the number of frames.
    fn advance_until_rest(&mut self, up: f64) -> usize {
        let mut frames = 0;
        loop {
            self.advance(up);
            frames += 1;
            if self.drag.is_at_rest() || frames == 900 {
                return frames;
            }
        }
    }

    /// Raises the hand's target in 20 frames.
    fn lift(&mut self, up: f64) {
        for k in 1..=20 {
            self.advance(up * f64::from(k) / 20.0);
        }
    }

    /// Advances one frame. True if the skeleton moves again after a rest, before reaching the target.
    fn starts_to_move(&mut self, up: f64, rested: &mut bool) -> bool {
        let before = self.drag.q().to_vec();
        self.advance(up);
        let moves = self.drag.q().iter().zip(&before);
        let moved = moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        *rested |= moved < 1e-6;
        *rested && moved > 1e-3 && !self.drag.solution().reached
    }
}

/// At these heights twist limits of spine and arm become active, depending on the target's course. One course in ten
/// rested up to 4 mm short of the solver's result.
#[test]
fn hand_reaches_target_for_any_drag_course() {
    let mut short = 0;
    let courses = case_count(160, 40);
    // Seed 62 does not come to rest without an escape.
    for seed in (0..courses as u64).chain([62]) {
        let random = &mut Random::new(seed);
        let mut scene = Scene::new();
        let (moves, up) = (1 + random.below(100), random.within(0.36, 0.5));
        for k in 1..=moves {
            for _ in 0..random.below(4) {
                scene.advance(up * k as f64 / moves as f64);
            }
        }
        // The skeleton catches up with a target that jumped.
        while scene.drag.is_speed_limited() {
            scene.advance(up);
        }
        scene.largest = [0.0; 2];
        let frames = scene.advance_until_rest(up);
        let reported = scene.drag.solution();
        let [moved, off] = scene.largest;
        assert!(moved <= 0.15 + 1e-12 && off < 0.02, "{seed}: {moved} {off}");
        assert!(frames < 900, "{seed}");
        // The remaining misses need another branch, and are reported.
        short += usize::from(!reported.reached);
        assert!(
            reported.reached || reported.position_error() < Some(2e-4),
            "{seed}: {}",
            reported.explain()
        );
    }
    assert!(short * 20 <= courses, "{short} of {courses}");
}

/// A skeleton without an escape does not move, during the search and after it.
#[test]
fn drag_rests_at_unreachable_target() {
    let mut scene = Scene::new();
    for k in 0..60 {
        scene.advance(f64::from(k) * 0.02);
    }
    let frames = scene.advance_until_rest(1.2);
    assert!(frames < 300 && !scene.drag.solution().reached, "{frames}");
    let rest = scene.drag.q().to_vec();
    for _ in 0..40 {
        scene.advance(1.2);
        assert!(scene.drag.is_at_rest());
        let moves = scene.drag.q().iter().zip(&rest);
        assert!(moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-5);
    }
}

/// Escape data belongs to a configuration: a relocated drag equals a new one.
#[test]
fn relocated_drag_drops_its_escape() {
    let mut out = 0;
    for seed in 0..12 {
        let random = &mut Random::new(seed);
        let mut scene = Scene::new();
        let up = random.within(0.36, 0.5);
        let rest = scene.drag.q().to_vec();
        scene.lift(up);
        let mut rested = false;
        for _ in 0..200 {
            if !scene.starts_to_move(up, &mut rested) {
                continue;
            }
            out += 1;
            let mut put = scene.drag.clone();
            put.set_configuration(&rest).unwrap();
            let mut fresh = Drag::new(put.problem().clone(), &rest).unwrap();
            let target = scene.from + Vector3::new(0.0, 0.0, up);
            fresh.target_mut(scene.hand).unwrap().set_target(target);
            for frame in 0..3 {
                assert_eq!(put.advance().q, fresh.advance().q, "{seed}, frame {frame}");
            }
        }
    }
    assert!(out > 0);
}

/// Nor does it continue to an earlier target.
#[test]
fn retargeted_drag_drops_its_escape() {
    let mut out = 0;
    for seed in 0..4 {
        let random = &mut Random::new(seed);
        let mut scene = Scene::new();
        let up = random.within(0.36, 0.5);
        scene.lift(up);
        let mut rested = false;
        for _ in 0..200 {
            if scene.starts_to_move(up, &mut rested) {
                break;
            }
        }
        if !rested || scene.drag.is_at_rest() {
            continue;
        }
        out += 1;
        let mut dragged = scene.drag;
        let mut fresh = Drag::new(dragged.problem().clone(), dragged.q()).unwrap();
        let target = scene.from + Vector3::new(0.0, 0.0, 0.8 * up);
        for drag in [&mut dragged, &mut fresh] {
            drag.target_mut(scene.hand).unwrap().set_target(target);
        }
        for frame in 0..3 {
            assert_eq!(
                dragged.advance().q,
                fresh.advance().q,
                "{seed}, frame {frame}"
            );
        }
    }
    assert!(out > 0);
}

/// Two links whose shoulder limit blocks the present elbow side. A solver with restarts flips the elbow; a drag at rest
/// does not.
#[test]
fn escape_never_changes_branch() {
    let mut builder = Model::builder("two links");
    let axis = Vector3::UNITS[2];
    let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
    let limits = Limits::new(-0.1, 3.0);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), axis, limits);
    let limits = Limits::new(-3.0, 3.0);
    let elbow = builder.revolute("elbow", Some(shoulder), link, axis, limits);
    let tip = builder.frame("tip", Some(elbow), link);
    let model = builder.build().unwrap();
    // Elbows at ±0.6 rad about the line to the target, the shoulder 0.3 rad off it.
    let target = Vector3::new(2.0 * 0.3_f64.cos(), 0.0, 0.0);
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, target));
    let problem = tasks.build().unwrap();
    let flipped = Solver::default()
        .solve_once(&problem, &[0.3, -0.6])
        .unwrap();
    assert!(flipped.reached && flipped.q[1] < -0.5, "{:?}", flipped.q);
    let mut drag = Drag::new(problem, &[0.0, 0.6]).unwrap();
    let mut frames = 0;
    while frames < 20 || (!drag.is_at_rest() && frames < 400) {
        drag.advance();
        frames += 1;
        assert!(drag.q()[1] > 0.1, "frame {frames}: {:?}", drag.q());
    }
    assert!(drag.is_at_rest() && !drag.solution().reached, "{frames}");
    // The shoulder on its limit, and the elbow on the line from itself to the target.
    let from_elbow = target - Vector3::new(0.1_f64.cos(), -0.1_f64.sin(), 0.0);
    let nearest = 0.1 + (from_elbow.y / from_elbow.x).atan();
    let [shoulder, elbow] = [drag.q()[0], drag.q()[1]];
    assert!(
        shoulder == -0.1 && (elbow - nearest).abs() < 1e-3,
        "{elbow} {nearest}"
    );
}
