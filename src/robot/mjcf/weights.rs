//! Inertias of bodies: from `<inertial>` or from geoms, scaled to `settotalmass`.

use super::body::Body;
use super::compiler::Compiler;
use super::inertial::{Weighed, of_geoms};
use crate::robot::xml::{Repair, RepairKind};
use crate::robot::{Inertial, MissingInertia};

/// The inertia of each body, and notes on those that depend on mesh files.
pub(super) fn weigh(bodies: &[Body<'_>], compiler: &Compiler) -> (Vec<Weighed>, Vec<Repair>) {
    let own = bodies.iter().map(|body| weight(body, compiler));
    let mut weights: Vec<Weighed> = own.collect();
    if let Some(total) = compiler.total_mass {
        scale(&mut weights, total);
    }
    let notes = bodies.iter().zip(&weights).filter_map(|(body, weight)| {
        let Weighed::Left(left) = *weight else {
            return None;
        };
        Some(Repair {
            line: body.tag.line(),
            element: body.tag.called(),
            mended: RepairKind::MassLeftToMeshes(left),
        })
    });
    let notes = notes.collect();
    (weights, notes)
}

fn weight(body: &Body<'_>, compiler: &Compiler) -> Weighed {
    let stated = || body.inertial.map_or(Weighed::Nothing, Weighed::Known);
    match (compiler.inertia_from_geom, body.inertial) {
        // The world has no inertia.
        _ if body.parent.is_none() => Weighed::Nothing,
        (Some(false), _) | (None, Some(_)) => stated(),
        (None, None) => of_geoms(&body.geoms),
        (Some(true), _) => match of_geoms(&body.geoms) {
            Weighed::Nothing => stated(),
            weight => weight,
        },
    }
}

/// Scales all bodies, including those fixed to the world, to the total mass `settotalmass`. If one mass depends on a
/// mesh file, the scale factor is unknown, and so are all masses.
fn scale(weights: &mut [Weighed], total: f64) {
    let mut sum = Some(0.0);
    for weight in &*weights {
        let own = match *weight {
            Weighed::Nothing => Some(0.0),
            Weighed::Known(inertial) => Some(inertial.mass),
            Weighed::Left(MissingInertia::Centre { mass }) => Some(mass),
            Weighed::Left(MissingInertia::Mass) => None,
        };
        sum = sum.zip(own).map(|(sum, own)| sum + own);
    }
    let factor = sum.map(|sum| total / sum);
    for weight in weights {
        *weight = match (*weight, factor) {
            (Weighed::Nothing, _) => Weighed::Nothing,
            (_, None) => Weighed::Left(MissingInertia::Mass),
            (Weighed::Known(inertial), Some(factor)) => Weighed::Known(Inertial {
                mass: inertial.mass * factor,
                moments: inertial.moments.map(|row| row.map(|entry| entry * factor)),
                ..inertial
            }),
            (Weighed::Left(MissingInertia::Centre { mass }), Some(factor)) => {
                let mass = mass * factor;
                Weighed::Left(MissingInertia::Centre { mass })
            }
            (left, _) => left,
        };
    }
}
