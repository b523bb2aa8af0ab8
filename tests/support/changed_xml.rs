//! Random mutations of XML documents as trees, so that the results are valid XML and mostly nearly correct.

use crate::random::Random;

/// Element of a document.
#[derive(Clone, Debug)]
pub struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
}

/// Replacement values of attributes, unusual or invalid.
const VALUES: [&str; 34] = [
    "",
    " ",
    "0",
    "-0",
    "1",
    "-1",
    "2.5",
    "180",
    "-720",
    "nan",
    "-inf",
    "1e400",
    "1e308",
    "-1e308",
    "1e9",
    "4e-324",
    "0 0 0",
    "1 2",
    "1 2 3",
    "0 0 0 0",
    "1 0 0 0",
    "1 2 3 4 5 6",
    "1 0 0 2 0 0",
    "0x10",
    "1,5",
    "true",
    "false",
    "auto",
    "ball",
    "free",
    "slide",
    "nobody",
    "${x}",
    "\u{1F916}",
];
const NUMBERS: [&str; 12] = [
    "0", "-1", "1e-300", "1e300", "-1e308", "nan", "inf", "3.2", "-0.5", "720", "x", "1e17",
];

impl Element {
    /// Root element of a document.
    pub fn parse(text: &str) -> Self {
        let document = roxmltree::Document::parse(text).unwrap();
        Self::of(document.root_element())
    }

    fn of(node: roxmltree::Node<'_, '_>) -> Self {
        let attributes = node.attributes();
        let attributes =
            attributes.map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned()));
        let children = node.children().filter(roxmltree::Node::is_element);
        Self {
            tag: node.tag_name().name().to_owned(),
            attributes: attributes.collect(),
            children: children.map(Self::of).collect(),
        }
    }

    /// Text of the document with one element per line.
    pub fn text(&self) -> String {
        let escape = |value: &str| {
            value
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('"', "&quot;")
        };
        let attributes = self.attributes.iter();
        let attributes = attributes.map(|(name, value)| format!(" {name}=\"{}\"", escape(value)));
        let attributes: String = attributes.collect();
        let inner: String = self.children.iter().map(Self::text).collect();
        format!("<{}{attributes}>\n{inner}</{}>\n", self.tag, self.tag)
    }

    /// Number of elements, including this one.
    pub fn count(&self) -> usize {
        1 + self.children.iter().map(Self::count).sum::<usize>()
    }

    /// Element by its number in document order; the root has number 0.
    fn at(&mut self, number: usize) -> Option<&mut Self> {
        if number == 0 {
            return Some(self);
        }
        let mut left = number - 1;
        for child in &mut self.children {
            let count = child.count();
            if left < count {
                return child.at(left);
            }
            left -= count;
        }
        None
    }

    /// Removes and returns an element other than the root.
    fn take(&mut self, number: usize) -> Option<Self> {
        let mut left = number.checked_sub(1)?;
        for k in 0..self.children.len() {
            let count = self.children[k].count();
            if left == 0 {
                return Some(self.children.remove(k));
            }
            if left < count {
                return self.children[k].take(left);
            }
            left -= count;
        }
        None
    }

    /// Collects all attributes as pairs of name and value.
    fn all_attributes(&self, all: &mut Vec<(String, String)>) {
        all.extend(self.attributes.iter().cloned());
        self.children
            .iter()
            .for_each(|child| child.all_attributes(all));
    }

    fn all_tags(&self, all: &mut Vec<String>) {
        all.push(self.tag.clone());
        self.children.iter().for_each(|child| child.all_tags(all));
    }

    /// Applies one random change.
    pub fn change(&mut self, random: &mut Random) {
        let mut known_attributes = Vec::new();
        self.all_attributes(&mut known_attributes);
        let count = self.count();
        let (one, other) = (random.below(count), random.below(count));
        match random.below(12) {
            // Replaces an attribute's value, or one number in it, by another value.
            0..=5 => {
                let kind = random.below(3);
                let (_, other_value) =
                    known_attributes[random.below(known_attributes.len())].clone();
                let (value, number) = (
                    VALUES[random.below(VALUES.len())],
                    NUMBERS[random.below(NUMBERS.len())],
                );
                let position = random.bits() as usize;
                // First element with attributes from that number on.
                for number_of in (one..count).chain(0..one) {
                    let Some(element) = self.at(number_of) else {
                        break;
                    };
                    let (among, value_to_change) =
                        (element.attributes.len(), &mut element.attributes);
                    let Some((_, value_to_change)) =
                        value_to_change.get_mut(position % among.max(1))
                    else {
                        continue;
                    };
                    match kind {
                        0 => *value_to_change = value.to_owned(),
                        1 => *value_to_change = other_value,
                        _ => {
                            let mut words: Vec<&str> = value_to_change.split_whitespace().collect();
                            let at = position % words.len().max(1);
                            if let Some(word) = words.get_mut(at) {
                                *word = number;
                            }
                            *value_to_change = words.join(" ");
                        }
                    }
                    break;
                }
            }
            // Removes an attribute, or adds one from another element.
            6 => {
                let position = random.bits() as usize;
                if let Some(element) = self
                    .at(one)
                    .filter(|candidate| !candidate.attributes.is_empty())
                {
                    let among = element.attributes.len();
                    element.attributes.remove(position % among);
                }
            }
            7 => {
                let (name, value) = known_attributes[random.below(known_attributes.len())].clone();
                if let Some(element) = self.at(one) {
                    element.attributes.retain(|(key, _)| *key != name);
                    element.attributes.push((name, value));
                }
            }
            // Renames an element like another one.
            8 => {
                let mut tags = Vec::new();
                self.all_tags(&mut tags);
                let tag = tags[random.below(tags.len())].clone();
                if let Some(element) = self.at(one) {
                    element.tag = tag;
                }
            }
            // Removes, duplicates or moves an element.
            9 => drop(self.take(one)),
            10 => {
                let copy = self
                    .at(one)
                    .map(|original| original.clone())
                    .filter(|_| one > 0);
                if let (Some(copy), Some(parent)) = (copy, self.at(other)) {
                    parent.children.push(copy);
                }
            }
            _ => {
                if let Some(taken) = self.take(one) {
                    let left = self.count();
                    if let Some(parent) = self.at(other % left) {
                        parent.children.insert(0, taken);
                    }
                }
            }
        }
    }
}
