//! Promise: a target that is moved by a small step within the residual, as derivatives of solutions do, equals one
//! moved by the task's setter.

use kinopt::model::{JointId, Model};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{
    Axis, Bounded, DifferentiableTarget, FramePose, FrameVelocity, Gaze, LookAt, Orientation,
    Plane, Point, Ray,
};

fn same<R: DifferentiableTarget>(task: &R, moved: &R, step: &[f64]) {
    let placed = Placement::new(
        rotation_exp(Vector3::new(0.4, -0.3, 0.8)),
        Vector3::new(0.2, 0.5, -0.1),
    );
    same_at(
        task,
        moved,
        step,
        &vec![placed; task.inputs().frame_ids().len()],
        &[],
    );
}

/// Compares the rows of a task with its target moved by a step and of one set there, at given frames and joints.
fn same_at<R: DifferentiableTarget>(
    task: &R,
    moved: &R,
    step: &[f64],
    frames: &[Placement<f64>],
    joints: &[f64],
) {
    let rows: usize = task.rows().iter().map(|rows| rows.count).sum();
    let [mut unmoved, mut by_step, mut by_setter] = [(); 3].map(|()| vec![0.0; rows]);
    task.evaluate(frames, joints, &mut unmoved);
    task.evaluate_moved(frames, joints, step, &mut by_step);
    moved.evaluate(frames, joints, &mut by_setter);
    let deviation_of = |a: &[f64], b: &[f64]| {
        let pairs = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        pairs.fold(0.0, f64::max)
    };
    let kind = task.description().kind();
    assert!(
        deviation_of(&unmoved, &by_step) > 1e-6,
        "{kind}: {unmoved:?} {by_step:?}"
    );
    assert!(
        deviation_of(&by_step, &by_setter) < 1e-12,
        "{kind}: {by_step:?} {by_setter:?}"
    );
}

#[test]
fn positions_and_directions_move_by_the_step() {
    let mut builder = Model::builder("eye");
    let frame = builder.frame("eye", None::<JointId>, Placement::identity());
    builder.build().unwrap();
    let (target, step) = (Vector3::new(1.0, 0.5, 2.0), [1e-3, -2e-3, 3e-3]);
    let moved_target = target + Vector3::from(step);
    let axis = [1.0, 0.2, 0.0];
    for gaze in [
        Gaze::at(frame, axis, target, 0.1),
        Gaze::along(frame, axis, target, 0.1),
    ] {
        let mut moved = gaze;
        moved.set_target(moved_target);
        same(&gaze, &moved, &step);
    }
    same(
        &Point::new(frame, target),
        &Point::new(frame, moved_target),
        &step,
    );
}

/// A task that is set equals a task constructed with the value.
#[test]
fn setter_equals_the_constructor() {
    let mut builder = Model::builder("eye");
    let frame = builder.frame("eye", None::<JointId>, Placement::identity());
    builder.build().unwrap();
    let [a, b, c, d] = [0.1, 0.7, 1.3, 2.0].map(|k| Vector3::new(k, 1.0 - k, 0.5 * k));
    let [one, other] = [a, b].map(|vector| Placement::new(rotation_exp(vector), vector));

    let mut plane = Plane::new(frame, a, b);
    plane.set_plane(c, d);
    assert_eq!(plane, Plane::new(frame, c, d));
    let mut ray = Ray::new(frame, a, b);
    ray.set_line(c, d);
    assert_eq!(ray, Ray::new(frame, c, d));
    let mut look = LookAt::new(frame, a, b);
    look.set_target(c);
    assert_eq!(look, LookAt::new(frame, a, c));
    let mut pose = FramePose::new(frame, one);
    pose.set_target(other);
    assert_eq!(pose, FramePose::new(frame, other));
    let mut turned = Orientation::new(frame, one.rotation);
    turned.set_target(other.rotation);
    assert_eq!(turned, Orientation::new(frame, other.rotation));
    let mut moving = FrameVelocity::new(frame, one, 0.1, (a, b));
    moving.set_previous(other);
    moving.set_velocity(c, d);
    assert_eq!(moving, FrameVelocity::new(frame, other, 0.1, (c, d)));
    let mut within = Bounded::at_most(Point::new(frame, a), 0.1);
    within.residual_mut().set_target(b);
    assert_eq!(within, Bounded::at_most(Point::new(frame, b), 0.1));
}

/// The same for scalar values.
#[test]
fn scalar_setter_equals_the_constructor() {
    use kinopt::model::Limits;
    use kinopt::task::{Distance, JointCoupling, Manipulability};
    let mut builder = Model::builder("hinges");
    let (at, mut last, mut frames, mut joints) =
        (Placement::identity(), None, Vec::new(), Vec::new());
    for (name, axis) in ["a", "b", "c"].iter().zip(Vector3::UNITS) {
        last = Some(builder.revolute(*name, last, at, axis, Limits::new(-1.0, 1.0)));
        joints.extend(last);
        frames.push(builder.frame(*name, last, at));
    }
    let model = builder.build().unwrap();
    let mut distance = Distance::new(frames[0], frames[1], 0.5);
    distance.set_distance(0.7);
    assert_eq!(distance, Distance::new(frames[0], frames[1], 0.7));
    let least = |least: f64| Manipulability::new(&model, None, frames[2], least).of_orientation();
    let mut manipulability = least(0.5);
    manipulability.set_least(0.7);
    assert_eq!(manipulability, least(0.7));
    let coupled =
        |offset: f64| JointCoupling::new(&model, [(joints[0], 1.0), (joints[1], -2.0)], offset);
    let mut coupling = coupled(0.5);
    coupling.set_offset(0.7);
    assert_eq!(coupling, coupled(0.7));
}

/// Targets belong to a problem with the same kinds of tasks in the same order, and to no other.
#[test]
fn targets_of_other_tasks_are_rejected() {
    use kinopt::model::Limits;
    use kinopt::problem::{Problem, ProblemBuilder, ProblemError};
    let mut builder = Model::builder("hinge");
    let at = Placement::identity();
    let z = Vector3::UNITS[2];
    let hinge = builder.revolute("hinge", None, at, z, Limits::new(-1.0, 1.0));
    let frame = builder.frame(
        "tip",
        Some(hinge),
        Placement::translation(Vector3::UNITS[0]),
    );
    let model = builder.build().unwrap();
    let [a, b] = [Vector3::new(0.5, 0.5, 0.0), Vector3::new(0.0, 1.0, 0.0)];
    type AddTask<'a> = &'a dyn Fn(&mut ProblemBuilder<'_>);
    let problem = |adds: &[AddTask<'_>]| {
        let mut builder = Problem::builder(&model);
        adds.iter().for_each(|add| add(&mut builder));
        builder.build().unwrap()
    };
    let point: AddTask<'_> = &|builder| {
        builder.add(Point::new(frame, a));
    };
    let other: AddTask<'_> = &|builder| {
        builder.add(Point::new(frame, b));
    };
    let pose: AddTask<'_> = &|builder| {
        builder.add(FramePose::new(frame, Placement::translation(a)));
    };
    let look: AddTask<'_> = &|builder| {
        builder.add(LookAt::new(frame, a, b));
    };
    let first_problem = problem(&[point, pose]);
    assert!(
        first_problem
            .with_targets(&problem(&[other, pose]).targets())
            .is_ok()
    );
    for others in [
        &[point][..],
        &[point, look],
        &[pose, point],
        &[point, pose, look],
    ] {
        let targets = problem(others).targets();
        let refused = first_problem.with_targets(&targets);
        assert!(matches!(refused, Err(ProblemError::ForeignTargets { .. })));
    }
}

/// Getters of tasks and problems return the given values.
#[test]
fn getters_return_the_given_values() {
    use kinopt::model::Limits;
    use kinopt::problem::Problem;
    use kinopt::task::{Posture, Task};
    let mut builder = Model::builder("hinge");
    let at = Placement::identity();
    let hinge = builder.revolute("hinge", None, at, Vector3::UNITS[2], Limits::new(-1.0, 1.0));
    let frame = builder.frame("tip", Some(hinge), at);
    let model = builder.build().unwrap();
    let tool = Placement::translation(Vector3::new(0.1, 0.2, 0.3));
    assert_eq!(FramePose::new(frame, at).frame_from_tool(), at);
    assert_eq!(
        FramePose::new(frame, at).with_tool(tool).frame_from_tool(),
        tool
    );
    for (is_goal, prefers) in [(true, false), (false, true)] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(frame, Vector3::UNITS[0]));
        let posture = Task::new(Posture::new(&model, &[0.5]));
        builder.add(if is_goal { posture.goal() } else { posture });
        assert_eq!(builder.build().unwrap().has_preferences(), prefers);
    }
}

/// Compares the rows of a task with numbers moved by a step and of one set there.
fn same_with<R: DifferentiableTarget>(task: &R, moved: &R, step: &[f64], joints: &[f64]) {
    assert_eq!(
        task.target_len(),
        step.len(),
        "{}",
        task.description().kind()
    );
    let mut random = support::random::Random::new(31);
    let mut anywhere = || {
        let mut random_vector = || Vector3::from([0; 3].map(|_| random.within(-0.5, 0.5)));
        Placement::new(rotation_exp(random_vector()), random_vector())
    };
    let frames: Vec<_> = task
        .inputs()
        .frame_ids()
        .iter()
        .map(|_| anywhere())
        .collect();
    same_at(task, moved, step, &frames, joints);
}

/// Numbers, pixels, points of lines, postures and velocities are moved by a step like positions.
#[test]
fn targets_of_every_kind_move_by_the_step() {
    use kinopt::model::{Limits, Masses, PointMass};
    use kinopt::task::{Camera, CentreOfMass, Distance, JointCoupling, Pixel, Posture};
    let mut builder = Model::builder("hinges");
    let (identity, mut last, mut frames, mut joints) =
        (Placement::identity(), None, Vec::new(), Vec::new());
    for (name, axis) in ["a", "b", "c"].iter().zip(Vector3::UNITS) {
        last = Some(builder.revolute(*name, last, identity, axis, Limits::new(-1.0, 1.0)));
        joints.extend(last);
        frames.push(builder.frame(*name, last, identity));
    }
    let model = builder.build().unwrap();
    let [a, b] = [frames[0], frames[1]];
    let (point, step) = (Vector3::new(1.0, 0.5, 2.0), [1e-3, -2e-3, 3e-3]);
    let moved_point = point + Vector3::from(step);

    let distance = |change: f64| Distance::new(a, b, 0.4 + change);
    same_with(&distance(0.0), &distance(1e-3), &[1e-3], &[]);
    let through = |through: Vector3<f64>| Ray::new(a, [0.1, 0.2, -3.0], through);
    let mut ray = through(point);
    // A line's target is the mouse; its eye moves along.
    ray.set_line(
        Vector3::new(0.1, 0.2, -3.0) + Vector3::from(step),
        moved_point,
    );
    same_with(&through(point), &ray, &step, &[]);
    let plane = |at: Vector3<f64>| Plane::new(a, at, [0.2, 0.4, 1.0]);
    same_with(&plane(point), &plane(moved_point), &step, &[]);
    let look = |at: Vector3<f64>| LookAt::new(a, [2.0, 0.3, 0.1], at);
    same_with(&look(point), &look(moved_point), &step, &[]);
    let camera = Camera::pinhole(
        &Placement::translation([0.0, 0.0, -3.0].into()),
        [500.0, 480.0],
        [320.0, 240.0],
    );
    let pixel = |by: [f64; 2]| Pixel::new(a, camera, [300.0 + by[0], 200.0 + by[1]]);
    same_with(&pixel([0.0; 2]), &pixel([1e-3, -2e-3]), &[1e-3, -2e-3], &[]);
    let points = [(0, 1.0), (2, 3.0)].map(|(k, mass)| PointMass {
        frame: frames[k],
        mass,
        at: Vector3::new(0.1, 0.2, 0.3),
    });
    let masses = Masses::new(&model, points).unwrap();
    let centre = |at: Vector3<f64>| CentreOfMass::new(&masses, at).free_along(Axis::Y);
    same_with(&centre(point), &centre(moved_point), &step, &[]);
    let relative = |at: Vector3<f64>| CentreOfMass::new(&masses, at).relative_to(b);
    same_with(&relative(point), &relative(moved_point), &step, &[]);
    let velocity = [1e-3, -2e-3, 3e-3, 2e-3, 1e-3, -1e-3];
    let moving = |change: f64| {
        let [x, y, z, a, b, c] = velocity.map(|v| 0.3 + change * v);
        let (linear, angular) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        FrameVelocity::new(
            frames[2],
            Placement::translation(point),
            0.1,
            (linear, angular),
        )
    };
    same_with(&moving(0.0), &moving(1.0), &velocity, &[]);
    let values = [0.3, -0.4, 0.7];
    let coupled = |change: f64| {
        JointCoupling::new(&model, [(joints[0], 1.0), (joints[1], -2.0)], 0.5 + change)
    };
    same_with(&coupled(0.0), &coupled(1e-3), &[1e-3], &values);
    let posture = |change: f64| Posture::new(&model, &step.map(|step| 0.2 + change * step));
    same_with(&posture(0.0), &posture(1.0), &step, &values);
}
