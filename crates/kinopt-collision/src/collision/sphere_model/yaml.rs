//! Sphere models in cuRobo's YAML format.
//!
//! ```yaml
//! collision_spheres:
//!   panda_link0:
//!     - center: [0.0, 0.0, 0.05]
//!       radius: 0.08
//! ```

use std::fmt::Write;

use super::{NamedSpheres, SphereModel};
use crate::collision::Ball;
use kinopt_kinematics::file::{FileLocation, ReadError};
use kinopt_kinematics::plural::counted;
use kinopt_kinematics::spatial::Vector3;
use kinopt_robot::yaml::{self, Node, Value};

impl SphereModel {
    /// The spheres as cuRobo's `collision_spheres`. The numbers have enough digits to read back exactly.
    #[must_use]
    pub fn to_yaml(&self) -> String {
        let mut text = "collision_spheres:\n".to_owned();
        // Writing to a String cannot fail.
        for group in &self.groups {
            let _ = writeln!(text, "  {}:", quoted(&group.name));
            for Ball { centre, radius } in &group.spheres {
                let Vector3 { x, y, z } = centre;
                let _ = writeln!(text, "    - center: [{x:?}, {y:?}, {z:?}]");
                let _ = writeln!(text, "      radius: {radius:?}");
            }
        }
        text
    }
}

/// A name as a quoted YAML string.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The spheres of a document, by link. `collision_spheres` is found at any depth, as cuRobo also writes it under
/// `robot_cfg: kinematics:`.
///
/// Spheres of radius 0 or less are left out, with a note.
pub(super) fn parse(
    text: &str,
    file: &str,
    notes: &mut Vec<String>,
) -> Result<NamedSpheres, ReadError> {
    let root = yaml::parse(text, file)?;
    let fail = |node: &Node<'_>, problem: &str| {
        ReadError::malformed(file, FileLocation::Line(node.line), problem)
    };
    let missing = || ReadError::of_file(file, "has no `collision_spheres`");
    let spheres_node = find(&root).ok_or_else(missing)?;
    let Value::Map(links) = &spheres_node.value else {
        let problem = "`collision_spheres` must be a map of links or the name of a file";
        return Err(fail(spheres_node, problem));
    };
    let mut named = Vec::new();
    for (link, list) in links {
        let name = link
            .text()
            .ok_or_else(|| fail(link, "must be the name of a link"))?;
        let list = list.list();
        let list = list.ok_or_else(|| fail(link, "holds no list of spheres"))?;
        let mut spheres = Vec::with_capacity(list.len());
        for sphere in list {
            let number = |node: &Node<'_>| node.number().filter(|number| number.is_finite());
            let centre = sphere.get("center").and_then(|centre| {
                let numbers = centre.list()?.iter().map(number);
                let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
                <[f64; 3]>::try_from(numbers).ok()
            });
            let centre = centre
                .ok_or_else(|| fail(sphere, "a sphere needs a `center` of three finite numbers"))?;
            let radius = sphere.get("radius").and_then(number);
            let radius =
                radius.ok_or_else(|| fail(sphere, "a sphere needs a `radius`, a finite number"))?;
            if radius > 0.0 {
                let centre = Vector3::from(centre);
                spheres.push(Ball { centre, radius });
            }
        }
        let disabled = list.len() - spheres.len();
        if disabled > 0 {
            let spheres = counted(disabled, "sphere");
            notes.push(format!(
                "link `{name}`: {spheres} of a radius of 0 or less left out: cuRobo switches them off so"
            ));
        }
        named.push((name.to_owned(), spheres));
    }
    Ok(named)
}

fn find<'n, 't>(node: &'n Node<'t>) -> Option<&'n Node<'t>> {
    node.get("collision_spheres").or_else(|| match &node.value {
        Value::Map(pairs) => pairs.iter().find_map(|(_, value)| find(value)),
        _ => None,
    })
}
