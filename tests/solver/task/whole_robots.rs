//! Promise: whole-body tasks work on free bases and ball joints. Reachable targets are reached, tasks within bounds
//! cost nothing, and derivatives agree by every route, also near half a turn and at the identity. Invalid input is
//! rejected by name.

use std::f64::consts::PI;

use kinopt::kinematics::{ForwardKinematics, centre_of_mass};
use kinopt::model::{FrameId, JointId, Limits, Masses, Model, ParameterMap, PointMass};
use kinopt::problem::{Derivatives, Evaluation, ProblemBuilder};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Axis, Bounded, CentreOfMass, Distance, FramePose, FrameVelocity, Gaze, Inputs, JointCoupling,
    LimitCentring, LookAt, Manipulability, Orientation, Plane, Point, PoseBounds, Posture,
    Quantity, Ray, Residual, RowBlock, Smoothness, SupportPolygon, Task,
};
use kinopt::{Problem, Scalar, Solver};
use nalgebra::DMatrix;
use support::figures::Figure;
use support::random::Random;
use support::{placement, vector};

use crate::ball_joints::jacobian;

/// Masses on every frame, heavier towards the tips.
fn masses_of(figure: &Figure) -> Masses {
    let parts = figure.frames.iter().enumerate();
    let parts = parts.map(|(k, &frame)| PointMass {
        frame,
        at: Vector3::new(0.05, -0.02 * k as f64, 0.1),
        mass: 1.0 + k as f64,
    });
    Masses::new(&figure.model, parts).unwrap()
}

type Add<'a> = (&'static str, Box<dyn Fn(&mut ProblemBuilder<'_>) + 'a>);

fn tasks<'a>(figure: &'a Figure, masses: &'a Masses, seed: u64) -> Vec<Add<'a>> {
    let (model, random) = (&figure.model, &mut Random::new(seed));
    let last = figure.frames[figure.frames.len() - 1];
    let base = figure.frames[1];
    let reference = model.random_configuration(seed + 7);
    let joints = model.moving_joints().to_vec();
    let count = {
        let mut joints = joints.clone();
        joints.dedup();
        joints.len()
    };
    let weights: Vec<f64> = (0..count).map(|_| random.within(0.1, 3.0)).collect();
    let [target, axis, aim] = [random.vector(0.4), random.vector(1.0), random.vector(1.0)];
    let previous = placement(&random.rigid(0.5));
    let sole: Vec<[f64; 3]> = (0..4).map(|_| random.vector(0.3).into()).collect();
    let [near, at] = [reference.clone(), reference];
    let heavy = weights.clone();
    vec![
        (
            "centre of mass",
            Box::new(move |b| {
                b.add(CentreOfMass::new(masses, target));
            }),
        ),
        (
            "centre of mass in a base",
            Box::new(move |b| {
                b.add(
                    CentreOfMass::new(masses, target)
                        .relative_to(base)
                        .free_along(Axis::Y),
                );
            }),
        ),
        (
            "support polygon",
            Box::new(move |b| {
                b.add(SupportPolygon::new(masses).with_points(sole.clone()));
            }),
        ),
        (
            "support polygon on a frame",
            Box::new(move |b| {
                let corners = [
                    [1.0, 1.0, 0.0],
                    [1.2, 1.0, 0.1],
                    [1.0, 1.3, 0.0],
                    [1.2, 1.3, -0.1],
                ];
                b.add(
                    SupportPolygon::new(masses)
                        .with_points_on(last, corners)
                        .with_margin(0.02),
                );
            }),
        ),
        (
            "gaze",
            Box::new(move |b| {
                b.add(Gaze::along(last, axis, aim, 0.1));
                b.add(Gaze::at(last, axis, aim * 5.0, 0.1));
            }),
        ),
        (
            "frame velocity",
            Box::new(move |b| {
                b.add(FrameVelocity::new(
                    last,
                    previous,
                    0.1,
                    ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]),
                ));
            }),
        ),
        (
            "manipulability",
            Box::new(move |b| {
                b.add(Manipulability::new(model, None, last, 50.0));
            }),
        ),
        (
            "manipulability against a base",
            Box::new(move |b| {
                b.add(Manipulability::new(model, Some(base), last, 50.0).of_position());
            }),
        ),
        (
            "posture with weights",
            Box::new(move |b| {
                b.add(Posture::new(model, &near).with_weights(weights.iter().copied()));
                b.add(Posture::new(model, &near).by_range(model));
            }),
        ),
        (
            "smoothness with weights",
            Box::new(move |b| {
                b.add(Smoothness::new(model, &at, 0.1).with_weights(heavy.iter().copied()));
            }),
        ),
        (
            "pose in a base",
            Box::new(move |b| {
                b.add(FramePose::new(last, previous).relative_to(base));
            }),
        ),
        (
            "poses with tools, free axes and room",
            Box::new(move |b| {
                b.add(FramePose::new(last, previous).with_tool(previous));
                b.add(FramePose::new(last, previous).with_goal(PoseBounds::free_about(Axis::Y)));
                b.add(FramePose::new(last, previous).with_goal(PoseBounds::within([0.01; 6])));
                b.add(Bounded::new(FramePose::new(base, previous), 0.05));
            }),
        ),
        (
            "places",
            Box::new(move |b| {
                b.add(Point::new(last, target).at(axis));
                b.add(Point::new(last, target).at(axis).relative_to(base));
                b.add(Orientation::new(last, previous.rotation));
                b.add(Orientation::new(last, previous.rotation).relative_to(base));
                b.add(Distance::new(last, base, 0.3));
                b.add(Plane::new(last, target, aim));
                b.add(Ray::new(last, target, aim));
                b.add(LookAt::new(last, axis, aim * 5.0));
            }),
        ),
        (
            "joints of one number",
            Box::new(move |b| {
                let moving = model.moving_joints().iter().copied();
                let kind = |id: JointId| model.joints()[id.index()].kind;
                let single = moving.filter(|&id| kind(id).coordinates() == 1);
                let shares = single.zip([0.5, -1.0, 2.0].into_iter().cycle());
                b.add(JointCoupling::new(model, shares, 0.1));
                b.add(LimitCentring::new(model));
            }),
        ),
    ]
}

/// Derivative of the residual by fourth-order differences: (8 (r₁ − r₋₁) − (r₂ − r₋₂)) / 12 h.
fn by_differences(problem: &Problem, x: &[f64]) -> DMatrix<f64> {
    const STEP: f64 = 1e-3;
    let mut scratch = problem.scratch();
    let mut residual_at = |component: usize, steps: f64| {
        let mut x = x.to_vec();
        x[component] += steps * STEP;
        let mut residual = nalgebra::DVector::zeros(problem.rows());
        Evaluation::new(problem, &mut scratch).residual(&x, residual.as_mut_slice());
        residual
    };
    let columns: Vec<_> = (0..x.len())
        .map(|j| {
            let [near, far] = [1.0, 2.0].map(|h| residual_at(j, h) - residual_at(j, -h));
            (near * 8.0 - far) / (12.0 * STEP)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

#[test]
fn derivative_routes_agree_on_floating_bases() {
    for seed in 0..8 {
        let figure = Figure::new(seed, 8);
        let (model, masses) = (&figure.model, masses_of(&figure));
        for (name, add) in tasks(&figure, &masses, seed) {
            let mut builder = Problem::builder(model);
            builder.parameters(ParameterMap::free(model));
            add(&mut builder);
            let Ok(problem) = builder.build() else {
                // Too few joints for manipulability.
                assert!(name.starts_with("manipulability"), "{name}");
                continue;
            };
            let mut x = vec![0.0; problem.variables()];
            for case in 0..3 {
                let mut q = match case {
                    0 => model.neutral(),
                    _ => model.random_configuration(seed + case),
                };
                if case == 2 {
                    // The base is 1e-7 rad short of half a turn.
                    let half = 0.5 * (PI - 1e-7);
                    q[3..7].copy_from_slice(&[half.cos(), half.sin(), 0.0, 0.0]);
                }
                problem.parameters().reduce(&q, &mut x).unwrap();
                let analytic = jacobian(&problem, Derivatives::Analytic, &x);
                let dual = jacobian(&problem, Derivatives::Dual, &x);
                let size = dual.amax().max(1.0);
                let deviation = (&analytic - &dual).amax() / size;
                assert!(
                    deviation < 1e-11,
                    "{name}, seed {seed}, case {case}: {deviation:e}"
                );
                if name.starts_with("manipulability") && case == 0 {
                    // It has a kink at singularities, such as the neutral configuration.
                    continue;
                }
                let central = jacobian(&problem, Derivatives::CentralDifference, &x);
                let deviation = (&central - &dual).amax() / size;
                assert!(
                    deviation < 1e-7,
                    "{name}, seed {seed}, case {case}: {deviation:e}"
                );
                // The long steps cross edges of inequalities.
                let is_smooth = !name.contains("room");
                let deviation = match is_smooth {
                    true => (by_differences(&problem, &x) - &dual).amax() / size,
                    false => 0.0,
                };
                assert!(
                    deviation < 1e-8,
                    "{name}, seed {seed}, case {case}: {deviation:e}"
                );
                for route in [Derivatives::Analytic, Derivatives::Dual] {
                    let problem = problem.clone().with_derivatives(route);
                    let mut scratch = problem.scratch();
                    let mut evaluation = Evaluation::new(&problem, &mut scratch);
                    let mut residual = vec![0.0; problem.rows()];
                    evaluation.residual(&x, &mut residual);
                    let mut gradient = vec![0.0; x.len()];
                    let mut buffer = DMatrix::zeros(residual.len(), x.len());
                    evaluation.gradient(&x, &residual, &mut gradient, &mut buffer);
                    let expected = dual.transpose() * nalgebra::DVector::from_vec(residual);
                    let scale = expected.amax().max(1.0);
                    let deviation =
                        (nalgebra::DVector::from_vec(gradient) - &expected).amax() / scale;
                    assert!(
                        deviation < 1e-11,
                        "{name}, seed {seed}, case {case}, {route:?}: {deviation:e}"
                    );
                }
            }
        }
    }
}

/// Manipulability of a frame relative to a base equals that of the base relative to the frame, for any joints between
/// them.
#[test]
fn manipulability_is_symmetric_in_base_and_frame() {
    let random = &mut Random::new(21);
    let mut builder = Model::builder("two arms");
    let limits = Limits::new(-2.0, 2.0);
    let stand = builder.frame("stand", None, placement(&random.rigid(0.5)));
    let [left, right] = ["left", "right"].map(|side| {
        let mut last = None;
        for k in 0..6 {
            let at = placement(&random.rigid(0.4));
            let axis = vector(random.direction().into_inner());
            last = Some(builder.revolute(format!("{side} {k}"), last, at, axis, limits));
        }
        builder.frame(side, last, placement(&random.rigid(0.3)))
    });
    let model = builder.build().unwrap();
    for case in 0..20 {
        let q: Vec<f64> = (0..12).map(|_| random.within(-2.0, 2.0)).collect();
        let measure = |task: Manipulability| {
            let inputs = task.inputs();
            let joints = inputs.joint_ids().iter();
            let values: Vec<f64> = joints.map(|id| q[model.coordinate(*id).unwrap()]).collect();
            let mut residual = [0.0];
            task.evaluate(&[], &values, &mut residual);
            1.0 - residual[0]
        };
        for [base, frame] in [[left, right], [stand, left], [stand, right]] {
            let manipulability = |base, frame| Manipulability::new(&model, Some(base), frame, 10.0);
            for [forward, backward] in [
                [manipulability(base, frame), manipulability(frame, base)],
                [manipulability(base, frame), manipulability(frame, base)]
                    .map(Manipulability::of_orientation),
            ] {
                let [forward, backward] = [forward, backward].map(measure);
                assert!(forward > 0.0, "case {case}");
                assert!(
                    (forward - backward).abs() < 1e-9 * forward,
                    "case {case}: {forward} {backward}"
                );
            }
        }
    }
}

/// The centre of mass of some configuration is reached, also with a polygon of one point.
#[test]
fn reachable_centre_of_mass_is_reached() {
    for seed in 0..20 {
        let figure = Figure::new(seed, 6);
        let (model, masses) = (&figure.model, masses_of(&figure));
        let target = centre_of_mass(model, &masses, &model.random_configuration(seed + 9)).unwrap();
        let mut builder = Problem::builder(model);
        builder.add(CentreOfMass::new(&masses, target));
        builder.add(Posture::new(model, &model.neutral()));
        let problem = builder.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &model.neutral())
            .unwrap();
        assert!(solution.reached, "seed {seed}: {}", solution.explain());
        let centre = centre_of_mass(model, &masses, &solution.q).unwrap();
        assert!((centre - target).norm() < 2e-6, "seed {seed}");
        let task = solution.tasks().next().unwrap();
        assert_eq!((task.name, task.frame), ("center of mass", None));
    }
}

/// Support triangle with one corner on a foot: no motion inside, and the closest point of the shrunken triangle
/// outside.
#[test]
fn balanced_robot_does_not_move() {
    let mut builder = Model::builder("sledge");
    let [x, y, _] = Vector3::UNITS;
    let still = Placement::identity();
    let wide = Limits::new(-5.0, 5.0);
    let along = builder.prismatic("along", None, still, x, wide);
    let aside = builder.prismatic("aside", Some(along), still, y, wide);
    let mass = builder.frame(
        "mass",
        Some(aside),
        Placement::translation([0.0, 0.0, 1.0].into()),
    );
    let foot = builder.frame("foot", None, Placement::translation([4.0, 0.0, 7.0].into()));
    let model = builder.build().unwrap();
    let mass = PointMass {
        frame: mass,
        at: Vector3::zero(),
        mass: 3.0,
    };
    let masses = Masses::new(&model, [mass]).unwrap();
    // Right triangle with legs of 4: (0, 0), (4, 0), (0, 4).
    let triangle = SupportPolygon::new(&masses)
        .with_points([[0.0, 0.0, 2.0], [0.0, 4.0, -3.0], [1.0, 1.0, 0.0]])
        .with_points_on(foot, [[0.0, 0.0, 0.5]]);
    let solve = |polygon: &SupportPolygon, start: [f64; 2]| {
        let mut tasks = Problem::builder(&model);
        tasks.add(polygon.clone());
        let problem = tasks.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        assert!(solution.reached, "{}", solution.explain());
        [solution.q[0], solution.q[1]]
    };
    let check = |found: [f64; 2], expected: [f64; 2]| {
        let deviation = f64::hypot(found[0] - expected[0], found[1] - expected[1]);
        assert!(deviation < 2e-6, "{found:?} {expected:?}");
    };
    assert_eq!(solve(&triangle, [0.5, 0.4]), [0.5, 0.4]);
    check(solve(&triangle, [-2.0, 1.0]), [0.0, 1.0]);
    check(solve(&triangle, [-2.0, -1.0]), [0.0, 0.0]);
    check(solve(&triangle, [3.0, 3.0]), [2.0, 2.0]);
    let inner = triangle.clone().with_margin(0.5);
    assert_eq!(solve(&inner, [0.6, 0.7]), [0.6, 0.7]);
    check(solve(&inner, [-2.0, 1.0]), [0.5, 1.0]);
    check(solve(&inner, [-2.0, -1.0]), [0.5, 0.5]);
    let edge = 2.0 - 0.5 * 0.5_f64.sqrt();
    check(solve(&inner, [3.0, 3.0]), [edge, edge]);
    // A support line, and a support point.
    let line =
        SupportPolygon::new(&masses).with_points([[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 5.0]]);
    check(solve(&line, [1.5, 1.0]), [1.5, 0.0]);
    let point = SupportPolygon::new(&masses).with_points([[1.0, 2.0, 3.0]]);
    check(solve(&point, [0.0, 0.0]), [1.0, 2.0]);
}

/// A custom residual with a signed distance.
#[derive(Clone)]
struct Depth(FrameId);

impl Residual for Depth {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
        r[0] = frames[0].translation.norm() - S::constant(2.0);
    }
}

/// `Bounded` makes any residual one-sided, also a custom one.
#[test]
fn custom_residual_may_be_one_sided() {
    for seed in 0..10 {
        let figure = Figure::new(2 * seed + 1, 5);
        let model = &figure.model;
        let last = figure.frames[4];
        let mut random = Random::new(seed);
        let [inside, outside] =
            [1.0, 3.0].map(|distance| Vector3::from(random.direction().into_inner() * distance));
        for (target, is_free) in [(inside, true), (outside, false)] {
            let mut tasks = Problem::builder(model);
            tasks.add(Task::new(Point::new(last, target)).preference());
            tasks.add(Bounded::at_most(Depth(last), 0.0));
            let problem = tasks.build().unwrap();
            let solution = Solver::default()
                .solve_once(&problem, &model.neutral())
                .unwrap();
            assert!(solution.reached, "seed {seed}: {}", solution.explain());
            let mut places = ForwardKinematics::new(model);
            let at = places.place(&solution.q).unwrap()[last.index()].translation;
            // Inside the sphere the point follows the soft task, outside it stops at the sphere.
            if is_free {
                assert!(
                    (at - target).norm() < 1e-3,
                    "seed {seed}: {at:?} {target:?}"
                );
            } else {
                let deviation = (at - target * (2.0 / 3.0)).norm();
                assert!(
                    (1.999..2.000_002).contains(&at.norm()) && deviation < 0.2,
                    "seed {seed}: {at:?}"
                );
            }
        }
    }
}

#[test]
fn invalid_task_input_is_rejected_by_name() {
    let figure = Figure::new(1, 6);
    let (model, masses) = (&figure.model, masses_of(&figure));
    let (last, nan) = (figure.frames[5], f64::NAN);
    let z = [0.0, 0.0, 1.0];
    let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let polygon = || SupportPolygon::new(&masses).with_points(square);
    let origin = Placement::identity();
    let neutral = model.neutral();
    let ball = model.moving_joints()[3];
    let refused = |add: &dyn Fn(&mut ProblemBuilder<'_>), words: &[&str]| {
        let mut builder = Problem::builder(model);
        add(&mut builder);
        let error = builder.build().unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    macro_rules! refuse {
        ($task:expr, $($word:literal),+) => {
            refused(&|b| { b.add($task); }, &[$($word),+]);
        };
    }
    refuse!(
        CentreOfMass::new(&masses, [nan; 3]),
        "center of mass",
        "target"
    );
    refuse!(
        CentreOfMass::new(&masses, [0.0; 3])
            .free_along(Axis::X)
            .free_along(Axis::Y)
            .free_along(Axis::Z),
        "center of mass",
        "all its axes are free"
    );
    refuse!(SupportPolygon::new(&masses), "support polygon", "no points");
    refuse!(polygon().with_margin(0.6), "margin", "nothing");
    refuse!(polygon().with_margin(-0.1), "margin", "-0.1");
    refuse!(polygon().with_up([0.0; 3]), "vertical");
    refuse!(
        SupportPolygon::new(&masses).with_points([[nan; 3]]),
        "points of support"
    );
    refuse!(Gaze::along(last, z, z, 0.0), "gaze", "half angle 0");
    refuse!(Gaze::along(last, z, z, 3.2), "half angle 3.2");
    refuse!(Gaze::along(last, [0.0; 3], z, 0.1), "axis");
    refuse!(Gaze::along(last, z, [0.0; 3], 0.1), "direction");
    refuse!(
        FrameVelocity::new(last, origin, 0.0, ([0.0; 3], z)),
        "frame velocity",
        "time step"
    );
    refuse!(
        FrameVelocity::new(last, origin, 0.1, ([nan; 3], z)),
        "velocity"
    );
    refuse!(
        JointCoupling::new(model, [], 0.0),
        "joint coupling",
        "no joints"
    );
    refuse!(
        JointCoupling::new(model, [(ball, 1.0)], 0.0),
        "joint coupling",
        "is a ball"
    );
    refuse!(
        JointCoupling::new(model, [(ball, nan)], 0.0),
        "coefficients"
    );
    refuse!(
        Posture::new(model, &neutral).with_weights([1.0]),
        "posture",
        "1 weights"
    );
    refuse!(
        Posture::new(model, &neutral).with_weights(vec![-1.0; 9]),
        "posture",
        "weight"
    );
    refuse!(
        Manipulability::new(model, None, last, 0.0),
        "manipulability",
        "least"
    );
    let near = Some(figure.frames[5]);
    refuse!(
        Manipulability::new(model, near, last, 1.0),
        "0 degrees of freedom"
    );
}

/// Redundant motion is shared evenly, or by weights: three revolute joints of a finger bend equally.
#[test]
fn joints_share_a_redundant_motion() {
    let mut builder = Model::builder("column");
    let (z, still) = (Vector3::UNITS[2], Placement::identity());
    let (mut last, mut joints) = (None, Vec::new());
    for limit in [1.0, 2.0, 4.0] {
        let limits = Limits::new(-limit, limit);
        let joint = builder.revolute(format!("{limit}"), last, still, z, limits);
        last = Some(joint);
        joints.push(joint);
    }
    let model = builder.build().unwrap();
    let sum = || JointCoupling::new(&model, joints.iter().map(|&joint| (joint, 1.0)), 2.1);
    let zero = || Posture::new(&model, &[0.0; 3]);
    for (posture, expected) in [
        (zero(), [0.7, 0.7, 0.7]),
        // λ/w² each.
        (zero().with_weights([1.0, 1.0, 0.5]), [0.35, 0.35, 1.4]),
        (zero().by_range(&model), [0.1, 0.4, 1.6]),
    ] {
        let mut tasks = Problem::builder(&model);
        tasks.add(sum());
        tasks.add(posture);
        let solution = Solver::default()
            .solve_once(&tasks.build().unwrap(), &[0.5, -0.2, 0.1])
            .unwrap();
        assert!(solution.reached);
        for (q, expected) in solution.q.iter().zip(expected) {
            assert!((q - expected).abs() < 1e-4, "{:?} {expected}", solution.q);
        }
    }
}

/// A stretched arm bends to the required measure; a pinned frame stays.
#[test]
fn manipulability_task_avoids_singularities() {
    let mut builder = Model::builder("arm");
    let [_, y, z] = Vector3::UNITS;
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let wide = Limits::new(-2.5, 2.5);
    let turn = builder.revolute("turn", None, Placement::identity(), z, wide);
    let lift = builder.revolute("lift", Some(turn), Placement::identity(), y, wide);
    let bend = builder.revolute("bend", Some(lift), link, y, wide);
    let tip = builder.frame("tip", Some(bend), link);
    let model = builder.build().unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(
        Task::new(Manipulability::new(&model, None, tip, 0.5).of_position())
            .goal()
            .tolerance(Quantity::Ratio, 1e-6),
    );
    let problem = tasks.build().unwrap();
    let solution = Solver::default()
        .solve_once(&problem, &[0.0, 0.1, 0.05])
        .unwrap();
    assert!(solution.reached, "{}", solution.explain());
    // |det J| of this arm is l² |sin bend| · (l cos lift + l cos(lift + bend)).
    let [_, lift, bend] = [solution.q[0], solution.q[1], solution.q[2]];
    let measure = (bend.sin() * (lift.cos() + (lift + bend).cos())).abs();
    assert!(measure >= 0.5 - 1e-5, "{measure}");

    let q = [0.2, 0.3, 1.4];
    let mut places = ForwardKinematics::new(&model);
    let before = places.place(&q).unwrap()[tip.index()];
    let mut tasks = Problem::builder(&model);
    let still = FrameVelocity::new(tip, before, 0.5, ([-0.2, 0.0, 0.1], [0.0; 3]));
    tasks.add(Task::new(still).weight(Quantity::RadiansPerSecond, 0.0));
    let solution = Solver::default()
        .solve_once(&tasks.build().unwrap(), &q)
        .unwrap();
    assert!(solution.reached, "{}", solution.explain());
    let after = places.place(&solution.q).unwrap()[tip.index()];
    let error = after.translation - before.translation - Vector3::new(-0.1, 0.0, 0.05);
    assert!(error.norm() < 1e-6, "{error:?}");
}
