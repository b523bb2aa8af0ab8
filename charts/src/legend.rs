//! Legend next to the data.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend, IntoFont, Text};

use crate::ChartError;
use crate::entry::Entry;
use crate::panel::{self, FONT, FONT_SIZE, draw_error, ink};

const LINE_HEIGHT: u32 = 21;
const SAMPLE_LENGTH: i32 = 34;
const TOP_MARGIN: i32 = 44;
const MIN_WIDTH: u32 = 90;
const MAX_WIDTH: u32 = 330;
/// Upper estimate of the width of a letter of a sans-serif font, relative to its size.
const LETTER_WIDTH: f64 = 0.56;

/// Names of a figure with samples of their lines.
pub(crate) struct Legend<'e> {
    entries: &'e [Entry],
}

impl<'e> Legend<'e> {
    pub(crate) fn new(entries: &'e [Entry]) -> Self {
        Self { entries }
    }

    /// Width in pixels.
    pub(crate) fn width(&self) -> u32 {
        let letters = self.entries.iter().map(|entry| entry.name.chars().count());
        let text = letters.max().unwrap_or(0) as f64 * LETTER_WIDTH * f64::from(FONT_SIZE);
        (text as u32 + SAMPLE_LENGTH.unsigned_abs() + 20).clamp(MIN_WIDTH, MAX_WIDTH)
    }

    /// Height in pixels.
    pub(crate) fn height(&self) -> u32 {
        let lines = u32::try_from(self.entries.len()).unwrap_or(u32::MAX / LINE_HEIGHT / 2);
        TOP_MARGIN.unsigned_abs() + lines * LINE_HEIGHT
    }

    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), ChartError> {
        let font = (FONT, FONT_SIZE).into_font().color(&ink());
        let mut y = TOP_MARGIN;
        for entry in self.entries {
            let sample = [(4, y), (4 + SAMPLE_LENGTH, y)];
            panel::draw_line(area, &sample, entry.style)?;
            panel::draw_marker(area, (4 + SAMPLE_LENGTH / 2, y), entry.style)?;
            let text = Text::new(
                entry.name.clone(),
                (SAMPLE_LENGTH + 11, y - 6),
                font.clone(),
            );
            area.draw(&text).map_err(draw_error)?;
            y += LINE_HEIGHT as i32;
        }
        Ok(())
    }
}
