//! Promise: so it is for whole motions under everything that can be asked of them: weights by frame, factors of joints, ends that are
//! fixed, contacts of several points, windows, and every report. Those that turn have a promise of their own.
#![allow(clippy::unwrap_used)]

use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::motion::trajectory::{
    Contact, MotionProblem, MotionProblemBuilder, MotionSolution, MotionSolver, RateCost, Windows,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture, Quantity, Task};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};

pub(crate) const STEP: f64 = 1.0 / 20.0;

/// Everything that a motion says.
fn add(digest: &mut Digest, solved: &MotionSolution) {
    digest.doubles(solved.q().iter().copied());
    digest.doubles([
        solved.cost(),
        solved.cost_of_rates(),
        solved.slip(),
        solved.loop_gap(),
    ]);
    let ended = (
        solved.termination(),
        solved.iterations(),
        solved.counts(),
        solved.reached(),
    );
    add_text(digest, &format!("{ended:?}"));
    for frame in 0..solved.frames() {
        digest.doubles(solved.frame_cost(frame));
        digest.doubles(solved.frame(frame).unwrap().iter().copied());
        for limit in solved.active_limits(frame) {
            add_text(digest, &format!("{limit:?}"));
        }
        for miss in solved.missed(frame) {
            add_text(digest, &format!("{miss:?}"));
        }
    }
}

pub(crate) fn solve(
    digest: &mut Digest,
    motion: &MotionProblem,
    start: &[f64],
    solver: &MotionSolver,
) {
    match solver.solve(motion, start) {
        Ok(solved) => add(digest, &solved),
        Err(error) => add_error(digest, &error),
    }
}

/// Two hinges, a slide, and a follower.
fn arm() -> Model {
    let mut builder = Model::builder("arm");
    let [x, _, z] = Vector3::UNITS;
    let link = Placement::translation(x);
    let limits = Limits::new(-2.0, 2.0);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
    let rod = builder.prismatic("rod", Some(elbow), link, x, Limits::new(0.0, 0.5));
    let hand = builder.continuous("hand", Some(rod), Placement::identity(), z);
    builder.frame("tip", Some(hand), Placement::translation(x * 0.2));
    builder.build().unwrap()
}

fn wave(frame: usize) -> [f64; 3] {
    let (sin, cos) = kinopt::Scalar::sin_cos(0.4 * frame as f64);
    [1.6 + 0.5 * cos, 0.9 * sin, 0.0]
}

pub(crate) type Ask<'a> = &'a dyn Fn(&mut MotionProblemBuilder);

fn asked(
    model: &Model,
    frames: usize,
    ask: Ask<'_>,
) -> Result<MotionProblem, kinopt::motion::trajectory::MotionError> {
    let mut motion = MotionProblem::builder(model, frames, STEP);
    let tip = motion.add(Point::new(model.frame("tip").unwrap(), [1.0, 1.0, 0.0]));
    motion.follow(tip, |frame, point| point.set_target(wave(frame)));
    motion.rate_cost(RateCost::acceleration(1e-4));
    ask(&mut motion);
    motion.build()
}

/// One thing is asked after another.
fn each_ask() -> Value {
    let mut digest = Digest::new();
    let model = arm();
    let tip = model.frame("tip").unwrap();
    let [elbow, hand, rod] = ["elbow", "hand", "rod"].map(|name| model.joint(name).unwrap());
    let start = [0.3, 0.5, 0.1, 0.0];
    let weights: Vec<f64> = (0..16).map(|k| f64::from(k % 4) * 0.5).collect();
    let coupled = ParameterMap::builder(&model).with_coupled(hand, elbow, -0.5, 0.1);
    let coupled = coupled
        .with_narrowed(rod, Limits::new(0.1, 0.3))
        .build()
        .unwrap();
    let asks: [Ask<'_>; 17] = [
        &|_| {},
        &|motion| {
            _ = motion
                .max_speed("shoulder", 1.0)
                .max_speed(rod, 0.4)
                .max_speed("shoulder", 2.0)
        },
        &|motion| _ = motion.first(&start).max_speed("elbow", 1.5),
        &|motion| _ = motion.last(&[0.5, 0.2, 0.3, 1.0]).max_speed("hand", 1.0),
        &|motion| _ = motion.first(&start).last(&start).max_speed("shoulder", 0.8),
        &|motion| {
            _ = motion
                .bound("elbow", Limits::new(0.4, 0.6))
                .bound(rod, Limits::new(0.2, 0.2))
        },
        &|motion| _ = motion.tolerance(Quantity::Metres, 0.2),
        &|motion| {
            _ = motion.rate_cost(
                RateCost::velocity(1e-2)
                    .scale("elbow", 3.0)
                    .scale("rod", 0.0),
            )
        },
        &|motion| _ = motion.rate_cost(RateCost::jerk(1e-5).scale("hand", 10.0)),
        &|motion| {
            _ = motion
                .contact(Contact::new(tip, 4..9))
                .contact(Contact::new(tip, 11..16))
        },
        &|motion| {
            _ = motion
                .contact(Contact::new(tip, 3..8).at([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0]]))
                .max_speed("rod", 0.3)
        },
        &|motion| _ = motion.parameters(coupled.clone()).max_speed("hand", 0.6),
        &|motion| {
            _ = motion.add(
                Task::new(Posture::new(&model, &start))
                    .scale(0.2)
                    .preference(),
            )
        },
        &|motion| {
            let second = motion.add(Task::new(Point::new(tip, [1.5, 0.4, 0.0])).named("second"));
            motion.weights(second, &weights);
        },
        &|motion| {
            let far = motion.add(
                Task::new(Point::new(tip, [3.0, 0.4, 0.0]))
                    .named("far")
                    .scale(2.0),
            );
            motion.follow(far, |frame, point| {
                point.set_target([4.0, 0.1 * frame as f64, 0.0])
            });
            motion.follow(far, |frame, point| {
                point.set_target([3.5, 0.1 * frame as f64, 0.0])
            });
            motion.max_speed("rod", 1.0);
        },
        &|motion| _ = motion.contact(Contact::new(tip, 0..16).at([[0.0; 3]; 0])),
        &|motion| _ = motion.max_speed("shoulder", 1e6).max_speed("hand", 1e-3),
    ];
    let solver = MotionSolver::default().with_max_iterations(60);
    for ask in asks {
        let motion = asked(&model, 16, ask).unwrap();
        for contact in motion.contacts() {
            add_text(
                &mut digest,
                &format!(
                    "{:?} {:?} {:?}",
                    contact.frame(),
                    contact.points(),
                    contact.span()
                ),
            );
        }
        solve(&mut digest, &motion, &start, &solver);
    }
    digest.value()
}

/// By solvers of other settings, of few frames, and near to what is known.
fn solvers() -> Value {
    let mut digest = Digest::new();
    let model = arm();
    let start = [0.3, 0.5, 0.1, 0.0];
    let tip = model.frame("tip").unwrap();
    let motion = asked(&model, 18, &|motion| {
        motion
            .max_speed("shoulder", 1.2)
            .contact(Contact::new(tip, 6..12));
        motion.first(&start);
    });
    let motion = motion.unwrap();
    let plain = || MotionSolver::default().with_max_iterations(40);
    for solver in [
        plain().with_tolerance(1e-2),
        plain().with_tolerance(0.0).with_max_iterations(12),
        plain().with_max_iterations(0),
        plain().with_max_iterations(3),
        plain().with_curvature(false),
        plain().with_slip(1e-3),
        plain().with_slip(0.0).with_max_iterations(20),
        plain().with_windows(Some(Windows::new(5, 3))),
        plain().with_windows(Some(Windows::new(7, 0))),
        plain().with_windows(Some(Windows::new(18, 4))),
        plain().with_windows(Some(Windows::new(1, 5))),
        plain().with_windows(Some(Windows::new(0, 5))),
        plain().with_tolerance(-1.0),
        plain().with_slip(f64::NAN),
        plain()
            .with_tolerance(1e-3)
            .with_windows(Some(Windows::new(6, 2))),
    ] {
        solve(&mut digest, &motion, &start, &solver);
    }
    let near = start.repeat(18);
    let mut heard = Vec::new();
    let windows = plain().with_windows(Some(Windows::new(8, 4)));
    let solved = windows.solve_near_with_progress(&motion, &near, &mut |done| heard.push(done));
    add(&mut digest, &solved.unwrap());
    add_text(&mut digest, &format!("{heard:?}"));
    add(&mut digest, &plain().solve_near(&motion, &near).unwrap());
    for bad in [&near[4..], &start, &[]] {
        add_error(&mut digest, &plain().solve_near(&motion, bad).unwrap_err());
    }
    for bad in [&[0.0; 3][..], &[0.0, f64::NAN, 0.0, 0.0]] {
        solve(&mut digest, &motion, bad, &plain());
    }
    // What is beyond its limits comes within.
    solve(&mut digest, &motion, &[3.0, -3.0, 2.0, 9.0], &plain());
    for frames in [1, 2, 3] {
        let few = asked(&model, frames, &|motion| {
            _ = motion.rate_cost(RateCost::jerk(1e-3)).max_speed("rod", 0.1)
        });
        solve(&mut digest, &few.unwrap(), &start, &plain());
    }
    digest.value()
}

/// What cannot be asked.
fn refusals() -> Value {
    let mut digest = Digest::new();
    let model = arm();
    let tip = model.frame("tip").unwrap();
    let (start, far) = ([0.3, 0.5, 0.1, 0.0], [0.3, 1.9, 0.1, 0.0]);
    let asks: [Ask<'_>; 22] = [
        &|motion| _ = motion.max_speed("wrist", 1.0),
        &|motion| _ = motion.max_speed("elbow", 0.0).max_speed("wrist", 1.0),
        &|motion| _ = motion.max_speed("elbow", f64::NAN),
        &|motion| _ = motion.max_free_speed("base", 1.0, 1.0),
        &|motion| _ = motion.bound("wrist", Limits::new(0.0, 1.0)),
        &|motion| _ = motion.bound("elbow", Limits::new(3.0, 4.0)),
        &|motion| _ = motion.rate_cost(RateCost::jerk(1.0).scale("wrist", 2.0)),
        &|motion| _ = motion.rate_cost(RateCost::velocity(-1.0)),
        &|motion| _ = motion.rate_cost(RateCost::velocity(1.0).scale("elbow", -2.0)),
        &|motion| _ = motion.first(&[3.0, 0.0, 0.1, 0.0]),
        &|motion| _ = motion.last(&[0.0, 0.0, 0.6, 0.0]),
        &|motion| _ = motion.last(&[0.0; 3]),
        &|motion| _ = motion.first(&[f64::NAN; 4]),
        &|motion| _ = motion.first(&start).last(&far).max_speed("elbow", 0.1),
        &|motion| _ = motion.contact(Contact::new(tip, 1..9)),
        &|motion| _ = motion.contact(Contact::new(tip, 1..2)),
        &|motion| _ = motion.contact(Contact::new(tip, std::ops::Range { start: 3, end: 1 })),
        &|motion| _ = motion.contact(Contact::new(tip, 0..3).at([[f64::NAN, 0.0, 0.0]])),
        &|motion| {
            _ = motion.add(
                Task::new(Point::new(tip, [0.0; 3]))
                    .named("gaze")
                    .at_level(2),
            )
        },
        &|motion| {
            let own = motion.add(Task::new(Point::new(tip, [0.0; 3])).named("own"));
            motion.weights(own, &[1.0; 3]);
        },
        &|motion| {
            let own = motion.add(Task::new(Point::new(tip, [0.0; 3])).named("own"));
            motion.weights(own, &[1.0, 2.0, -1.0, 0.0]);
        },
        &|motion| {
            let own = motion.add(Task::new(Point::new(tip, [0.0; 3])).named("own"));
            motion.follow(own, |frame, point| {
                point.set_target([if frame == 2 { f64::NAN } else { 1.0 }, 0.0, 0.0]);
            });
        },
    ];
    for ask in asks {
        match asked(&model, 4, ask) {
            Ok(motion) => solve(&mut digest, &motion, &start, &MotionSolver::default()),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    add_error(&mut digest, &asked(&model, 0, &|_| {}).unwrap_err());
    for step in [0.0, f64::NAN, -1.0] {
        add_error(
            &mut digest,
            &MotionProblem::builder(&model, 2, step).build().unwrap_err(),
        );
    }
    digest.value()
}

#[test]
fn of_motions_by_what_is_asked() {
    check(&[
        ("motions: each thing that is asked", each_ask()),
        ("motions: settings of the solver", solvers()),
        ("motions: what is refused", refusals()),
    ]);
}
