//! Promise: so it is for tasks: what a residual of every kind is under all its options, its derivatives by every
//! route and what they make of a gradient, targets that are set anew, and what is refused.
#![allow(clippy::unwrap_used)]

use kinopt::model::{FrameId, JointId, Model, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation, Problem, ProblemBuilder};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{
    Axis, Bounded, Camera, CentreOfMass, Description, Distance, FramePose, FrameVelocity, Gaze,
    Inputs, JointCoupling, LimitCentring, LocalJacobian, LookAt, Manipulability, Numeric,
    NumericResidual, Orientation, Pixel, Plane, Point, PoseBounds, Posture, Quantity, Ray,
    RowBlock, Smoothness, SupportPolygon, Task,
};
use nalgebra::DMatrix;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, map, masses, model, place, vector};

/// Residual, derivatives and gradient at variables.
pub(crate) fn evaluate(digest: &mut Digest, problem: &Problem, x: &[f64]) {
    let mut scratch = problem.scratch();
    let mut own = Evaluation::new(problem, &mut scratch);
    let (rows, n) = (own.rows(), own.variables());
    let (mut r, mut jacobian, mut gradient) =
        (vec![0.0; rows], DMatrix::zeros(rows, n), vec![0.0; n]);
    own.residual(x, &mut r);
    digest.doubles(r.iter().copied());
    own.jacobian(x, &mut jacobian);
    digest.doubles(jacobian.iter().copied());
    own.gradient(x, &r, &mut gradient, &mut jacobian);
    digest.doubles(gradient);
    digest.word(own.is_reached(&r).into());
}

/// A hand-written residual: numbers alone, with derivatives of its own or by differences.
#[derive(Clone)]
pub(crate) struct Own {
    pub(crate) frames: [FrameId; 2],
    pub(crate) joint: JointId,
    pub(crate) knows: bool,
}

impl NumericResidual for Own {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames).with_joints([self.joint])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::Metres, 2),
            RowBlock::new(Quantity::Ratio, 1),
        ]
    }

    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
        let [a, b] = [frames[0], frames[1]];
        residual[0] = a.translation.x * b.rotation.y.z + joints[0];
        residual[1] = a.translation.z - 2.0 * b.translation.y;
        residual[2] = joints[0] * joints[0] * a.rotation.x.y;
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        j: &mut LocalJacobian,
    ) -> bool {
        if !self.knows {
            return false;
        }
        let [x, y, z] = Vector3::UNITS;
        let [a, b] = [frames[0], frames[1]];
        j.linear_mut(0)
            .copy_from_slice(&[x * b.rotation.y.z, z, Vector3::zero()]);
        j.linear_mut(1)[1] = y * -2.0;
        j.angular_mut(1)[0] = b.rotation.y.cross(z) * a.translation.x;
        j.angular_mut(0)[2] = a.rotation.x.cross(y) * (joints[0] * joints[0]);
        j.joint_mut(0)
            .copy_from_slice(&[1.0, 0.0, 2.0 * joints[0] * a.rotation.x.y]);
        true
    }

    fn description(&self) -> Description {
        Description::default().with_validity(self.validate())
    }
}

impl Own {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        match self.frames[0] == self.frames[1] {
            true => Err("is of one frame".to_owned()),
            false => Ok(()),
        }
    }
}

pub(crate) fn camera(random: &mut Random) -> Camera {
    let mut away = place(random, 0.2);
    away.translation -= away.rotation.z * 3.0;
    Camera::pinhole(&away, [500.0, 470.0], [320.0, 240.0])
}

/// Residuals that a frame, or two of them, are asked for.
fn of_frames(
    tasks: &mut ProblemBuilder<'_>,
    model: &Model,
    random: &mut Random,
    near: &[Placement<f64>],
) {
    let [hand, foot, head, back] = frames(model, &["hand", "foot", "head", "back"])[..] else {
        unreachable!()
    };
    let own = near[hand.index()];
    let turned = |random: &mut Random, size: f64| {
        Placement::new(rotation_exp(vector(random, size)), vector(random, size)) * own
    };
    tasks.add(
        Task::new(Point::new(hand, turned(random, 0.3).translation)).weight(Quantity::Metres, 1.7),
    );
    tasks.add(Point::new(foot, vector(random, 1.0)).at(vector(random, 0.3)));
    tasks.add(
        Point::new(foot, vector(random, 1.0))
            .at(vector(random, 0.3))
            .relative_to(head),
    );
    tasks.add(Task::new(Orientation::new(hand, turned(random, 0.5).rotation)).scale(0.3));
    tasks.add(Orientation::new(head, place(random, 0.1).rotation).relative_to(hand));
    let inf = f64::INFINITY;
    let goals = [
        PoseBounds::pose(),
        PoseBounds::position(),
        PoseBounds::free_about(Axis::Y),
        PoseBounds::free_along(Axis::Z),
        PoseBounds::within([0.05, inf, 0.01, 0.1, 0.02, 3.2]),
        PoseBounds::within([0.4, 0.3, 0.2, 1.0, 2.0, 1.5]),
    ];
    tasks.add(FramePose::new(hand, turned(random, 0.2)));
    tasks.add(FramePose::new(hand, turned(random, 0.2)).with_tool(place(random, 0.2)));
    for goal in goals {
        tasks.add(FramePose::new(hand, turned(random, 0.4)).with_goal(goal));
        let pose = FramePose::new(hand, turned(random, 0.4)).with_goal(goal);
        tasks.add(pose.with_tool(place(random, 0.2)).relative_to(foot));
    }
    tasks.add(LookAt::new(head, vector(random, 2.0), vector(random, 1.0)));
    let aside = own.translation - own.rotation.y;
    tasks.add(LookAt::new(hand, [0.0, 3.0, 0.0], aside));
    for half_angle in [0.2, 1.4, 2.8] {
        tasks.add(Gaze::along(
            head,
            vector(random, 1.0),
            vector(random, 2.0),
            half_angle,
        ));
        tasks.add(Gaze::at(
            head,
            vector(random, 1.0),
            vector(random, 1.0),
            half_angle,
        ));
    }
    tasks.add(Plane::new(back, vector(random, 0.5), vector(random, 3.0)));
    tasks.add(Ray::new(hand, vector(random, 1.0), vector(random, 1.0)));
    tasks.add(Task::new(Distance::new(hand, foot, 0.4)).tolerance(Quantity::Metres, 0.5));
    tasks.add(Distance::new(back, hand, 0.0));
    tasks.add(Task::new(Pixel::new(hand, camera(random), [300.0, 200.0])).scale(1e-2));
    let speed = (vector(random, 0.3), vector(random, 0.5));
    tasks.add(FrameVelocity::new(hand, turned(random, 0.1), 0.05, speed));
    let plane = Plane::new(foot, vector(random, 0.2), vector(random, 2.0));
    tasks.add(Bounded::new(plane, 0.1));
    tasks.add(Bounded::at_most(plane, -0.2));
    tasks.add(Bounded::at_least(plane, 0.1));
    tasks.add(Bounded::between(
        Point::new(head, vector(random, 0.5)).relative_to(back),
        -0.2,
        0.3,
    ));
    let joint = model.joint("elbow").unwrap();
    for knows in [false, true] {
        tasks.add(Numeric(Own {
            frames: [hand, foot],
            joint,
            knows,
        }));
    }
}

/// Residuals that joints, or all of a body, are asked for.
fn of_bodies(tasks: &mut ProblemBuilder<'_>, model: &Model, random: &mut Random, q: &[f64]) {
    let masses = masses(model, random);
    let [foot, hand, middle, tray] = frames(model, &["foot", "hand", "middle", "tray"])[..] else {
        unreachable!()
    };
    tasks.add(CentreOfMass::new(&masses, vector(random, 0.5)));
    tasks.add(CentreOfMass::new(&masses, vector(random, 0.5)).free_along(Axis::Y));
    let seen = CentreOfMass::new(&masses, vector(random, 0.5)).free_along(Axis::X);
    tasks.add(seen.free_along(Axis::Z).relative_to(foot));
    let square = |size: f64| {
        [
            [-size, -size, 0.0],
            [size, -size, 0.1],
            [size, size, 0.0],
            [-size, size, 0.3],
        ]
    };
    for size in [0.05, 0.4, 2.0] {
        tasks.add(SupportPolygon::new(&masses).with_points(square(size)));
        tasks.add(
            SupportPolygon::new(&masses)
                .with_points_on(foot, square(size))
                .with_margin(0.02),
        );
        let both = SupportPolygon::new(&masses).with_points_on(foot, square(size));
        let both = both.with_points_on(hand, [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0]]);
        let both = both
            .with_points([vector(random, 0.5)])
            .with_points_on(foot, [[0.0, 0.3, 0.0]]);
        tasks.add(both.with_up(vector(random, 1.0)).with_margin(0.3 * size));
        tasks.add(
            SupportPolygon::new(&masses)
                .with_points(square(size))
                .with_up([0.0, 1.0, 0.0])
                .with_margin(0.01),
        );
    }
    tasks.add(SupportPolygon::new(&masses).with_points([[0.1, 0.2, 0.0], [0.4, -0.2, 0.0]]));
    tasks.add(SupportPolygon::new(&masses).with_points([[0.1, 0.2, 0.0]]));
    tasks.add(Posture::new(model, q));
    tasks.add(Task::new(Posture::new(model, q).by_range(model)).goal());
    tasks.add(Posture::new(model, q).upright(model));
    tasks.add(Posture::new(model, q).with_weights((0..40_u8).map(f64::from).take(joints(model))));
    let [elbow, slide, first] =
        ["elbow", "slide", "ankle/first"].map(|name| model.joint(name).unwrap());
    tasks.add(Posture::of_joints([(slide, 0.1), (elbow, 0.7)]).with_weights([2.0, 0.5]));
    tasks.add(Smoothness::new(model, q, 0.1));
    tasks.add(Smoothness::new(model, q, 0.3).by_range(model));
    let weights = (0..joints(model)).map(|k| if k % 3 == 0 { 0.0 } else { 1.5 });
    tasks.add(Smoothness::new(model, q, 0.2).with_weights(weights));
    tasks.add(LimitCentring::new(model));
    tasks.add(JointCoupling::new(
        model,
        [(elbow, 0.5), (first, -2.0)],
        0.3,
    ));
    tasks.add(JointCoupling::new(model, [(slide, 1.5)], -0.1));
    for least in [1e-3, 0.2, 30.0] {
        tasks.add(Manipulability::new(model, None, hand, least));
        tasks.add(Manipulability::new(model, Some(middle), hand, least).of_position());
        tasks.add(Manipulability::new(model, Some(foot), hand, least).of_orientation());
        tasks.add(Manipulability::new(model, Some(tray), foot, least));
    }
}

/// How many joints move: a ball is one.
fn joints(model: &Model) -> usize {
    let mut all = model.moving_joints().to_vec();
    all.dedup();
    all.len()
}

fn every_residual() -> [Value; 2] {
    let (mut digests, mut random) = ([Digest::new(), Digest::new()], Random::new(121));
    for (free, body) in [(false, false), (true, false), (false, true), (true, true)] {
        let model = model(&mut random, free);
        let q = configuration(&model, &mut random);
        let mut kinematics = kinopt::kinematics::ForwardKinematics::new(&model);
        let near = kinematics.place(&q).unwrap().to_vec();
        for map in [ParameterMap::free(&model), map(&model)] {
            let mut tasks = Problem::builder(&model);
            tasks.parameters(map);
            match body {
                false => of_frames(&mut tasks, &model, &mut random, &near),
                true => of_bodies(&mut tasks, &model, &mut random, &q),
            }
            let problem = tasks.build().unwrap();
            let digest = &mut digests[usize::from(body)];
            digest.noted(&problem);
            for index in 0..=problem.tasks() {
                digest.noted(&problem.task_name(index));
            }
            digest.doubles(problem.weights());
            digest.doubles(problem.lower().iter().chain(problem.upper()).copied());
            digest.doubles([problem.reach()]);
            for case in 0..4 {
                let at = if case == 0 {
                    q.clone()
                } else {
                    configuration(&model, &mut random)
                };
                let mut x = vec![0.0; problem.variables()];
                problem.parameters().reduce(&at, &mut x).unwrap();
                for route in Derivatives::ALL {
                    evaluate(digest, &problem.clone().with_derivatives(route), &x);
                }
            }
        }
    }
    digests.map(|digest| digest.value())
}

#[test]
fn of_every_residual() {
    let [frames, bodies] = every_residual();
    check(&[
        ("residuals of frames and their derivatives", frames),
        (
            "residuals of joints and bodies and their derivatives",
            bodies,
        ),
    ]);
}
