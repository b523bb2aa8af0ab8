//! Plain objects of callers: options and tasks.

use js_sys::{Array, ArrayBuffer, Float64Array, Object, Reflect};
use kinopt::model::UnknownName;
use wasm_bindgen::prelude::*;

use crate::error::Exception;
use crate::names::camel;

/// An object with known keys only. `undefined` and `null` count as missing.
pub(crate) struct NamedArguments {
    object: JsValue,
    /// Description of a key in messages.
    pub(crate) what: &'static str,
}

impl NamedArguments {
    /// Reads an object, or an empty one for `undefined`; `what` names a key in messages.
    pub(crate) fn new(
        object: JsValue,
        what: &'static str,
        known: &[&str],
    ) -> Result<Self, Exception> {
        if object.is_undefined() || object.is_null() {
            return Ok(Self {
                object: Object::new().into(),
                what,
            });
        }
        let Some(fields) = object.dyn_ref::<Object>() else {
            let (part, whole) = what.split_once(' ').unwrap_or((what, ""));
            let message = format!("{part}s {whole} must be an object");
            return Err(Exception::new(&message));
        };
        for name in Object::keys(fields) {
            let name = name.as_string().unwrap_or_default();
            if !known.contains(&name.as_str()) {
                return Err(crate::error::raise(UnknownName::new(
                    what,
                    &name,
                    known.iter().copied(),
                )));
            }
        }
        Ok(Self { object, what })
    }

    /// Reads options whose names are in snake case.
    pub(crate) fn of(
        options: Option<impl Into<JsValue>>,
        what: &'static str,
        known: impl IntoIterator<Item = &'static str>,
    ) -> Result<Self, Exception> {
        let known: Vec<String> = known.into_iter().map(camel).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        Self::new(options.map_or(JsValue::UNDEFINED, Into::into), what, &known)
    }

    /// Value of a key.
    pub(crate) fn get(&self, name: &str) -> Option<JsValue> {
        let value = Reflect::get(&self.object, &name.into()).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    /// Value of a required key.
    #[cfg(feature = "clip-ik")]
    pub(crate) fn required(&self, name: &str) -> Result<JsValue, Exception> {
        let missing = || Exception::new(&format!("{} `{name}` is missing", self.what));
        self.get(name).ok_or_else(missing)
    }

    /// A number.
    #[cfg(feature = "bodies")]
    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>, Exception> {
        self.get(name).map(|value| number(&value, name)).transpose()
    }

    /// A whole number of at least 0.
    #[cfg(feature = "bodies")]
    pub(crate) fn whole(&self, name: &str) -> Result<Option<u32>, Exception> {
        self.number(name)?
            .map(|value| whole(value, name))
            .transpose()
    }

    /// A boolean.
    pub(crate) fn switch(&self, name: &str) -> Result<Option<bool>, Exception> {
        let switch = |value: JsValue| {
            let not_a_switch = || Exception::new(&format!("{name} must be true or false"));
            value.as_bool().ok_or_else(not_a_switch)
        };
        self.get(name).map(switch).transpose()
    }

    /// A string.
    #[cfg(feature = "bodies")]
    pub(crate) fn text(&self, name: &str) -> Result<Option<String>, Exception> {
        self.get(name).map(|value| text(&value, name)).transpose()
    }

    /// A required string.
    #[cfg(feature = "clip-ik")]
    pub(crate) fn name(&self, name: &str) -> Result<String, Exception> {
        text(&self.required(name)?, name)
    }

    /// A list of strings.
    #[cfg(feature = "bodies")]
    pub(crate) fn texts(&self, name: &str) -> Result<Option<Vec<String>>, Exception> {
        self.get(name).map(|value| texts(&value, name)).transpose()
    }

    /// A list of numbers.
    #[cfg(any(feature = "bodies", feature = "paths"))]
    pub(crate) fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, Exception> {
        self.get(name)
            .map(|value| numbers(&value, name))
            .transpose()
    }

    /// A list of whole numbers of at least 0.
    #[cfg(feature = "paths")]
    pub(crate) fn wholes(&self, name: &str) -> Result<Option<Vec<usize>>, Exception> {
        let numbers = self.numbers(name)?;
        let each = |list: Vec<f64>| {
            list.into_iter()
                .map(|value| Ok(whole(value, name)? as usize))
                .collect()
        };
        numbers.map(each).transpose()
    }
}

/// Keys and values of an object.
pub(crate) fn entries(
    value: Option<&JsValue>,
    what: &str,
) -> Result<Vec<(String, JsValue)>, Exception> {
    let Some(value) = value.filter(|value| !value.is_undefined() && !value.is_null()) else {
        return Ok(Vec::new());
    };
    let Some(object) = value.dyn_ref::<Object>() else {
        return Err(Exception::new(&format!(
            "{what} must be an object with names as keys"
        )));
    };
    let list = Object::entries(object);
    let pairs = list.iter().map(|pair| {
        let pair = Array::from(&pair);
        (pair.get(0).as_string().unwrap_or_default(), pair.get(1))
    });
    Ok(pairs.collect())
}

/// True for a typed array or an array, false for an object with other keys.
pub(crate) fn is_list(value: &JsValue) -> bool {
    let length = Reflect::get(value, &"length".into());
    length.is_ok_and(|length| length.as_f64().is_some())
}

/// Reads a whole number of at least 0; `what` names it in messages.
pub(crate) fn whole(number: f64, what: &str) -> Result<u32, Exception> {
    if number.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
        return Err(Exception::new(&format!(
            "{what} must be a whole number of at least 0, not {number}"
        )));
    }
    Ok(number as u32)
}

/// Reads a number; `what` names it in messages.
pub(crate) fn number(value: &JsValue, what: &str) -> Result<f64, Exception> {
    let not_a_number = || Exception::new(&format!("{what} must be a number"));
    value.as_f64().ok_or_else(not_a_number)
}

/// Reads a string; `what` names it in messages.
pub(crate) fn text(value: &JsValue, what: &str) -> Result<String, Exception> {
    let not_a_string = || Exception::new(&format!("{what} must be a string"));
    value.as_string().ok_or_else(not_a_string)
}

/// Reads a list of strings; `what` names it in messages.
pub(crate) fn texts(value: &JsValue, what: &str) -> Result<Vec<String>, Exception> {
    let not_a_list = || Exception::new(&format!("{what} must be a list of strings"));
    let list = list(value).ok_or_else(not_a_list)?;
    list.iter().map(|value| text(&value, what)).collect()
}

/// Content of an array or a typed array. Other objects may have any `length`, so they are not accepted.
pub(crate) fn list(value: &JsValue) -> Option<Array> {
    let is_list = Array::is_array(value) || ArrayBuffer::is_view(value);
    is_list.then(|| Array::from(value))
}

/// Numbers in a typed array or an array.
pub(crate) fn numbers(value: &JsValue, what: &str) -> Result<Vec<f64>, Exception> {
    if let Some(array) = value.dyn_ref::<Float64Array>() {
        return Ok(array.to_vec());
    }
    let not_a_list = || Exception::new(&format!("{what} must be a list of numbers"));
    let list = list(value).ok_or_else(not_a_list)?;
    let items = list.iter().enumerate();
    let number = |(index, item): (usize, JsValue)| {
        let not_a_number = || Exception::new(&format!("{what}[{index}] must be a number"));
        item.as_f64().ok_or_else(not_a_number)
    };
    items.map(number).collect()
}

/// Exactly `N` numbers.
pub(crate) fn vector<const N: usize>(value: &JsValue, what: &str) -> Result<[f64; N], Exception> {
    let numbers = numbers(value, what)?;
    let count = numbers.len();
    numbers
        .try_into()
        .map_err(|_| Exception::new(&format!("{what} has {count} numbers, expected {N}")))
}
