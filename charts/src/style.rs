//! Styles of series: colour, dash and marker.

use plotters::style::{RGBColor, ShapeStyle};

/// The colours of Okabe & Ito 2008, "Color universal design", without yellow, which is too pale for thin lines on
/// white; the most different ones first.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

const GREY: RGBColor = RGBColor(110, 110, 110);
/// Index of the colour and marker of guides, outside the lists.
const GUIDE: usize = usize::MAX;

/// Dash patterns, pixels drawn and omitted; the first is a solid line.
const DASHES: [Option<(u32, u32)>; 4] = [None, Some((9, 4)), Some((2, 3)), Some((16, 6))];

/// Style of a series: one of 7 colours, 4 dashes and 5 markers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Style {
    colour: usize,
    dash: usize,
    marker: usize,
}

impl Style {
    /// The k-th style: colours change first, then dashes.
    #[must_use]
    pub fn nth(k: usize) -> Self {
        let round = k / COLOURS.len();
        Self {
            colour: k % COLOURS.len(),
            dash: round % DASHES.len(),
            marker: (k + round) % Marker::ALL.len(),
        }
    }

    /// Style of a family with a common colour; `member` selects dash and marker.
    #[must_use]
    pub fn family(colour: usize, member: usize) -> Self {
        Self {
            colour: colour % COLOURS.len(),
            dash: member % DASHES.len(),
            marker: (colour + member) % Marker::ALL.len(),
        }
    }

    /// Style of a guide line: thin and grey, without markers; `member` selects the dash.
    #[must_use]
    pub fn guide(member: usize) -> Self {
        Self {
            colour: GUIDE,
            dash: member % DASHES.len(),
            marker: GUIDE,
        }
    }

    pub(crate) fn line(self) -> ShapeStyle {
        ShapeStyle {
            color: self.colour().into(),
            filled: false,
            stroke_width: if self.colour == GUIDE { 1 } else { 2 },
        }
    }

    pub(crate) fn dash(self) -> Option<(u32, u32)> {
        DASHES.get(self.dash).copied().flatten()
    }

    pub(crate) fn marker(self) -> Option<Marker> {
        Marker::ALL.get(self.marker).copied()
    }

    fn colour(self) -> RGBColor {
        COLOURS.get(self.colour).copied().unwrap_or(GREY)
    }
}

/// Marker at some of a series' points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Triangle,
    Square,
    Cross,
    Ring,
}

impl Marker {
    const ALL: [Self; 5] = [
        Self::Circle,
        Self::Triangle,
        Self::Square,
        Self::Cross,
        Self::Ring,
    ];
}
