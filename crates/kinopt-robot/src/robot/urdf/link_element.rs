//! Reader of the shapes and the mass of a `<link>`. Faulty elements are left out with a note, as no joint depends on
//! them.

use roxmltree::Node;

use super::origin;
use super::version::Version;
use crate::robot::xml::{Element, ParseIssue, Read, Reading, RobotFileError, is};
use crate::robot::{Geometry, GeometryObject, Inertial, Link};

/// Shapes that a `<geometry>` can hold.
const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

/// Reads the shapes and the mass of the link `name`.
pub(super) fn read<'a>(
    reading: &'a Reading<'a>,
    node: Node<'a, 'a>,
    name: &str,
    version: Version,
) -> Link {
    let parts = |tag: &'static str| {
        let elements = node.children().filter(move |child| is(*child, tag));
        elements.map(move |child| Element::new(reading, child, format!("link `{name}`, <{tag}>")))
    };
    let shapes = |tag| {
        let shapes = parts(tag).map(|part| shape(&part, version));
        shapes.filter_map(|shape| reading.or_left_out(shape))
    };
    let inertial = parts("inertial").next();
    Link {
        visuals: shapes("visual").collect(),
        collisions: shapes("collision").collect(),
        inertial: inertial.and_then(|part| reading.or_left_out(self::inertial(&part, version))),
        left_to_meshes: None,
    }
}

fn shape(shape: &Element<'_>, version: Version) -> Read<GeometryObject> {
    let geometry = shape.required("geometry")?;
    let mut children = geometry.node.children();
    let body =
        children.find_map(|child| Some((child, SHAPES.into_iter().find(|tag| is(child, tag))?)));
    let Some((body, tag)) = body else {
        return Err(geometry.fault(ParseIssue::UnknownShape));
    };
    let body = shape.part(body);
    let length = |attribute| body.required_numbers(attribute).map(|[value]| value);
    let geometry = match tag {
        "box" => Geometry::Box {
            size: body.required_numbers("size")?,
        },
        "sphere" => Geometry::Sphere {
            radius: length("radius")?,
        },
        "cylinder" => Geometry::Cylinder {
            radius: length("radius")?,
            length: length("length")?,
        },
        "capsule" => Geometry::Capsule {
            radius: length("radius")?,
            length: length("length")?,
        },
        _ => Geometry::Mesh {
            file: body.name("filename")?,
            scale: body.numbers("scale")?.unwrap_or([1.0; 3]),
        },
    };
    Ok(GeometryObject {
        name: shape.text("name").map(str::to_owned),
        link_from_shape: origin::read(shape, version)?,
        geometry,
    })
}

fn inertial(inertial: &Element<'_>, version: Version) -> Read<Inertial> {
    let (mass, inertia) = (inertial.required("mass")?, inertial.required("inertia")?);
    let moment = |attribute| Ok::<_, RobotFileError>(inertia.number(attribute)?.unwrap_or(0.0));
    let (xy, xz, yz) = (moment("ixy")?, moment("ixz")?, moment("iyz")?);
    let (xx, yy, zz) = (moment("ixx")?, moment("iyy")?, moment("izz")?);
    let [mass] = mass.required_numbers("value")?;
    Ok(Inertial {
        mass,
        link_from_inertia: origin::read(inertial, version)?,
        moments: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
    })
}
