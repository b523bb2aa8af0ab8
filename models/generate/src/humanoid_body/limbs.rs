//! Arms and legs of the left side.

use glam::{DVec3, dvec3};

use super::{ARM, FOOT, Finish, HAND, LEG, Limb, ROUND};
use crate::Failure;
use crate::landmarks::Landmarks;

pub(super) fn fill_arm(arm: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
    let along = |from: DVec3, to: DVec3, share: f64| from.lerp(to, share);
    let upper = |share| along(at.shoulder, at.elbow, share);
    let lower = |share| along(at.elbow, at.wrist, share);
    let hand = |share| along(at.wrist, at.fingertips, share);
    let palm = (at.wrist - at.elbow).cross(DVec3::X).normalize();
    let out = -palm;
    let bone = "left_upper_arm";
    // The shoulder has softer skin weights than the elbow.
    let shoulder = Finish {
        softness: 0.05,
        ..ARM
    };
    let trunk_side = [upper(0.0), upper(0.35)];
    arm.cone(bone, trunk_side, [0.05, 0.0465], ROUND, shoulder)?;
    arm.cone(
        bone,
        [upper(0.02) + out * 0.008, upper(0.3) + out * 0.012],
        [0.054, 0.036],
        ROUND,
        shoulder,
    )?;
    arm.cone(bone, [upper(0.35), upper(1.0)], [0.046, 0.039], ROUND, ARM)?;
    arm.cone(
        bone,
        [
            upper(0.42) + DVec3::X * 0.014,
            upper(0.7) + DVec3::X * 0.012,
        ],
        [0.035, 0.031],
        ROUND,
        ARM,
    )?;
    let bone = "left_forearm";
    arm.cone(bone, [lower(0.0), lower(1.0)], [0.038, 0.0255], ROUND, ARM)?;
    arm.cone(
        bone,
        [lower(0.12) + out * 0.004, lower(0.42)],
        [0.039, 0.033],
        ROUND,
        ARM,
    )?;

    let bone = "left_hand";
    let flat = ([1.5, 0.62], DVec3::X);
    arm.cone(
        bone,
        [hand(0.0), hand(0.18)],
        [0.026, 0.029],
        ([1.15, 0.8], DVec3::X),
        HAND,
    )?;
    arm.cone(bone, [hand(0.2), hand(0.45)], [0.027, 0.027], flat, HAND)?;
    // Four fingers in one part, slightly curved towards the palm, and a thumb.
    let bend = palm * 0.012;
    arm.cone(
        bone,
        [hand(0.45), hand(0.72) + 0.3 * bend],
        [0.0255, 0.0235],
        ([1.5, 0.5], DVec3::X),
        HAND,
    )?;
    arm.cone(
        bone,
        [hand(0.72) + 0.3 * bend, hand(0.9) + bend],
        [0.0235, 0.0185],
        ([1.5, 0.5], DVec3::X),
        HAND,
    )?;
    let root = hand(0.12) + DVec3::X * 0.02 + palm * 0.004;
    let knuckle = hand(0.3) + DVec3::X * 0.052 + palm * 0.012;
    let tip = hand(0.47) + DVec3::X * 0.064 + palm * 0.018;
    let slim = Finish {
        fillet: 0.018,
        ..HAND
    };
    arm.cone(bone, [root, knuckle], [0.018, 0.0135], ROUND, slim)?;
    arm.cone(
        bone,
        [knuckle, tip],
        [0.0135, 0.0105],
        ROUND,
        Finish {
            fillet: 0.006,
            ..HAND
        },
    )
}

pub(super) fn fill_leg(leg: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
    let upper = |share: f64| at.hip.lerp(at.knee, share);
    let lower = |share: f64| at.knee.lerp(at.ankle, share);
    let x = DVec3::X;
    let bone = "left_thigh";
    leg.cone(
        bone,
        [upper(0.08) + DVec3::Y * 0.002, upper(1.0)],
        [0.084, 0.052],
        ROUND,
        LEG,
    )?;
    leg.cone(
        bone,
        [upper(0.25) + x * 0.016, upper(0.65) + x * 0.014],
        [0.07, 0.055],
        ROUND,
        LEG,
    )?;
    let bone = "left_shin";
    leg.cone(
        bone,
        [lower(0.0) + x * 0.004, lower(1.0)],
        [0.049, 0.034],
        ROUND,
        LEG,
    )?;
    leg.cone(
        bone,
        [lower(0.16) - x * 0.02, lower(0.48) - x * 0.012],
        [0.044, 0.034],
        ROUND,
        LEG,
    )?;

    let bone = "left_foot";
    let heel = dvec3(at.ankle.x - 0.038, at.ankle.y, 0.034);
    leg.ball(bone, heel, dvec3(0.04, 0.032, 0.034), FOOT)?;
    leg.cone(
        bone,
        [
            at.ankle + dvec3(0.0, 0.0, 0.005),
            at.ball + dvec3(-0.02, 0.0, 0.008),
        ],
        [0.036, 0.024],
        ([1.0, 1.1], DVec3::Z),
        FOOT,
    )?;
    let sole = [
        heel + dvec3(0.02, 0.0, -0.01),
        at.ball + dvec3(0.0, 0.004, 0.0),
    ];
    leg.cone(bone, sole, [0.024, 0.022], ([1.0, 1.6], DVec3::Z), FOOT)?;
    let toes = [
        at.ball + dvec3(0.012, 0.004, -0.002),
        at.toes + dvec3(-0.018, 0.0, -0.005),
    ];
    leg.cone(
        "left_toes",
        toes,
        [0.0205, 0.0165],
        ([1.0, 1.9], DVec3::Z),
        FOOT,
    )
}
