//! Serialisation of infinite and NaN numbers as text, because JSON lacks them. Residuals of callers may have such
//! values.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Other(Other),
}

#[derive(Deserialize, Serialize)]
enum Other {
    #[serde(rename = "nan")]
    Nan,
    #[serde(rename = "inf")]
    Infinity,
    #[serde(rename = "-inf")]
    MinusInfinity,
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        match value {
            f64::INFINITY => Self::Other(Other::Infinity),
            f64::NEG_INFINITY => Self::Other(Other::MinusInfinity),
            _ if value.is_nan() => Self::Other(Other::Nan),
            _ => Self::Finite(value),
        }
    }
}

impl From<Number> for f64 {
    fn from(number: Number) -> Self {
        match number {
            Number::Finite(value) => value,
            Number::Other(Other::Nan) => Self::NAN,
            Number::Other(Other::Infinity) => Self::INFINITY,
            Number::Other(Other::MinusInfinity) => Self::NEG_INFINITY,
        }
    }
}

#[doc(hidden)]
pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    Number::from(*value).serialize(to)
}

#[doc(hidden)]
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Number::deserialize(from).map(f64::from)
}

/// Serialisation of optional numbers.
pub(super) mod optional {
    use super::{Deserialize, Deserializer, Number, Serialize, Serializer};

    pub(in crate::search) fn serialize<S: Serializer>(
        value: &Option<f64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        value.map(Number::from).serialize(to)
    }

    pub(in crate::search) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<f64>, D::Error> {
        let number = Option::<Number>::deserialize(from)?;
        Ok(number.map(f64::from))
    }
}
