//! Wavefront OBJ reader: vertices (`v`) and polygons (`f`) of all objects and groups. Other statements are ignored.

use super::{CORNER_LIMIT, MeshFile, text};
use kinopt_kinematics::file::{FileLocation, ReadError};
use kinopt_kinematics::spatial::Vector3;

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    // Comments may have any encoding.
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = MeshFile::default();
    let mut corners = Vec::new();
    let mut joined = String::new();
    // An additional empty line ends a continued last line.
    for (number, line) in text.lines().chain([""]).enumerate() {
        let fail =
            |problem: &str| ReadError::malformed(file, FileLocation::Line(number + 1), problem);
        let line = line.split('#').next().unwrap_or_default().trim_end();
        // A trailing backslash continues the line.
        if let Some(part) = line.strip_suffix('\\') {
            joined.push_str(part);
            joined.push(' ');
            continue;
        }
        joined.push_str(line);
        let mut words = joined.split_whitespace();
        match words.next() {
            Some("v") => {
                let point = text::three(&mut words)
                    .ok_or_else(|| fail("a point needs three finite numbers"))?;
                mesh.points.push(Vector3::from(point));
            }
            Some("f") => {
                corners.clear();
                for word in words {
                    corners.push(corner(word, mesh.points.len()).ok_or_else(|| {
                        let count = mesh.points.len();
                        fail(&format!(
                            "`{word}` is not an index of the {count} points so far"
                        ))
                    })?);
                }
                if corners.len() < 3 {
                    return Err(fail("a face needs three corners"));
                }
                if 3 * (mesh.triangles.len() + corners.len()) > CORNER_LIMIT {
                    return Err(fail("more triangles than are read of a mesh"));
                }
                mesh.add_polygon(&corners);
            }
            _ => {}
        }
        joined.clear();
    }
    Ok(mesh)
}

/// Index of the vertex in `12`, `12/3`, `12//4` or `12/3/4`. Negative numbers count back from the last vertex.
fn corner(word: &str, points: usize) -> Option<u32> {
    let index: i64 = word.split('/').next()?.parse().ok()?;
    let points = i64::try_from(points).ok()?;
    let index = match index {
        0 => return None,
        1.. => index - 1,
        _ => points.checked_add(index)?,
    };
    let inside = (0..points).contains(&index);
    inside.then(|| u32::try_from(index).ok()).flatten()
}
