//! YAML as a tree of values with line numbers.

use std::borrow::Cow;

use saphyr_parser::{Event, Parser};

use kinopt_kinematics::file::{FileLocation, ReadError};

/// Largest nesting depth of lists and maps.
const MAX_DEPTH: usize = 64;

/// A value and the line at which it begins, from 1.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Node<'t> {
    #[doc(hidden)]
    pub line: usize,
    #[doc(hidden)]
    pub value: Value<'t>,
}

#[derive(Clone, Debug)]
#[doc(hidden)]
pub enum Value<'t> {
    Scalar(Cow<'t, str>),
    List(Vec<Node<'t>>),
    /// In the order of the file.
    Map(Vec<(Node<'t>, Node<'t>)>),
}

/// A list or map that is still open.
struct Open<'t> {
    line: usize,
    map: bool,
    nodes: Vec<Node<'t>>,
}

/// The first document of a text.
#[doc(hidden)]
pub fn parse<'t>(text: &'t str, file: &str) -> Result<Node<'t>, ReadError> {
    let fail =
        |line: usize, problem: &str| ReadError::malformed(file, FileLocation::Line(line), problem);
    let mut open: Vec<Open<'t>> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| fail(error.marker().line(), error.info()))?;
        let line = span.start.line();
        let node = match event {
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                if open.len() == MAX_DEPTH {
                    return Err(fail(line, "lists are nested too deeply"));
                }
                let map = matches!(event, Event::MappingStart(..));
                let nodes = Vec::new();
                open.push(Open { line, map, nodes });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                let Some(closed) = open.pop() else { continue };
                closed.node()
            }
            Event::Scalar(text, ..) => Node {
                line,
                value: Value::Scalar(text),
            },
            // A few aliases can expand beyond all memory.
            Event::Alias(_) => return Err(fail(line, "aliases are not read")),
            _ => continue,
        };
        match open.last_mut() {
            Some(outer) => outer.nodes.push(node),
            None => return Ok(node),
        }
    }
    Err(ReadError::of_file(file, "holds no YAML"))
}

impl<'t> Open<'t> {
    fn node(self) -> Node<'t> {
        let value = match self.map {
            false => Value::List(self.nodes),
            true => {
                let mut nodes = self.nodes.into_iter();
                let pair = || Some((nodes.next()?, nodes.next()?));
                Value::Map(std::iter::from_fn(pair).collect())
            }
        };
        Node {
            line: self.line,
            value,
        }
    }
}

impl<'t> Node<'t> {
    /// The value of a key in a map; `None` for a missing key or another kind of node.
    #[doc(hidden)]
    pub fn get(&self, key: &str) -> Option<&Node<'t>> {
        let Value::Map(pairs) = &self.value else {
            return None;
        };
        let pair = pairs.iter().find(|(k, _)| k.text() == Some(key));
        pair.map(|(_, value)| value)
    }

    /// The elements of a list; empty for an empty or null scalar, `None` for any other node.
    #[doc(hidden)]
    pub fn list(&self) -> Option<&[Node<'t>]> {
        match &self.value {
            Value::List(nodes) => Some(nodes),
            Value::Scalar(text) if matches!(&**text, "" | "~" | "null") => Some(&[]),
            _ => None,
        }
    }

    #[doc(hidden)]
    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar(text) => Some(text),
            _ => None,
        }
    }

    /// A number; `None` for YAML's `.inf` and `.nan`.
    #[doc(hidden)]
    pub fn number(&self) -> Option<f64> {
        self.text()?.parse().ok()
    }
}
