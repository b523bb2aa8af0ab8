//! One XML element: strict reading of its attributes and children. Errors contain the position.

use roxmltree::Node;

use super::error::{ParseIssue, Read, RobotFileError};
use super::reading::Reading;
use super::repair::RepairKind;

/// A link or joint by name, with its byte offset in the text.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) offset: usize,
}

/// An element of the file, with its name in messages.
#[derive(Clone, Debug)]
pub(crate) struct Element<'a> {
    pub(crate) reading: &'a Reading<'a>,
    pub(crate) node: Node<'a, 'a>,
    label: String,
}

/// Reports whether a node is an element of this name in the namespace of the root. Extensions such as `<drake:joint>`
/// have another namespace.
pub(crate) fn is(node: Node<'_, '_>, name: &str) -> bool {
    // Empty for nodes that are no elements.
    let tag = node.tag_name();
    let root_namespace = node.document().root_element().tag_name().namespace();
    tag.name() == name && tag.namespace() == root_namespace
}

impl<'a> Element<'a> {
    pub(crate) fn new(reading: &'a Reading<'a>, node: Node<'a, 'a>, label: String) -> Self {
        Self {
            reading,
            node,
            label,
        }
    }

    /// A child element that messages call by the name of this element.
    pub(crate) fn part(&self, node: Node<'a, 'a>) -> Self {
        Self::new(self.reading, node, self.label.clone())
    }

    /// Byte offset of the element in the text.
    pub(crate) fn offset(&self) -> usize {
        self.node.range().start
    }

    pub(crate) fn fault(&self, fault: ParseIssue) -> RobotFileError {
        self.reading.fault(self.offset(), self.label.clone(), fault)
    }

    pub(crate) fn note(&self, kind: RepairKind) {
        self.reading.note(self.offset(), &self.label, kind);
    }

    /// Returns a fault as an error if the reader is strict; a lenient reader notes the repair instead.
    pub(crate) fn repair_or_fail(
        &self,
        fault: ParseIssue,
        repair: impl FnOnce(ParseIssue) -> RepairKind,
    ) -> Read<()> {
        self.reading
            .repair_or_fail(self.offset(), &self.label, fault, repair)
    }

    /// Name and offset of the element. The name is required.
    pub(crate) fn named(&self) -> Read<Named> {
        let (name, offset) = (self.name("name")?, self.offset());
        Ok(Named { name, offset })
    }

    /// An attribute without a namespace. The look-up of roxmltree accepts any namespace.
    pub(crate) fn text(&self, attribute: &str) -> Option<&'a str> {
        let mut attributes = self.node.attributes().filter(|a| a.namespace().is_none());
        attributes
            .find(|a| a.name() == attribute)
            .map(|a| a.value())
    }

    /// A required attribute that is not blank.
    pub(crate) fn name(&self, attribute: &'static str) -> Read<String> {
        match self.text(attribute) {
            Some(name) if !name.trim().is_empty() => Ok(name.to_owned()),
            _ => Err(self.fault(ParseIssue::MissingAttribute { attribute })),
        }
    }

    /// An attribute of exactly `N` finite numbers; `None` without the attribute.
    pub(crate) fn numbers<const N: usize>(
        &self,
        attribute: &'static str,
    ) -> Read<Option<[f64; N]>> {
        let Some(text) = self.text(attribute) else {
            return Ok(None);
        };
        if let Some(values) = exactly(text) {
            return Ok(Some(values));
        }
        let (count, text) = (N, text.to_owned());
        // A decimal comma would change the numbers, so only commas followed by a space separate.
        let without_commas = exactly(&format!("{text} ").replace(", ", " "));
        let fault = ParseIssue::BadNumbers {
            attribute,
            count,
            text,
        };
        match without_commas {
            Some(values) => {
                self.repair_or_fail(fault, |_| RepairKind::CommasAreBlanks { attribute })?;
                Ok(Some(values))
            }
            None => Err(self.fault(fault)),
        }
    }

    /// An attribute of one finite number.
    pub(crate) fn number(&self, attribute: &'static str) -> Read<Option<f64>> {
        Ok(self.numbers(attribute)?.map(|[value]| value))
    }

    /// As [`number`](Self::number), for attributes that kinematics does not need: a lenient reader leaves out invalid
    /// ones.
    pub(crate) fn number_or_left_out(&self, attribute: &'static str) -> Read<Option<f64>> {
        Ok(self.reading.leniently(self.number(attribute))?.flatten())
    }

    /// A required attribute of exactly `N` finite numbers.
    pub(crate) fn required_numbers<const N: usize>(
        &self,
        attribute: &'static str,
    ) -> Read<[f64; N]> {
        let missing = || self.fault(ParseIssue::MissingAttribute { attribute });
        self.numbers(attribute)?.ok_or_else(missing)
    }

    /// The child element of a name. A second one is a fault; a lenient reader uses the first.
    fn unique_child(&self, child: &'static str) -> Read<Option<Node<'a, 'a>>> {
        let mut matches = self.node.children().filter(|inner| is(*inner, child));
        let first = matches.next();
        if let Some(second) = matches.next() {
            let fault = ParseIssue::RepeatedElement { child };
            self.part(second)
                .repair_or_fail(fault, |_| RepairKind::FirstCounts { child })?;
        }
        Ok(first)
    }

    /// The child element of a name as an [`Element`]; `None` without one.
    pub(crate) fn child(&self, name: &'static str) -> Read<Option<Self>> {
        let label = || format!("{}, <{name}>", self.label);
        let child = self.unique_child(name)?;
        Ok(child.map(|node| Self::new(self.reading, node, label())))
    }

    /// The required [part](Self::part) of a name.
    pub(crate) fn required(&self, child: &'static str) -> Read<Self> {
        let missing = || self.fault(ParseIssue::MissingElement { child });
        let node = self.unique_child(child)?.ok_or_else(missing)?;
        Ok(self.part(node))
    }

    /// Reports attributes whose names are misspellings of names in `known`.
    pub(crate) fn check_attributes(&self, known: &[&'static str]) -> Read<()> {
        let mut attributes = self.node.attributes().filter(|a| a.namespace().is_none());
        attributes.try_for_each(|attribute| self.check_known(attribute.name(), known))
    }

    /// Reports a child element whose name is a misspelling of a name in `known`.
    pub(crate) fn check_child(&self, child: Node<'a, 'a>, known: &[&'static str]) -> Read<()> {
        let tag = child.tag_name();
        match tag.namespace() {
            None => self.part(child).check_known(tag.name(), known),
            Some(_) => Ok(()),
        }
    }

    /// Other unknown names are extensions, which are common in files.
    fn check_known(&self, name: &str, known: &[&'static str]) -> Read<()> {
        if known.contains(&name) {
            return Ok(());
        }
        match known.iter().find(|meant| differs_by_one_edit(name, meant)) {
            Some(meant) => {
                let found = name.to_owned();
                self.repair_or_fail(ParseIssue::Misspelt { found, meant }, RepairKind::LeftOut)
            }
            None => Ok(()),
        }
    }
}

/// Exactly `N` finite numbers separated by white space.
pub(crate) fn exactly<const N: usize>(text: &str) -> Option<[f64; N]> {
    let words = text.split_whitespace();
    let numbers = words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()));
    numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// Reports whether two names differ by at most one edit, regardless of case: one letter removed, added or replaced, or
/// two neighbours swapped.
fn differs_by_one_edit(name: &str, meant: &str) -> bool {
    let (name, meant) = (name.to_ascii_lowercase(), meant.to_ascii_lowercase());
    let (a, b) = (name.as_bytes(), meant.as_bytes());
    let prefix = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (a, b) = (&a[prefix..], &b[prefix..]);
    let reversed = a.iter().rev().zip(b.iter().rev());
    let suffix = reversed.take_while(|(x, y)| x == y).count();
    match (&a[..a.len() - suffix], &b[..b.len() - suffix]) {
        ([x, y], [v, w]) => x == w && y == v,
        (x, y) => x.len() <= 1 && y.len() <= 1,
    }
}

#[cfg(test)]
mod tests {
    use super::differs_by_one_edit;

    #[test]
    fn misspellings_differ_by_one_edit() {
        for (name, meant) in [
            ("Origin", "origin"),
            ("orgin", "origin"),
            ("limits", "limit"),
            ("xzy", "xyz"),
            ("upper", "uppre"),
            ("aaa", "aa"),
        ] {
            assert!(differs_by_one_edit(name, meant), "{name} {meant}");
        }
        for (name, meant) in [("rpy", "xyz"), ("effort", "offset"), ("axis", "limit")] {
            assert!(!differs_by_one_edit(name, meant), "{name} {meant}");
        }
    }
}
