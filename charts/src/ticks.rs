//! Ticks of axes and their labels.

/// Labelled ticks, and minor ticks between them, as positions along the axis.
#[derive(Clone)]
pub(crate) struct Ticks {
    pub(crate) labelled: Vec<(f64, String)>,
    pub(crate) fine: Vec<f64>,
}

impl Ticks {
    /// Label of the tick at a position.
    pub(crate) fn label(&self, position: f64) -> String {
        let is_at_position = |(p, _): &&(f64, String)| *p == position;
        let tick = self.labelled.iter().find(is_at_position);
        tick.map(|(_, text)| text.clone()).unwrap_or_default()
    }
}

/// At most `max_ticks` multiples of 1, 2 or 5 times a power of ten.
pub(crate) fn linear(from: f64, to: f64, max_ticks: usize) -> Ticks {
    let rough = (to - from) / max_ticks.max(1) as f64;
    let decade = 10_f64.powf(rough.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade);
    let step = factors.into_iter().find(|&step| step >= rough);
    let step = step.unwrap_or(10.0 * decade);
    let decimals = (-(step * 1.0001).log10().floor()).max(0.0) as usize;
    let labelled = multiples(from, to, step)
        // Adding zero removes the sign of −0.
        .map(|position| (position, format!("{:.decimals$}", position + 0.0)))
        .collect();
    Ticks {
        labelled,
        fine: Vec::new(),
    }
}

/// Labelled ticks at powers of ten, at most `max_ticks` of them; minor ticks at 2, 3 … 9 times each, if they fit.
pub(crate) fn log(from: f64, to: f64, max_ticks: usize) -> Ticks {
    let decades = (to - from).max(1.0);
    let steps = [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0];
    let fits = |step: &f64| decades / step <= max_ticks.max(1) as f64;
    let step = steps.into_iter().find(fits).unwrap_or(200.0);
    let mut labelled: Vec<_> = multiples(from, to, step)
        .map(|decade| (decade, power_of_ten(decade as i32)))
        .collect();
    let is_inside = |position: &f64| *position >= from && *position <= to;
    let decade_range = (from.floor() as i32)..=(to.ceil() as i32);
    let between = |factors: &'static [u32]| {
        decade_range.clone().flat_map(move |decade| {
            let digits = factors.iter();
            digits.map(move |&factor| {
                (
                    decade,
                    factor,
                    f64::from(decade) + f64::from(factor).log10(),
                )
            })
        })
    };
    if labelled.len() < 2 {
        // Less than two decades: label numbers in between too.
        let minor = between(&[2, 5]).filter(|(_, _, position)| is_inside(position));
        labelled
            .extend(minor.map(|(decade, factor, position)| (position, times_ten(factor, decade))));
    }
    let fine = if step == 1.0 && decades <= 6.0 {
        between(&[2, 3, 4, 5, 6, 7, 8, 9])
            .map(|(_, _, position)| position)
            .filter(is_inside)
            .collect()
    } else {
        Vec::new()
    };
    Ticks { labelled, fine }
}

fn multiples(from: f64, to: f64, step: f64) -> impl Iterator<Item = f64> {
    // Tolerance for rounding: an end that is a multiple of the step has a tick.
    let slack = 1e-9 * (to - from);
    let first = ((from - slack) / step).ceil() as i64;
    let last = ((to + slack) / step).floor() as i64;
    (first..=last).map(move |k| k as f64 * step)
}

/// Plain notation if it is short: 0.01 … 10 000, else 10⁻⁶.
fn power_of_ten(decade: i32) -> String {
    match decade {
        -3..=-1 => format!("{:.*}", decade.unsigned_abs() as usize, 10_f64.powi(decade)),
        0..=4 => format!("{}", 10_u32.pow(decade.unsigned_abs())),
        _ => format!("10{}", superscript(decade)),
    }
}

fn times_ten(factor: u32, decade: i32) -> String {
    match decade {
        -3..=-1 => {
            let decimals = decade.unsigned_abs() as usize;
            format!("{:.decimals$}", f64::from(factor) * 10_f64.powi(decade))
        }
        0..=4 => format!("{}", factor * 10_u32.pow(decade.unsigned_abs())),
        _ => format!("{factor}·10{}", superscript(decade)),
    }
}

fn superscript(number: i32) -> String {
    let raised = |c| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        other => other,
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks
            .labelled
            .iter()
            .map(|(_, text)| text.as_str())
            .collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        assert_eq!(
            labels(&linear(0.0, 100.0, 6)),
            ["0", "20", "40", "60", "80", "100"]
        );
        assert_eq!(labels(&linear(-0.11, 0.11, 4)), ["-0.1", "0.0", "0.1"]);
        assert_eq!(labels(&linear(0.0, 0.3, 3)), ["0.0", "0.1", "0.2", "0.3"]);
    }

    #[test]
    fn log_ticks_are_decades() {
        assert_eq!(
            labels(&log(-1.2, 5.1, 8)),
            ["0.1", "1", "10", "100", "1000", "10000", "10⁵"]
        );
        assert_eq!(
            labels(&log(-12.0, 1.0, 5)),
            ["10⁻¹²", "10⁻⁹", "10⁻⁶", "0.001", "1"]
        );
        assert_eq!(labels(&log(0.1, 0.9, 5)), ["2", "5"]);
        assert_eq!(log(0.0, 1.0, 5).fine.len(), 8);
    }
}
