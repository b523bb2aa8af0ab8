//! Checks of a parsed PLY header before the payload is read.

use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

use kinopt_kinematics::file::{FileLocation, ReadError};

/// Checks that the elements and properties of a mesh are declared, each once.
pub(super) fn check(header: &Header, text: &[u8], name: &str) -> Result<(), ReadError> {
    let fail = |problem: String| Err(ReadError::of_file(name, problem));
    // The parser keeps the last of two declarations with one name and would misread the payload.
    let declared: usize = header
        .elements
        .values()
        .map(|e| 1 + e.properties.len())
        .sum();
    let lines = text
        .split(|&b| b == b'\n' || b == b'\r')
        .filter(|line| line.starts_with(b"element") || line.starts_with(b"property"))
        .count();
    if lines != declared {
        return fail("the header declares an element or a property twice".into());
    }
    for element in ["vertex", "face"] {
        if !header.elements.contains_key(element) {
            let names: Vec<&str> = header.elements.keys().map(String::as_str).collect();
            return fail(format!("has no element `{element}`; it has {names:?}"));
        }
    }
    for property in ["x", "y", "z"] {
        if !has_vertex_property(header, property) {
            return fail(format!("the element `vertex` has no property `{property}`"));
        }
    }
    let lists = header.elements.get("face").map_or(0, |face| {
        let names = ["vertex_indices", "vertex_index"];
        names
            .iter()
            .filter(|name| face.properties.contains_key(**name))
            .count()
    });
    if lists != 1 {
        let problem = "the element `face` needs one property `vertex_indices` or `vertex_index`";
        return fail(problem.into());
    }
    Ok(())
}

/// Reports whether vertices have normals.
pub(super) fn has_normals(header: &Header) -> bool {
    ["nx", "ny", "nz"]
        .iter()
        .all(|name| has_vertex_property(header, name))
}

fn has_vertex_property(header: &Header, property: &str) -> bool {
    let vertex = header.elements.get("vertex");
    vertex.is_some_and(|vertex| vertex.properties.contains_key(property))
}

/// Checks that the remaining bytes can hold the entries of an element.
pub(super) fn check_count(
    header: &Header,
    element: &ElementDef,
    available: usize,
    name: &str,
) -> Result<(), ReadError> {
    let binary = header.encoding != Encoding::Ascii;
    // An ASCII property takes at least a digit and a separator.
    let width = |kind: &PropertyType| match kind {
        _ if !binary => 2,
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => scalar_width(scalar),
    };
    let entry: u128 = element
        .properties
        .values()
        .map(|p| width(&p.data_type))
        .sum();
    if entry == 0 && element.count > 0 {
        let problem = format!("the element `{}` has no properties", element.name);
        return Err(ReadError::of_file(name, problem));
    }
    let needed = (element.count as u128).saturating_mul(entry);
    // The last ASCII line needs no line break.
    if needed > available as u128 + u128::from(!binary) {
        let what = format!(
            "{} entries of the element `{}`",
            element.count, element.name
        );
        return Err(ReadError::truncated(
            name,
            FileLocation::File,
            what,
            needed,
            available,
        ));
    }
    Ok(())
}

fn scalar_width(kind: &ScalarType) -> u128 {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
