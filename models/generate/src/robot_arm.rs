//! Desk-size robot arm with six joints: base, shoulder, upper arm, forearm, wrist, gripper.
//!
//! The arm is original, with the proportions of common six-axis arms. Units are metres; x is forward, y to its left,
//! z up. Links meet along circles about the joint's axis, so the skin only shears in a groove when the joint rotates.

use glam::{DMat3, DVec3, dvec3};
use kinopt::animation::{EulerClip, EulerKey, EulerTrack};
use kinopt::io::rig::Rig;
use kinopt::skeleton::Skeleton;

use crate::Failure;
use crate::figure::{BoneSpec, Figure, axes};
use crate::surface::{Part, Shape};

const FIXED: [f64; 2] = [0.0, 0.0];
/// Heights of the shoulder and elbow, and x positions of wrist, gripper and fingertips, metres.
const SHOULDER: f64 = 0.36;
const ELBOW: f64 = 0.8;
const WRIST: f64 = 0.36;
const GRIPPER: f64 = 0.5;
const FINGERTIPS: f64 = 0.66;

/// Robot arm with its skin and keyframes.
pub(crate) fn rig() -> Result<Rig, Failure> {
    let mut figure = Figure {
        bones: bones(),
        ..Figure::default()
    };
    figure.surface.limbs = vec![(parts(), 0.0)];
    let skeleton = figure.skeleton("robot-arm")?;
    let clip = clip(&skeleton)?;
    figure.rig(skeleton, clip, &["gripper"], 0.004)
}

fn bones() -> Vec<BoneSpec> {
    let up = |z: f64| DVec3::Z * z;
    let out = |x: f64| dvec3(x, 0.0, ELBOW);
    let bone = |name: &str, parent, tail, tip, towards, limits| BoneSpec {
        name: name.into(),
        parent,
        tail,
        tip,
        towards,
        limits,
    };
    let (x, down) = (DVec3::X, -DVec3::Z);
    vec![
        bone("base", None, up(0.0), up(0.2), x, [FIXED; 3]),
        bone(
            "shoulder",
            Some(0),
            up(0.2),
            up(SHOULDER),
            x,
            [[-170.0, 170.0], FIXED, FIXED],
        ),
        bone(
            "upper_arm",
            Some(1),
            up(SHOULDER),
            up(ELBOW),
            x,
            [FIXED, [-60.0, 95.0], FIXED],
        ),
        bone(
            "forearm",
            Some(2),
            up(ELBOW),
            out(WRIST),
            down,
            [FIXED, [-80.0, 60.0], FIXED],
        ),
        // The wrist rolls before it bends.
        bone(
            "wrist",
            Some(3),
            out(WRIST),
            out(GRIPPER),
            down,
            [FIXED, [-110.0, 110.0], [-175.0, 175.0]],
        ),
        bone(
            "gripper",
            Some(4),
            out(GRIPPER),
            out(FINGERTIPS),
            down,
            [[-175.0, 175.0], FIXED, FIXED],
        ),
    ]
}

/// Part with the fillets of machined metal.
fn part(bone: usize, shape: Shape, origin: DVec3, along: DVec3) -> Part {
    let towards = if along.normalize().x.abs() > 0.5 {
        DVec3::Z
    } else {
        DVec3::X
    };
    Part {
        bone,
        shape,
        origin,
        axes: axes(along, towards),
        fillet: 0.008,
        edge: 0.0105,
        softness: 0.008,
    }
}

fn parts() -> Vec<Part> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let drum = |bone, centre: DVec3, along, radius, half| {
        part(
            bone,
            Shape::Cylinder {
                radius,
                half,
                bevel: 0.007,
            },
            centre,
            along,
        )
    };
    let block = |bone, centre: DVec3, half: DVec3| Part {
        axes: DMat3::IDENTITY,
        ..part(bone, Shape::Block { half, bevel: 0.012 }, centre, x)
    };
    let taper = |bone, from: DVec3, to: DVec3, [r0, r1]: [f64; 2], wide: f64| {
        let shape = Shape::RoundCone {
            length: from.distance(to),
            r0,
            r1,
            wide: 1.0,
            thick: wide,
        };
        part(bone, shape, from, to - from)
    };
    let mut parts = vec![
        drum(0, z * 0.018, z, 0.135, 0.018),
        drum(0, z * 0.1, z, 0.088, 0.078),
        drum(0, z * 0.18, z, 0.066, 0.03),
        drum(1, z * 0.236, z, 0.095, 0.04),
        drum(2, z * SHOULDER, y, 0.075, 0.046),
        taper(
            2,
            z * (SHOULDER + 0.02),
            z * (ELBOW - 0.02),
            [0.054, 0.044],
            0.72,
        ),
        drum(2, z * ELBOW, y, 0.058, 0.036),
        taper(
            3,
            z * ELBOW + x * 0.122,
            z * ELBOW + x * (WRIST - 0.1),
            [0.05, 0.036],
            1.0,
        ),
        drum(3, z * ELBOW + x * 0.28, x, 0.041, 0.052),
        part(
            4,
            Shape::Ellipsoid(DVec3::splat(0.046)),
            z * ELBOW + x * WRIST,
            x,
        ),
        drum(4, z * ELBOW + x * 0.43, x, 0.033, 0.055),
        drum(4, z * ELBOW + x * 0.49, x, 0.026, 0.03),
        drum(5, z * ELBOW + x * 0.532, x, 0.042, 0.028),
        block(5, z * ELBOW + x * 0.56, dvec3(0.018, 0.072, 0.026)),
    ];
    for side in [1.0, -1.0] {
        // Side plates that carry the drums.
        let shoulder = z * SHOULDER + y * (0.068 * side);
        parts.push(drum(1, shoulder, y, 0.07, 0.019));
        parts.push(block(
            1,
            z * 0.31 + y * (0.068 * side),
            dvec3(0.062, 0.019, 0.06),
        ));
        let elbow = z * ELBOW + y * (0.053 * side);
        parts.push(drum(3, elbow, y, 0.054, 0.014));
        parts.push(block(3, elbow + x * 0.055, dvec3(0.06, 0.014, 0.036)));
        let finger = z * ELBOW + y * (0.05 * side);
        parts.push(block(5, finger + x * 0.61, dvec3(0.06, 0.014, 0.018)));
        parts.push(block(
            5,
            z * ELBOW + dvec3(0.645, 0.04 * side, 0.0),
            dvec3(0.022, 0.016, 0.018),
        ));
    }
    for part in &mut parts {
        if part.bone >= 3 {
            part.edge = 0.008;
        }
    }
    parts
}

/// Keyframes in seconds and degrees: reach down on the right, lift, swing over and set down on the left.
fn clip(skeleton: &Skeleton) -> Result<EulerClip, Failure> {
    const TIMES: [f64; 8] = [0.0, 0.7, 1.1, 1.6, 2.5, 3.1, 3.4, 4.2];
    let bend = |angles: [f64; 8]| angles.map(|bend| [0.0, bend, 0.0]);
    let twist = |angles: [f64; 8]| angles.map(|twist| [twist, 0.0, 0.0]);
    let rolls = [0.0, 0.0, 0.0, 20.0, 90.0, 0.0, 0.0, 0.0];
    let nods = [0.0, 40.0, 55.0, 30.0, -20.0, 50.0, 58.0, 0.0];
    let tracks = [
        (
            "shoulder",
            twist([0.0, -55.0, -60.0, -50.0, 40.0, 75.0, 78.0, 0.0]),
        ),
        (
            "upper_arm",
            bend([0.0, 35.0, 52.0, 10.0, -20.0, 30.0, 48.0, 0.0]),
        ),
        (
            "forearm",
            bend([0.0, 5.0, 12.0, -10.0, -35.0, 8.0, 15.0, 0.0]),
        ),
        (
            "wrist",
            std::array::from_fn(|key| [0.0, nods[key], rolls[key]]),
        ),
        (
            "gripper",
            twist([0.0, 30.0, 30.0, 0.0, -120.0, -60.0, -60.0, 0.0]),
        ),
    ];
    let mut list = Vec::new();
    for (name, angles) in tracks {
        let keys = TIMES.iter().zip(angles).map(|(&time, angles)| EulerKey {
            time,
            angles: angles.map(f64::to_radians),
        });
        list.push(EulerTrack {
            bone: skeleton.bone(name)?,
            keys: keys.collect(),
        });
    }
    Ok(EulerClip::new(list)?)
}
