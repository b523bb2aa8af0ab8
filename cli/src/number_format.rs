//! Number format of texts, with a precision that suits the model's size.

/// Number of decimals for lengths of a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LengthFormat {
    decimals: usize,
}

impl LengthFormat {
    /// Six digits below the leading one of `size`.
    pub(crate) fn of_size(size: f64) -> Self {
        let leading = match size > 0.0 && size.is_finite() {
            true => size.log10().floor(),
            false => 0.0,
        };
        // Clamped before the conversion, which is then exact.
        let decimals = (6.0 - leading).clamp(0.0, 15.0) as usize;
        Self { decimals }
    }

    pub(crate) fn number(self, value: f64) -> String {
        let text = format!("{value:.*}", self.decimals);
        without_minus_zero(text)
    }

    pub(crate) fn vector(self, values: [f64; 3]) -> [String; 3] {
        values.map(|value| self.number(value))
    }
}

/// Angle in radians or component of a quaternion, with six decimals.
pub(crate) fn six_digits(value: f64) -> String {
    without_minus_zero(format!("{value:.6}"))
}

/// Error with three significant digits.
pub(crate) fn magnitude(value: f64) -> String {
    match value == 0.0 {
        true => "0".to_owned(),
        false => format!("{value:.2e}"),
    }
}

/// Angle in degrees, with three decimals.
pub(crate) fn three_digits(value: f64) -> String {
    without_minus_zero(format!("{value:.3}"))
}

/// Time from microseconds, in a readable unit.
pub(crate) fn time(micros: f64) -> String {
    if micros < 1e3 {
        format!("{micros:.2} µs")
    } else if micros < 1e6 {
        format!("{:.2} ms", micros * 1e-3)
    } else {
        format!("{:.2} s", micros * 1e-6)
    }
}

fn without_minus_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_size() {
        assert_eq!(LengthFormat::of_size(1.7).number(0.25), "0.250000");
        assert_eq!(LengthFormat::of_size(250.0).number(123.456_789), "123.4568");
        assert_eq!(LengthFormat::of_size(3e-6).number(1.5e-6), "0.000001500000");
        assert_eq!(LengthFormat::of_size(4e12).number(123.4), "123");
        assert_eq!(LengthFormat::of_size(0.0).number(-1e-9), "0.000000");
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(six_digits(-0.0), "0.000000");
        assert_eq!(six_digits(-0.000_001), "-0.000001");
        assert_eq!(three_digits(-1e-9), "0.000");
    }
}
