//! Torso, neck and head.

use glam::{DVec3, dvec3};

use super::{Finish, HEAD, Limb, ROUND, TORSO};
use crate::Failure;
use crate::landmarks::Landmarks;

pub(super) fn fill_torso(torso: &mut Limb<'_>) -> Result<(), Failure> {
    torso.ball(
        "pelvis",
        dvec3(-0.005, 0.0, 0.95),
        dvec3(0.1, 0.15, 0.1),
        TORSO,
    )?;
    torso.ball(
        "spine",
        dvec3(0.0, 0.0, 1.09),
        dvec3(0.09, 0.13, 0.12),
        TORSO,
    )?;
    torso.ball(
        "chest",
        dvec3(-0.005, 0.0, 1.235),
        dvec3(0.1, 0.148, 0.12),
        TORSO,
    )?;
    torso.ball(
        "upper_chest",
        dvec3(-0.012, 0.0, 1.335),
        dvec3(0.1, 0.165, 0.095),
        TORSO,
    )?;
    for side in [1.0, -1.0] {
        let name = |bone: &str| format!("{}_{bone}", if side > 0.0 { "left" } else { "right" });
        torso.ball(
            "pelvis",
            dvec3(-0.045, 0.072 * side, 0.9),
            dvec3(0.085, 0.08, 0.085),
            TORSO,
        )?;
        torso.ball(
            "upper_chest",
            dvec3(0.05, 0.07 * side, 1.325),
            dvec3(0.048, 0.078, 0.058),
            TORSO,
        )?;
        let shoulder = [
            dvec3(-0.025, 0.035 * side, 1.452),
            dvec3(-0.01, 0.17 * side, 1.396),
        ];
        torso.cone(&name("clavicle"), shoulder, [0.046, 0.05], ROUND, TORSO)?;
    }
    Ok(())
}

pub(super) fn fill_head(head: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
    let neck = [
        at.spine[4] - DVec3::X * 0.02,
        at.spine[5] + dvec3(-0.004, 0.0, 0.03),
    ];
    head.cone("neck", neck, [0.058, 0.05], ROUND, HEAD)?;
    head.ball(
        "head",
        dvec3(0.002, 0.0, 1.652),
        dvec3(0.097, 0.079, 0.098),
        HEAD,
    )?;
    head.ball(
        "head",
        dvec3(0.038, 0.0, 1.592),
        dvec3(0.058, 0.056, 0.07),
        HEAD,
    )?;
    let nose = [dvec3(0.088, 0.0, 1.645), dvec3(0.104, 0.0, 1.615)];
    head.cone(
        "head",
        nose,
        [0.008, 0.013],
        ROUND,
        Finish {
            edge: 0.011,
            ..HEAD
        },
    )
}
