//! Body of the humanoid: a smooth mannequin of about forty rounded parts, in metres.

mod limbs;
mod trunk;

use glam::{DMat3, DVec3};

use crate::Failure;
use crate::figure::{Figure, axes, mirrored};
use crate::landmarks::Landmarks;
use crate::surface::{Part, Shape, Surface};

/// Fillets, edge lengths and weight softness of one region, metres.
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

/// Parts of a limb under construction, by the names of their bones.
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

    /// Adds an ellipsoid along the model's axes.
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

    /// Adds a round cone between two points; `[wide, thick]` are its stretches across and along `up`.
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

    /// The mirrored limb of the right side.
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

/// Surface of the whole body.
pub(crate) fn surface(figure: &Figure, at: &Landmarks) -> Result<Surface, Failure> {
    let limb = || Limb {
        figure,
        parts: Vec::new(),
    };
    let (mut torso, mut head) = (limb(), limb());
    let (mut arm, mut leg) = (limb(), limb());
    trunk::fill_torso(&mut torso)?;
    trunk::fill_head(&mut head, at)?;
    limbs::fill_arm(&mut arm, at)?;
    limbs::fill_leg(&mut leg, at)?;
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
