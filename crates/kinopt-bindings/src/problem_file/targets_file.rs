//! Files of many targets, validated; every error names the file and the position in it.

use std::path::Path;

use kinopt::spatial::Placement;
use serde_json::{Map, Value};

use super::number_list::MAX_NUMBER;
use super::target::placement;
use crate::failure::Outcome;
use crate::json_file;

/// Content of a file of targets.
#[derive(Debug)]
pub(crate) struct TargetsFile {
    /// base_from_tip of each target; the rotation is the identity if only positions are given.
    pub(crate) targets: Vec<Placement<f64>>,
    /// True if the targets have orientations.
    pub(crate) turns: bool,
    /// One row for each target, all of one length.
    pub(crate) starts: Option<Vec<Vec<f64>>>,
    pub(crate) joint_names: Option<Vec<String>>,
    pub(crate) tip_link: Option<String>,
    pub(crate) base_link: Option<String>,
}

impl TargetsFile {
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let value = json_file::read(path)?;
        let file = Self::of_value(&value);
        file.map_err(|problem| failure!("{}: {problem}", path.display()))
    }

    fn of_value(value: &Value) -> Result<Self, String> {
        let Value::Object(document) = value else {
            return Err(format!("is {}, not an object", a(value)));
        };
        let Some(targets) = document.get("targets") else {
            return Err("has no key `targets`".to_owned());
        };
        let rows = rows(targets, "targets")?;
        let width = width_of(&rows);
        if width == 0 {
            return Err("targets: the list is empty".to_owned());
        }
        if width != 3 && width != 7 {
            return Err(format!(
                "targets[0]: has {width} numbers; a target has 3 (x,y,z) or 7 (x,y,z,qw,qx,qy,qz)"
            ));
        }
        let targets = rows.iter().enumerate().map(|(index, row)| {
            let target = placement(row).map_err(|problem| format!("targets[{index}]: {problem}"));
            target.map(|(target, _)| target)
        });
        let targets = targets.collect::<Result<Vec<_>, _>>()?;
        let joint_names = optional(document, "joint_names", names)?;
        let starts = optional(document, "starts", self::rows)?;
        if let Some(starts) = &starts {
            if starts.len() != targets.len() {
                let (given, targets) = (starts.len(), targets.len());
                return Err(format!("starts: {given} starts for {targets} targets"));
            }
            let (width, names) = (width_of(starts), joint_names.as_ref().map(Vec::len));
            if let Some(names) = names.filter(|&names| names != width) {
                return Err(format!(
                    "starts[0]: has {width} numbers for {names} joint_names"
                ));
            }
        }
        Ok(Self {
            targets,
            turns: width == 7,
            starts,
            joint_names,
            tip_link: optional(document, "tip_link", text)?,
            base_link: optional(document, "base_link", text)?,
        })
    }
}

/// Value of a key that may be missing or null.
fn optional<T>(
    document: &Map<String, Value>,
    key: &str,
    read: impl Fn(&Value, &str) -> Result<T, String>,
) -> Result<Option<T>, String> {
    match document.get(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => read(value, key).map(Some),
    }
}

/// Rows of finite numbers, all as long as the first.
fn rows(value: &Value, at: &str) -> Result<Vec<Vec<f64>>, String> {
    let rows = list(value, at)?.iter().enumerate();
    let rows = rows.map(|(index, row)| {
        let at = format!("{at}[{index}]");
        let numbers = list(row, &at)?.iter().enumerate();
        let numbers = numbers.map(|(column, number)| match number.as_f64() {
            Some(number) if number.abs() <= MAX_NUMBER => Ok(number),
            Some(_) => Err(format!(
                "{at}[{column}]: is beyond {MAX_NUMBER:e}, the largest accepted number"
            )),
            _ => Err(format!("{at}[{column}]: is {}, not a number", a(number))),
        });
        numbers.collect::<Result<Vec<_>, _>>()
    });
    let rows = rows.collect::<Result<Vec<_>, String>>()?;
    let width = width_of(&rows);
    match rows.iter().position(|row| row.len() != width) {
        Some(index) => Err(format!(
            "{at}[{index}]: has {} numbers, {at}[0] has {width}",
            rows.get(index).map_or(0, Vec::len)
        )),
        None => Ok(rows),
    }
}

fn width_of(rows: &[Vec<f64>]) -> usize {
    rows.first().map_or(0, Vec::len)
}

fn names(value: &Value, at: &str) -> Result<Vec<String>, String> {
    let names = list(value, at)?.iter().enumerate();
    let read = |(index, name): (usize, &Value)| text(name, &format!("{at}[{index}]"));
    names.map(read).collect()
}

fn list<'v>(value: &'v Value, at: &str) -> Result<&'v Vec<Value>, String> {
    let list = value.as_array();
    list.ok_or_else(|| format!("{at}: is {}, not a list", a(value)))
}

fn text(value: &Value, at: &str) -> Result<String, String> {
    let text = value.as_str().map(str::to_owned);
    text.ok_or_else(|| format!("{at}: is {}, not a name", a(value)))
}

/// Type of a value in words, with an article.
fn a(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
