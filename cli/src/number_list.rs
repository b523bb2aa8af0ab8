//! Lists of numbers separated by commas, spaces or both.

use std::time::Duration;

/// Largest accepted number; its square is finite, so that results of the solvers are finite.
pub(crate) const MAX_NUMBER: f64 = 1e150;

/// Parses finite numbers.
pub(crate) fn parse(text: &str) -> Result<Vec<f64>, String> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    words.filter(|word| !word.is_empty()).map(number).collect()
}

/// List of numbers as one value of an option.
#[derive(Clone, Debug)]
pub(crate) struct Numbers(pub(crate) Vec<f64>);

impl Numbers {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        parse(text).map(Self)
    }

    /// Parses at least one number.
    pub(crate) fn parse_some(text: &str) -> Result<Self, String> {
        match parse(text)? {
            numbers if numbers.is_empty() => Err("expected numbers".to_owned()),
            numbers => Ok(Self(numbers)),
        }
    }
}

/// Parses exactly N numbers between N − 1 commas.
pub(crate) fn parse_exactly<const N: usize>(text: &str, what: &str) -> Result<[f64; N], String> {
    let numbers = between_commas(text)?;
    let given = numbers.len();
    let wrong = |_| format!("{what} takes {N} numbers separated by commas, not {given}");
    numbers.try_into().map_err(wrong)
}

/// Parses numbers between commas, none omitted.
pub(crate) fn between_commas(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(|word| number(word.trim())).collect()
}

/// Parses one finite number, at most [`MAX_NUMBER`].
pub(crate) fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(number) if number.abs() <= MAX_NUMBER => Ok(number),
        Ok(number) if number.is_finite() => Err(format!(
            "`{word}` is beyond {MAX_NUMBER:e}, the largest accepted number"
        )),
        Ok(_) => Err(format!("`{word}` is not a finite number")),
        Err(_) => Err(format!("`{word}` is not a number")),
    }
}

/// Parses one number above zero.
pub(crate) fn positive(word: &str) -> Result<f64, String> {
    match number(word)? {
        number if number > 0.0 => Ok(number),
        _ => Err(format!("`{word}` is not above 0")),
    }
}

/// Parses a time limit in milliseconds: above zero, at most 1e12, about 30 years.
pub(crate) fn milliseconds(text: &str) -> Result<Duration, String> {
    let milliseconds = positive(text)?;
    if milliseconds > 1e12 {
        return Err(format!("`{text}` is above 1e12 ms"));
    }
    Duration::try_from_secs_f64(milliseconds * 1e-3).map_err(|error| error.to_string())
}

/// Parses one number that is not negative.
pub(crate) fn not_negative(word: &str) -> Result<f64, String> {
    match number(word)? {
        number if number >= 0.0 => Ok(number),
        _ => Err(format!("`{word}` is below 0")),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn separators_mix() {
        let mixed = parse("1,2 3, -4e-1\n,5").unwrap();
        assert_eq!(mixed, [1.0, 2.0, 3.0, -0.4, 5.0]);
        assert!(parse("").unwrap().is_empty());
        assert_eq!(parse_exactly::<2>("1, 2", "a pair").unwrap(), [1.0, 2.0]);
    }

    #[test]
    fn number_invalid_text_is_named() {
        for bad in ["x", "1,nan", "1,inf", "--json"] {
            let word = bad.rsplit(',').next().unwrap_or(bad);
            assert!(parse(bad).unwrap_err().contains(word), "{bad}");
        }
        let two = parse_exactly::<3>("1,2", "a point").unwrap_err();
        assert!(two.contains("3 numbers"));
        assert!(parse_exactly::<3>("1,,2", "a point").is_err());
        assert!(positive("0").is_err() && positive("-1").is_err() && positive("2").is_ok());
        assert!(not_negative("0").is_ok() && not_negative("-1").is_err());
    }
}
