//! `<default>`: nested classes of default attributes.

use std::collections::HashMap;

use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};
use kinopt_kinematics::model::UnknownName;

/// Default name of the outermost class.
const MAIN: &str = "main";

/// The default classes of a document; the first is the outermost.
#[derive(Clone, Debug)]
pub(super) struct Defaults<'a> {
    classes: Vec<DefaultClass<'a>>,
    by_name: HashMap<&'a str, usize>,
}

#[derive(Clone, Debug, Default)]
struct DefaultClass<'a> {
    enclosing: Option<usize>,
    /// Elements in the order of the file; later ones override earlier ones.
    tags: Vec<Tag<'a>>,
}

impl<'a> Defaults<'a> {
    pub(super) fn read(root: Tag<'a>) -> Read<Self> {
        let mut defaults = Self {
            classes: vec![DefaultClass::default()],
            by_name: HashMap::from([(MAIN, 0)]),
        };
        let mut lines: HashMap<&'a str, u32> = HashMap::new();
        for outermost in root.children_named("default") {
            // Each file of a document may have one; all of them are the outermost class.
            if let Some(name) = outermost.text("class") {
                defaults.name(outermost, name, 0, &mut lines)?;
            }
            let mut pending = vec![(outermost, 0)];
            while let Some((tag, class)) = pending.pop() {
                for child in tag.children() {
                    if child.name() != "default" {
                        defaults.classes[class].tags.push(child);
                        continue;
                    }
                    let attribute = "class";
                    let unnamed = || child.fault(ParseIssue::MissingAttribute { attribute });
                    let name = child.text(attribute).filter(|name| !name.is_empty());
                    let inner = defaults.classes.len();
                    defaults.name(child, name.ok_or_else(unnamed)?, inner, &mut lines)?;
                    defaults.classes.push(DefaultClass {
                        enclosing: Some(class),
                        tags: Vec::new(),
                    });
                    pending.push((child, inner));
                }
            }
        }
        Ok(defaults)
    }

    /// Names a class. Names are unique, so no class can contain itself.
    fn name(
        &mut self,
        tag: Tag<'a>,
        name: &'a str,
        class: usize,
        lines: &mut HashMap<&'a str, u32>,
    ) -> Read<()> {
        let previous_class = self.by_name.insert(name, class);
        let first_line = lines.insert(name, tag.line());
        match previous_class {
            Some(other) if other != class => Err(tag.fault(ParseIssue::RepeatedClass {
                class: name.to_owned(),
                first_line: first_line.unwrap_or(0),
            })),
            _ => Ok(()),
        }
    }

    /// Index of the class that an element names; the outermost without a name.
    pub(super) fn class(&self, tag: Tag<'a>, name: Option<&str>) -> Read<usize> {
        let Some(name) = name else { return Ok(0) };
        self.by_name.get(name).copied().ok_or_else(|| {
            let mut valid: Vec<&str> = self.by_name.keys().copied().collect();
            valid.sort_unstable();
            tag.fault(UnknownName::new("default class", name, valid).into())
        })
    }

    /// Appends the tags of the elements `element` in a class and in the enclosing classes, highest priority first.
    pub(super) fn add_layers(&self, class: usize, element: &str, layers: &mut Vec<Tag<'a>>) {
        let mut current = Some(class);
        while let Some(class) = current.and_then(|class| self.classes.get(class)) {
            let tags = class.tags.iter().rev();
            layers.extend(tags.filter(|tag| tag.name() == element));
            current = class.enclosing;
        }
    }
}
