//! `<geom>`: what a body looks like, bumps into things with and weighs.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::mesh::Mesh;
use super::orientation::placement;
use super::segment;
use super::solid::Solid;
use super::tree::Tag;
use crate::model::UnknownName;
use crate::robot::contacts::ContactBits;
use crate::robot::xml::{Fault, Read, RobotFileError};
use crate::robot::{Geometry, Shape};
use crate::spatial::Placement;

const TYPES: [&str; 9] = [
    "plane",
    "hfield",
    "sphere",
    "capsule",
    "ellipsoid",
    "cylinder",
    "box",
    "mesh",
    "sdf",
];
const SPHERE: usize = 2;
/// MuJoCo shows geoms of groups below.
const SHOWN_GROUPS: f64 = 3.0;
/// Of water, kg/m³.
const DENSITY: f64 = 1000.0;

/// A geom of a body.
#[derive(Clone, Debug)]
pub(super) struct Geom<'a> {
    pub(super) tag: Tag<'a>,
    kind: &'static str,
    /// `None` for what [`Geometry`] has no word for.
    pub(super) shape: Option<Shape>,
    pub(super) is_visual: bool,
    pub(super) collides: bool,
    pub(super) bits: ContactBits,
    /// Where a plane stands.
    pub(super) body_from_plane: Option<Placement<f64>>,
    pub(super) weight: Weight,
}

impl Geom<'_> {
    /// Whether it is among the collision shapes of its link.
    pub(super) fn is_collision(&self) -> bool {
        self.collides && self.shape.is_some()
    }

    /// What touches other things, but has no shape that counts, by its kind.
    pub(super) fn missing_shape(&self) -> Option<RobotFileError> {
        let missing = self.collides && self.shape.is_none() && self.body_from_plane.is_none();
        let kind = self.kind;
        missing.then(|| self.tag.fault(Fault::NoShape { kind }))
    }
}

/// What a geom adds to its body's mass.
#[derive(Clone, Copy, Debug)]
pub(super) enum Weight {
    Nothing,
    /// Kilograms, and where the solid stands in the body.
    Known(f64, Solid, Placement<f64>),
    /// Kilograms; the file of a mesh would have to be opened to know where their centre is.
    Somewhere(f64),
    /// The file of a mesh would have to be opened; a shell's is not worked out either.
    Unknown,
}

/// Reads a geom, `body_from_frame` away from its body.
pub(super) fn read<'a>(
    tag: Tag<'a>,
    (compiler, defaults, meshes): (&Compiler, &Defaults<'a>, &HashMap<String, Mesh>),
    around: Option<&str>,
    body_from_frame: &Placement<f64>,
) -> Read<Geom<'a>> {
    let geom = Attributes::of(tag, defaults, around)?;
    let kind = geom.word("type", &TYPES)?.unwrap_or(SPHERE);
    let segment = segment::read(&geom)?;
    let own = match &segment {
        Some(segment) => segment.placement,
        None => placement(&geom, compiler)?,
    };
    let body_from_geom = *body_from_frame * own;
    let length = segment.map(|segment| segment.length);
    let (solid, geometry, own) = match TYPES[kind] {
        "plane" | "hfield" => (None, None, None),
        "mesh" | "sdf" => {
            let mesh = mesh(&geom, meshes)?;
            (
                None,
                mesh.map(|m| m.geometry.clone()),
                mesh.map(|m| m.shape_from_file),
            )
        }
        // One that is fitted to a mesh has sizes that are not in the document.
        _ if geom.text("mesh").is_some() => (None, None, None),
        kind => {
            let (solid, geometry) = solid(&geom, kind, length)?;
            (Some(solid), geometry, None)
        }
    };
    let shape = geometry.map(|geometry| Shape {
        name: tag.text("name").map(str::to_owned),
        link_from_shape: match own {
            Some(shape_from_file) => body_from_geom * shape_from_file,
            None => body_from_geom,
        },
        geometry,
    });
    let bits = |attribute, usual: u32| {
        // MuJoCo's are integers of 32 bits.
        let taken = |bits: f64| bits as i64 as u32;
        geom.number(attribute)
            .map(|given| given.map_or(usual, taken))
    };
    let bits = ContactBits {
        own: bits("contype", ContactBits::USUAL.own)?,
        of_others: bits("conaffinity", ContactBits::USUAL.of_others)?,
    };
    let group = geom.number("group")?.unwrap_or(0.0);
    let weighs_nothing = matches!(TYPES[kind], "plane" | "hfield") || !compiler.weighs_group(group);
    Ok(Geom {
        tag,
        kind: TYPES[kind],
        shape,
        is_visual: group < SHOWN_GROUPS,
        collides: bits.own != 0 || bits.of_others != 0,
        bits,
        body_from_plane: (TYPES[kind] == "plane").then_some(body_from_geom),
        weight: match weighs_nothing {
            true => Weight::Nothing,
            false => weight(&geom, solid, body_from_geom)?,
        },
    })
}

fn mesh<'m>(geom: &Attributes<'_>, meshes: &'m HashMap<String, Mesh>) -> Read<Option<&'m Mesh>> {
    let attribute = "mesh";
    let missing = || geom.fault(Fault::MissingAttribute { attribute });
    let name = geom.text(attribute).ok_or_else(missing)?;
    let unknown = || {
        let mut valid: Vec<&str> = meshes.keys().map(String::as_str).collect();
        valid.sort_unstable();
        geom.fault(UnknownName::new("mesh", name, valid).into())
    };
    meshes.get(name).map(Some).ok_or_else(unknown)
}

fn solid(
    geom: &Attributes<'_>,
    kind: &'static str,
    length: Option<f64>,
) -> Read<(Solid, Option<Geometry>)> {
    let attribute = "size";
    let missing = || geom.fault(Fault::MissingAttribute { attribute });
    let (mut size, mut given) = geom.up_to::<3>(attribute)?.ok_or_else(missing)?;
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    // A segment says how long it is; a box of it is as deep as wide.
    if let (Some(length), true) = (length, needed > 1) {
        if given < 2 {
            size[1] = size[0];
        }
        size[needed - 1] = length / 2.0;
        given = needed;
    }
    if given < needed || size[..needed].iter().any(|size| *size <= 0.0) {
        let text = geom.text(attribute).unwrap_or_default().to_owned();
        let count = needed;
        return Err(geom.fault(Fault::BadNumbers {
            attribute,
            count,
            text,
        }));
    }
    let [radius, half, _] = size;
    Ok(match kind {
        "sphere" => (
            Solid::Ellipsoid([radius; 3]),
            Some(Geometry::Sphere { radius }),
        ),
        "capsule" => {
            let length = 2.0 * half;
            (
                Solid::Capsule(radius, half),
                Some(Geometry::Capsule { radius, length }),
            )
        }
        "cylinder" => {
            let length = 2.0 * half;
            (
                Solid::Cylinder(radius, half),
                Some(Geometry::Cylinder { radius, length }),
            )
        }
        "ellipsoid" => (
            Solid::Ellipsoid(size),
            Some(Geometry::Ellipsoid { radii: size }),
        ),
        _ => {
            let size = size.map(|half| 2.0 * half);
            (
                Solid::Box(size.map(|whole| whole / 2.0)),
                Some(Geometry::Box { size }),
            )
        }
    })
}

fn weight(
    geom: &Attributes<'_>,
    solid: Option<Solid>,
    body_from_geom: Placement<f64>,
) -> Read<Weight> {
    let not_negative = |attribute| match geom.number(attribute)? {
        Some(value) if value < 0.0 => Err(geom.fault(Fault::NegativeMass { attribute, value })),
        value => Ok(value),
    };
    let (mass, density) = (not_negative("mass")?, not_negative("density")?);
    let is_shell = geom.flag("shellinertia")? == Some(true);
    Ok(match (mass, density, solid) {
        (Some(0.0), ..) | (None, Some(0.0), _) => Weight::Nothing,
        (Some(mass), _, None) => Weight::Somewhere(mass),
        (Some(mass), ..) if is_shell => Weight::Somewhere(mass),
        (None, ..) if is_shell => Weight::Unknown,
        (None, _, None) => Weight::Unknown,
        (Some(mass), _, Some(solid)) => Weight::Known(mass, solid, body_from_geom),
        (None, density, Some(solid)) => {
            let mass = density.unwrap_or(DENSITY) * solid.volume();
            Weight::Known(mass, solid, body_from_geom)
        }
    })
}
