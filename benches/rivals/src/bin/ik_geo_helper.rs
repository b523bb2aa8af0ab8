//! Helper process of ik-geo: `ik_geo_helper ROBOT.urdf BASE TIP`. See `rival/helper.rs`.
//!
//! It solves the closed form for arms like those of Universal Robots. It uses nothing of the library here, which links
//! a newer NLopt than ik-geo: one process cannot contain both.

use std::io::{BufRead, Write};
use std::time::Instant;

use ik_geo::inverse_kinematics::auxiliary::Kinematics;
use ik_geo::inverse_kinematics::three_parallel_two_intersecting;
use ik_geo::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use kinopt::robot::Robot;
use kinopt::simd_ik::{Chain, JointKind};
use kinopt::spatial;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [urdf, base, tip] = &arguments[..] else {
        return Err("usage: ik_geo_helper ROBOT.urdf BASE TIP".into());
    };
    serve(&kinopt_benches::chain(&Robot::read(urdf)?, base, tip)?)
}

fn vector(v: spatial::Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// The arm as a product of exponentials, and the tip's rotation at zero.
///
/// Returns an error for an arm without joints 2, 3 and 4 parallel, and 5 and 6 intersecting.
fn kinematics(chain: &Chain) -> Result<(Kinematics<6, 7>, Matrix3<f64>), Failure> {
    let joints = chain.joints();
    if joints.len() != 6 || joints.iter().any(|j| j.kind != JointKind::Revolute) {
        return Err("not six revolute joints".into());
    }
    let mut arm = Kinematics::<6, 7>::new();
    let mut at = spatial::Placement::identity();
    let mut last = spatial::Vector3::zero();
    for (i, joint) in joints.iter().enumerate() {
        at = at * joint.parent_from_joint;
        arm.h.set_column(i, &vector(at.rotation * joint.axis));
        arm.p.set_column(i, &vector(at.translation - last));
        last = at.translation;
    }
    let tip = at * *chain.joint_from_tip();
    arm.p.set_column(6, &vector(tip.translation - last));
    let axis = |i: usize| arm.h.column(i).into_owned();
    let parallel = |a: usize, b: usize| axis(a).cross(&axis(b)).norm() < 1e-9;
    let offset = arm.p.column(5).into_owned();
    let axis_distance = offset.dot(&axis(4).cross(&axis(5))).abs();
    if !(parallel(1, 2) && parallel(2, 3)) || parallel(4, 5) || axis_distance > 1e-9 {
        return Err("no arm with three parallel and two intersecting axes".into());
    }
    let r = tip.rotation;
    let rotation = Matrix3::from_columns(&[vector(r.x), vector(r.y), vector(r.z)]);
    Ok((arm, rotation))
}

/// Shifts angles by full turns into each joint's range; false if a joint has no such angle.
fn shift_into_limits(chain: &Chain, q: &mut [f64]) -> bool {
    chain.joints().iter().zip(q).all(|(joint, q)| {
        let turns = ((joint.lower - *q) / std::f64::consts::TAU).ceil().max(0.0)
            - ((*q - joint.upper) / std::f64::consts::TAU).ceil().max(0.0);
        *q += turns * std::f64::consts::TAU;
        joint.lower <= *q && *q <= joint.upper
    })
}

/// Answers lines from standard input until it closes.
///
/// For an arm without a closed form, writes the reason to standard output instead of "ready".
fn serve(chain: &Chain) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let (arm, tip_at_zero) = match kinematics(chain) {
        Ok(kinematics) => kinematics,
        Err(failure) => {
            writeln!(out, "{failure}")?;
            return Ok(());
        }
    };
    writeln!(out, "ready")?;
    out.flush()?;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let numbers: Vec<f64> = line
            .split_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        let [x, y, z, qw, qx, qy, qz, ..] = numbers[..] else {
            return Err("seven numbers of a pose are needed".into());
        };
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(qw, qx, qy, qz));
        let started = Instant::now();
        let rotation_from_zero =
            rotation.to_rotation_matrix().into_inner() * tip_at_zero.transpose();
        let (candidates, approximate) =
            three_parallel_two_intersecting(&rotation_from_zero, &Vector3::new(x, y, z), &arm);
        let mut solutions = Vec::new();
        for (q, approximate) in candidates.iter().zip(approximate) {
            let mut q = *q;
            if !approximate && shift_into_limits(chain, q.as_mut_slice()) {
                solutions.extend_from_slice(q.as_slice());
            }
        }
        let nanoseconds = started.elapsed().as_nanos();
        write!(out, "{nanoseconds}")?;
        for value in solutions {
            write!(out, " {value:e}")?;
        }
        writeln!(out)?;
        out.flush()?;
    }
    Ok(())
}
