//! One element: its attributes and children, read strictly. What is wrong is named with its place.

use roxmltree::Node;

use super::error::{Fault, Read, RobotFileError};
use super::reading::Reading;
use super::repair::Mended;

/// A link or joint by name, and where it starts in the text.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) at: usize,
}

/// An element of the file that is being read, and what it is called in messages.
#[derive(Clone, Debug)]
pub(crate) struct Element<'a> {
    pub(crate) reading: &'a Reading<'a>,
    pub(crate) node: Node<'a, 'a>,
    label: String,
}

/// Whether a node is an element of this name in the document's own namespace: extensions such as
/// `<drake:joint>` are none of ours.
pub(crate) fn is(node: Node<'_, '_>, name: &str) -> bool {
    // Empty for what is no element.
    let tag = node.tag_name();
    let own = node.document().root_element().tag_name().namespace();
    tag.name() == name && tag.namespace() == own
}

impl<'a> Element<'a> {
    pub(crate) fn new(reading: &'a Reading<'a>, node: Node<'a, 'a>, label: String) -> Self {
        Self {
            reading,
            node,
            label,
        }
    }

    /// A part of this element that goes by its name in messages.
    pub(crate) fn part(&self, node: Node<'a, 'a>) -> Self {
        Self::new(self.reading, node, self.label.clone())
    }

    /// Where it starts in the text.
    pub(crate) fn at(&self) -> usize {
        self.node.range().start
    }

    pub(crate) fn fault(&self, fault: Fault) -> RobotFileError {
        self.reading.fault(self.at(), self.label.clone(), fault)
    }

    pub(crate) fn note(&self, mended: Mended) {
        self.reading.note(self.at(), &self.label, mended);
    }

    /// What is damage to a strict reader, and mended by a lenient one.
    pub(crate) fn mend(&self, fault: Fault, mended: impl FnOnce(Fault) -> Mended) -> Read<()> {
        self.reading.mend(self.at(), &self.label, fault, mended)
    }

    /// Its name, which it must have.
    pub(crate) fn named(&self) -> Read<Named> {
        let (name, at) = (self.name("name")?, self.at());
        Ok(Named { name, at })
    }

    /// An attribute without a namespace; roxmltree's own look-up takes any.
    pub(crate) fn text(&self, attribute: &str) -> Option<&'a str> {
        let mut own = self.node.attributes().filter(|a| a.namespace().is_none());
        own.find(|a| a.name() == attribute).map(|a| a.value())
    }

    /// An attribute that must be there and not be blank.
    pub(crate) fn name(&self, attribute: &'static str) -> Read<String> {
        match self.text(attribute) {
            Some(name) if !name.trim().is_empty() => Ok(name.to_owned()),
            _ => Err(self.fault(Fault::MissingAttribute { attribute })),
        }
    }

    /// An attribute of exactly `N` finite numbers; `None` where it is not there.
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
        // A decimal comma would make other numbers: only commas before blanks separate.
        let without_commas = exactly(&format!("{text} ").replace(", ", " "));
        let fault = Fault::BadNumbers {
            attribute,
            count,
            text,
        };
        match without_commas {
            Some(values) => {
                self.mend(fault, |_| Mended::CommasAreBlanks { attribute })?;
                Ok(Some(values))
            }
            None => Err(self.fault(fault)),
        }
    }

    /// As [`numbers`](Self::numbers), of one.
    pub(crate) fn number(&self, attribute: &'static str) -> Read<Option<f64>> {
        Ok(self.numbers(attribute)?.map(|[value]| value))
    }

    /// As [`number`](Self::number), of what kinematics can do without: a lenient reader leaves it out.
    pub(crate) fn number_or_left_out(&self, attribute: &'static str) -> Read<Option<f64>> {
        Ok(self.reading.leniently(self.number(attribute))?.flatten())
    }

    /// As [`numbers`](Self::numbers) that must be there.
    pub(crate) fn demanded<const N: usize>(&self, attribute: &'static str) -> Read<[f64; N]> {
        let missing = || self.fault(Fault::MissingAttribute { attribute });
        self.numbers(attribute)?.ok_or_else(missing)
    }

    /// The child of a name, which may stand once; to a lenient reader the first counts.
    fn once(&self, child: &'static str) -> Read<Option<Node<'a, 'a>>> {
        let mut found = self.node.children().filter(|inner| is(*inner, child));
        let first = found.next();
        if let Some(second) = found.next() {
            let fault = Fault::RepeatedElement { child };
            self.part(second)
                .mend(fault, |_| Mended::FirstCounts { child })?;
        }
        Ok(first)
    }

    /// The child of a name, which may stand once.
    pub(crate) fn child(&self, name: &'static str) -> Read<Option<Self>> {
        let label = || format!("{}, <{name}>", self.label);
        let child = self.once(name)?;
        Ok(child.map(|node| Self::new(self.reading, node, label())))
    }

    /// The [part](Self::part) of a name, which must stand once.
    pub(crate) fn required(&self, child: &'static str) -> Read<Self> {
        let missing = || self.fault(Fault::MissingElement { child });
        let node = self.once(child)?.ok_or_else(missing)?;
        Ok(self.part(node))
    }

    /// Finds fault with attributes whose names are nearly, but not, one of `known`.
    pub(crate) fn check_attributes(&self, known: &[&'static str]) -> Read<()> {
        let mut own = self.node.attributes().filter(|a| a.namespace().is_none());
        own.try_for_each(|attribute| self.check_known(attribute.name(), known))
    }

    /// Finds fault with a child element whose name is nearly, but not, one of `known`.
    pub(crate) fn check_child(&self, child: Node<'a, 'a>, known: &[&'static str]) -> Read<()> {
        let tag = child.tag_name();
        match tag.namespace() {
            None => self.part(child).check_known(tag.name(), known),
            Some(_) => Ok(()),
        }
    }

    /// Other unknown names are extensions, which real files are full of.
    fn check_known(&self, name: &str, known: &[&'static str]) -> Read<()> {
        if known.contains(&name) {
            return Ok(());
        }
        match known.iter().find(|meant| one_slip_apart(name, meant)) {
            Some(meant) => {
                let found = name.to_owned();
                self.mend(Fault::Misspelt { found, meant }, Mended::LeftOut)
            }
            None => Ok(()),
        }
    }
}

/// `N` finite numbers between blanks and nothing else.
pub(crate) fn exactly<const N: usize>(text: &str) -> Option<[f64; N]> {
    let words = text.split_whitespace();
    let numbers = words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()));
    numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// Whether two names differ, but for case, by at most one letter left out, added, exchanged or
/// swapped with its neighbour.
fn one_slip_apart(name: &str, meant: &str) -> bool {
    let (name, meant) = (name.to_ascii_lowercase(), meant.to_ascii_lowercase());
    let (a, b) = (name.as_bytes(), meant.as_bytes());
    let front = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (a, b) = (&a[front..], &b[front..]);
    let backwards = a.iter().rev().zip(b.iter().rev());
    let back = backwards.take_while(|(x, y)| x == y).count();
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
