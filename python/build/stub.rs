//! A stub with docstrings inserted below its classes and functions.

use crate::docstrings::Docstrings;

/// The stub `text` of `module` with docstrings.
///
/// A definition is formatted as in `stubs/`: a class begins a line with `class`, and a function ends in `: ...`.
pub(crate) fn with_docstrings(text: &str, module: &str, docs: &Docstrings) -> String {
    let mut out = String::new();
    let mut class = String::new();
    // The function whose signature continues, with its indentation.
    let mut function: Option<(String, usize)> = None;
    // Overloads share a docstring, which the first one has.
    let mut documented = String::new();
    let mut is_setter = false;
    if let Some(doc) = docs.get("", module) {
        out.push_str(&docstring(doc, 0));
    }
    for line in text.lines() {
        let statement = line.trim_start();
        let indent = line.len() - statement.len();
        if let Some(name) = name_after(statement, "class ") {
            class = name.to_owned();
            out.push_str(&format!("{line}\n"));
            if let Some(doc) = docs.get("", name) {
                out.push_str(&docstring(doc, indent + 4));
            }
            continue;
        }
        is_setter |= statement.starts_with('@') && statement.ends_with(".setter");
        if let Some(name) = name_after(statement, "def ") {
            if indent == 0 {
                class.clear();
            }
            function = Some((name.to_owned(), indent));
        }
        let doc = match (&function, line.strip_suffix(": ...")) {
            (Some((name, indent)), Some(signature)) => {
                let key = format!("{class}.{name}");
                let doc = docs
                    .get(&class, name)
                    .filter(|_| !is_setter && documented != key);
                documented = key;
                let doc = doc.map(|doc| format!("{signature}:\n{}", docstring(doc, indent + 4)));
                (function, is_setter) = (None, false);
                doc
            }
            _ => None,
        };
        out.push_str(&doc.unwrap_or_else(|| format!("{line}\n")));
    }
    out
}

/// The name that follows `keyword` at the begin of `statement`.
fn name_after<'s>(statement: &'s str, keyword: &str) -> Option<&'s str> {
    let rest = statement.strip_prefix(keyword)?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_')
        .next()
}

/// `doc` as a docstring with its indentation.
fn docstring(doc: &str, indent: usize) -> String {
    let margin = " ".repeat(indent);
    let doc = doc.trim().replace('\\', "\\\\").replace('"', "\\\"");
    let lines: Vec<String> = doc
        .lines()
        .map(|line| format!("{margin}{line}").trim_end().to_owned())
        .collect();
    match lines.as_slice() {
        [line] => format!("{margin}\"\"\"{}\"\"\"\n", line.trim_start()),
        lines => format!(
            "{margin}\"\"\"{}\n{margin}\"\"\"\n",
            lines.join("\n").trim_start()
        ),
    }
}
