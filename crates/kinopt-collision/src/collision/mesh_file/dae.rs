//! COLLADA reader.
//!
//! Reads the triangles of the scene, each geometry transformed by its nodes, in metres. `<up_axis>` is ignored, as in
//! RViz and MoveIt, since robots' meshes are written for that.

use roxmltree::{Document, Node};

use super::dae_document::{Collada, children, named};
use super::dae_nodes::Instances;
use super::{CORNER_LIMIT, MeshFile, text};
use kinopt_kinematics::file::{FileLocation, ReadError};
use kinopt_kinematics::spatial::Vector3;

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    let text = text::of(bytes, file)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // Document type declarations are rejected: their entities could expand to any amount of memory.
    let document = Document::parse(text).map_err(|error| {
        let location = FileLocation::Line(error.pos().row as usize);
        ReadError::malformed(file, location, error.to_string())
    })?;
    let collada = Collada::new(&document, file);
    let unit = named(document.root_element(), "asset")
        .and_then(|asset| named(asset, "unit")?.attribute("meter")?.parse().ok())
        .filter(|unit: &f64| unit.is_finite() && *unit > 0.0)
        .unwrap_or(1.0);
    let mut mesh = MeshFile::default();
    for (geometry, placed) in Instances::of(&collada)? {
        let first = mesh.points.len();
        let part = collada.geometry(geometry)?;
        if mesh.triangles.len() + part.triangles.len() > CORNER_LIMIT / 3 {
            return Err(collada.fail(geometry, "more triangles than are read of a mesh"));
        }
        let inside_out = placed.mirrors();
        mesh.points.extend(
            part.points
                .into_iter()
                .map(|point| placed.apply(point) * unit),
        );
        mesh.triangles.extend(part.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| corner + first as u32);
            if inside_out { [a, c, b] } else { [a, b, c] }
        }));
    }
    Ok(mesh)
}

impl<'a> Collada<'a> {
    fn geometry(&self, geometry: Node<'a, 'a>) -> Result<MeshFile, ReadError> {
        let mut mesh = MeshFile::default();
        // A spline has no triangles.
        let Some(part) = named(geometry, "mesh") else {
            return Ok(mesh);
        };
        for primitives in part.children() {
            let tag = primitives.tag_name().name();
            if matches!(
                tag,
                "triangles" | "polylist" | "polygons" | "trifans" | "tristrips"
            ) {
                self.primitives(primitives, tag, &mut mesh)?;
            }
        }
        Ok(mesh)
    }

    fn primitives(
        &self,
        node: Node<'a, 'a>,
        tag: &str,
        mesh: &mut MeshFile,
    ) -> Result<(), ReadError> {
        let offset = |input: Node<'a, 'a>| {
            let offset = input.attribute("offset").unwrap_or("0");
            offset.parse::<usize>().ok().filter(|offset| *offset < 64)
        };
        let mut stride = 1;
        let mut vertices = None;
        for input in children(node, "input") {
            let bad = || self.fail(input, "the offset must be a number below 64");
            let offset = offset(input).ok_or_else(bad)?;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertices = Some((offset, self.referred(input, "source")?));
            }
        }
        // Without a VERTEX input there are no corners.
        let Some((offset, vertices)) = vertices else {
            return Ok(());
        };
        let first = mesh.points.len() as u32;
        self.positions(vertices, &mut mesh.points)?;
        let count = mesh.points.len() as u32 - first;
        let mut counts = match named(node, "vcount") {
            Some(counts) if tag == "polylist" => self.numbers::<usize>(counts)?.into_iter(),
            _ => Vec::new().into_iter(),
        };
        for list in children(node, "p") {
            let numbers: Vec<u32> = self.numbers(list)?;
            let corners = numbers.chunks_exact(stride).map(|corner| corner[offset]);
            let corners: Vec<u32> = corners.map(|corner| first.saturating_add(corner)).collect();
            if corners.iter().any(|corner| *corner - first >= count) {
                return Err(self.fail(
                    list,
                    format!("contains an index beyond the {count} entries"),
                ));
            }
            match tag {
                "triangles" => corners
                    .chunks_exact(3)
                    .for_each(|three| mesh.add_polygon(three)),
                "polylist" => {
                    let mut rest = corners.as_slice();
                    for sides in counts.by_ref() {
                        let Some((polygon, others)) = rest.split_at_checked(sides) else {
                            return Err(
                                self.fail(list, "contains fewer corners than <vcount> announces")
                            );
                        };
                        mesh.add_polygon(polygon);
                        rest = others;
                    }
                }
                "tristrips" => {
                    for (k, three) in corners.windows(3).enumerate() {
                        let [a, b, c] = [three[0], three[1], three[2]];
                        let oriented = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
                        mesh.triangles.push(oriented);
                    }
                }
                _ => mesh.add_polygon(&corners),
            }
        }
        Ok(())
    }

    /// Appends the positions of a `<vertices>` element.
    fn positions(
        &self,
        vertices: Node<'a, 'a>,
        points: &mut Vec<Vector3<f64>>,
    ) -> Result<(), ReadError> {
        let position = |input: &Node<'a, 'a>| input.attribute("semantic") == Some("POSITION");
        let input = children(vertices, "input").find(position);
        let input = input.ok_or_else(|| self.fail(vertices, "has no POSITION"))?;
        let source = self.referred(input, "source")?;
        let missing = || self.fail(source, "has no <float_array>");
        let numbers: Vec<f64> = self.numbers(named(source, "float_array").ok_or_else(missing)?)?;
        let accessor =
            named(source, "technique_common").and_then(|technique| named(technique, "accessor"));
        let stride = accessor.and_then(|accessor| accessor.attribute("stride")?.parse().ok());
        let stride: usize = stride.unwrap_or(3);
        if stride < 3 {
            return Err(self.fail(source, "a point needs three numbers"));
        }
        let rows = numbers.chunks_exact(stride);
        points.extend(rows.map(|p| Vector3::new(p[0], p[1], p[2])));
        Ok(())
    }
}
