//! Inertias of bodies: from `<inertial>` or from geoms, scaled to `settotalmass`.

use super::body::BodyElement;
use super::compiler::Compiler;
use super::inertial::{BodyInertia, of_geoms};
use crate::robot::xml::{Repair, RepairKind};
use crate::robot::{Inertial, MissingInertia};

/// The inertia of each body, and notes on those that depend on mesh files.
pub(super) fn compute_inertias(
    bodies: &[BodyElement<'_>],
    compiler: &Compiler,
) -> (Vec<BodyInertia>, Vec<Repair>) {
    let inertias = bodies.iter().map(|body| inertia(body, compiler));
    let mut inertias: Vec<BodyInertia> = inertias.collect();
    if let Some(total) = compiler.total_mass {
        scale(&mut inertias, total);
    }
    let notes = bodies.iter().zip(&inertias).filter_map(|(body, inertia)| {
        let BodyInertia::Missing(missing) = *inertia else {
            return None;
        };
        Some(Repair {
            line: body.tag.line(),
            element: body.tag.label(),
            mended: RepairKind::MassLeftToMeshes(missing),
        })
    });
    let notes = notes.collect();
    (inertias, notes)
}

fn inertia(body: &BodyElement<'_>, compiler: &Compiler) -> BodyInertia {
    let stated = || {
        body.inertial
            .map_or(BodyInertia::Nothing, BodyInertia::Known)
    };
    match (compiler.inertia_from_geom, body.inertial) {
        // The world has no inertia.
        _ if body.parent.is_none() => BodyInertia::Nothing,
        (Some(false), _) | (None, Some(_)) => stated(),
        (None, None) => of_geoms(&body.geoms),
        (Some(true), _) => match of_geoms(&body.geoms) {
            BodyInertia::Nothing => stated(),
            inertia => inertia,
        },
    }
}

/// Scales all bodies, including those fixed to the world, to the total mass `settotalmass`. If one mass depends on a
/// mesh file, the scale factor is unknown, and so are all masses.
fn scale(inertias: &mut [BodyInertia], total: f64) {
    let mut sum = Some(0.0);
    for inertia in &*inertias {
        let mass = match *inertia {
            BodyInertia::Nothing => Some(0.0),
            BodyInertia::Known(inertial) => Some(inertial.mass),
            BodyInertia::Missing(MissingInertia::Centre { mass }) => Some(mass),
            BodyInertia::Missing(MissingInertia::Mass) => None,
        };
        sum = sum.zip(mass).map(|(sum, mass)| sum + mass);
    }
    let factor = sum.map(|sum| total / sum);
    for inertia in inertias {
        *inertia = match (*inertia, factor) {
            (BodyInertia::Nothing, _) => BodyInertia::Nothing,
            (_, None) => BodyInertia::Missing(MissingInertia::Mass),
            (BodyInertia::Known(inertial), Some(factor)) => BodyInertia::Known(Inertial {
                mass: inertial.mass * factor,
                moments: inertial.moments.map(|row| row.map(|entry| entry * factor)),
                ..inertial
            }),
            (BodyInertia::Missing(MissingInertia::Centre { mass }), Some(factor)) => {
                let mass = mass * factor;
                BodyInertia::Missing(MissingInertia::Centre { mass })
            }
            (missing, _) => missing,
        };
    }
}
