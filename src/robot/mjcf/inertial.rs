//! `<inertial>`, and inertias of bodies computed from their geoms.

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::geom::{Geom, Weight};
use super::orientation::placement;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};
use crate::robot::{Inertial, MissingInertia};
use crate::spatial::{Placement, Vector3};

/// Inertia of a body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Weighed {
    Nothing,
    Known(Inertial),
    Left(MissingInertia),
}

pub(super) fn read(tag: Tag<'_>, compiler: &Compiler) -> Read<Inertial> {
    let inertial = Attributes::own(tag);
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
pub(super) fn of_geoms(geoms: &[Geom]) -> Weighed {
    let (mut mass, mut moment) = (0.0, Vector3::zero());
    let mut has_centre = true;
    let mut parts = Vec::new();
    for geom in geoms {
        match geom.weight {
            Weight::Nothing => {}
            Weight::Unknown => return Weighed::Left(MissingInertia::Mass),
            Weight::Somewhere(own) => {
                mass += own;
                has_centre = false;
            }
            Weight::Known(own, solid, at) => {
                mass += own;
                moment += at.translation * own;
                parts.push((own, solid, at));
            }
        }
    }
    if mass <= 0.0 || !mass.is_finite() {
        return Weighed::Nothing;
    }
    if !has_centre {
        return Weighed::Left(MissingInertia::Centre { mass });
    }
    let centre = moment * (1.0 / mass);
    let mut moments = [[0.0; 3]; 3];
    for (own, solid, at) in parts {
        let axes = [at.rotation.x, at.rotation.y, at.rotation.z].map(Vector3::to_array);
        let about = solid.moments();
        let away = (at.translation - centre).to_array();
        let squared: f64 = away.iter().map(|c| c * c).sum();
        for (i, row) in moments.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                // Rotated moments R diag(I) Rᵀ plus the parallel axis theorem.
                let turned: f64 = (0..3).map(|k| axes[k][i] * about[k] * axes[k][j]).sum();
                let moved = if i == j { squared } else { 0.0 } - away[i] * away[j];
                *entry += own * (turned + moved);
            }
        }
    }
    Weighed::Known(Inertial {
        mass,
        link_from_inertia: Placement::translation(centre),
        moments,
    })
}
