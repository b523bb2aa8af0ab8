//! Docstrings of modules, classes, their members and functions, from the doc comments of pyo3's items.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use syn::{Attribute, Expr, ExprLit, ImplItem, Item, Lit, LitStr, Member, Meta, Stmt, Type};

/// Docstrings by scope and name. The scope is the class of a member; that of other items is empty.
#[derive(Default)]
pub(crate) struct Docstrings {
    texts: BTreeMap<(String, String), String>,
}

/// Docstrings of all Rust files in `folder` and below.
pub(crate) fn of_folder(folder: &Path) -> Result<Docstrings, Box<dyn Error>> {
    let mut docs = Docstrings::default();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                docs.add_items(&items(&path)?);
            }
        }
    }
    Ok(docs)
}

impl Docstrings {
    /// Docstring of a member of the class `scope`; an empty scope is that of modules, classes and functions.
    pub(crate) fn get(&self, scope: &str, name: &str) -> Option<&str> {
        let key = (scope.to_owned(), name.to_owned());
        self.texts.get(&key).map(String::as_str)
    }

    /// Adds the documentation of a table of options to that of `class`, as the module does when it is loaded.
    pub(crate) fn add_options(&mut self, class: &str, table: &Path) -> Result<(), Box<dyn Error>> {
        let key = (String::new(), class.to_owned());
        let doc = self
            .texts
            .get_mut(&key)
            .ok_or("a class without doc comment has options")?;
        let errors = format!("{}\n\nRaises ", options(&items(table)?).join("\n"));
        *doc = doc.replacen("Raises ", &errors, 1);
        Ok(())
    }

    fn add_items(&mut self, items: &[Item]) {
        for item in items {
            match item {
                Item::Mod(module) => {
                    if has(&module.attrs, "pymodule") {
                        self.add("", &module.ident.to_string(), &module.attrs);
                    }
                    if let Some((_, items)) = &module.content {
                        self.add_items(items);
                    }
                }
                Item::Fn(function) if has(&function.attrs, "pyfunction") => {
                    self.add("", &function.sig.ident.to_string(), &function.attrs);
                }
                Item::Struct(class) if has(&class.attrs, "pyclass") => {
                    let scope = class.ident.to_string();
                    self.add("", &scope, &class.attrs);
                    for field in &class.fields {
                        let name = field.ident.as_ref().map(ToString::to_string);
                        self.add(&scope, &name.unwrap_or_default(), &field.attrs);
                    }
                }
                Item::Impl(methods) if has(&methods.attrs, "pymethods") => {
                    let Type::Path(class) = &*methods.self_ty else {
                        continue;
                    };
                    let scope = class
                        .path
                        .segments
                        .last()
                        .map(|class| class.ident.to_string());
                    for method in &methods.items {
                        let ImplItem::Fn(method) = method else {
                            continue;
                        };
                        if !has(&method.attrs, "setter") {
                            let name = python_name(&method.sig.ident, &method.attrs);
                            self.add(scope.as_deref().unwrap_or_default(), &name, &method.attrs);
                        }
                    }
                }
                _ => {}
            }
        }
    }

    fn add(&mut self, scope: &str, name: &str, attributes: &[Attribute]) {
        let lines: Vec<String> = attributes.iter().filter_map(doc_line).collect();
        if !lines.is_empty() {
            let key = (scope.to_owned(), name.to_owned());
            self.texts.insert(key, lines.join("\n"));
        }
    }
}

/// Items of a Rust file.
fn items(path: &Path) -> Result<Vec<Item>, Box<dyn Error>> {
    Ok(syn::parse_file(&fs::read_to_string(path)?)?.items)
}

/// Documentation of the options in the table at the end of the function `options`, one a line.
fn options(items: &[Item]) -> Vec<String> {
    let table = items.iter().find_map(|item| match item {
        Item::Fn(function) if function.sig.ident == "options" => function.block.stmts.last(),
        _ => None,
    });
    let Some(Stmt::Expr(Expr::Array(rows), None)) = table else {
        return Vec::new();
    };
    let line = |row: &Expr| {
        let Expr::Struct(row) = row else { return None };
        let field = |name: &str| {
            let named = |member: &Member| matches!(member, Member::Named(n) if n == name);
            let field = row.fields.iter().find(|field| named(&field.member))?;
            text(&field.expr)
        };
        let (name, doc, default) = (field("name")?, field("doc")?, field("default")?);
        Some(format!("{name}: {doc} Default: {default}."))
    };
    rows.elems.iter().filter_map(line).collect()
}

/// Name of a method in Python: that of its attributes, else of its signature.
fn python_name(ident: &syn::Ident, attributes: &[Attribute]) -> String {
    for attribute in attributes {
        let mut name = None;
        if attribute.path().is_ident("getter") {
            name = attribute
                .parse_args::<syn::Ident>()
                .ok()
                .map(|name| name.to_string());
        } else if attribute.path().is_ident("pyo3") {
            // Settings other than the name end the search.
            let _ = attribute.parse_nested_meta(|setting| {
                if setting.path.is_ident("name") {
                    name = Some(setting.value()?.parse::<LitStr>()?.value());
                }
                Ok(())
            });
        }
        if let Some(name) = name {
            return name;
        }
    }
    ident.to_string().trim_start_matches("r#").to_owned()
}

fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes
        .iter()
        .any(|attribute| attribute.path().is_ident(name))
}

/// Text of a line `///`, without the space at its begin.
fn doc_line(attribute: &Attribute) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else {
        return None;
    };
    let line = pair.path.is_ident("doc").then(|| text(&pair.value))??;
    Some(line.strip_prefix(' ').unwrap_or(&line).to_owned())
}

fn text(value: &Expr) -> Option<String> {
    match value {
        Expr::Lit(ExprLit {
            lit: Lit::Str(text),
            ..
        }) => Some(text.value()),
        _ => None,
    }
}
