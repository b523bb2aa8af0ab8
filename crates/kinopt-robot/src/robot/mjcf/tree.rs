//! A document with its includes inserted, as a tree of tags with file and line.

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::robot::xml::{ParseIssue, Read, RobotFileError, parse};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem, read_bytes};
use kinopt_kinematics::file_access::AllowedFiles;

/// Largest file size that is read, bytes; robot files stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;
/// Largest nesting depth of elements; robot files stay below 60.
const MAX_LEVELS: usize = 1000;
/// Largest nesting depth of includes.
const MAX_INCLUDE_DEPTH: usize = 32;

/// The elements of a file and of its includes.
#[derive(Clone, Debug)]
pub(super) struct ElementTree {
    /// Elements; the first is the root, and parents come before children.
    nodes: Vec<StoredElement>,
    /// Files; the main one comes first.
    files: Vec<SourceFile>,
    /// The files below the folder of the main file.
    allowed: AllowedFiles,
    /// Only files below the folder of the main file may be included.
    confined: bool,
}

/// A file of a document.
#[derive(Clone, Debug)]
struct SourceFile {
    name: String,
    /// The file is outside the folder of the main file, so error messages must not quote it.
    outside: bool,
}

#[derive(Clone, Debug)]
struct StoredElement {
    name: String,
    attributes: Vec<(String, String)>,
    children: Vec<usize>,
    file: usize,
    line: u32,
}

/// An element of a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag<'a> {
    tree: &'a ElementTree,
    index: usize,
}

impl ElementTree {
    /// Reads a file and its includes. `confined` restricts includes to files below its folder.
    pub(super) fn read(path: &Path, confined: bool) -> Read<Self> {
        Self::parse(&text_of(path)?, &path.display().to_string(), confined)
    }

    /// Reads a document. Includes are resolved relative to the folder of `file`; `confined` restricts them to files
    /// below it.
    pub(super) fn parse(text: &str, file: &str, confined: bool) -> Read<Self> {
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let mut tree = Self {
            nodes: Vec::new(),
            files: Vec::new(),
            allowed: AllowedFiles::below([folder]),
            confined,
        };
        let main = SourceFile {
            name: file.to_owned(),
            outside: false,
        };
        tree.add(text, main, None, (folder, 0))?;
        Ok(tree)
    }

    /// The root element.
    pub(super) fn root(&self) -> Tag<'_> {
        Tag {
            tree: self,
            index: 0,
        }
    }

    /// A file with its includes inserted; the unchanged text if it includes nothing.
    pub(super) fn text_with_includes(path: &Path, confined: bool) -> Read<String> {
        let text = text_of(path)?;
        let tree = Self::parse(&text, &path.display().to_string(), confined)?;
        Ok(match tree.files.len() {
            1 => text,
            _ => tree.text(),
        })
    }

    /// The document as text, with its includes inserted.
    fn text(&self) -> String {
        enum Part<'a> {
            Element(Tag<'a>),
            End(&'a str),
        }
        let mut text = String::new();
        let mut pending = vec![Part::Element(self.root())];
        while let Some(part) = pending.pop() {
            match part {
                Part::End(name) => text.extend(["</", name, ">\n"]),
                Part::Element(tag) => {
                    text.extend(["<", tag.name()]);
                    for (name, value) in &tag.stored().attributes {
                        text.extend([" ", name, "=\"", &escaped(value), "\""]);
                    }
                    text.push_str(">\n");
                    pending.push(Part::End(tag.name()));
                    pending.extend(tag.children().rev().map(Part::Element));
                }
            }
        }
        text
    }

    /// Name of the main file.
    pub(super) fn file(&self) -> &str {
        self.files.first().map_or("", |source| &source.name)
    }

    /// Adds the elements of a file as a document, or the children of its root to the element `include_parent`.
    fn add(
        &mut self,
        text: &str,
        source: SourceFile,
        include_parent: Option<usize>,
        (folder, include_depth): (&Path, usize),
    ) -> Read<()> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document = match include_parent {
            None => parse(&source.name, text)?,
            // The parser's message quotes the file.
            Some(_) => Document::parse(text).map_err(|error| {
                let line = FileLocation::Line(error.pos().row as usize);
                ReadError::new(&source.name, line, ReadProblem::InvalidReferenced)
            })?,
        };
        let file = self.files.len();
        self.files.push(source);
        let mut lines = LineCounter {
            text,
            offset: 0,
            line: 1,
        };
        let root = document.root_element();
        let mut pending: Vec<(Node<'_, '_>, Option<usize>, usize)> = match include_parent {
            None => vec![(root, None, 0)],
            Some(_) => elements(root)
                .map(|child| (child, include_parent, 1))
                .collect(),
        };
        pending.reverse();
        while let Some((node, parent, level)) = pending.pop() {
            let stored = StoredElement {
                name: node.tag_name().name().to_owned(),
                attributes: node
                    .attributes()
                    .map(|a| (a.name().to_owned(), a.value().to_owned()))
                    .collect(),
                children: Vec::new(),
                file,
                line: lines.line_at(node.range().start),
            };
            if stored.name == "include" {
                self.include(&stored, parent, (folder, include_depth))?;
                continue;
            }
            let index = self.nodes.len();
            self.nodes.push(stored);
            if let Some(parent) = parent.and_then(|parent| self.nodes.get_mut(parent)) {
                parent.children.push(index);
            }
            if level > MAX_LEVELS {
                return Err(self
                    .tag(index)
                    .fault(ParseIssue::TooDeep { limit: MAX_LEVELS }));
            }
            let first_new = pending.len();
            pending.extend(elements(node).map(|child| (child, Some(index), level + 1)));
            pending[first_new..].reverse();
        }
        Ok(())
    }

    /// Replaces an `<include>` by the elements of its file.
    fn include(
        &mut self,
        include: &StoredElement,
        parent: Option<usize>,
        (folder, include_depth): (&Path, usize),
    ) -> Read<()> {
        let fault = |fault| RobotFileError::Element {
            file: self.files[include.file].name.clone(),
            line: include.line,
            element: "<include>".to_owned(),
            fault,
        };
        let named = include.attributes.iter().find(|(name, _)| name == "file");
        let (Some((_, named)), Some(parent)) = (named, parent) else {
            return Err(fault(ParseIssue::MissingAttribute { attribute: "file" }));
        };
        let path: PathBuf = folder.join(named);
        let name = path.display().to_string();
        // As in MuJoCo; it also prevents a file from including itself.
        if self.files.iter().any(|source| source.name == name) {
            return Err(fault(ParseIssue::IncludedTwice { file: name }));
        }
        if include_depth >= MAX_INCLUDE_DEPTH {
            return Err(fault(ParseIssue::TooDeep {
                limit: MAX_INCLUDE_DEPTH,
            }));
        }
        let referred = |error: ReadError| {
            let location = FileLocation::Line(include.line as usize);
            ReadError::referred(
                &self.files[include.file].name,
                location,
                error.without_contents(),
            )
        };
        let real = self.allowed.resolve(&path);
        let outside = real.is_err();
        // Read under its real path, so that no link is followed once more.
        let path = match self.confined {
            true => real.map_err(referred)?,
            false => path,
        };
        let text = text_of(&path).map_err(referred)?;
        let source = SourceFile { name, outside };
        self.add(&text, source, Some(parent), (folder, include_depth + 1))
    }

    fn tag(&self, index: usize) -> Tag<'_> {
        Tag { tree: self, index }
    }
}

impl<'a> Tag<'a> {
    fn stored(&self) -> &'a StoredElement {
        &self.tree.nodes[self.index]
    }

    /// Tag name.
    pub(super) fn name(&self) -> &'a str {
        &self.stored().name
    }

    /// Value of an attribute.
    pub(super) fn text(&self, attribute: &str) -> Option<&'a str> {
        let mut attributes = self.stored().attributes.iter();
        let attribute_pair = attributes.find(|(name, _)| name == attribute)?;
        Some(&attribute_pair.1)
    }

    /// Child elements in document order.
    pub(super) fn children(&self) -> impl DoubleEndedIterator<Item = Self> + use<'a> {
        let tree = self.tree;
        let children = self.stored().children.iter();
        children.map(move |&index| tree.tag(index))
    }

    /// Child elements of a name in document order.
    pub(super) fn children_named(&self, name: &'a str) -> impl Iterator<Item = Self> + use<'a> {
        self.children().filter(move |child| child.name() == name)
    }

    /// Line of the element in its file, from 1.
    pub(super) fn line(&self) -> u32 {
        self.stored().line
    }

    /// An error for a fault of the element.
    pub(super) fn fault(&self, fault: ParseIssue) -> RobotFileError {
        let source = &self.tree.files[self.stored().file];
        if source.outside {
            let line = FileLocation::Line(self.line() as usize);
            return ReadError::new(&source.name, line, ReadProblem::InvalidReferenced).into();
        }
        RobotFileError::Element {
            file: source.name.clone(),
            line: self.line(),
            element: self.label(),
            fault,
        }
    }

    /// Name of the element in messages.
    pub(super) fn label(&self) -> String {
        let name = self.name();
        let named = self.text("name");
        named.map_or_else(|| format!("<{name}>"), |it| format!("{name} `{it}`"))
    }
}

/// Text escaped for an attribute value.
fn escaped(value: &str) -> String {
    value
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

fn text_of(path: &Path) -> Result<String, ReadError> {
    let bytes = read_bytes(path, LENGTH_LIMIT)?;
    String::from_utf8(bytes).map_err(|error| {
        let location = FileLocation::Byte(error.utf8_error().valid_up_to());
        let file = path.display().to_string();
        ReadError::malformed(&file, location, "is not UTF-8 text")
    })
}

fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(Node::is_element)
}

/// Line counter for offsets in ascending order.
struct LineCounter<'a> {
    text: &'a str,
    offset: usize,
    line: u32,
}

impl LineCounter<'_> {
    fn line_at(&mut self, offset: usize) -> u32 {
        let skipped = self
            .text
            .as_bytes()
            .get(self.offset..offset)
            .unwrap_or_default();
        self.line += skipped.iter().filter(|&&byte| byte == b'\n').count() as u32;
        self.offset = self.offset.max(offset);
        self.line
    }
}
