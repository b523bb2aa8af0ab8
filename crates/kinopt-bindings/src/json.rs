//! JSON values as values and named arguments, for problem files.

use std::time::Duration;

use kinopt::SizeMismatch;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{Camera, PoseBounds};
use serde_json::{Map, Value as Json};

use crate::error::ErrorKind;
use crate::placement::{bad_last_row, of_rows};
use crate::quantities::QuantityValues;
use crate::value::{Arguments, OrRaise, Value};

/// Error about a JSON value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonError {
    /// Kind of the error.
    pub kind: ErrorKind,
    /// Message with the name of the value.
    pub message: String,
}

impl std::fmt::Display for JsonError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for JsonError {}

impl From<JsonError> for String {
    fn from(error: JsonError) -> Self {
        error.message
    }
}

fn expected(what: &str, value: &Json, content: &str) -> JsonError {
    Json::error(
        ErrorKind::InvalidValue,
        format!("{what} is {value}, expected {content}"),
    )
}

/// Placements are four rows of four numbers, rotations three of three, masses a number or `[mass, [x, y, z]]`. Infinite
/// numbers are "inf" and "-inf".
impl Value for Json {
    type Error = JsonError;

    fn error(kind: ErrorKind, message: String) -> JsonError {
        JsonError { kind, message }
    }

    fn label(name: &str) -> String {
        name.to_owned()
    }

    fn wrong_length(what: &str, mismatch: &SizeMismatch) -> JsonError {
        let SizeMismatch {
            given, expected, ..
        } = mismatch;
        Self::error(
            ErrorKind::InvalidValue,
            format!("{what} has {given} numbers, expected {expected}"),
        )
    }

    fn no_target(what: &str, task: &str) -> JsonError {
        Self::error(
            ErrorKind::InvalidValue,
            format!("{what}: {task} has no target"),
        )
    }

    fn is_missing(&self) -> bool {
        self.is_null()
    }

    fn as_text(&self) -> Option<String> {
        self.as_str().map(str::to_owned)
    }

    fn as_number(&self) -> Option<f64> {
        match self.as_str() {
            Some("inf") => Some(f64::INFINITY),
            Some("-inf") => Some(f64::NEG_INFINITY),
            _ => self.as_f64(),
        }
    }

    fn is_map(&self) -> bool {
        self.is_object()
    }

    fn number(&self, what: &str) -> Result<f64, JsonError> {
        Value::as_number(self).ok_or_else(|| expected(what, self, "a number"))
    }

    fn whole(&self, what: &str, max: u64) -> Result<u64, JsonError> {
        let number = self.as_u64().filter(|number| *number <= max);
        number.ok_or_else(|| expected(what, self, "a whole number of at least 0"))
    }

    fn switch(&self, what: &str) -> Result<bool, JsonError> {
        self.as_bool()
            .ok_or_else(|| expected(what, self, "true or false"))
    }

    fn time_limit(&self, what: &str) -> Result<Duration, JsonError> {
        Duration::try_from_secs_f64(self.number(what)?)
            .map_err(|_| expected(what, self, "seconds of at least 0"))
    }

    fn name(&self, what: &str) -> Result<String, JsonError> {
        self.as_text().ok_or_else(|| expected(what, self, "a name"))
    }

    fn names(&self, what: &str) -> Result<Vec<String>, JsonError> {
        let list = items(self, what)?;
        let items = list.iter().enumerate();
        let name = |(index, item): (usize, &Self)| item.name(&format!("{what}[{index}]"));
        items.map(name).collect()
    }

    fn numbers(&self, what: &str) -> Result<Vec<f64>, JsonError> {
        let list = items(self, what)?;
        list.iter().map(|item| item.number(what)).collect()
    }

    fn vector(&self, what: &str, length: usize) -> Result<Vec<f64>, JsonError> {
        let numbers = self.numbers(what)?;
        match numbers.len() {
            given if given == length => Ok(numbers),
            given => Err(Self::error(
                ErrorKind::InvalidValue,
                format!("{what} has {given} numbers, expected {length}"),
            )),
        }
    }

    fn two_points(&self, what: &str) -> Result<[[f64; 3]; 2], JsonError> {
        rows(self, what)
    }

    fn points(&self, what: &str) -> Result<Vec<Vector3<f64>>, JsonError> {
        let list = items(self, what)?;
        list.iter()
            .map(|item| item.array::<3>(what).map(Vector3::from))
            .collect()
    }

    fn placement(&self, what: &str) -> Result<Placement<f64>, JsonError> {
        let rows: [[f64; 4]; 4] = rows(self, what)?;
        let mut numbers = [0.0; 16];
        numbers.copy_from_slice(rows.as_flattened());
        of_rows(&numbers)
            .map_err(|last_row| Self::error(ErrorKind::InvalidValue, bad_last_row(what, last_row)))
    }

    fn rotation(&self, what: &str) -> Result<Matrix3<f64>, JsonError> {
        if items(self, what)?.len() == 4 {
            return Ok(self.placement(what)?.rotation);
        }
        let [a, b, c]: [[f64; 3]; 3] = rows(self, what)?;
        let column = |k: usize| Vector3::new(a[k], b[k], c[k]);
        Ok(Matrix3::from_columns(column(0), column(1), column(2)))
    }

    fn pose_bounds(&self, what: &str) -> Result<PoseBounds, JsonError> {
        match self.as_str() {
            Some(name) => crate::names::goal(name).or_raise::<Self>(),
            None => {
                let widths = self.array::<6>(what)?;
                match widths.iter().all(|width| *width >= 0.0) {
                    true => Ok(PoseBounds::within(widths)),
                    false => Err(expected(what, self, "half widths of at least 0")),
                }
            }
        }
    }

    fn camera(&self, what: &str) -> Result<Camera, JsonError> {
        let pixel_from_world = rows(self, what)?;
        Ok(Camera { pixel_from_world })
    }

    fn mass(&self, what: &str) -> Result<(f64, [f64; 3]), JsonError> {
        match self.as_array().map(Vec::as_slice) {
            None => Ok((self.number(what)?, [0.0; 3])),
            Some([mass, at]) => Ok((mass.number(what)?, at.array(what)?)),
            Some(_) => Err(expected(what, self, "a mass, or [mass, [x, y, z]]")),
        }
    }

    fn entries(&self, what: &str) -> Result<Vec<(String, Self)>, JsonError> {
        let object = self
            .as_object()
            .ok_or_else(|| expected(what, self, "an object"))?;
        let entries = object.iter();
        Ok(entries
            .map(|(key, value)| (key.clone(), value.clone()))
            .collect())
    }

    fn quantity_values(&self, what: &str) -> Result<QuantityValues, JsonError> {
        if !self.is_map() {
            return self.number(what).map(QuantityValues::All);
        }
        let entries = self.numbers_by_name(what, "")?.into_iter();
        let each = entries.map(|(name, number)| {
            let quantity = crate::names::quantity(&name).or_raise::<Self>()?;
            Ok((quantity, number))
        });
        each.collect::<Result<_, _>>().map(QuantityValues::Each)
    }
}

fn items<'a>(value: &'a Json, what: &str) -> Result<&'a [Json], JsonError> {
    let list = value.as_array().map(Vec::as_slice);
    list.ok_or_else(|| expected(what, value, "a list"))
}

/// Reads a table of a fixed shape.
fn rows<const R: usize, const C: usize>(
    value: &Json,
    what: &str,
) -> Result<[[f64; C]; R], JsonError> {
    let list = items(value, what)?;
    if list.len() != R {
        return Err(expected(what, value, &format!("{R} rows of {C} numbers")));
    }
    let mut table = [[0.0; C]; R];
    for (row, item) in table.iter_mut().zip(list) {
        *row = item.array(what)?;
    }
    Ok(table)
}

/// Null counts as missing.
impl Arguments for Map<String, Json> {
    type Value = Json;

    fn get(&self, name: &str) -> Result<Option<Json>, JsonError> {
        let value = Self::get(self, name).filter(|value| !value.is_missing());
        Ok(value.cloned())
    }

    fn required(&self, name: &str) -> Result<Json, JsonError> {
        let missing = || Json::error(ErrorKind::InvalidValue, format!("`{name}` is missing"));
        Arguments::get(self, name)?.ok_or_else(missing)
    }
}
