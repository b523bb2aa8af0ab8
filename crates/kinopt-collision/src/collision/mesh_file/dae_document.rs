//! Access to the elements of a COLLADA document, with errors.

use std::collections::HashMap;

use roxmltree::{Document, Node};

use kinopt_kinematics::file::{FileLocation, ReadError};

/// A document with its file name for errors and its elements by id.
pub(super) struct Collada<'a> {
    pub(super) file: &'a str,
    document: &'a Document<'a>,
    by_id: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> Collada<'a> {
    /// Indexes the elements of a document by id.
    pub(super) fn new(document: &'a Document<'a>, file: &'a str) -> Self {
        let ids = document.descendants();
        let by_id = ids.filter_map(|node| Some((node.attribute("id")?, node)));
        Self {
            file,
            by_id: by_id.collect(),
            document,
        }
    }

    pub(super) fn root(&self) -> Node<'a, 'a> {
        self.document.root_element()
    }

    pub(super) fn fail(&self, node: Node<'a, 'a>, problem: impl Into<String>) -> ReadError {
        let row = self.document.text_pos_at(node.range().start).row;
        ReadError::malformed(self.file, FileLocation::Line(row as usize), problem)
    }

    /// The element that an attribute `#id` refers to.
    pub(super) fn referred(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
    ) -> Result<Node<'a, 'a>, ReadError> {
        let reference = node.attribute(attribute).unwrap_or_default();
        let element = self.by_id.get(reference.trim_start_matches('#')).copied();
        element.ok_or_else(|| {
            self.fail(
                node,
                format!("{attribute} `{reference}` is not an id of the file"),
            )
        })
    }

    /// The numbers in the text of an element.
    pub(super) fn numbers<T: std::str::FromStr>(
        &self,
        node: Node<'a, 'a>,
    ) -> Result<Vec<T>, ReadError> {
        let words = node.text().unwrap_or_default().split_ascii_whitespace();
        let number = |word: &str| {
            let fault = |_| self.fail(node, format!("`{word}` is not a valid number here"));
            word.parse().map_err(fault)
        };
        words.map(number).collect()
    }
}

/// The first child with a tag.
pub(super) fn named<'a>(node: Node<'a, 'a>, tag: &str) -> Option<Node<'a, 'a>> {
    children(node, tag).next()
}

pub(super) fn children<'a>(node: Node<'a, 'a>, tag: &str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children()
        .filter(move |child| child.tag_name().name() == tag)
}
