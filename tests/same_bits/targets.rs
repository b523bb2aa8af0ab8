//! Promise: so it is for targets that are set anew, what they are asked for, and tasks that are refused.
#![allow(clippy::unwrap_used)]

use kinopt::model::Masses;
use kinopt::problem::{Evaluation, Problem, ProblemBuilder};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_exp};
use kinopt::task::{
    Axis, Bounded, Camera, CentreOfMass, Distance, FramePose, FrameVelocity, Gaze, JointCoupling,
    LookAt, Manipulability, Numeric, Orientation, Pixel, Plane, Point, PoseBounds, Posture,
    Quantity, Ray, Smoothness, SupportPolygon, Task,
};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, masses, model, place, vector};
use crate::tasks::{Own, camera};

/// Targets set anew, in the problem's own and in a copy's.
fn targets() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(122));
    let model = model(&mut random, false);
    let q = configuration(&model, &mut random);
    let masses = masses(&model, &mut random);
    let [hand, foot] = frames(&model, &["hand", "foot"])[..] else {
        unreachable!()
    };
    let elbow = model.joint("elbow").unwrap();
    let x = Vector3::UNITS[0];
    let mut tasks = Problem::builder(&model);
    let point = tasks.add(Point::new(hand, x).relative_to(foot).at(x));
    let orientation = tasks.add(Orientation::new(hand, Matrix3::identity()).relative_to(foot));
    let pose = tasks.add(
        FramePose::new(hand, x)
            .with_goal(PoseBounds::free_about(Axis::X))
            .relative_to(foot),
    );
    let look = tasks.add(LookAt::new(hand, x, x));
    let gaze = tasks.add(Gaze::along(hand, x, x, 0.3));
    let at = tasks.add(Gaze::at(hand, x, x, 0.3));
    let plane = tasks.add(Bounded::new(Plane::new(hand, x, x), 0.1));
    let ray = tasks.add(Ray::new(hand, x, Vector3::zero()));
    let distance = tasks.add(Distance::new(hand, foot, 0.1));
    let pixel = tasks.add(Pixel::new(hand, camera(&mut random), [0.0; 2]));
    let velocity = tasks.add(FrameVelocity::new(hand, x, 0.1, (x, x)));
    let centre = tasks.add(CentreOfMass::new(&masses, x).relative_to(foot));
    let posture = tasks.add(Posture::new(&model, &q));
    let smooth = tasks.add(Smoothness::new(&model, &q, 0.1));
    let coupling = tasks.add(JointCoupling::new(&model, [(elbow, 1.0)], 0.0));
    let able = tasks.add(Manipulability::new(&model, None, hand, 1.0));
    let problem = tasks.build().unwrap();
    let mut targets = problem.targets();
    let own = &mut targets;
    let pieces = [(); 12].map(|()| vector(&mut random, 0.8));
    own.get_mut(point).unwrap().set_target(pieces[0]);
    own.get_mut(orientation)
        .unwrap()
        .set_target(rotation_exp(pieces[1]));
    own.get_mut(pose)
        .unwrap()
        .set_target(place(&mut random, 0.5));
    own.get_mut(look).unwrap().set_target(pieces[2]);
    own.get_mut(gaze).unwrap().set_target(pieces[3]);
    own.get_mut(at).unwrap().set_target(pieces[4]);
    own.get_mut(plane)
        .unwrap()
        .residual_mut()
        .set_plane(pieces[5], pieces[6]);
    own.get_mut(ray).unwrap().set_line(pieces[7], pieces[8]);
    own.get_mut(distance).unwrap().set_distance(0.7);
    own.get_mut(pixel).unwrap().set_target([12.0, 34.0]);
    own.get_mut(velocity)
        .unwrap()
        .set_velocity(pieces[9], pieces[10]);
    own.get_mut(velocity)
        .unwrap()
        .set_previous(place(&mut random, 0.3));
    own.get_mut(centre).unwrap().set_target(pieces[11]);
    let other = configuration(&model, &mut random);
    own.get_mut(posture).unwrap().set_reference(&other).unwrap();
    own.get_mut(smooth).unwrap().set_previous(&other).unwrap();
    own.get_mut(coupling).unwrap().set_offset(0.4);
    own.get_mut(able).unwrap().set_least(20.0);
    digest.refusal(own.get_mut(posture).unwrap().set_reference(&other[1..]));
    digest.refusal(own.get_mut(smooth).unwrap().set_previous(&[]));
    digest.noted(&(
        own.get(point),
        own.get(orientation),
        own.get(pose),
        own.get(plane),
    ));
    let kept = own.get(pose).unwrap();
    digest.noted(&(
        kept.target(),
        kept.goal().map(|goal| goal.half_widths()),
        kept.base(),
        kept.frame_from_tool(),
    ));
    let kept = own.get(point).unwrap();
    digest.noted(&(kept.base(), kept.offset(), kept.target()));
    let kept = own.get(centre).unwrap();
    digest.noted(&(
        kept.base(),
        kept.target(),
        own.get(orientation).unwrap().base(),
        own.get(orientation).unwrap().target(),
    ));
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(&q, &mut x).unwrap();
    let mut scratch = problem.scratch();
    for question in [problem.with_targets(&targets).unwrap(), (&problem).into()] {
        let mut own = Evaluation::new(question, &mut scratch);
        let mut r = vec![0.0; own.rows()];
        own.residual(&x, &mut r);
        digest.doubles(r);
        digest.noted(&(
            question.variables(),
            question.rows(),
            question.lower(),
            question.upper(),
        ));
    }
    let mut fewer = Problem::builder(&model);
    let wrong = fewer.add(Point::new(hand, Vector3::zero()));
    let fewer = fewer.build().unwrap();
    digest.refusal(problem.with_targets(&fewer.targets()));
    digest.refusal(fewer.with_targets(&targets));
    digest.refusal(fewer.targets().get(pose));
    digest.refusal(fewer.targets().get_mut(look));
    digest.refusal(targets.get(wrong));
    digest.refusal(problem.is_reached(&[0.0; 3]));
    digest.noted(&(wrong.index(), pose.index()));
    let ray = camera(&mut random).viewing_ray([200.0, 100.0]);
    digest.noted(&ray);
    digest.noted(&camera(&mut random).project(Vector3::new(0.1, 0.2, 0.3)));
    digest.noted(
        &Camera {
            pixel_from_world: [[0.0; 4]; 3],
        }
        .viewing_ray([1.0, 2.0]),
    );
    digest.value()
}

/// What a task says that cannot be one.
fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(123));
    let model = model(&mut random, false);
    let masses: Masses = masses(&model, &mut random);
    let q = configuration(&model, &mut random);
    let [hand, foot] = frames(&model, &["hand", "foot"])[..] else {
        unreachable!()
    };
    let waist = model.joint("waist").unwrap();
    let mut slanted = place(&mut random, 0.1);
    slanted.rotation.x = slanted.rotation.x * 1.01;
    let (x, nan, zero) = (Vector3::UNITS[0], [f64::NAN, 0.0, 0.0], [0.0; 3]);
    let straight = Placement::identity();
    let mut add = |task: &dyn Fn(&mut ProblemBuilder<'_>)| {
        let mut tasks = Problem::builder(&model);
        task(&mut tasks);
        digest.refusal(tasks.build());
    };
    macro_rules! refused {
        ($($task:expr),* $(,)?) => { $(add(&|tasks| {
            tasks.add($task);
        });)* };
    }
    refused![
        Point::new(hand, nan),
        Point::new(hand, x).at(nan),
        Point::new(hand, x).relative_to(hand),
        Orientation::new(hand, slanted.rotation),
        Orientation::new(hand, straight.rotation).relative_to(hand),
        FramePose::new(hand, slanted),
        FramePose::new(hand, straight).with_tool(slanted),
        FramePose::new(hand, straight).relative_to(hand),
        FramePose::new(hand, Vector3::from(nan)),
        FramePose::new(hand, straight).with_tool(Vector3::from(nan)),
        FramePose::new(hand, straight)
            .with_goal(PoseBounds::within([0.0, -0.1, 0.0, 0.0, 0.0, 0.0])),
        FramePose::new(hand, straight).with_goal(PoseBounds::within([
            0.0,
            0.0,
            0.0,
            0.0,
            f64::NAN,
            0.0
        ])),
        FramePose::new(hand, straight).with_goal(PoseBounds::within([f64::INFINITY; 6])),
        LookAt::new(hand, zero, x),
        LookAt::new(hand, x, nan),
        Gaze::at(hand, x, nan, 0.2),
        Gaze::at(hand, zero, x, 0.2),
        Gaze::along(hand, x, zero, 0.2),
        Gaze::along(hand, x, x, 0.0),
        Gaze::along(hand, x, x, 3.2),
        Plane::new(hand, nan, x),
        Plane::new(hand, x, zero),
        Ray::new(hand, x, x),
        Ray::new(hand, nan, x),
        Distance::new(hand, foot, -0.1),
        Distance::new(hand, hand, 0.1),
        Distance::new(hand, foot, f64::INFINITY),
        Pixel::new(
            hand,
            Camera {
                pixel_from_world: [[f64::NAN; 4]; 3]
            },
            [0.0; 2]
        ),
        Pixel::new(
            hand,
            Camera {
                pixel_from_world: [[1.0; 4]; 3]
            },
            [0.0, f64::NAN]
        ),
        FrameVelocity::new(hand, Vector3::from(nan), 0.1, (x, x)),
        FrameVelocity::new(hand, slanted, 0.1, (x, x)),
        FrameVelocity::new(hand, straight, 0.1, (nan, zero)),
        FrameVelocity::new(hand, straight, 0.1, (zero, nan)),
        FrameVelocity::new(hand, straight, 0.0, (x, x)),
        Bounded::between(Plane::new(hand, x, x), 1.0, 0.5),
        Bounded::new(Plane::new(hand, x, zero), 1.0),
        Bounded::at_least(Plane::new(hand, x, x), f64::INFINITY),
        CentreOfMass::new(&masses, nan),
        CentreOfMass::new(&masses, x)
            .free_along(Axis::X)
            .free_along(Axis::Y)
            .free_along(Axis::Z),
        SupportPolygon::new(&masses),
        SupportPolygon::new(&masses).with_points([nan]),
        SupportPolygon::new(&masses).with_points([x]).with_up(zero),
        SupportPolygon::new(&masses).with_points([x]).with_up(nan),
        SupportPolygon::new(&masses)
            .with_points([x])
            .with_margin(-1.0),
        SupportPolygon::new(&masses)
            .with_points([x, x * 2.0, Vector3::UNITS[1]])
            .with_margin(0.5),
        Posture::new(&model, &[0.0]),
        Posture::new(&model, &vec![0.0; q.len()]),
        Posture::new(&model, &vec![f64::NAN; q.len()]),
        Posture::new(&model, &q).with_weights([1.0]),
        Posture::of_joints([(model.joint("elbow").unwrap(), 0.3)]).with_weights([-1.0]),
        Posture::of_joints([(waist, 0.3)]),
        Posture::of_joints([(model.joint("plate").unwrap(), 0.3)]),
        Smoothness::new(&model, &q, -0.1),
        Smoothness::new(&model, &q[1..], 0.1),
        JointCoupling::new(&model, [(waist, 1.0)], 0.0),
        JointCoupling::new(&model, [(model.joint("elbow").unwrap(), 0.0)], 0.0),
        JointCoupling::new(&model, [(model.joint("elbow").unwrap(), f64::NAN)], 0.0),
        JointCoupling::new(&model, [(model.joint("elbow").unwrap(), 1.0)], f64::NAN),
        Manipulability::new(&model, None, hand, 0.0),
        Manipulability::new(&model, Some(hand), hand, 1.0),
        Manipulability::new(&model, Some(hand), frames(&model, &["forearm"])[0], 1.0).of_position(),
        Numeric(Own {
            frames: [hand, hand],
            joint: waist,
            knows: false
        }),
        Task::new(Point::new(hand, x)).weight(Quantity::Radians, 1.0),
        Task::new(Point::new(hand, x)).weight(Quantity::Metres, -1.0),
        Task::new(Point::new(hand, x)).tolerance(Quantity::Pixels, 1.0),
        Task::new(Point::new(hand, x)).tolerance(Quantity::Metres, f64::NAN),
        Task::new(Point::new(hand, x))
            .named("reach")
            .scale(f64::NAN),
    ];
    digest.value()
}

#[test]
fn of_targets() {
    check(&[
        ("targets set anew", targets()),
        ("tasks that are refused", refused()),
    ]);
}
