//! `<default>`: classes of attributes, one within another.

use std::collections::HashMap;

use super::tree::Tag;
use crate::model::UnknownName;
use crate::robot::xml::{Fault, Read};

/// What the outermost class is called unless it says otherwise.
const MAIN: &str = "main";

/// The classes of a document; the first is the outermost.
#[derive(Clone, Debug)]
pub(super) struct Defaults<'a> {
    classes: Vec<Class<'a>>,
    by_name: HashMap<&'a str, usize>,
}

#[derive(Clone, Debug, Default)]
struct Class<'a> {
    around: Option<usize>,
    /// In the order of the file; the later say more.
    tags: Vec<Tag<'a>>,
}

impl<'a> Defaults<'a> {
    pub(super) fn read(root: Tag<'a>) -> Read<Self> {
        let mut own = Self {
            classes: vec![Class::default()],
            by_name: HashMap::from([(MAIN, 0)]),
        };
        let mut lines: HashMap<&'a str, u32> = HashMap::new();
        for outermost in root.children_named("default") {
            // Documents of several parts have several; all are the outermost class.
            if let Some(name) = outermost.text("class") {
                own.name(outermost, name, 0, &mut lines)?;
            }
            let mut waiting = vec![(outermost, 0)];
            while let Some((tag, class)) = waiting.pop() {
                for child in tag.children() {
                    if child.name() != "default" {
                        own.classes[class].tags.push(child);
                        continue;
                    }
                    let attribute = "class";
                    let unnamed = || child.fault(Fault::MissingAttribute { attribute });
                    let name = child.text(attribute).filter(|name| !name.is_empty());
                    let inner = own.classes.len();
                    own.name(child, name.ok_or_else(unnamed)?, inner, &mut lines)?;
                    own.classes.push(Class {
                        around: Some(class),
                        tags: Vec::new(),
                    });
                    waiting.push((child, inner));
                }
            }
        }
        Ok(own)
    }

    /// Gives a class its name, which no other may have: so none can stand within itself.
    fn name(
        &mut self,
        tag: Tag<'a>,
        name: &'a str,
        class: usize,
        lines: &mut HashMap<&'a str, u32>,
    ) -> Read<()> {
        let known = self.by_name.insert(name, class);
        let first_line = lines.insert(name, tag.line());
        match known {
            Some(other) if other != class => Err(tag.fault(Fault::RepeatedClass {
                class: name.to_owned(),
                first_line: first_line.unwrap_or(0),
            })),
            _ => Ok(()),
        }
    }

    /// The class that an element asks for; the outermost where it asks for none.
    pub(super) fn class(&self, tag: Tag<'a>, name: Option<&str>) -> Read<usize> {
        let Some(name) = name else { return Ok(0) };
        self.by_name.get(name).copied().ok_or_else(|| {
            let mut valid: Vec<&str> = self.by_name.keys().copied().collect();
            valid.sort_unstable();
            tag.fault(UnknownName::new("default class", name, valid).into())
        })
    }

    /// Adds what a class and those around it say of elements of a name, nearest first.
    pub(super) fn add_layers(&self, class: usize, element: &str, layers: &mut Vec<Tag<'a>>) {
        let mut at = Some(class);
        while let Some(class) = at.and_then(|class| self.classes.get(class)) {
            let own = class.tags.iter().rev();
            layers.extend(own.filter(|tag| tag.name() == element));
            at = class.around;
        }
    }
}
