//! Promise: an inequality of a required task constrains lower priorities at its boundary, and only while they pull
//! outward.

use kinopt::ik::Drag;
use kinopt::model::{FrameId, Limits, Model};
use kinopt::problem::Problem;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Bounded, Extensions, FramePose, Gaze, Inequality, InequalityResidual, Inputs, Plane, Point,
    PoseBounds, Posture, Quantity, Residual, RowBlock, SupportPolygon, Task,
};
use kinopt::{Scalar, Solution, Solver};
use support::arms::robot;
use support::bodies::sledge;
use support::random::{Random, case_count};
use support::trees::configuration_of;

use crate::soft_task_fixtures::{Add, linearised};

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// An upward prismatic joint and its frame.
fn slide() -> (Model, FrameId) {
    let mut builder = Model::builder("slide");
    let axis = Vector3::UNITS[2];
    let limits = Limits::new(-2.0, 2.0);
    let slide = builder.prismatic("z", None, Placement::identity(), axis, limits);
    let frame = builder.frame("t", Some(slide), Placement::identity());
    (builder.build().unwrap(), frame)
}

/// A revolute joint about z and its frame.
fn hinge() -> (Model, FrameId) {
    let mut builder = Model::builder("hinge");
    let axis = Vector3::UNITS[2];
    let hinge = builder.revolute(
        "a",
        None,
        Placement::identity(),
        axis,
        Limits::new(-3.0, 3.0),
    );
    let frame = builder.frame("t", Some(hinge), Placement::identity());
    (builder.build().unwrap(), frame)
}

/// Residual with its own inequality: depth of a frame below a height.
#[derive(Clone)]
struct Below(FrameId, f64);

impl Residual for Below {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], residual: &mut [S]) {
        let below = S::constant(self.1) - frames[0].translation.z;
        residual[0] = below.max(S::zero());
    }
}

impl InequalityResidual for Below {
    fn inequalities(&self) -> Vec<Inequality> {
        vec![Inequality::new(0..1, 1)]
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], depths: &mut [S]) {
        depths[0] = frames[0].translation.z - S::constant(self.1);
    }
}

/// Results of a one-variable goal with a posture, from several starts, by the solver and by a settled drag.
fn ends(model: &Model, goal: Add<'_>, reference: f64, starts: &[f64]) -> Vec<f64> {
    let mut builder = Problem::builder(model);
    goal(&mut builder);
    builder.add(Posture::new(model, &[reference]));
    let problem = builder.build().unwrap();
    let mut ends = Vec::new();
    for &start in starts {
        let solution = Solver::default().solve_once(&problem, &[start]).unwrap();
        assert!(solution.reached, "{}", solution.explain());
        ends.push(solution.q[0]);
        let mut drag = Drag::new(problem.clone(), &[start]).unwrap();
        ends.push(drag.settle(100).q[0]);
    }
    ends
}

fn assert_all_near(ends: &[f64], expected: f64, what: &str) {
    let deviation = ends
        .iter()
        .fold(0.0_f64, |largest, x| largest.max((x - expected).abs()));
    assert!(deviation < 2e-6, "{what}: {ends:?}, not {expected}");
}

#[test]
fn soft_task_leaves_or_keeps_the_boundary() {
    let (slide, carried) = slide();
    let floor = || Plane::new(carried, [0.0, 0.0, 0.5], UP);
    let starts = [0.0, 0.5, 0.7, 1.9, -1.0];
    let rooms: [(&str, Add<'_>); 3] = [
        ("plane", &|builder| {
            builder.add(Bounded::at_least(floor(), 0.0));
        }),
        ("own residual", &|builder| {
            builder.add(Below(carried, 0.5));
        }),
        ("goal", &|builder| {
            let target = Placement::translation([0.0, 0.0, 1.25].into());
            let bounds = PoseBounds::within([0.0, 0.0, 0.75, 0.0, 0.0, 0.0]);
            builder.add(FramePose::new(carried, target).with_goal(bounds));
        }),
    ];
    for (what, goal) in rooms {
        assert_all_near(&ends(&slide, goal, 1.0, &starts), 1.0, what);
        assert_all_near(&ends(&slide, goal, -1.0, &starts), 0.5, what);
    }
    let (hinge, carried) = hinge();
    let gaze: Add<'_> = &|builder| {
        let ahead = Vector3::UNITS[0];
        builder.add(Gaze::along(carried, ahead, ahead, 0.3));
    };
    let starts = [1.0, 0.3, -1.2, 0.1];
    assert_all_near(&ends(&hinge, gaze, 0.0, &starts), 0.0, "gaze");
    assert_all_near(&ends(&hinge, gaze, 0.2, &starts), 0.2, "gaze");
    assert_all_near(&ends(&hinge, gaze, -0.9, &starts), -0.3, "gaze");
}

/// Half-space above a floor as a bounded task, and a point below it on a lower level.
fn over_a_floor(model: &Model, flange: FrameId, at: [f64; 3]) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(Bounded::at_least(
        Plane::new(flange, [0.0, 0.0, 0.4], UP),
        0.0,
    ));
    builder.add(Task::new(Point::new(flange, at)).at_level(1));
    builder.build().unwrap()
}

/// Closest point of a triangle, corners in counter-clockwise order.
fn nearest(corners: [[f64; 2]; 3], to: [f64; 2]) -> [f64; 2] {
    let sides = (0..3).map(|k| (corners[k], corners[(k + 1) % 3]));
    let is_outside = |(a, b): ([f64; 2], [f64; 2])| {
        (b[0] - a[0]) * (to[1] - a[1]) - (b[1] - a[1]) * (to[0] - a[0]) < 0.0
    };
    if !sides.clone().any(is_outside) {
        return to;
    }
    let on_side = |(a, b): ([f64; 2], [f64; 2])| {
        let (side, displacement) = ([b[0] - a[0], b[1] - a[1]], [to[0] - a[0], to[1] - a[1]]);
        let share = (side[0] * displacement[0] + side[1] * displacement[1])
            / (side[0].powi(2) + side[1].powi(2));
        let share = share.clamp(0.0, 1.0);
        [a[0] + share * side[0], a[1] + share * side[1]]
    };
    let distance = |at: &[f64; 2]| f64::hypot(at[0] - to[0], at[1] - to[1]);
    let places = sides.map(on_side);
    places
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap()
}

#[test]
fn sledge_in_triangle_reaches_closest_point() {
    let (model, frame, masses) = sledge();
    let corners = [[0.0, 0.0], [2.0, 0.3], [0.7, 1.9]];
    let triangle = SupportPolygon::new(&masses).with_points(corners.map(|[x, y]| [x, y, 0.0]));
    for seed in 0..case_count(200, 40) as u64 {
        let mut random = Random::new(seed);
        let [start, to] = [(); 2].map(|()| [(); 2].map(|()| random.within(-2.0, 4.0)));
        let best = nearest(corners, to);
        let goal: Add<'_> = &|builder| {
            builder.add(Task::new(Point::new(frame, [to[0], to[1], 0.0])).at_level(1));
        };
        let preference: Add<'_> = &|builder| {
            builder.add(Posture::new(&model, &to));
        };
        for (what, below) in [("goal", goal), ("preference", preference)] {
            let mut builder = Problem::builder(&model);
            builder.add(triangle.clone());
            below(&mut builder);
            let solution = Solver::default()
                .solve_once(&builder.build().unwrap(), &start)
                .unwrap();
            let deviation = f64::hypot(solution.q[0] - best[0], solution.q[1] - best[1]);
            assert!(
                deviation < 2e-6,
                "{what} {seed}: {:?}, not {best:?}: {}",
                solution.q,
                solution.explain()
            );
        }
    }
}

fn error(solution: &Solution, task: usize) -> f64 {
    let task = solution.tasks().nth(task).unwrap();
    task.position_error().unwrap()
}

#[test]
fn closest_point_above_floor_is_vertical() {
    let robot = robot("kuka_iiwa14");
    let model = robot.model();
    let flange = model.frame("flange").unwrap();
    for seed in 0..case_count(200, 20) as u64 {
        let mut random = Random::new(seed);
        let start = configuration_of(model, &mut random);
        let angle = random.within(-3.0, 3.0);
        let (out, below) = (random.within(0.4, 0.6), random.within(0.0, 0.35));
        let at = [out * angle.cos(), out * angle.sin(), below];
        let problem = over_a_floor(model, flange, at);
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        let best = 0.4 - below;
        assert!(
            (error(&solution, 1) - best).abs() < 1e-6,
            "{seed}: {} instead of {best}: {}",
            error(&solution, 1),
            solution.explain()
        );
    }
}

#[test]
fn posture_above_floor_is_stationary() {
    let robot = robot("kuka_iiwa14");
    let model = robot.model();
    let flange = model.frame("flange").unwrap();
    let (mut on_edge, mut left) = (0, Vec::new());
    for seed in 0..case_count(100, 20) as u64 {
        let mut random = Random::new(1000 + seed);
        let [start, reference] = [(); 2].map(|()| configuration_of(model, &mut random));
        let mut builder = Problem::builder(model);
        let floor = || Plane::new(flange, [0.0, 0.0, 0.4], UP);
        builder.add(Bounded::at_least(floor(), 0.0));
        builder.add(Posture::new(model, &reference));
        let solution = Solver::default()
            .solve_once(&builder.build().unwrap(), &start)
            .unwrap();
        assert!(solution.reached, "{seed}: {}", solution.explain());

        let mut alone = Problem::builder(model);
        alone.add(Posture::new(model, &reference));
        let (residual, jacobian) = linearised(&alone.build().unwrap(), &solution.q);
        let mut slope = jacobian.transpose() * &residual;
        let mut plane = Problem::builder(model);
        plane.add(floor());
        let (height, row) = linearised(&plane.build().unwrap(), &solution.q);
        let mut row = row.transpose();
        for (j, &id) in model.moving_joints().iter().enumerate() {
            let limits = model.joints()[id.index()].limits;
            let out = (solution.q[j] <= limits.lower && slope[j] > 0.0)
                || (solution.q[j] >= limits.upper && slope[j] < 0.0);
            if out {
                (slope[j], row[j]) = (0.0, 0.0);
            }
        }
        let residual_norm = residual.norm();
        let along = slope.dot(&row.column(0));
        // A floor only opposes a downward pull.
        if height[0] < 1e-8 && along > 0.0 {
            on_edge += 1;
            slope -= row.column(0) * (along / row.norm_squared());
        }
        left.push(slope.norm() / residual_norm.max(1e-9));
    }
    left.sort_by(f64::total_cmp);
    assert!(on_edge * 10 > left.len(), "{on_edge} of {}", left.len());
    let settled = left.iter().filter(|left| **left < 1e-4).count();
    assert!(settled * 100 >= 98 * left.len(), "{settled}: {left:?}");
}

/// A goal with inequalities on several axes enforces each of them: lower priorities that pull outward end in the
/// corner.
#[test]
fn inequalities_on_all_axes_hold() {
    let mut builder = Model::builder("slides");
    let (mut last, limits) = (None, Limits::new(-2.0, 2.0));
    for (name, axis) in ["x", "y", "z"].iter().zip(Vector3::UNITS) {
        last = Some(builder.prismatic(*name, last, Placement::identity(), axis, limits));
    }
    let carried = builder.frame("t", last, Placement::identity());
    let model = builder.build().unwrap();
    let widths = [0.5, 0.25, 0.75];
    for signs in 0..8 {
        let sign = [0, 1, 2].map(|k| if signs >> k & 1 == 0 { 1.0 } else { -1.0 });
        let corner = [0, 1, 2].map(|k| sign[k] * widths[k]);
        // With a point on a lower level, and with a soft task.
        for level in [true, false] {
            let mut builder = Problem::builder(&model);
            let bounds = PoseBounds::within([0.5, 0.25, 0.75, 0.0, 0.0, 0.0]);
            builder.add(FramePose::new(carried, Placement::identity()).with_goal(bounds));
            let target = sign.map(|sign| 1.5 * sign);
            match level {
                true => {
                    builder.add(Task::new(Point::new(carried, target)).at_level(1));
                }
                false => {
                    builder.add(Posture::new(&model, &target));
                }
            }
            let problem = builder.build().unwrap();
            let start = [0.1, -0.2, 0.3];
            let solution = Solver::default().solve_once(&problem, &start).unwrap();
            for (value, edge) in solution.q.iter().zip(corner) {
                assert!((value - edge).abs() < 2e-6, "{corner:?}: {:?}", solution.q);
            }
        }
    }
}
