//! Prepared chain and options, read-only for the drivers.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::atlas::{Atlas, TooledAtlas};
use super::chain::Chain;
use super::links::Links;
use super::options::{LaneError, LaneOptions};
use super::settings::Settings;

/// Normalised chain, options and seed atlas of a solver.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    pub(crate) links: Links,
    pub(crate) settings: Settings,
    pub(crate) options: LaneOptions,
    pub(crate) atlas: Option<TooledAtlas>,
    /// True if some revolute joint has a range of a whole revolution.
    pub(crate) has_full_revolution: bool,
    /// True if rounding may exceed half a tolerance at some q within the initial bounds.
    pub(crate) needs_resolution: bool,
}

impl Prepared {
    /// Normalises a chain, and builds its seed atlas unless there is one of the same joints and seed to share.
    ///
    /// # Errors
    /// Returns [`LaneError::Option`] for a tolerance, damping or weight out of range.
    pub(crate) fn new(
        chain: &Chain,
        options: LaneOptions,
        shared: Option<&Arc<Atlas>>,
    ) -> Result<Self, LaneError> {
        options.check()?;
        let links = Links::new(chain);
        let settings = Settings::new(&options, links.lengths_per_metre);
        let atlas = if options.atlas {
            TooledAtlas::new(chain, &links, options.seed, shared)
        } else {
            None
        };
        let has_full_revolution = links
            .links
            .iter()
            .any(|link| link.kind.turns() && link.upper - link.lower >= TAU);
        let max_values = links.links.iter().map(|l| l.lower.abs().max(l.upper.abs()));
        let (metres, radians) = links.resolution(max_values);
        let needs_resolution = !(metres < 0.5 * options.position_tolerance
            && radians < 0.5 * options.orientation_tolerance);
        Ok(Self {
            needs_resolution,
            atlas,
            links,
            settings,
            options,
            has_full_revolution,
        })
    }

    /// Copy without the atlas, whose configurations are useless after a change of bounds.
    pub(crate) fn without_atlas(&self) -> Self {
        Self {
            links: self.links.clone(),
            settings: self.settings,
            options: self.options.clone(),
            atlas: None,
            has_full_revolution: self.has_full_revolution,
            needs_resolution: self.needs_resolution,
        }
    }

    /// Number of moving joints.
    pub(crate) fn joints(&self) -> usize {
        self.links.links.len()
    }

    /// Sets the bounds, radians or metres, within those of the chain.
    pub(crate) fn set_bounds(&mut self, lower: &[f64], upper: &[f64]) {
        let bounds = lower.iter().zip(upper);
        self.links.set_bounds(bounds.map(|(l, u)| (*l, *u)));
    }
}
