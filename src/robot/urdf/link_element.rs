//! Reads what a `<link>` is made of. What is wrong here is left out with a note: no joint needs it.

use roxmltree::Node;

use super::attributes::{element_once, is, name_attribute, numbers, text_of};
use super::error::{Fault, UrdfError};
use super::origin;
use super::reading::Reading;
use super::version::Version;
use crate::robot::{Geometry, Inertial, Link, Shape};

/// The shapes that a `<geometry>` can hold.
const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

/// Reads the link of a name.
pub(super) fn read(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    name: &str,
    version: Version,
) -> Link {
    let shapes = |tag: &str| {
        let label = format!("link `{name}`, <{tag}>");
        node.children()
            .filter(|child| is(*child, tag))
            .filter_map(|child| reading.or_left_out(shape(reading, child, &label, version)))
            .collect()
    };
    let label = format!("link `{name}`, <inertial>");
    let inertial = node.children().find(|child| is(*child, "inertial"));
    Link {
        visuals: shapes("visual"),
        collisions: shapes("collision"),
        inertial: inertial
            .and_then(|child| reading.or_left_out(self::inertial(reading, child, &label, version))),
    }
}

fn shape(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    version: Version,
) -> Result<Shape, UrdfError> {
    let geometry = required(reading, node, label, "geometry")?;
    let body = geometry
        .children()
        .find_map(|child| Some((child, SHAPES.into_iter().find(|tag| is(child, tag))?)));
    let Some((body, tag)) = body else {
        let fault = Fault::UnknownShape;
        return Err(reading.fault(geometry.range().start, label.to_owned(), fault));
    };
    let length = |attribute| one(reading, body, label, attribute);
    let geometry = match tag {
        "box" => Geometry::Box {
            size: demanded(reading, body, label, "size")?,
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
            file: name_attribute(reading, body, label, "filename")?,
            scale: numbers(reading, body, label, "scale")?.unwrap_or([1.0; 3]),
        },
    };
    Ok(Shape {
        name: text_of(node, "name").map(str::to_owned),
        link_from_shape: origin::read(reading, node, label, version)?,
        geometry,
    })
}

fn inertial(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    version: Version,
) -> Result<Inertial, UrdfError> {
    let mass = required(reading, node, label, "mass")?;
    let inertia = required(reading, node, label, "inertia")?;
    let moment = |attribute| -> Result<f64, UrdfError> {
        let read = numbers::<1>(reading, inertia, label, attribute)?;
        Ok(read.map_or(0.0, |[value]| value))
    };
    let (xy, xz, yz) = (moment("ixy")?, moment("ixz")?, moment("iyz")?);
    let (xx, yy, zz) = (moment("ixx")?, moment("iyy")?, moment("izz")?);
    Ok(Inertial {
        mass: one(reading, mass, label, "value")?,
        link_from_inertia: origin::read(reading, node, label, version)?,
        moments: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
    })
}

fn required<'a, 'input>(
    reading: &Reading<'_>,
    node: Node<'a, 'input>,
    label: &str,
    child: &'static str,
) -> Result<Node<'a, 'input>, UrdfError> {
    element_once(reading, node, label, child)?.ok_or_else(|| {
        let fault = Fault::MissingElement { child };
        reading.fault(node.range().start, label.to_owned(), fault)
    })
}

fn one(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<f64, UrdfError> {
    demanded::<1>(reading, node, label, attribute).map(|[value]| value)
}

fn demanded<const N: usize>(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<[f64; N], UrdfError> {
    numbers(reading, node, label, attribute)?.ok_or_else(|| {
        let fault = Fault::MissingAttribute { attribute };
        reading.fault(node.range().start, label.to_owned(), fault)
    })
}
