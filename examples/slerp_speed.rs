//! Constant angular velocity of slerp, measured as the angle between neighbouring frames. nlerp takes the same arc
//! faster in its middle. Linear interpolation of Euler angles takes a longer path at a varying speed.
//!
//! `cargo run --example slerp_speed`: only the first column has equal numbers, and only the first two take the
//! shortest path.
#![allow(clippy::print_stdout)]

use glam::{DVec3, Quat};
use kinopt::animation::curve::lerp;
use kinopt::animation::rotation::{AxisAngle, EulerOrder, nlerp, slerp};

const FRAMES: u32 = 8;

/// Angle between two rotations, degrees.
fn angle_between(a: Quat, b: Quat) -> f64 {
    let turn = a.as_dquat().conjugate() * b.as_dquat();
    2.0 * turn.xyz().length().atan2(turn.w.abs()).to_degrees()
}

fn main() {
    // A rotation of 120° about y in steps of a quarter.
    let turn = AxisAngle {
        axis: DVec3::Y,
        angle: 120_f64.to_radians(),
    };
    let end = turn.to_quaternion().as_quat();
    println!("t     angle    q = [w, x, y, z]");
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let q = slerp(Quat::IDENTITY, end, t);
        let angle = angle_between(Quat::IDENTITY, q);
        println!(
            "{t:.2}  {angle:5.1}°  [{:.3}, {:.3}, {:.3}, {:.3}]",
            q.w, q.x, q.y, q.z
        );
    }

    // Euler angles from near one gimbal lock to near the other (middle angles of ∓90°).
    let order = EulerOrder::Zyx;
    let [from, to] =
        [[0.0, -75.0, 0.0], [150.0, 75.0, 150.0_f64]].map(|angles| angles.map(f64::to_radians));
    let rotation = |angles: DVec3| -> Quat { order.to_quaternion(angles.to_array()).as_quat() };
    let [start, end] = [from, to].map(|angles| rotation(DVec3::from(angles)));
    let interpolations: [&dyn Fn(f32) -> Quat; 3] =
        [&|t| slerp(start, end, t), &|t| nlerp(start, end, t), &|t| {
            rotation(lerp(from.into(), to.into(), f64::from(t)))
        }];
    println!("\ndegrees from frame to frame\n        slerp   nlerp   Euler");
    let mut sums = [0.0; 3];
    for frame in 0..FRAMES {
        let [t, next] = [frame, frame + 1].map(|k| k as f32 / FRAMES as f32);
        let steps = interpolations
            .map(|interpolation| angle_between(interpolation(t), interpolation(next)));
        println!(
            "{frame}  {:9.3} {:7.3} {:7.3}",
            steps[0], steps[1], steps[2]
        );
        sums.iter_mut()
            .zip(steps)
            .for_each(|(sum, step)| *sum += step);
    }
    println!("sum {:8.3} {:7.3} {:7.3}", sums[0], sums[1], sums[2]);
    let direct = angle_between(start, end);
    println!("the two ends are {direct:.3}° apart");
}
