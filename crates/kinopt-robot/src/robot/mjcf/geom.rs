//! `<geom>`: visual shapes, collision shapes and masses of bodies.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::mesh::Mesh;
use super::orientation::placement;
use super::segment;
use super::solid::GeomSolid;
use super::tree::Tag;
use crate::robot::contacts::ContactBits;
use crate::robot::xml::{ParseIssue, Read, RobotFileError};
use crate::robot::{Geometry, GeometryObject};
use kinopt_kinematics::model::UnknownName;
use kinopt_kinematics::spatial::Placement;

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
/// Geoms of groups below this number are visuals: MuJoCo displays groups 0 to 2 by default.
const FIRST_HIDDEN_GROUP: f64 = 3.0;
/// Default density, kg/m³: that of water.
const DEFAULT_DENSITY: f64 = 1000.0;

/// A geom of a body.
#[derive(Clone, Debug)]
pub(super) struct Geom<'a> {
    pub(super) tag: Tag<'a>,
    kind: &'static str,
    /// Shape of the geom; `None` for types that [`Geometry`] does not have.
    pub(super) shape: Option<GeometryObject>,
    pub(super) is_visual: bool,
    pub(super) collides: bool,
    pub(super) bits: ContactBits,
    /// Pose in the body if the geom is a plane.
    pub(super) body_from_plane: Option<Placement<f64>>,
    pub(super) mass: GeomMass,
}

impl Geom<'_> {
    /// Reports whether the geom is a collision shape of its link.
    pub(super) fn is_collision(&self) -> bool {
        self.collides && self.shape.is_some()
    }

    /// The fault of a geom with contact bits whose type is unsupported.
    pub(super) fn missing_shape(&self) -> Option<RobotFileError> {
        let missing = self.collides && self.shape.is_none() && self.body_from_plane.is_none();
        let kind = self.kind;
        missing.then(|| self.tag.fault(ParseIssue::NoShape { kind }))
    }
}

/// Contribution of a geom to the mass of its body.
#[derive(Clone, Copy, Debug)]
pub(super) enum GeomMass {
    Nothing,
    /// Mass in kilograms, solid, and pose of the solid in the body.
    Known(f64, GeomSolid, Placement<f64>),
    /// Mass in kilograms. The centre is unknown: it depends on a mesh file, or the geom is a shell.
    UnknownCentre(f64),
    /// Unknown mass: it depends on a mesh file, or the geom is a shell.
    Unknown,
}

/// Reads a geom; `body_from_frame` is the pose of the enclosing frame in the body.
pub(super) fn read<'a>(
    tag: Tag<'a>,
    (compiler, defaults, meshes): (&Compiler, &Defaults<'a>, &HashMap<String, Mesh>),
    enclosing_class: Option<&str>,
    body_from_frame: &Placement<f64>,
) -> Read<Geom<'a>> {
    let geom = Attributes::of(tag, defaults, enclosing_class)?;
    let kind = geom.word("type", &TYPES)?.unwrap_or(SPHERE);
    let segment = segment::read(&geom)?;
    let frame_from_geom = match &segment {
        Some(segment) => segment.placement,
        None => placement(&geom, compiler)?,
    };
    let body_from_geom = *body_from_frame * frame_from_geom;
    let length = segment.map(|segment| segment.length);
    let (solid, geometry, shape_from_file) = match TYPES[kind] {
        "plane" | "hfield" => (None, None, None),
        "mesh" | "sdf" => {
            let mesh = mesh(&geom, meshes)?;
            (
                None,
                mesh.map(|m| m.geometry.clone()),
                mesh.map(|m| m.shape_from_file),
            )
        }
        // A primitive that MuJoCo fits to a mesh has sizes that are not in the document.
        _ if geom.text("mesh").is_some() => (None, None, None),
        kind => {
            let (solid, geometry) = solid(&geom, kind, length)?;
            (Some(solid), geometry, None)
        }
    };
    let shape = geometry.map(|geometry| GeometryObject {
        name: tag.text("name").map(str::to_owned),
        link_from_shape: match shape_from_file {
            Some(shape_from_file) => body_from_geom * shape_from_file,
            None => body_from_geom,
        },
        geometry,
    });
    let bits = |attribute, default: u32| {
        // MuJoCo's contact bits are 32-bit integers.
        let as_bits = |bits: f64| bits as i64 as u32;
        geom.number(attribute)
            .map(|given| given.map_or(default, as_bits))
    };
    let bits = ContactBits {
        contype: bits("contype", ContactBits::DEFAULT.contype)?,
        conaffinity: bits("conaffinity", ContactBits::DEFAULT.conaffinity)?,
    };
    let group = geom.number("group")?.unwrap_or(0.0);
    let is_massless =
        matches!(TYPES[kind], "plane" | "hfield") || !compiler.counts_group_mass(group);
    Ok(Geom {
        tag,
        kind: TYPES[kind],
        shape,
        is_visual: group < FIRST_HIDDEN_GROUP,
        collides: bits.contype != 0 || bits.conaffinity != 0,
        bits,
        body_from_plane: (TYPES[kind] == "plane").then_some(body_from_geom),
        mass: match is_massless {
            true => GeomMass::Nothing,
            false => geom_mass(&geom, solid, body_from_geom)?,
        },
    })
}

fn mesh<'m>(geom: &Attributes<'_>, meshes: &'m HashMap<String, Mesh>) -> Read<Option<&'m Mesh>> {
    let attribute = "mesh";
    let missing = || geom.fault(ParseIssue::MissingAttribute { attribute });
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
) -> Read<(GeomSolid, Option<Geometry>)> {
    let attribute = "size";
    let missing = || geom.fault(ParseIssue::MissingAttribute { attribute });
    let (mut size, mut given) = geom.up_to::<3>(attribute)?.ok_or_else(missing)?;
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    // A segment gives the length; a box along it has equal sides.
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
        return Err(geom.fault(ParseIssue::BadNumbers {
            attribute,
            count,
            text,
        }));
    }
    let [radius, half, _] = size;
    Ok(match kind {
        "sphere" => (
            GeomSolid::Ellipsoid([radius; 3]),
            Some(Geometry::Sphere { radius }),
        ),
        "capsule" => {
            let length = 2.0 * half;
            (
                GeomSolid::Capsule(radius, half),
                Some(Geometry::Capsule { radius, length }),
            )
        }
        "cylinder" => {
            let length = 2.0 * half;
            (
                GeomSolid::Cylinder(radius, half),
                Some(Geometry::Cylinder { radius, length }),
            )
        }
        "ellipsoid" => (
            GeomSolid::Ellipsoid(size),
            Some(Geometry::Ellipsoid { radii: size }),
        ),
        _ => {
            let size = size.map(|half| 2.0 * half);
            (
                GeomSolid::Box(size.map(|whole| whole / 2.0)),
                Some(Geometry::Box { size }),
            )
        }
    })
}

fn geom_mass(
    geom: &Attributes<'_>,
    solid: Option<GeomSolid>,
    body_from_geom: Placement<f64>,
) -> Read<GeomMass> {
    let not_negative = |attribute| match geom.number(attribute)? {
        Some(value) if value < 0.0 => {
            Err(geom.fault(ParseIssue::NegativeMass { attribute, value }))
        }
        value => Ok(value),
    };
    let (mass, density) = (not_negative("mass")?, not_negative("density")?);
    let is_shell = geom.flag("shellinertia")? == Some(true);
    Ok(match (mass, density, solid) {
        (Some(0.0), ..) | (None, Some(0.0), _) => GeomMass::Nothing,
        (Some(mass), _, None) => GeomMass::UnknownCentre(mass),
        (Some(mass), ..) if is_shell => GeomMass::UnknownCentre(mass),
        (None, ..) if is_shell => GeomMass::Unknown,
        (None, _, None) => GeomMass::Unknown,
        (Some(mass), _, Some(solid)) => GeomMass::Known(mass, solid, body_from_geom),
        (None, density, Some(solid)) => {
            let mass = density.unwrap_or(DEFAULT_DENSITY) * solid.volume();
            GeomMass::Known(mass, solid, body_from_geom)
        }
    })
}
