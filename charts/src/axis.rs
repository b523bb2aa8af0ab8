//! Axes: scale, label and range.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::ChartError;
use crate::ticks::{self, Ticks};

/// Margin around the data without a set range, relative to their width.
const MARGIN: f64 = 0.03;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Log,
}

/// An axis of a [`Chart`](crate::Chart).
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    label: String,
    scale: Scale,
    range: Option<(f64, f64)>,
}

impl Axis {
    /// Linear axis. Write the unit into the label: "solved, %".
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// Logarithmic axis, for positive values only.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Log,
            range: None,
        }
    }

    /// Sets the range `from` to `to`; points outside are drawn at the edge. By default, the axis fits the data.
    #[must_use]
    pub fn range(mut self, from: f64, to: f64) -> Self {
        self.range = Some((from, to));
        self
    }

    /// Label of the axis.
    pub(crate) fn label(&self) -> &str {
        &self.label
    }

    /// Fits the axis to its values, at least one.
    pub(crate) fn fit(
        &self,
        values: impl Iterator<Item = f64>,
        max_ticks: usize,
    ) -> Result<FittedAxis, ChartError> {
        let (from, to) = match self.range {
            Some((from, to)) => {
                let (low, high) = (self.position(from), self.position(to));
                if !(low.is_finite() && high.is_finite() && low < high) {
                    let axis = self.label.clone();
                    return Err(ChartError::BadRange { axis, from, to });
                }
                (low, high)
            }
            None => {
                let positions = values.map(|value| self.position(value));
                let (low, high) = positions
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                        (l.min(v), h.max(v))
                    });
                let margin = match high - low {
                    width if width > 0.0 => MARGIN * width,
                    _ => 0.5,
                };
                (low - margin, high + margin)
            }
        };
        let ticks = match self.scale {
            Scale::Linear => ticks::linear(from, to, max_ticks),
            Scale::Log => ticks::log(from, to, max_ticks),
        };
        Ok(FittedAxis { from, to, ticks })
    }

    /// Validates a value of a series.
    pub(crate) fn check(&self, series: &str, value: f64) -> Result<(), ChartError> {
        let takes = match self.scale {
            Scale::Linear if value.is_finite() => return Ok(()),
            Scale::Linear => "finite numbers",
            // A set range has an edge to draw zero at.
            Scale::Log if value.is_finite() && (value > 0.0 || self.range.is_some()) => {
                return Ok(());
            }
            Scale::Log => "finite numbers above 0",
        };
        Err(ChartError::BadValue {
            series: series.to_owned(),
            axis: self.label.clone(),
            value,
            takes,
        })
    }

    /// Position of a value along the axis: the value, or its decimal logarithm.
    pub(crate) fn position(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.log10(),
        }
    }
}

/// Axis with a known range, in positions (for a logarithmic axis: decades).
#[derive(Clone)]
pub(crate) struct FittedAxis {
    from: f64,
    to: f64,
    ticks: Ticks,
}

impl Ranged for FittedAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, position: &f64, (first, last): (i32, i32)) -> i32 {
        let share = (position - self.from) / (self.to - self.from);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.ticks.fine.clone()
        } else {
            self.ticks
                .labelled
                .iter()
                .map(|(position, _)| *position)
                .collect()
        }
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for FittedAxis {
    fn format_ext(&self, position: &f64) -> String {
        self.ticks.label(*position)
    }
}

impl FittedAxis {
    /// Upper end.
    pub(crate) fn to(&self) -> f64 {
        self.to
    }

    /// Nearest position within the axis.
    pub(crate) fn clamp(&self, position: f64) -> f64 {
        // Not `clamp`: −∞, the logarithm of 0, belongs at the lower end, and so does NaN.
        if position > self.from {
            position.min(self.to)
        } else {
            self.from
        }
    }
}
