//! Files of many targets, validated; every error names the file and the position in it.

use std::path::Path;

use kinopt::spatial::Placement;
use serde_json::Value as Json;

use super::number_list::MAX_NUMBER;
use super::of_file;
use crate::json::JsonError;
use crate::placement::PoseTarget;
use crate::value::Value;

/// Content of a file of targets.
#[derive(Debug)]
pub struct TargetsFile {
    /// base_from_tip of each target; the rotation is the identity if only positions are given.
    pub targets: Vec<Placement<f64>>,
    /// True if the targets have orientations.
    pub turns: bool,
    /// One row for each target, all of one length.
    pub starts: Option<Vec<Vec<f64>>>,
    /// Names of the columns of the starts.
    pub joint_names: Option<Vec<String>>,
    /// Frame of the targets.
    pub tip_link: Option<String>,
    /// Frame in which the targets are given.
    pub base_link: Option<String>,
}

impl TargetsFile {
    /// Targets of the content of a JSON file.
    ///
    /// # Errors
    /// A wrong value; the message has the file and the position in it.
    pub fn of_value(value: &Json, path: &Path) -> Result<Self, JsonError> {
        Self::of_document(value).map_err(|problem| of_file(&path.display().to_string(), problem))
    }

    fn of_document(value: &Json) -> Result<Self, String> {
        let Json::Object(document) = value else {
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
            let target = PoseTarget::of_numbers(row);
            let target = target.map_err(|problem| format!("targets[{index}]: {problem}"));
            target.map(|target| target.placement)
        });
        let targets = targets.collect::<Result<Vec<_>, _>>()?;
        let given = |key: &str| document.get(key).filter(|value| !value.is_null());
        let text = |key: &str| given(key).map(|value| value.name(key)).transpose();
        let joint_names = given("joint_names").map(|names| names.names("joint_names"));
        let joint_names = joint_names.transpose()?;
        let starts = given("starts").map(|starts| self::rows(starts, "starts"));
        let starts = starts.transpose()?;
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
            tip_link: text("tip_link")?,
            base_link: text("base_link")?,
        })
    }
}

/// Rows of finite numbers, all as long as the first.
fn rows(value: &Json, at: &str) -> Result<Vec<Vec<f64>>, String> {
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

fn list<'v>(value: &'v Json, at: &str) -> Result<&'v Vec<Json>, String> {
    let list = value.as_array();
    list.ok_or_else(|| format!("{at}: is {}, not a list", a(value)))
}

/// Type of a value in words, with an article.
fn a(value: &Json) -> &'static str {
    match value {
        Json::Null => "null",
        Json::Bool(_) => "true or false",
        Json::Number(_) => "a number",
        Json::String(_) => "a string",
        Json::Array(_) => "a list",
        Json::Object(_) => "an object",
    }
}
