//! Attributes and child elements, read strictly: what is wrong is named with its place.

use roxmltree::Node;

use super::error::{Fault, UrdfError};

/// Where faults are reported: the file's name and its text, to count lines in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Place<'_> {
    /// The line of a byte offset, from 1.
    pub(super) fn line(&self, at: usize) -> u32 {
        let before = self.text.as_bytes().iter().take(at);
        1 + before.filter(|&&byte| byte == b'\n').count() as u32
    }

    pub(super) fn fault(&self, at: usize, element: String, fault: Fault) -> UrdfError {
        UrdfError::Element {
            file: self.file.to_owned(),
            line: self.line(at),
            element,
            fault,
        }
    }
}

/// A link or joint by name, and where it starts in the text.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) at: usize,
}

impl Named {
    /// Reads the name that an element must have.
    pub(super) fn read(
        place: &Place<'_>,
        node: Node<'_, '_>,
        label: &str,
    ) -> Result<Self, UrdfError> {
        Ok(Self {
            name: name_attribute(place, node, label, "name")?,
            at: node.range().start,
        })
    }
}

/// Whether a node is an element of this name in the document's own namespace: extensions such as
/// `<drake:joint>` are none of ours.
pub(super) fn is(node: Node<'_, '_>, name: &str) -> bool {
    let tag = node.tag_name();
    let own = node.document().root_element().tag_name().namespace();
    node.is_element() && tag.name() == name && tag.namespace() == own
}

/// An attribute without a namespace; roxmltree's own look-up takes any.
pub(super) fn text_of<'a>(node: Node<'a, '_>, attribute: &str) -> Option<&'a str> {
    node.attributes()
        .find(|a| a.namespace().is_none() && a.name() == attribute)
        .map(|a| a.value())
}

/// An attribute that must be there and not be blank.
pub(super) fn name_attribute(
    place: &Place<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<String, UrdfError> {
    match text_of(node, attribute) {
        Some(name) if !name.trim().is_empty() => Ok(name.to_owned()),
        _ => {
            let fault = Fault::MissingAttribute { attribute };
            Err(place.fault(node.range().start, label.to_owned(), fault))
        }
    }
}

/// An attribute of exactly `N` finite numbers; `None` where it is not there.
pub(super) fn numbers<const N: usize>(
    place: &Place<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<Option<[f64; N]>, UrdfError> {
    let Some(text) = text_of(node, attribute) else {
        return Ok(None);
    };
    let parsed: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    match parsed.and_then(|values| values.try_into().ok()) {
        Some(values) => Ok(Some(values)),
        None => {
            let fault = Fault::BadNumbers {
                attribute,
                count: N,
                text: text.to_owned(),
            };
            Err(place.fault(node.range().start, label.to_owned(), fault))
        }
    }
}

/// The child element of a name, which may stand at most once.
pub(super) fn element_once<'a, 'input>(
    place: &Place<'_>,
    node: Node<'a, 'input>,
    label: &str,
    child: &'static str,
) -> Result<Option<Node<'a, 'input>>, UrdfError> {
    let mut found = node.children().filter(|inner| is(*inner, child));
    let first = found.next();
    match found.next() {
        Some(second) => {
            let fault = Fault::RepeatedElement { child };
            Err(place.fault(second.range().start, label.to_owned(), fault))
        }
        None => Ok(first),
    }
}

/// Refuses a child element whose name is nearly, but not, one of `known`.
pub(super) fn refuse_misspelt(
    place: &Place<'_>,
    child: Node<'_, '_>,
    label: &str,
    known: &[&'static str],
) -> Result<(), UrdfError> {
    let tag = child.tag_name();
    match tag.namespace() {
        None => check_known(place, child.range().start, label, tag.name(), known),
        Some(_) => Ok(()),
    }
}

/// Refuses a name that is nearly, but not, one of `known`. Other unknown names are extensions,
/// which real files are full of.
pub(super) fn check_known(
    place: &Place<'_>,
    at: usize,
    label: &str,
    name: &str,
    known: &[&'static str],
) -> Result<(), UrdfError> {
    if known.contains(&name) {
        return Ok(());
    }
    match known.iter().find(|meant| one_slip_apart(name, meant)) {
        Some(meant) => {
            let found = name.to_owned();
            Err(place.fault(at, label.to_owned(), Fault::Misspelt { found, meant }))
        }
        None => Ok(()),
    }
}

/// Whether two names differ, but for case, by at most one letter left out, added, exchanged or
/// swapped with its neighbour.
fn one_slip_apart(name: &str, meant: &str) -> bool {
    let (name, meant) = (name.to_ascii_lowercase(), meant.to_ascii_lowercase());
    let (a, b) = (name.as_bytes(), meant.as_bytes());
    let front = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (a, b) = (&a[front..], &b[front..]);
    let back = a
        .iter()
        .rev()
        .zip(b.iter().rev())
        .take_while(|(x, y)| x == y)
        .count();
    match (&a[..a.len() - back], &b[..b.len() - back]) {
        ([x, y], [v, w]) => x == w && y == v,
        (x, y) => x.len() <= 1 && y.len() <= 1,
    }
}

#[cfg(test)]
mod tests {
    use super::one_slip_apart;

    #[test]
    fn slips_are_told_from_other_words() {
        for (name, meant) in [
            ("Origin", "origin"),
            ("orgin", "origin"),
            ("limits", "limit"),
            ("xzy", "xyz"),
            ("upper", "uppre"),
            ("aaa", "aa"),
        ] {
            assert!(one_slip_apart(name, meant), "{name} {meant}");
        }
        for (name, meant) in [("rpy", "xyz"), ("effort", "offset"), ("axis", "limit")] {
            assert!(!one_slip_apart(name, meant), "{name} {meant}");
        }
    }
}
