//! JavaScript values as values and named arguments of `kinopt-bindings`.

use std::time::Duration;

use kinopt::SizeMismatch;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{Camera, PoseBounds};
use kinopt_bindings::{Arguments, ErrorKind, QuantityValues};
use wasm_bindgen::prelude::*;

use crate::arguments::{self, NamedArguments};
use crate::error::{Exception, raise};
use crate::{clock, names, placement};

/// A JavaScript value.
pub(crate) struct Value(pub(crate) JsValue);

impl kinopt_bindings::Value for Value {
    type Error = Exception;

    fn error(kind: ErrorKind, message: String) -> Exception {
        Exception::of(kind, &message)
    }

    fn label(name: &str) -> String {
        names::camel(name)
    }

    fn wrong_length(what: &str, mismatch: &SizeMismatch) -> Exception {
        let (count, expected) = (mismatch.given, mismatch.expected);
        Exception::new(&format!("{what} has {count} numbers, expected {expected}"))
    }

    fn no_target(what: &str, _task: &str) -> Exception {
        Exception::new(&format!("{what}: this task has no target"))
    }

    fn is_missing(&self) -> bool {
        self.0.is_undefined() || self.0.is_null()
    }

    fn as_text(&self) -> Option<String> {
        self.0.as_string()
    }

    fn as_number(&self) -> Option<f64> {
        self.0.as_f64()
    }

    fn is_map(&self) -> bool {
        self.0.is_object() && !arguments::is_list(&self.0)
    }

    fn number(&self, what: &str) -> Result<f64, Exception> {
        arguments::number(&self.0, what)
    }

    fn whole(&self, what: &str, _max: u64) -> Result<u64, Exception> {
        Ok(arguments::whole(self.number(what)?, what)?.into())
    }

    fn switch(&self, what: &str) -> Result<bool, Exception> {
        let not_a_switch = || Exception::new(&format!("{what} must be true or false"));
        self.0.as_bool().ok_or_else(not_a_switch)
    }

    fn time_limit(&self, what: &str) -> Result<Duration, Exception> {
        clock::time_limit(self.number(what)?, what)
    }

    fn name(&self, what: &str) -> Result<String, Exception> {
        arguments::text(&self.0, what)
    }

    fn names(&self, what: &str) -> Result<Vec<String>, Exception> {
        arguments::texts(&self.0, what)
    }

    fn numbers(&self, what: &str) -> Result<Vec<f64>, Exception> {
        arguments::numbers(&self.0, what)
    }

    fn vector(&self, what: &str, expected: usize) -> Result<Vec<f64>, Exception> {
        let numbers = self.numbers(what)?;
        match numbers.len() {
            count if count == expected => Ok(numbers),
            count => Err(Exception::new(&format!(
                "{what} has {count} numbers, expected {expected}"
            ))),
        }
    }

    fn two_points(&self, what: &str) -> Result<[[f64; 3]; 2], Exception> {
        let [a, b, c, d, e, f] = arguments::vector(&self.0, what)?;
        Ok([[a, b, c], [d, e, f]])
    }

    fn points(&self, what: &str) -> Result<Vec<Vector3<f64>>, Exception> {
        let not_a_list = || Exception::new(&format!("{what} must be a list of positions"));
        let positions = arguments::list(&self.0).ok_or_else(not_a_list)?;
        let positions = positions
            .iter()
            .map(|position| arguments::vector::<3>(&position, what));
        positions
            .map(|position| position.map(Vector3::from))
            .collect()
    }

    fn placement(&self, what: &str) -> Result<Placement<f64>, Exception> {
        placement::of(&self.0, what)
    }

    fn rotation(&self, what: &str) -> Result<Matrix3<f64>, Exception> {
        Ok(self.placement(what)?.rotation)
    }

    fn pose_bounds(&self, _what: &str) -> Result<PoseBounds, Exception> {
        goal(&self.0)
    }

    fn camera(&self, what: &str) -> Result<Camera, Exception> {
        let [a, b, c, d, e, f, g, h, i, j, k, l] = arguments::vector(&self.0, what)?;
        Ok(Camera {
            pixel_from_world: [[a, b, c, d], [e, f, g, h], [i, j, k, l]],
        })
    }

    fn mass(&self, what: &str) -> Result<(f64, [f64; 3]), Exception> {
        match self.0.as_f64() {
            Some(mass) => Ok((mass, [0.0; 3])),
            None => {
                let [mass, x, y, z] = arguments::vector(&self.0, what)?;
                Ok((mass, [x, y, z]))
            }
        }
    }

    fn entries(&self, what: &str) -> Result<Vec<(String, Self)>, Exception> {
        let entries = arguments::entries(Some(&self.0), what)?.into_iter();
        Ok(entries.map(|(key, value)| (key, Self(value))).collect())
    }

    fn quantity_values(&self, what: &str) -> Result<QuantityValues, Exception> {
        self.number(what).map(QuantityValues::All)
    }
}

impl Arguments for NamedArguments {
    type Value = Value;

    fn get(&self, name: &str) -> Result<Option<Value>, Exception> {
        Ok(NamedArguments::get(self, &names::camel(name)).map(Value))
    }

    fn required(&self, name: &str) -> Result<Value, Exception> {
        let missing = || {
            let name = names::camel(name);
            Exception::new(&format!("{} `{name}` is missing", self.what))
        };
        Arguments::get(self, name)?.ok_or_else(missing)
    }
}

/// Reads "pose", "position", or half widths along and about the axes.
fn goal(value: &JsValue) -> Result<PoseBounds, Exception> {
    match value.as_string().as_deref() {
        Some(name) => kinopt_bindings::names::goal(name).map_err(raise),
        None => {
            let widths = arguments::vector::<6>(value, "goal")?;
            match widths.iter().find(|width| width.is_nan() || **width < 0.0) {
                None => Ok(PoseBounds::within(widths)),
                Some(width) => Err(Exception::new(&format!(
                    "goal contains {width}, expected numbers of at least 0"
                ))),
            }
        }
    }
}
