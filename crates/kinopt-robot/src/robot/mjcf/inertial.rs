//! `<inertial>`, and inertias of bodies computed from their geoms.

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::geom::{Geom, GeomMass};
use super::orientation::placement;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};
use crate::robot::{Inertial, MissingInertia};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Inertia of a body.
#[derive(Clone, Copy, Debug)]
pub(super) enum BodyInertia {
    Nothing,
    Known(Inertial),
    Missing(MissingInertia),
}

pub(super) fn read(tag: Tag<'_>, compiler: &Compiler) -> Read<Inertial> {
    let inertial = Attributes::without_defaults(tag);
    let missing = |attribute| tag.fault(ParseIssue::MissingAttribute { attribute });
    let mass = inertial.number("mass")?.ok_or_else(|| missing("mass"))?;
    if inertial.text("pos").is_none() {
        return Err(missing("pos"));
    }
    let moments = match inertial.numbers::<6>("fullinertia")? {
        Some([xx, yy, zz, xy, xz, yz]) => [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
        None => {
            let [xx, yy, zz] = inertial.numbers("diaginertia")?.unwrap_or_default();
            [[xx, 0.0, 0.0], [0.0, yy, 0.0], [0.0, 0.0, zz]]
        }
    };
    Ok(Inertial {
        mass,
        link_from_inertia: placement(&inertial, compiler)?,
        moments,
    })
}

/// Combined inertia of all geoms in the axes of the body, or the part of it that depends on mesh files.
pub(super) fn of_geoms(geoms: &[Geom]) -> BodyInertia {
    let (mut mass, mut moment) = (0.0, Vector3::zero());
    let mut has_centre = true;
    let mut parts = Vec::new();
    for geom in geoms {
        match geom.mass {
            GeomMass::Nothing => {}
            GeomMass::Unknown => return BodyInertia::Missing(MissingInertia::Mass),
            GeomMass::UnknownCentre(geom_mass) => {
                mass += geom_mass;
                has_centre = false;
            }
            GeomMass::Known(geom_mass, solid, body_from_solid) => {
                mass += geom_mass;
                moment += body_from_solid.translation * geom_mass;
                parts.push((geom_mass, solid, body_from_solid));
            }
        }
    }
    if mass <= 0.0 || !mass.is_finite() {
        return BodyInertia::Nothing;
    }
    if !has_centre {
        return BodyInertia::Missing(MissingInertia::Centre { mass });
    }
    let centre = moment * (1.0 / mass);
    let mut moments = [[0.0; 3]; 3];
    for (geom_mass, solid, body_from_solid) in parts {
        let axes = [
            body_from_solid.rotation.x,
            body_from_solid.rotation.y,
            body_from_solid.rotation.z,
        ]
        .map(Vector3::to_array);
        let solid_moments = solid.moments();
        let offset = (body_from_solid.translation - centre).to_array();
        let squared: f64 = offset.iter().map(|c| c * c).sum();
        for (i, row) in moments.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                // Rotated moments R diag(I) Rᵀ plus the parallel axis theorem.
                let rotated: f64 = (0..3)
                    .map(|k| axes[k][i] * solid_moments[k] * axes[k][j])
                    .sum();
                let shifted = if i == j { squared } else { 0.0 } - offset[i] * offset[j];
                *entry += geom_mass * (rotated + shifted);
            }
        }
    }
    BodyInertia::Known(Inertial {
        mass,
        link_from_inertia: Placement::translation(centre),
        moments,
    })
}
