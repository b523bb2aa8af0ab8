//! One task of every kind around a configuration, with its expected residual.

use std::f64::consts::PI;

use super::random::Random;
use super::trees::RandomTree;
use super::{Rigid, placement, rigid, vector};
use kinopt::Scalar;
use kinopt::model::{FrameId, JointId};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Axis, Bounded, Camera, Distance, FramePose, Inputs, LimitCentring, LookAt, Orientation, Pixel,
    Plane, Point, PoseBounds, Posture, Quantity, Ray, Residual, RowBlock, Smoothness, Task,
};
use nalgebra as na;

/// Unweighted residual as a function of all frames and the configuration.
type Expected = Box<dyn Fn(&[Rigid], &[f64]) -> Vec<f64>>;

pub struct TaskCase {
    pub name: &'static str,
    pub add: Box<dyn Fn(&mut ProblemBuilder<'_>)>,
    pub expected: Expected,
    /// True if finite differences are valid: the angle is not within a step of half a turn.
    pub smooth: bool,
}

/// User residual with five rows on two frames and two joints; every function is generic over the scalar.
#[derive(Clone)]
pub struct Entangled {
    pub frames: [FrameId; 2],
    pub joints: [JointId; 2],
}

impl Residual for Entangled {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames).with_joints(self.joints)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::Metres, 3),
            RowBlock::new(Quantity::Ratio, 2),
        ]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], r: &mut [S]) {
        let [a, b] = [frames[0], frames[1]];
        let [u, v] = [joints[0], joints[1]];
        let apart = a.translation - b.translation;
        let (sin, cos) = u.sin_cos();
        r[0] = apart.norm_squared() * sin;
        r[1] = a.rotation.x.dot(b.rotation.z) * cos;
        r[2] = apart.dot(a.rotation.y).abs() + v * v;
        r[3] = (-(u * u + v * v)).exp();
        r[4] = (apart.norm_squared() + S::one())
            .ln()
            .atan2(v - S::constant(3.0));
    }
}

fn entangled(frames: [Rigid; 2], u: f64, v: f64) -> Vec<f64> {
    let [a, b] = frames;
    let apart = a.translation.vector - b.translation.vector;
    let column = |m: &Rigid, k: usize| m.rotation.matrix().column(k).into_owned();
    vec![
        apart.norm_squared() * u.sin(),
        column(&a, 0).dot(&column(&b, 2)) * u.cos(),
        apart.dot(&column(&a, 1)).abs() + v * v,
        (-(u * u + v * v)).exp(),
        (apart.norm_squared() + 1.0).ln().atan2(v - 3.0),
    ]
}

pub(super) fn rotation_vector(rotation: na::Rotation3<f64>) -> Vec<f64> {
    let turn = na::UnitQuaternion::from_rotation_matrix(&rotation);
    turn.scaled_axis().iter().copied().collect()
}

pub(super) fn sum_case<R: Residual>(
    name: &'static str,
    make: impl Fn() -> R + 'static,
    expected: impl Fn(&[Rigid], &[f64]) -> Vec<f64> + 'static,
) -> TaskCase {
    let rows = make().rows();
    TaskCase {
        name,
        add: Box::new(move |builder| {
            // The weight is not a power of two, so that a lost weight changes the result.
            let task = rows
                .iter()
                .fold(Task::new(make()), |task, r| task.weight(r.quantity, WEIGHT));
            builder.add(task);
        }),
        expected: Box::new(expected),
        smooth: true,
    }
}

/// Weight of all rows.
pub const WEIGHT: f64 = 1.7;

/// One task of every kind on `tree`; some have a small error at `q`.
pub fn tasks_of(tree: &RandomTree, q: &[f64], random: &mut Random) -> Vec<TaskCase> {
    let at = tree.frames_at(q);
    let (slot, other) = (at.len() - 2, at.len() / 2 - 1);
    let (frame, other_frame) = (tree.frames[slot], tree.frames[other]);
    let frame_pose = at[slot];
    let near = frame_pose.translation.vector + random.vector(0.7);
    let offset = random.vector(0.4);
    let mut all = Vec::new();

    all.push(sum_case(
        "point",
        move || Point::new(frame, near),
        move |at, _| (at[slot].translation.vector - near).as_slice().to_vec(),
    ));
    all.push(sum_case(
        "point with an offset",
        move || Point::new(frame, near).at(offset),
        move |at, _| {
            let point = at[slot] * na::Point3::from(offset);
            (point.coords - near).as_slice().to_vec()
        },
    ));

    let eye = near + random.vector(2.0);
    all.push(sum_case(
        "ray",
        move || Ray::new(frame, eye, near),
        move |at, _| {
            let d = (eye - near).normalize();
            let across = na::Matrix3::identity() - d * d.transpose();
            let miss = across * (at[slot].translation.vector - near);
            miss.as_slice().to_vec()
        },
    ));

    let (focal, centre) = ([500.0, 480.0], [320.0, 240.0]);
    let camera_rotation = random.rotation();
    // 3 m in front of the frame.
    let camera_at = frame_pose.translation.vector - camera_rotation * na::Vector3::z() * 3.0;
    let world_from_camera = rigid(camera_rotation, camera_at);
    all.push(sum_case(
        "pixel",
        move || {
            let camera = Camera::pinhole(&placement(&world_from_camera), focal, centre);
            Pixel::new(frame, camera, [300.0, 200.0])
        },
        move |at, _| {
            let world = at[slot].translation.vector - camera_at;
            let seen = camera_rotation.inverse() * world;
            vec![
                focal[0] * seen.x / seen.z + centre[0] - 300.0,
                focal[1] * seen.y / seen.z + centre[1] - 200.0,
            ]
        },
    ));

    let axis = random.direction();
    let misses = [
        ("orientation", 1.1, true),
        ("orientation on target", 0.0, true),
        ("orientation missed by 1e-9", 1e-9, true),
        ("orientation missed by 1e-3", 1e-3, true),
        ("orientation missed by almost half a turn", PI - 1e-3, true),
        (
            "orientation missed by half a turn but 1e-8",
            PI - 1e-8,
            false,
        ),
    ];
    for (name, angle, smooth) in misses {
        let target = na::Rotation3::from_axis_angle(&axis, -angle) * frame_pose.rotation;
        let mut case = sum_case(
            name,
            move || Orientation::new(frame, target.into_inner()),
            move |at, _| rotation_vector(at[slot].rotation * target.inverse()),
        );
        case.smooth = smooth;
        all.push(case);
    }

    let target = rigid(random.rotation(), near);
    all.push(sum_case(
        "pose",
        move || FramePose::new(frame, placement(&target)),
        move |at, _| {
            let mut rows: Vec<f64> = (at[slot].translation.vector - near).as_slice().to_vec();
            rows.extend(rotation_vector(
                at[slot].rotation * target.rotation.inverse(),
            ));
            rows
        },
    ));

    let gaze = random.vector(1.0);
    let sights = [
        ("look-at", random.vector(2.0)),
        ("look-at on target", { frame_pose.rotation * gaze * 3.0 }),
    ];
    for (name, towards) in sights {
        let watched = frame_pose.translation.vector + towards;
        all.push(sum_case(
            name,
            move || LookAt::new(frame, gaze, watched),
            move |at, _| {
                let axis = (at[slot].rotation * gaze).normalize();
                let sight = (watched - at[slot].translation.vector).normalize();
                let across = axis.cross(&sight);
                let angle = across.norm().atan2(axis.dot(&sight));
                let unit = across.try_normalize(0.0).unwrap_or_default();
                (unit * angle).as_slice().to_vec()
            },
        ));
    }

    let normal = random.vector(2.0);
    all.push(sum_case(
        "plane",
        move || Plane::new(frame, near, normal),
        move |at, _| vec![(at[slot].translation.vector - near).dot(&normal.normalize())],
    ));
    all.push(sum_case(
        "distance",
        move || Distance::new(frame, other_frame, 0.4),
        move |at, _| {
            let apart = at[slot].translation.vector - at[other].translation.vector;
            vec![apart.norm() - 0.4]
        },
    ));

    let reference: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
    let (model, expected) = (tree.model.clone(), reference.clone());
    all.push(sum_case(
        "posture",
        {
            let reference = reference.clone();
            move || Posture::new(&model, &reference)
        },
        move |_, q| q.iter().zip(&expected).map(|(a, b)| a - b).collect(),
    ));
    let (model, expected) = (tree.model.clone(), reference.clone());
    all.push(sum_case(
        "smoothness",
        move || Smoothness::new(&model, &reference, 0.02),
        move |_, q| {
            q.iter()
                .zip(&expected)
                .map(|(a, b)| (a - b) / 0.02)
                .collect()
        },
    ));
    let (model, limits) = (tree.model.clone(), tree.model.limits().collect::<Vec<_>>());
    all.push(sum_case(
        "limit centring",
        move || LimitCentring::new(&model),
        move |_, q| {
            let both = q.iter().zip(&limits).filter(|(_, l)| l.upper.is_finite());
            both.map(|(v, l)| (2.0 * v - l.lower - l.upper) / (l.upper - l.lower))
                .collect()
        },
    ));

    let moving = tree.model.moving_joints();
    let (first, last) = (0, moving.len() - 1);
    let joints = [moving[last], moving[first]];
    all.push(sum_case(
        "a user's own",
        move || Entangled {
            frames: [frame, other_frame],
            joints,
        },
        move |at, q| entangled([at[slot], at[other]], q[last], q[first]),
    ));
    all.extend(placed_cases(tree, q, random));
    all.extend(super::body_tasks::body_cases(tree, q, random));
    all
}

/// Tasks for the placement of a tool relative to another frame, with goal bounds.
fn placed_cases(tree: &RandomTree, q: &[f64], random: &mut Random) -> Vec<TaskCase> {
    let at = tree.frames_at(q);
    let (slot, other) = (at.len() - 2, at.len() / 2 - 1);
    let (frame, base) = (tree.frames[slot], tree.frames[other]);
    let tool = random.rigid(0.3);
    let axis = random.direction();
    let off = rigid(
        na::Rotation3::from_axis_angle(&axis, 0.9),
        random.vector(0.4),
    );
    let in_base = move |at: &[Rigid]| at[other].inverse() * at[slot];
    // Offset by `off`, in world axes and in base axes.
    let target = off * (at[slot] * tool);
    let relative = off * in_base(&at);
    let mut all = vec![
        sum_case(
            "point in a base",
            move || Point::new(frame, relative.translation.vector).relative_to(base),
            move |at, _| {
                let miss = in_base(at).translation.vector - relative.translation.vector;
                miss.as_slice().to_vec()
            },
        ),
        sum_case(
            "orientation in a base",
            move || Orientation::new(frame, relative.rotation.into_inner()).relative_to(base),
            move |at, _| rotation_vector(in_base(at).rotation * relative.rotation.inverse()),
        ),
        sum_case(
            "pose of a tool in a base",
            move || {
                let pose = FramePose::new(frame, placement(&relative)).relative_to(base);
                pose.with_tool(placement(&tool))
            },
            move |at, _| world_miss(in_base(at) * tool, relative),
        ),
        sum_case(
            "pose of a tool",
            move || FramePose::new(frame, placement(&target)).with_tool(placement(&tool)),
            move |at, _| world_miss(at[slot] * tool, target),
        ),
        sum_case(
            "plane with room",
            move || Bounded::at_most(Plane::new(frame, [0.1; 3], [0.0, 0.6, 0.8]), -0.05),
            move |at, _| {
                let v = at[slot].translation.vector - na::Vector3::repeat(0.1);
                vec![(0.6 * v.y + 0.8 * v.z + 0.05).max(0.0)]
            },
        ),
    ];
    let inf = f64::INFINITY;
    let goals = [
        ("pose with the full goal", PoseBounds::pose()),
        ("pose of a position", PoseBounds::position()),
        ("pose free about x", PoseBounds::free_about(Axis::X)),
        (
            "pose with room on all axes",
            PoseBounds::within([0.05, inf, 0.01, 0.1, 0.02, inf]),
        ),
    ];
    for (name, goal) in goals {
        all.push(sum_case(
            name,
            move || {
                let pose = FramePose::new(frame, placement(&target)).with_goal(goal);
                pose.with_tool(placement(&tool))
            },
            move |at, _| beyond_goal(at[slot] * tool, target, goal.half_widths()),
        ));
        all.push(sum_case(
            name,
            move || {
                let pose = FramePose::new(frame, placement(&relative)).with_goal(goal);
                pose.relative_to(base)
            },
            move |at, _| beyond_goal(in_base(at), relative, goal.half_widths()),
        ));
    }
    all
}

/// Offset and rotation vector in the axes of the target.
fn world_miss(placed: Rigid, target: Rigid) -> Vec<f64> {
    let offset = placed.translation.vector - target.translation.vector;
    let mut rows = offset.as_slice().to_vec();
    rows.extend(rotation_vector(placed.rotation * target.rotation.inverse()));
    rows
}

/// Part of a pose error beyond the half widths, in the target's axes: metres, and a rotation vector. If any component
/// has goal bounds, the rotation is twice the quaternion's vector part.
fn beyond_goal(placed: Rigid, target: Rigid, half_widths: [f64; 6]) -> Vec<f64> {
    let target_from_placed = target.inverse() * placed;
    let mut rows = target_from_placed.translation.vector.as_slice().to_vec();
    if half_widths == [0.0; 6] {
        rows.extend(rotation_vector(target_from_placed.rotation));
    } else {
        let turn = na::UnitQuaternion::from_rotation_matrix(&target_from_placed.rotation);
        // Of the two equal quaternions, the one whose largest component is positive.
        let largest = turn.coords[turn.coords.iamax()];
        rows.extend(turn.imag().iter().map(|v| 2.0 * v * largest.signum()));
    }
    for (k, (row, half_width)) in rows.iter_mut().zip(half_widths).enumerate() {
        let band = match k {
            3.. if half_width < PI => 2.0 * (0.5 * half_width).sin(),
            3.. => f64::INFINITY,
            _ => half_width,
        };
        *row -= row.clamp(-band, band);
    }
    rows
}

/// Vector of the library's type.
pub fn point(v: na::Vector3<f64>) -> Vector3<f64> {
    vector(v)
}

/// Number that depends on a joint.
pub trait Curve: Clone + Send + Sync + 'static {
    fn at<S: Scalar>(&self, value: S) -> S;
}

/// Task of one unitless number, a curve over one joint.
#[derive(Clone)]
pub struct OfJoint<C>(pub JointId, pub C);

impl<C: Curve> Residual for OfJoint<C> {
    fn inputs(&self) -> Inputs {
        Inputs::joints([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, 1)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = self.1.at(joints[0]);
    }
}
