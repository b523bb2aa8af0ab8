//! Attributes and child elements, read strictly: what is wrong is named with its place.

use roxmltree::Node;

use super::error::{Fault, UrdfError};
use super::reading::Reading;
use super::repair::Mended;

/// A link or joint by name, and where it starts in the text.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) at: usize,
}

impl Named {
    /// Reads the name that an element must have.
    pub(super) fn read(
        reading: &Reading<'_>,
        node: Node<'_, '_>,
        label: &str,
    ) -> Result<Self, UrdfError> {
        Ok(Self {
            name: name_attribute(reading, node, label, "name")?,
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
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<String, UrdfError> {
    match text_of(node, attribute) {
        Some(name) if !name.trim().is_empty() => Ok(name.to_owned()),
        _ => {
            let fault = Fault::MissingAttribute { attribute };
            Err(reading.fault(node.range().start, label.to_owned(), fault))
        }
    }
}

/// An attribute of exactly `N` finite numbers; `None` where it is not there.
pub(super) fn numbers<const N: usize>(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<Option<[f64; N]>, UrdfError> {
    let Some(text) = text_of(node, attribute) else {
        return Ok(None);
    };
    if let Some(values) = exactly(text) {
        return Ok(Some(values));
    }
    let at = node.range().start;
    let fault = Fault::BadNumbers {
        attribute,
        count: N,
        text: text.to_owned(),
    };
    // A decimal comma would make other numbers: only commas before blanks separate.
    match exactly(&format!("{text} ").replace(", ", " ")) {
        Some(values) => {
            reading.mend(at, label, fault, |_| Mended::CommasAreBlanks { attribute })?;
            Ok(Some(values))
        }
        None => Err(reading.fault(at, label.to_owned(), fault)),
    }
}

/// As [`numbers`], of what kinematics can do without: a lenient reader leaves it out.
pub(super) fn number_or_left_out(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    label: &str,
    attribute: &'static str,
) -> Result<Option<f64>, UrdfError> {
    let read = numbers::<1>(reading, node, label, attribute);
    let read = match reading.lenient {
        true => reading.or_left_out(read).flatten(),
        false => read?,
    };
    Ok(read.map(|[value]| value))
}

fn exactly<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parsed: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    parsed?.try_into().ok()
}

/// The child element of a name, which may stand once; to a lenient reader the first counts.
pub(super) fn element_once<'a, 'input>(
    reading: &Reading<'_>,
    node: Node<'a, 'input>,
    label: &str,
    child: &'static str,
) -> Result<Option<Node<'a, 'input>>, UrdfError> {
    let mut found = node.children().filter(|inner| is(*inner, child));
    let first = found.next();
    if let Some(second) = found.next() {
        let fault = Fault::RepeatedElement { child };
        reading.mend(second.range().start, label, fault, |_| {
            Mended::FirstCounts { child }
        })?;
    }
    Ok(first)
}

/// Finds fault with a child element whose name is nearly, but not, one of `known`.
pub(super) fn refuse_misspelt(
    reading: &Reading<'_>,
    child: Node<'_, '_>,
    label: &str,
    known: &[&'static str],
) -> Result<(), UrdfError> {
    let tag = child.tag_name();
    match tag.namespace() {
        None => check_known(reading, child.range().start, label, tag.name(), known),
        Some(_) => Ok(()),
    }
}

/// Finds fault with a name that is nearly, but not, one of `known`. Other unknown names are extensions,
/// which real files are full of.
pub(super) fn check_known(
    reading: &Reading<'_>,
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
            reading.mend(at, label, Fault::Misspelt { found, meant }, Mended::LeftOut)
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
