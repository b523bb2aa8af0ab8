//! The humanoid's flesh: a smooth mannequin of some forty rounded parts, in metres.

use glam::{DMat3, DVec3, dvec3};

use crate::Failure;
use crate::figure::{Figure, axes, mirrored};
use crate::humanoid::Landmarks;
use crate::surface::{Part, Shape, Surface};

/// How parts of one region are joined and meshed, in metres.
#[derive(Clone, Copy)]
struct Finish {
    fillet: f64,
    edge: f64,
    softness: f64,
}

const TORSO: Finish = Finish {
    fillet: 0.06,
    edge: 0.026,
    softness: 0.05,
};
const HEAD: Finish = Finish {
    fillet: 0.018,
    edge: 0.0155,
    softness: 0.02,
};
const ARM: Finish = Finish {
    fillet: 0.025,
    edge: 0.0165,
    softness: 0.028,
};
const HAND: Finish = Finish {
    fillet: 0.014,
    edge: 0.0105,
    softness: 0.016,
};
const LEG: Finish = Finish {
    fillet: 0.035,
    edge: 0.0235,
    softness: 0.035,
};
const FOOT: Finish = Finish {
    fillet: 0.02,
    edge: 0.0145,
    softness: 0.016,
};

/// Parts that are being listed, by the names of their bones.
struct Limb<'a> {
    figure: &'a Figure,
    parts: Vec<Part>,
}

impl Limb<'_> {
    fn push(
        &mut self,
        bone: &str,
        shape: Shape,
        origin: DVec3,
        axes: DMat3,
        finish: Finish,
    ) -> Result<(), Failure> {
        let Finish {
            fillet,
            edge,
            softness,
        } = finish;
        let bone = self.figure.bone(bone)?;
        self.parts.push(Part {
            bone,
            shape,
            origin,
            axes,
            fillet,
            edge,
            softness,
        });
        Ok(())
    }

    /// A ball stretched along the model's axes.
    fn ball(
        &mut self,
        bone: &str,
        centre: DVec3,
        half: DVec3,
        finish: Finish,
    ) -> Result<(), Failure> {
        self.push(
            bone,
            Shape::Ellipsoid(half),
            centre,
            DMat3::IDENTITY,
            finish,
        )
    }

    /// A round cone between two points, `[wide, thick]` across and along `up`.
    fn cone(
        &mut self,
        bone: &str,
        ends: [DVec3; 2],
        [r0, r1]: [f64; 2],
        stretch: ([f64; 2], DVec3),
        finish: Finish,
    ) -> Result<(), Failure> {
        let along = ends[1] - ends[0];
        let ([thick, wide], up) = stretch;
        let shape = Shape::RoundCone {
            length: along.length(),
            r0,
            r1,
            wide: thick,
            thick: wide,
        };
        self.push(bone, shape, ends[0], axes(along, up), finish)
    }

    /// The same limb of the right side.
    fn right(&self) -> Result<Vec<Part>, Failure> {
        let each = self.parts.iter().map(|part| {
            let name = self
                .figure
                .bones
                .get(part.bone)
                .map_or("", |bone| &bone.name);
            let bone = self.figure.bone(&name.replace("left_", "right_"))?;
            Ok(mirrored(part, bone))
        });
        each.collect()
    }
}

const ROUND: ([f64; 2], DVec3) = ([1.0, 1.0], DVec3::X);

/// The whole body.
pub(crate) fn surface(figure: &Figure, at: &Landmarks) -> Result<Surface, Failure> {
    let limb = || Limb {
        figure,
        parts: Vec::new(),
    };
    let (mut torso, mut head) = (limb(), limb());
    let (mut arm, mut leg) = (limb(), limb());
    fill_torso(&mut torso)?;
    fill_head(&mut head, at)?;
    fill_arm(&mut arm, at)?;
    fill_leg(&mut leg, at)?;
    let limbs = vec![
        (torso.parts, 0.0),
        (head.parts, 0.03),
        (arm.right()?, 0.045),
        (arm.parts, 0.045),
        (leg.right()?, 0.04),
        (leg.parts, 0.04),
    ];
    Ok(Surface { limbs })
}

fn fill_torso(torso: &mut Limb<'_>) -> Result<(), Failure> {
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

fn fill_head(head: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
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

fn fill_arm(arm: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
    let along = |from: DVec3, to: DVec3, share: f64| from.lerp(to, share);
    let upper = |share| along(at.shoulder, at.elbow, share);
    let lower = |share| along(at.elbow, at.wrist, share);
    let hand = |share| along(at.wrist, at.fingertips, share);
    let palm = (at.wrist - at.elbow).cross(DVec3::X).normalize();
    let out = -palm;
    let bone = "left_upper_arm";
    arm.cone(bone, [upper(0.0), upper(1.0)], [0.05, 0.039], ROUND, ARM)?;
    arm.cone(
        bone,
        [upper(0.02) + out * 0.008, upper(0.3) + out * 0.012],
        [0.054, 0.036],
        ROUND,
        ARM,
    )?;
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
    // Four fingers together, slightly curved towards the palm, and a thumb.
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

fn fill_leg(leg: &mut Limb<'_>, at: &Landmarks) -> Result<(), Failure> {
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
