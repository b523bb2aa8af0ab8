//! Lists of numbers separated by commas, spaces or both.

use std::str::FromStr;
use std::time::Duration;

use serde::de::{Deserialize, Deserializer, Error};

/// Largest accepted number; its square is finite, so that results of the solvers are finite.
pub const MAX_NUMBER: f64 = 1e150;

/// Parses finite numbers.
pub fn parse(text: &str) -> Result<Vec<f64>, String> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    words.filter(|word| !word.is_empty()).map(number).collect()
}

/// One or more numbers of joints: lengths in metres, angles in radians or degrees.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// The numbers.
    pub values: Vec<f64>,
    /// True if angles are in degrees, otherwise radians.
    pub degrees: bool,
}

impl Numbers {
    /// Numbers of an option, with its unit of angles.
    pub fn typed(&self, degrees: bool) -> Self {
        let values = self.values.clone();
        Self { values, degrees }
    }
}

impl FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::try_from(parse(text)?)
    }
}

impl TryFrom<Vec<f64>> for Numbers {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        if values.is_empty() {
            return Err("expected numbers".to_owned());
        }
        let values = values.into_iter().map(limited).collect::<Result<_, _>>()?;
        let degrees = false;
        Ok(Self { values, degrees })
    }
}

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        #[serde(untagged, expecting = "expected a number or a list of numbers")]
        enum OneOrMore {
            One(f64),
            More(Vec<f64>),
        }
        let numbers = match OneOrMore::deserialize(deserializer)? {
            OneOrMore::One(number) => vec![number],
            OneOrMore::More(numbers) => numbers,
        };
        Self::try_from(numbers).map_err(Error::custom)
    }
}

/// Number of a file with a check of its range, such as [`positive`].
pub(super) fn checked<'de, D: Deserializer<'de>>(
    deserializer: D,
    check: fn(f64) -> Result<f64, String>,
) -> Result<Option<f64>, D::Error> {
    let number = f64::deserialize(deserializer)?;
    check(number).map(Some).map_err(Error::custom)
}

/// Parses exactly N numbers between N − 1 commas.
pub fn parse_exactly<const N: usize>(text: &str, what: &str) -> Result<[f64; N], String> {
    let numbers = between_commas(text)?;
    let given = numbers.len();
    let wrong = |_| format!("{what} takes {N} numbers separated by commas, not {given}");
    numbers.try_into().map_err(wrong)
}

/// Parses numbers between commas, none omitted.
pub fn between_commas(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(|word| number(word.trim())).collect()
}

/// Parses one finite number, at most [`MAX_NUMBER`].
pub fn number(word: &str) -> Result<f64, String> {
    let number = word.parse();
    accepted(
        number.map_err(|_| format!("`{word}` is not a number"))?,
        word,
    )
}

/// Parses one number above zero.
pub fn positive(word: &str) -> Result<f64, String> {
    above_zero(number(word)?)
}

/// Parses one number that is not negative.
pub fn not_negative(word: &str) -> Result<f64, String> {
    from_zero(number(word)?)
}

/// Parses a time limit in milliseconds: above zero, at most 1e12, about 30 years.
pub fn milliseconds(text: &str) -> Result<Duration, String> {
    duration(number(text)?)
}

/// Finite number, at most [`MAX_NUMBER`].
pub(super) fn limited(number: f64) -> Result<f64, String> {
    accepted(number, &format!("{number:e}"))
}

/// Finite number, at most [`MAX_NUMBER`]; the error has its `word`.
fn accepted(number: f64, word: &str) -> Result<f64, String> {
    match number {
        number if number.abs() <= MAX_NUMBER => Ok(number),
        number if number.is_finite() => Err(format!(
            "`{word}` is beyond {MAX_NUMBER:e}, the largest accepted number"
        )),
        _ => Err(format!("`{word}` is not a finite number")),
    }
}

pub(super) fn above_zero(number: f64) -> Result<f64, String> {
    match limited(number)? {
        number if number > 0.0 => Ok(number),
        number => Err(format!("`{number}` is not above 0")),
    }
}

pub(super) fn from_zero(number: f64) -> Result<f64, String> {
    match limited(number)? {
        number if number >= 0.0 => Ok(number),
        number => Err(format!("`{number}` is below 0")),
    }
}

/// Time limit of a number of milliseconds.
pub(super) fn duration(milliseconds: f64) -> Result<Duration, String> {
    let milliseconds = above_zero(milliseconds)?;
    if milliseconds > 1e12 {
        return Err(format!("`{milliseconds:e}` is above 1e12 ms"));
    }
    Duration::try_from_secs_f64(milliseconds * 1e-3).map_err(|error| error.to_string())
}
