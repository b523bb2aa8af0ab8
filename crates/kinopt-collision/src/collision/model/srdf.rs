//! Export of disabled collision pairs as SRDF.

use std::fmt::Write;

use super::CollisionModel;

impl CollisionModel {
    /// An SRDF document that disables every pair of links with shapes that is not enabled in this model.
    ///
    /// It also disables the pairs of a link and a plane of an MJCF file that may overlap. A plane has the name of its
    /// body.
    #[must_use]
    pub fn to_srdf(&self) -> String {
        let mut text = "<?xml version=\"1.0\"?>\n".to_owned();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<robot name=\"{}\">", escaped(self.model.name()));
        let default = super::bodies::unconnected_pairs(&self.model, &self.links);
        for (index, &a) in self.links.iter().enumerate() {
            for &b in &self.links[index + 1..] {
                if self.pairs.binary_search(&[a, b]).is_ok() {
                    continue;
                }
                let reason = match default.binary_search(&[a, b]) {
                    Ok(_) => "User",
                    Err(_) => "Adjacent",
                };
                let [a, b] = [a, b].map(|link| escaped(self.name_of(link)));
                let _ = writeln!(
                    text,
                    "  <disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"{reason}\"/>"
                );
            }
        }
        let mut passed = Vec::new();
        for plane in self.planes() {
            for &link in &plane.passed {
                let pair = [plane.link.min(link), plane.link.max(link)];
                let has_shapes = pair
                    .iter()
                    .all(|link| self.links.binary_search(link).is_ok());
                // Pairs of links with shapes are disabled above, or stay enabled: SRDF cannot disable the plane alone.
                if !has_shapes && !passed.contains(&pair) {
                    passed.push(pair);
                    let [a, b] = pair.map(|link| escaped(self.name_of(link)));
                    let _ = writeln!(
                        text,
                        "  <disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"User\"/>"
                    );
                }
            }
        }
        text + "</robot>\n"
    }
}

fn escaped(name: &str) -> String {
    let escape = |text: String, (plain, code): &(char, &str)| text.replace(*plain, code);
    let codes = [('&', "&amp;"), ('<', "&lt;"), ('"', "&quot;")];
    codes.iter().fold(name.to_owned(), escape)
}
