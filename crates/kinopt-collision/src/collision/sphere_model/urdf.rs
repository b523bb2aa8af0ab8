//! Spherised URDF, as foam and VAMP use it: a robot's URDF whose collision shapes are spheres.

use std::fmt::Write;

use roxmltree::{Document, Node};

use super::SphereModel;
use crate::collision::Ball;
use kinopt_kinematics::file::{FileLocation, ReadError};
use kinopt_kinematics::spatial::Vector3;

impl SphereModel {
    /// The text of a URDF with these spheres as its only collision shapes. The rest of the text is unchanged.
    ///
    /// # Errors
    /// Returns an error if the text is not XML with a `<robot>`. The error reports `file` as its name.
    pub fn spherised(&self, urdf: &str, file: &str) -> Result<String, ReadError> {
        let document = Document::parse(urdf).map_err(|error| {
            let location = FileLocation::Line(error.pos().row as usize);
            ReadError::malformed(file, location, error.to_string())
        })?;
        let robot = document.root_element();
        if robot.tag_name().name() != "robot" {
            return Err(ReadError::of_file(
                file,
                "is not a URDF file: it has no <robot>",
            ));
        }
        let mut text = String::with_capacity(urdf.len());
        let mut copied_end = 0;
        for link in robot.children().filter(|node| node.has_tag_name("link")) {
            for collision in link
                .children()
                .filter(|node| node.has_tag_name("collision"))
            {
                // Removes the preceding blanks too, so that no empty lines remain.
                let range = collision.range();
                text.push_str(
                    urdf.get(copied_end..range.start)
                        .unwrap_or_default()
                        .trim_end(),
                );
                copied_end = range.end;
            }
            let spheres = self.elements(link);
            if spheres.is_empty() {
                continue;
            }
            let end = link.range().end;
            let element = urdf.get(copied_end..end).unwrap_or_default();
            if let Some(open) = element.strip_suffix("/>") {
                text.push_str(open.trim_end());
                text.push('>');
                text.push_str(&spheres);
                text.push_str("\n  </link>");
            } else {
                let close = element.rfind("</").unwrap_or(element.len());
                text.push_str(element[..close].trim_end());
                text.push_str(&spheres);
                text.push_str("\n  ");
                text.push_str(&element[close..]);
            }
            copied_end = end;
        }
        text.push_str(urdf.get(copied_end..).unwrap_or_default());
        Ok(text)
    }

    fn elements(&self, link: Node<'_, '_>) -> String {
        let mut text = String::new();
        let group = self
            .groups
            .iter()
            .find(|group| Some(group.name.as_str()) == link.attribute("name"));
        for Ball { centre, radius } in group.map_or(&[][..], |group| &group.spheres) {
            let Vector3 { x, y, z } = centre;
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "\n    <collision><origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"0 0 0\"/><geometry><sphere radius=\"{radius:?}\"/></geometry></collision>"
            );
        }
        text
    }
}
